//! Strokes, markers and words of an SVG.

use std::f64::consts::TAU;

use plotters::coord::Shift;
use plotters::element::{Drawable, PathElement, PointCollection, Polygon};
use plotters::prelude::{DrawingArea, IntoDrawingArea, IntoFont, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, TextStyle};

use super::backend::{Elements, LINE_WIDTH, SMALLER, moves};
use super::palette::{Colour, INK};
use super::sheet::{PAPER, WORDS, WORDS_ON_TINT, style};
use super::symbols::scripts;

/// Width of a picture in units.
pub(super) const WIDTH: f64 = 1100.0;

/// Text height: 33 of 1100 units are 7.1 pt where a picture is 84 mm wide, a column of a paper.
pub(super) const TEXT: f64 = 33.0;

/// Words that viewers show unscaled are at most so many pixels tall.
const TALLEST: f64 = 22.0;

/// Line spacing of a large picture.
pub(super) const LINE: f64 = 44.0;

/// Strokes and gaps of dashed lines.
pub(super) const DASHES: (f64, f64) = (14.0, 10.0);

/// Distance of words from the edges of a picture.
pub(super) const EDGE: f64 = 30.0;

/// Half of the size of a marker with corners.
pub(super) const MARKER: f64 = 11.0;
/// Radius of a hollow disc, to the middle of its line.
const DISC: f64 = 9.0;

/// A point on the canvas, y downwards.
pub(super) type CanvasPoint = (f64, f64);

/// Position of a text relative to its place.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Left,
    Centre,
    Right,
    /// Centred, reading upwards.
    Upwards,
}

pub(super) struct Canvas {
    area: DrawingArea<Elements, Shift>,
    elements: Elements,
    size: (u32, u32),
    text: f64,
}

impl Canvas {
    /// A canvas of the usual width and text, which ends where [`Self::finish_at`] says.
    pub(super) fn new() -> Self {
        Self::of_size((WIDTH as u32, u32::from(u16::MAX)), TEXT)
    }

    pub(super) fn of_size(size: (u32, u32), text: f64) -> Self {
        let elements = Elements::new(size, text);
        Self { area: elements.clone().into_drawing_area(), elements, size, text }
    }

    /// The picture, which ends at this height.
    pub(super) fn finish_at(self, height: f64) -> String {
        Self { size: (self.size.0, height as u32), ..self }.finish()
    }

    /// The picture.
    pub(super) fn finish(self) -> String {
        let Self { size: (width, height), elements, text, .. } = self;
        let scale = (TALLEST / text).min(1.0);
        let [wide, tall] = [width, height].map(|side| (scale * f64::from(side)).round());
        let (style, elements) = (style(), elements.text());
        format!(
            "<svg font-family=\"sans-serif\" font-size=\"{text}\" fill=\"{WORDS}\" stroke-width=\"{LINE_WIDTH}\" stroke-linejoin=\"round\" width=\"{wide}\" height=\"{tall}\" \
             viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\">{style}\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"{PAPER}\"/>\n{elements}</svg>\n"
        )
    }

