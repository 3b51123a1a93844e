//! Strokes, markers and words of an SVG, in units of 1/1800 of its width, in colours for colour-blind readers, after Okabe
//! and Ito (2008), each with a marker for prints without colours.
//!
//! Pictures are drawn for white paper and printed so; viewers with a dark page map their inks. The style sheet selects by
//! the colours themselves, so that a picture without media queries is the light one.

use std::fmt;

use super::symbols::{escaped, scripts};

/// Red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Colour(pub(super) u8, pub(super) u8, pub(super) u8);

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02X}{:02X}{:02X}", self.0, self.1, self.2)
    }
}

pub(super) const COLOURS: [Colour; 7] = [
    Colour(0, 114, 178),
    Colour(213, 94, 0),
    Colour(0, 158, 115),
    Colour(204, 121, 167),
    Colour(230, 159, 0),
    Colour(86, 180, 233),
    Colour(0, 0, 0),
];
/// Lines of the grid.
pub(super) const GRID: Colour = Colour(222, 222, 222);
/// Axes, triangles and floors.
pub(super) const INK: Colour = Colour(90, 90, 90);
/// Paper; hollow markers are filled with it.
pub(super) const PAPER: Colour = Colour(255, 255, 255);
const WORDS: Colour = Colour(30, 30, 30);
/// Words on an area of light colour, which a dark page leaves as it is.
const WORDS_ON_TINT: Colour = Colour(31, 31, 31);

/// Colour of the i-th curve. With four markers, 28 curves differ.
pub(super) fn colour(index: usize) -> Colour {
    COLOURS[index % COLOURS.len()]
}

/// The colour at a part of the way between two, by their numbers.
pub(super) fn mixed(from: [f64; 3], to: [f64; 3], part: f64) -> Colour {
    let [r, g, b] = [0, 1, 2].map(|i| (from[i] + part * (to[i] - from[i])) as u8);
    Colour(r, g, b)
}

/// The rules, for a page that shows several pictures.
pub(super) const RULES: &str = "\
@media (prefers-color-scheme:dark){\
svg [fill=\"#FFFFFF\"]{fill:#14171a}\
svg [fill=\"#1E1E1E\"]{fill:#e6e6e6}\
svg [fill=\"#5A5A5A\"]{fill:#a8adb3}svg [stroke=\"#5A5A5A\"]{stroke:#a8adb3}\
svg [stroke=\"#DEDEDE\"]{stroke:#33393f}\
svg [fill=\"#000000\"]{fill:#f2f2f2}svg [stroke=\"#000000\"]{stroke:#f2f2f2}\
svg [fill=\"#0072B2\"]{fill:#4aa3df}svg [stroke=\"#0072B2\"]{stroke:#4aa3df}\
svg [fill=\"#D55E00\"]{fill:#f0803c}svg [stroke=\"#D55E00\"]{stroke:#f0803c}\
svg [fill=\"#009E73\"]{fill:#2fc59a}svg [stroke=\"#009E73\"]{stroke:#2fc59a}\
svg [fill=\"#CC79A7\"]{fill:#e39cc4}svg [stroke=\"#CC79A7\"]{stroke:#e39cc4}\
svg [fill=\"#56B4E9\"]{fill:#a5dbff}svg [stroke=\"#56B4E9\"]{stroke:#a5dbff}\
}\n";

/// A picture without the rules.
pub(super) fn without(svg: &str) -> String {
    svg.replacen(&style(), "", 1)
}

/// The rules as an element of a picture.
fn style() -> String {
    format!("\n<style>{}</style>", RULES.trim_end())
}

pub(super) const SIZE: (u32, u32) = (1800, 1120);

/// Text height: 33 of 1800 units are 8.3 pt at a picture width of 16 cm.
pub(super) const TEXT: f64 = 33.0;

/// Line spacing of a large picture.
pub(super) const LINE: f64 = 44.0;

/// Strokes and gaps of dashed lines.
pub(super) const DASHES: (f64, f64) = (14.0, 10.0);

/// Half of the size of a marker.
const MARKER: f64 = 11.0;

/// Scripts are this much smaller, and this much lower or higher, relative to the text.
const SMALLER: f64 = 0.72;
const APART: f64 = 0.3;

