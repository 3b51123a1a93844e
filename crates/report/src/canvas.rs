//! Strokes, markers and words of an SVG, in units of 1/1800 of its width.

use plotters::coord::Shift;
use plotters::element::{Drawable, PathElement, PointCollection, Polygon};
use plotters::prelude::{DrawingArea, IntoDrawingArea, IntoFont, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, TextStyle};

use super::backend::{Elements, LINE_WIDTH, moves};
use super::palette::{Colour, INK};
use super::sheet::{PAPER, WORDS, WORDS_ON_TINT, style};

pub(super) const SIZE: (u32, u32) = (1800, 1120);

/// Text height: 33 of 1800 units are 8.3 pt at a picture width of 16 cm.
pub(super) const TEXT: f64 = 33.0;

/// Line spacing of a large picture.
pub(super) const LINE: f64 = 44.0;

/// Strokes and gaps of dashed lines.
pub(super) const DASHES: (f64, f64) = (14.0, 10.0);

/// Half of the size of a marker with corners.
const MARKER: f64 = 11.0;
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
    pub(super) fn new() -> Self {
        Self::of_size(SIZE, TEXT)
    }

    pub(super) fn of_size(size: (u32, u32), text: f64) -> Self {
        let elements = Elements::new(size, text);
        Self { area: elements.clone().into_drawing_area(), elements, size, text }
    }

    /// The picture.
    pub(super) fn finish(self) -> String {
        self.without_head(0)
    }

    /// The picture without so much of its top.
    pub(super) fn without_head(self, head: u32) -> String {
        let Self { size: (width, height), elements, text, .. } = self;
        let (left, style, elements) = (height - head, style(), elements.text());
        format!(
            "<svg font-family=\"sans-serif\" font-size=\"{text}\" fill=\"{WORDS}\" stroke-width=\"{LINE_WIDTH}\" stroke-linejoin=\"round\" width=\"{width}\" height=\"{left}\" \
             viewBox=\"0 {head} {width} {left}\" xmlns=\"http://www.w3.org/2000/svg\">{style}\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"{PAPER}\"/>\n{elements}</svg>\n"
        )
    }

    pub(super) fn height(&self) -> f64 {
        f64::from(self.size.1)
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

    /// One of four shapes by number at each place; hollow for points that are left out.
    pub(super) fn markers(
        &mut self,
        places: &[CanvasPoint],
        shape: usize,
        colour: Colour,
        hollow: bool,
    ) {
        if shape.is_multiple_of(4) && !hollow {
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

    /// A legend of colours on one line.
    pub(super) fn swatches<const COUNT: usize>(
        &mut self,
        (mut x, y): CanvasPoint,
        entries: [((Colour, bool), &str); COUNT],
    ) {
        for (tint, words) in entries {
            let sides = [x, y - 16.0, x + 60.0, y + 16.0];
            self.tinted(sides, tint, &[]);
            self.line_box(sides, INK, 1);
            self.text(words, (x + 76.0, y), Anchor::Left);
            x += 120.0 + 0.53 * self.text * words.chars().count() as f64;
        }
    }

    /// A title, and lines below it.
    pub(super) fn heading(&mut self, title: &str, lines: &[String]) {
        self.bold(title, (30.0, 44.0));
        for (i, line) in lines.iter().enumerate() {
            self.text(line, (30.0, 44.0 + LINE * (i + 1) as f64), Anchor::Left);
        }
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

/// The data of a closed path around a point.
fn outline(shape: usize, (x, y): CanvasPoint) -> String {
    let corners: &[CanvasPoint] = match shape % 4 {
        0 => {
            let (left, up) = pixel((x - DISC, y));
            let r = DISC as i32;
            return format!("M{left} {up}a{r} {r} 0 1 0 {0} 0a{r} {r} 0 1 0-{0} 0z", 2 * r);
        }
        1 => &[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)],
        2 => &[(0.0, -1.3), (1.2, 0.9), (-1.2, 0.9)],
        _ => &[(0.0, -1.4), (1.4, 0.0), (0.0, 1.4), (-1.4, 0.0)],
    };
    moves(corners.iter().map(|(dx, dy)| pixel((x + MARKER * dx, y + MARKER * dy)))) + "z"
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
    scale: (f64, f64),
    corner: (f64, f64),
}

impl View {
    /// The view of the finite points in a room [left, top, right, bottom]; both axes have one scale unless `stretched`.
    pub(super) fn of(
        points: impl Iterator<Item = (f64, f64)>,
        [left, top, right, bottom]: [f64; 4],
        stretched: bool,
    ) -> Option<Self> {
        let all: Vec<_> = points.filter(|p| p.0.is_finite() && p.1.is_finite()).collect();
        let (x, y) = (span(all.iter().map(|p| p.0)), span(all.iter().map(|p| p.1)));
        let wide = |(lo, hi): (f64, f64)| (hi - lo).max(f64::MIN_POSITIVE);
        let mut scale = ((right - left) / wide(x), (bottom - top) / wide(y));
        if !stretched {
            scale = (scale.0.min(scale.1), scale.0.min(scale.1));
        }
        let rest = (right - left - scale.0 * wide(x), bottom - top - scale.1 * wide(y));
        let corner = (left + 0.5 * rest.0, bottom - 0.5 * rest.1);
        (!all.is_empty()).then_some(Self { origin: (x.0, y.0), scale, corner })
    }

    pub(super) fn place(&self, (x, y): (f64, f64)) -> CanvasPoint {
        let away = (x - self.origin.0, y - self.origin.1);
        (self.corner.0 + self.scale.0 * away.0, self.corner.1 - self.scale.1 * away.1)
    }
}

fn pixel((x, y): CanvasPoint) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

fn pixels(path: &[CanvasPoint]) -> Vec<(i32, i32)> {
    path.iter().copied().map(pixel).collect()
}