    fn draw<'a, E>(&self, element: &'a E)
    where
        &'a E: PointCollection<'a, (i32, i32)>,
        E: Drawable<Elements>,
    {
        self.area.draw(element).expect("elements of a text have no errors");
    }

    pub(super) fn line(&mut self, path: &[CanvasPoint], colour: Colour, width: u32) {
        self.draw(&PathElement::new(pixels(path), colour.stroke_width(width)));
    }

    /// Areas under lines from lower left to upper right.
    pub(super) fn hatch(&mut self, areas: impl Iterator<Item = Vec<CanvasPoint>>, colour: Colour) {
        let data: String = areas.map(|corners| moves(pixels(&corners)) + "Z").collect();
        self.elements.push(format!(
            "<pattern id=\"hatch\" patternUnits=\"userSpaceOnUse\" width=\"13\" height=\"13\" patternTransform=\"rotate(45)\">\
             <path fill=\"none\" stroke=\"{colour}\" stroke-width=\"3\" d=\"M6 0L6 13\"/></pattern>\n\
             <path fill=\"url(#hatch)\" d=\"{data}\"/>"
        ));
    }

    /// A path of strokes of length `on` with gaps of length `off`.
    pub(super) fn dashed(&mut self, path: &[CanvasPoint], colour: Colour, (on, off): (f64, f64)) {
        let dashes = format!(" stroke-dasharray=\"{on} {off}\"");
        self.elements.line(&colour.to_string(), LINE_WIDTH, &dashes, &moves(pixels(path)));
    }

    pub(super) fn fill(&mut self, corners: &[CanvasPoint], colour: Colour, opacity: f64) {
        self.draw(&Polygon::new(pixels(corners), colour.mix(opacity).filled()));
    }

    /// A box from [left, top, right, bottom].
    pub(super) fn fill_box(&mut self, sides: [f64; 4], colour: Colour, opacity: f64) {
        self.fill(&corners(sides), colour, opacity);
    }

    pub(super) fn line_box(&mut self, sides: [f64; 4], colour: Colour, width: u32) {
        let corners = corners(sides);
        self.line(&[&corners[..], &corners[..1]].concat(), colour, width);
    }

    /// One of seven shapes by number at each place; hollow for points that are left out.
    pub(super) fn markers(
        &mut self,
        places: &[CanvasPoint],
        shape: usize,
        colour: Colour,
        hollow: bool,
    ) {
        if shape.is_multiple_of(SHAPES.len() + 1) && !hollow {
            // Points of a round pen.
            let point = |place: &CanvasPoint| moves([pixel(*place)]) + "h0";
            let data: String = places.iter().map(point).collect();
            let round = " stroke-linecap=\"round\"";
            self.elements.line(&colour.to_string(), 2 * MARKER as u32, round, &data);
            return;
        }
        let inside = if hollow { PAPER } else { colour };
        let data: String = places.iter().map(|place| outline(shape, *place)).collect();
        self.elements.push(format!("<path fill=\"{inside}\" stroke=\"{colour}\" d=\"{data}\"/>"));
    }

    pub(super) fn text(&mut self, words: &str, place: CanvasPoint, anchor: Anchor) {
        self.styled(words, place, anchor, (FontStyle::Normal, WORDS));
    }

    /// Lines so far below each other.
    pub(super) fn lines(
        &mut self,
        lines: &[String],
        (x, y): CanvasPoint,
        apart: f64,
        anchor: Anchor,
    ) {
        for (i, line) in lines.iter().enumerate() {
            self.text(line, (x, y + apart * i as f64), anchor);
        }
    }

    pub(super) fn bold(&mut self, words: &str, place: CanvasPoint) {
        self.styled(words, place, Anchor::Left, (FontStyle::Bold, WORDS));
    }

    /// A box of a light colour around lines of words; `crossed` for prints without colours.
    pub(super) fn tinted(
        &mut self,
        [left, top, right, bottom]: [f64; 4],
        (colour, crossed): (Colour, bool),
        lines: &[String],
    ) {
        self.fill_box([left, top, right, bottom], colour, 1.0);
        if crossed {
            self.line(&[(left, top), (right, bottom)], INK, 3);
            self.line(&[(left, bottom), (right, top)], INK, 3);
        }
        let apart = 1.27 * self.text;
        let first = 0.5 * (top + bottom) - 0.5 * apart * (lines.len() as f64 - 1.0);
        for (i, words) in lines.iter().enumerate() {
            let place = (0.5 * (left + right), first + apart * i as f64);
            self.styled(words, place, Anchor::Centre, (FontStyle::Normal, WORDS_ON_TINT));
        }
    }

    /// A legend of colours, on as many lines as it takes; the height below it.
    pub(super) fn swatches(
        &mut self,
        (left, mut y): CanvasPoint,
        entries: &[((Colour, bool), &str)],
    ) -> f64 {
        let mut x = left;
        for (tint, words) in entries {
            let wide = 76.0 + self.text * breadth(words);
            if x > left && x + wide > f64::from(self.size.0) {
                (x, y) = (left, y + LINE);
            }
            let sides = [x, y - 16.0, x + 60.0, y + 16.0];
            self.tinted(sides, *tint, &[]);
            self.line_box(sides, INK, 1);
            self.text(words, (x + 76.0, y), Anchor::Left);
            x += wide + EDGE;
        }
        y + LINE
    }

    /// A title and lines below it, as [`heading`] breaks them.
    pub(super) fn heading(&mut self, title: &str, lines: &[String]) {
        self.bold(title, (EDGE, LINE));
        self.lines(lines, (EDGE, 2.0 * LINE), LINE, Anchor::Left);
    }

    fn styled(
        &mut self,
        words: &str,
        place: CanvasPoint,
        anchor: Anchor,
        (weight, ink): (FontStyle, Colour),
    ) {
        if words.is_empty() {
            return;
        }
        let font = ("sans-serif", self.text).into_font().style(weight);
        let (font, horizontal) = match anchor {
            Anchor::Left => (font, HPos::Left),
            Anchor::Centre => (font, HPos::Center),
            Anchor::Right => (font, HPos::Right),
            Anchor::Upwards => (font.transform(FontTransform::Rotate270), HPos::Center),
        };
        let style = TextStyle::from(font).color(&ink).pos(Pos::new(horizontal, VPos::Center));
        self.draw(&Text::new(words, pixel(place), style));
    }
}