const PATH_END: &str = "\"/>\n";

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
    elements: String,
    /// Beginning of the last element if it is a path, which a line of the same style continues.
    path: String,
    size: (u32, u32),
    text: f64,
}

impl Canvas {
    pub(super) fn new() -> Self {
        Self::of_size(SIZE, TEXT)
    }

    pub(super) fn of_size(size: (u32, u32), text: f64) -> Self {
        Self { elements: String::new(), path: String::new(), size, text }
    }

    /// The picture.
    pub(super) fn finish(self) -> String {
        self.without_head(0)
    }

    /// The picture without so much of its top.
    pub(super) fn without_head(self, head: u32) -> String {
        let Self { size: (width, height), elements, .. } = self;
        let (left, style) = (height - head, style());
        format!(
            "<svg font-family=\"sans-serif\" width=\"{width}\" height=\"{left}\" viewBox=\"0 {head} {width} {left}\" \
             xmlns=\"http://www.w3.org/2000/svg\">{style}\n\
             <rect x=\"0\" y=\"0\" width=\"{width}\" height=\"{height}\" fill=\"{PAPER}\"/>\n{elements}</svg>\n"
        )
    }

    pub(super) fn height(&self) -> f64 {
        f64::from(self.size.1)
    }

    fn push(&mut self, element: &str) {
        self.path.clear();
        self.elements += element;
        self.elements.push('\n');
    }

    /// Consecutive lines of one style are one path.
    pub(super) fn line(&mut self, path: &[CanvasPoint], ink: Colour, width: u32) {
        let begins = format!("<path fill=\"none\" stroke=\"{ink}\" stroke-width=\"{width}\" d=\"");
        if begins == self.path {
            self.elements.truncate(self.elements.len() - PATH_END.len());
        } else {
            self.elements += &begins;
            self.path = begins;
        }
        self.elements += &moves(path);
        self.elements += PATH_END;
    }

    /// Areas under lines from lower left to upper right.
    pub(super) fn hatch(&mut self, areas: impl Iterator<Item = Vec<CanvasPoint>>, colour: Colour) {
        let data: String = areas.map(|corners| moves(&corners) + "Z").collect();
        self.push(&format!(
            "<pattern id=\"hatch\" patternUnits=\"userSpaceOnUse\" width=\"13\" height=\"13\" patternTransform=\"rotate(45)\">\
             <path fill=\"none\" stroke=\"{colour}\" stroke-width=\"3\" d=\"M6 0L6 13\"/></pattern>\n\
             <path fill=\"url(#hatch)\" d=\"{data}\"/>"
        ));
    }