/// Shapes of markers after the disc: square, triangle, diamond, triangle that points down, cross, star. Points, their
/// distance from the centre in half sizes, that of the corners between them as a part, and the first point's angle upwards in
/// turns.
const SHAPES: [(usize, f64, f64, f64); 6] = [
    (4, 1.414, 0.707, 0.125),
    (3, 1.4, 0.5, 0.0),
    (4, 1.4, 0.707, 0.0),
    (3, 1.4, 0.5, 0.5),
    (4, 1.6, 0.35, 0.125),
    (5, 1.7, 0.42, 0.0),
];

/// The data of a closed path around a point.
fn outline(shape: usize, (x, y): CanvasPoint) -> String {
    let Some(shape) = (shape % (SHAPES.len() + 1)).checked_sub(1) else {
        let (left, up) = pixel((x - DISC, y));
        let r = DISC as i32;
        return format!("M{left} {up}a{r} {r} 0 1 0 {0} 0a{r} {r} 0 1 0-{0} 0z", 2 * r);
    };
    let (points, far, between, turn) = SHAPES[shape];
    let corner = |i: usize| {
        let reach = MARKER * far * if i.is_multiple_of(2) { 1.0 } else { between };
        let (sin, cos) = (TAU * (turn + i as f64 / (2 * points) as f64)).sin_cos();
        pixel((x + reach * sin, y - reach * cos))
    };
    moves((0..2 * points).map(corner)) + "z"
}

pub(super) fn corners([left, top, right, bottom]: [f64; 4]) -> [CanvasPoint; 4] {
    [(left, top), (right, top), (right, bottom), (left, bottom)]
}

/// The least and the largest of the values.
pub(super) fn span(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
}

/// Maps points, y upwards, to the middle of a room of the canvas.
#[derive(Default)]
pub(super) struct View {
    origin: (f64, f64),
    scale: f64,
    corner: (f64, f64),
}

impl View {
    /// The view of the finite points in a room [left, top, right, bottom].
    pub(super) fn of(
        points: impl Iterator<Item = (f64, f64)>,
        [left, top, right, bottom]: [f64; 4],
    ) -> Option<Self> {
        let all: Vec<_> = points.filter(|p| p.0.is_finite() && p.1.is_finite()).collect();
        let (x, y) = (span(all.iter().map(|p| p.0)), span(all.iter().map(|p| p.1)));
        let wide = |(lo, hi): (f64, f64)| (hi - lo).max(f64::MIN_POSITIVE);
        let scale = ((right - left) / wide(x)).min((bottom - top) / wide(y));
        let rest = (right - left - scale * wide(x), bottom - top - scale * wide(y));
        let corner = (left + 0.5 * rest.0, bottom - 0.5 * rest.1);
        (!all.is_empty()).then_some(Self { origin: (x.0, y.0), scale, corner })
    }

    pub(super) fn place(&self, (x, y): (f64, f64)) -> CanvasPoint {
        let away = (x - self.origin.0, y - self.origin.1);
        (self.corner.0 + self.scale * away.0, self.corner.1 - self.scale * away.1)
    }
}

fn pixel((x, y): CanvasPoint) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

fn pixels(path: &[CanvasPoint]) -> Vec<(i32, i32)> {
    path.iter().copied().map(pixel).collect()
}

// How wide words are.

/// Width of words in text heights, from above: that of DejaVu Sans, which is wider than most.
pub(super) fn breadth(words: &str) -> f64 {
    let of = |text: &str| text.chars().map(advance).sum::<f64>();
    let piece = |(sign, text): (char, String)| match sign {
        ' ' => of(&text),
        _ => SMALLER * of(&text),
    };
    scripts(words, false).into_iter().map(piece).sum()
}

fn advance(sign: char) -> f64 {
    match sign {
        ' ' | '.' | ',' | ':' | ';' | '\'' | '|' | 'i' | 'j' | 'l' | 'I' => 0.34,
        '(' | ')' | '[' | ']' | '-' | '/' | 'r' | 't' | 'f' | '·' => 0.42,
        '⁰'..='⁹' | '⁻' | '¹' | '²' | '³' => 0.42,
        '0'..='9' | 'a'..='l' | 'n'..='v' | 'x'..='z' => 0.64,
        'm' | 'M' | 'W' | '%' | '…' | '—' => 1.0,
        _ => 0.84,
    }
}

/// Breaks words into lines of at most `width` text heights.
pub(super) fn lines(words: &str, width: f64) -> Vec<String> {
    wrapped(words, |line| breadth(line) <= width)
}

/// The lines below a title, across the picture.
pub(super) fn heading(words: &str) -> Vec<String> {
    lines(words, (WIDTH - 2.0 * EDGE) / TEXT)
}

/// Breaks words at blanks into lines that fit; a word that does not has its own.
pub(super) fn wrapped(words: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words.split_whitespace() {
        let longer = lines.last().map(|line| format!("{line} {word}")).filter(|line| fits(line));
        match (lines.last_mut(), longer) {
            (Some(last), Some(longer)) => *last = longer,
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