    /// A path of strokes of length `on` with gaps of length `off`.
    pub(super) fn dashed(&mut self, path: &[CanvasPoint], colour: Colour, (on, off): (f64, f64)) {
        let mut phase = 0.0;
        for pair in path.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            let along = |s: f64| {
                let share = s / length;
                (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1))
            };
            let mut start = -phase;
            while start < length {
                let stroke = (start.max(0.0), (start + on).min(length));
                if stroke.1 > stroke.0 {
                    self.line(&[along(stroke.0), along(stroke.1)], colour, 4);
                }
                start += on + off;
            }
            phase = (phase + length) % (on + off);
        }
    }

    pub(super) fn fill(&mut self, corners: &[CanvasPoint], ink: Colour, opacity: f64) {
        let faint = if opacity < 1.0 { format!(" opacity=\"{opacity}\"") } else { String::new() };
        let corners = corners.iter().map(|corner| pixel(*corner));
        let points: String = corners.map(|(x, y)| format!("{x},{y} ")).collect();
        self.push(&format!("<polygon{faint} fill=\"{ink}\" points=\"{points}\"/>"));
    }

    /// A box from [left, top, right, bottom].
    pub(super) fn fill_box(&mut self, sides: [f64; 4], colour: Colour, opacity: f64) {
        self.fill(&corners(sides), colour, opacity);
    }

    pub(super) fn line_box(&mut self, sides: [f64; 4], colour: Colour, width: u32) {
        let corners = corners(sides);
        self.line(&[&corners[..], &corners[..1]].concat(), colour, width);
    }

    /// One of four shapes by number; hollow for a point that is left out.
    pub(super) fn marker(
        &mut self,
        place: CanvasPoint,
        shape: usize,
        colour: Colour,
        hollow: bool,
    ) {
        let corners = outline(shape, place);
        let inside = if hollow { PAPER } else { colour };
        if corners.is_empty() {
            for (radius, ink) in [(MARKER, colour), (MARKER - 4.0, inside)] {
                let (x, y) = pixel(place);
                self.push(&format!(
                    "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{ink}\" stroke-width=\"1\"/>"
                ));
            }
            return;
        }
        self.fill(&corners, inside, 1.0);
        let closed: Vec<CanvasPoint> = corners.iter().chain(corners.first()).copied().collect();
        self.line(&closed, colour, 4);
    }

    pub(super) fn text(&mut self, words: &str, place: CanvasPoint, anchor: Anchor) {
        self.styled(words, place, anchor, ("", WORDS));
    }

    pub(super) fn bold(&mut self, words: &str, place: CanvasPoint) {
        self.styled(words, place, Anchor::Left, (" font-weight=\"bold\"", WORDS));
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
            self.styled(words, place, Anchor::Centre, ("", WORDS_ON_TINT));
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
        (weight, ink): (&str, Colour),
    ) {
        let ((x, y), size) = (pixel(place), self.text);
        let (anchor, turned) = match anchor {
            Anchor::Left => ("", String::new()),
            Anchor::Centre => (" text-anchor=\"middle\"", String::new()),
            Anchor::Right => (" text-anchor=\"end\"", String::new()),
            Anchor::Upwards => {
                (" text-anchor=\"middle\"", format!(" transform=\"rotate(270, {x}, {y})\""))
            }
        };
        if !words.is_empty() {
            self.push(&format!(
                "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\"{anchor} font-size=\"{size}\" fill=\"{ink}\"{weight}{turned}>{}</text>",
                set(words, size)
            ));
        }
    }
}

/// `M1 2L3 4`: from the first point through the others.
fn moves(path: &[CanvasPoint]) -> String {
    let letters = std::iter::once('M').chain(std::iter::repeat('L'));
    let points = letters.zip(path.iter().map(|point| pixel(*point)));
    points.map(|(letter, (x, y))| format!("{letter}{x} {y}")).collect()
}

/// Words with their scripts low and high.
fn set(words: &str, size: f64) -> String {
    let (shift, small) = ((APART * size).round(), (SMALLER * size).round());
    let mut back = 0.0;
    let piece = |(sign, text): (char, String)| {
        let there = match sign {
            '_' => shift,
            '^' => -shift,
            _ => 0.0,
        };
        let text = escaped(&text);
        let dy = there + std::mem::replace(&mut back, -there);
        match (there == 0.0, dy == 0.0) {
            (true, true) => text,
            (true, false) => format!("<tspan dy=\"{dy}\">{text}</tspan>"),
            (false, _) => format!("<tspan dy=\"{dy}\" font-size=\"{small}\">{text}</tspan>"),
        }
    };
    scripts(words, false).into_iter().map(piece).collect()
}

fn outline(shape: usize, (x, y): CanvasPoint) -> Vec<CanvasPoint> {
    let corners: &[CanvasPoint] = match shape % 4 {
        0 => &[],
        1 => &[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)],
        2 => &[(0.0, -1.3), (1.2, 0.9), (-1.2, 0.9)],
        _ => &[(0.0, -1.4), (1.4, 0.0), (0.0, 1.4), (-1.4, 0.0)],
    };
    corners.iter().map(|(dx, dy)| (x + MARKER * dx, y + MARKER * dy)).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Every ink except the light orange has its counterpart, spelt as pictures spell it.
    #[test]
    fn every_ink_has_a_dark_counterpart() {
        let orange = Colour(230, 159, 0);
        let inks = COLOURS.into_iter().filter(|colour| *colour != orange);
        for ink in inks.chain([PAPER, WORDS, GRID, INK]) {
            assert!(RULES.contains(&ink.to_string()), "{ink}");
        }
        assert!(!RULES.contains(&WORDS_ON_TINT.to_string()));
        let svg = Canvas::new().finish();
        assert!(svg.contains("2000/svg\">\n<style>@media") && !without(&svg).contains("style"));
    }
}
