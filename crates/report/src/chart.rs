//! A picture of series over two axes.

use super::canvas::{Anchor, Canvas, CanvasPoint, DASHES, LINE};
use super::canvas::{Colour, INK, colour};
use super::direct;
use super::frame::{Frame, LARGE, Layout, SMALL, TITLE_ROOM};
use super::legend::{Legend, wrapped};
use super::marks::{draw_marks, mark_entries};
use super::ruler::Scale;
use super::slope::{self, Slope};

/// x and y.
pub type Datum = (f64, f64);

/// An axis with its label (including units) and scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    pub label: String,
    pub scale: Scale,
}

/// A part of a series. Points that cannot be placed (not finite, or not positive on a logarithmic axis) are skipped and
/// interrupt lines.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    Line(Vec<Datum>),
    /// Dashed.
    Dashed(Vec<Datum>),
    Dotted(Vec<Datum>),
    /// Of strokes and gaps of these lengths.
    Broken((f64, f64), Vec<Datum>),
    Points(Vec<Datum>),
    /// Shown but not counted.
    Hollow(Vec<Datum>),
}

/// One name: one colour, one marker shape, one entry of the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its words in the legend; without any it has no entry.
    pub name: String,
    /// More lines below the name.
    pub detail: String,
    pub parts: Vec<Part>,
    /// Grey for what belongs to all series; else the next colour.
    pub grey: bool,
    /// A triangle of the predicted order near it, if both axes are logarithmic.
    pub slope: Option<Slope>,
}

/// A line across the picture at a value of one axis, with a letter at its end. A value that cannot be placed (an
/// infinite threshold) only has its words in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// The value on the axis.
    pub at: f64,
    /// Words in the legend.
    pub label: String,
}

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// First line, in bold; empty if a heading above the picture says it.
    pub title: String,
    pub question: String,
    pub x: Axis,
    pub y: Axis,
    /// The legend keeps this order.
    pub series: Vec<Series>,
    pub verticals: Vec<Mark>,
    pub horizontals: Vec<Mark>,
    /// Words beside points; those that would stand on others before them are left out.
    pub labels: Vec<(Datum, String)>,
    /// Signs that no series explains, with their meaning.
    pub keys: Vec<(Part, String)>,
    pub note: String,
    /// Writes names at the ends of lines, not in the legend.
    pub direct: bool,
    /// Readable at 240 pixels, with room for a few short names.
    pub small: bool,
}

impl Axis {
    /// An axis.
    pub fn new(label: impl Into<String>, scale: Scale) -> Self {
        Self { label: label.into(), scale }
    }
}

impl Series {
    /// A series of these parts.
    pub fn new(name: impl Into<String>, parts: Vec<Part>) -> Self {
        Self { name: name.into(), detail: String::new(), parts, grey: false, slope: None }
    }

    /// Its first line and its markers, filled.
    fn samples(&self) -> Vec<&Part> {
        let line = self.parts.iter().find(|part| !part.has_markers());
        let marker = self.parts.iter().find(|part| part.has_markers());
        line.into_iter().chain(marker).collect()
    }
}

/// Strokes and gaps of dotted lines.
const DOTS: (f64, f64) = (4.0, 9.0);

/// Characters in the width of the picture.
const TITLE_CHARACTERS: usize = 92;

/// Offset of words from their point: above the line that goes on to the right.
const LABEL: (f64, f64) = (10.0, -34.0);
/// Maximal width of a character.
const CHARACTER: f64 = 17.5;

/// Limit of decades added below to make room for the triangles.
const LONGER: i32 = 3;

impl Part {
    pub(super) fn points(&self) -> &[Datum] {
        match self {
            Part::Line(points)
            | Part::Dashed(points)
            | Part::Dotted(points)
            | Part::Broken(_, points)
            | Part::Points(points)
            | Part::Hollow(points) => points,
        }
    }

    pub(super) fn has_markers(&self) -> bool {
        matches!(self, Part::Points(_) | Part::Hollow(_))
    }

    /// Draws an uninterrupted run of places as this part is drawn, by colour and shape.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas,
        run: &[CanvasPoint],
        (ink, shape): (Colour, usize),
    ) {
        match self {
            Part::Line(_) => canvas.line(run, ink, 4),
            Part::Dashed(_) => canvas.dashed(run, ink, DASHES),
            Part::Dotted(_) => canvas.dashed(run, ink, DOTS),
            Part::Broken(pattern, _) => canvas.dashed(run, ink, *pattern),
            Part::Points(_) => run.iter().for_each(|at| canvas.marker(*at, shape, ink, false)),
            Part::Hollow(_) => run.iter().for_each(|at| canvas.marker(*at, shape, ink, true)),
        }
    }
}

impl Chart {
    /// A chart without series.
    pub fn new(title: &str, question: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            question: question.to_owned(),
            x,
            y,
            series: Vec::new(),
            verticals: Vec::new(),
            horizontals: Vec::new(),
            labels: Vec::new(),
            keys: Vec::new(),
            note: String::new(),
            direct: false,
            small: false,
        }
    }

    /// The picture as SVG; none if no point has a place.
    pub fn svg(&self) -> Option<String> {
        let (frame, slopes) = self.arranged()?;
        let layout = self.layout();
        let mut canvas = Canvas::of_size(layout.size, layout.text);
        canvas.heading(&self.title, &wrapped(&self.question, TITLE_CHARACTERS, 2));
        frame.draw(&mut canvas, [&self.x.label, &self.y.label]);
        canvas.line_box(layout.room, INK, 3);
        draw_marks(&mut canvas, &frame, self);
        // Lines lie below markers.
        for markers in [false, true] {
            for (series, ink) in self.series.iter().zip(self.inks()) {
                for part in series.parts.iter().filter(|part| part.has_markers() == markers) {
                    self.runs(&frame, part).iter().for_each(|run| part.draw(&mut canvas, run, ink));
                }
            }
        }
        for placed in &slopes {
            placed.draw(&mut canvas, self.inks()[placed.series].0);
        }
        // The ends and heights of the labels that are drawn: none stands on one before it.
        let mut taken: Vec<[f64; 3]> = Vec::new();
        for (point, words) in &self.labels {
            let (x, y) = frame.place(*point);
            let (width, right) = (CHARACTER * words.chars().count() as f64, layout.room[2]);
            let (place, anchor, left) = match x + LABEL.0 + width > right {
                true => (right - LABEL.0, Anchor::Right, right - LABEL.0 - width),
                false => (x + LABEL.0, Anchor::Left, x + LABEL.0),
            };
            let clear = |[from, to, height]: &[f64; 3]| {
                (y - height).abs() >= LINE || *to <= left || left + width <= *from
            };
            if taken.iter().all(clear) {
                canvas.text(words, (place, y + LABEL.1), anchor);
                taken.push([left, left + width, y]);
            }
        }
        self.draw_legend(&mut canvas, &frame, !slopes.is_empty());
        let has_head = self.small || !self.title.is_empty();
        Some(canvas.without_head(if has_head { 0 } else { TITLE_ROOM }))
    }

    pub(super) fn layout(&self) -> &'static Layout {
        if self.small { &SMALL } else { &LARGE }
    }

    /// The axes, extended until every triangle has a place; failing that, the triangle is omitted.
    fn arranged(&self) -> Option<(Frame, Vec<slope::Placed>)> {
        let mut frame = Frame::new(self, &[])?;
        let wanted = self.series.iter().filter(|series| series.slope.is_some()).count();
        let mut slopes = slope::place(self, &frame);
        let heights = self.series.iter().flat_map(|s| &s.parts).flat_map(|p| p.points());
        let lowest = heights.map(|p| p.1).filter(|y| self.y.scale.holds(*y));
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        for decades in 1..=LONGER {
            if slopes.len() == wanted {
                break;
            }
            let longer = Frame::new(self, &[lowest * 10f64.powi(-decades)])?;
            let found = slope::place(self, &longer);
            if found.len() > slopes.len() {
                (frame, slopes) = (longer, found);
            }
        }
        Some((frame, slopes))
    }

    /// Colour and shape of each series.
    pub(super) fn inks(&self) -> Vec<(Colour, usize)> {
        let mut next = 0;
        let ink = |series: &Series| {
            if series.grey {
                return (INK, 0);
            }
            next += 1;
            (colour(next - 1), next - 1)
        };
        self.series.iter().map(ink).collect()
    }

    /// The places of a part, cut at points without a place.
    pub(super) fn runs(&self, frame: &Frame, part: &Part) -> Vec<Vec<CanvasPoint>> {
        let holds = |p: &Datum| self.x.scale.holds(p.0) && self.y.scale.holds(p.1);
        let pieces = part.points().split(|point| !holds(point));
        pieces
            .filter(|piece| !piece.is_empty())
            .map(|piece| piece.iter().map(|point| frame.place(*point)).collect())
            .collect()
    }

    fn draw_legend(&self, canvas: &mut Canvas, frame: &Frame, triangles: bool) {
        let [_, top, _, bottom] = frame.room;
        let direct = self.direct && direct::fits(self, [top, bottom]);
        let lowest = if direct { direct::draw(canvas, self, frame) } else { 0.0 };
        let mut legend = Legend::new(canvas, frame);
        if direct {
            legend.below(lowest);
        }
        let grey = (INK, 0);
        for (series, ink) in self.series.iter().zip(self.inks()) {
            if !series.name.is_empty() && !direct {
                legend.entry(&series.samples(), ink, &series.name);
                series.detail.lines().for_each(|words| legend.entry(&[], grey, words));
                legend.space();
            }
        }
        for (sample, words) in mark_entries(self) {
            legend.entry(&sample.iter().collect::<Vec<_>>(), grey, &words);
        }
        for (sample, words) in &self.keys {
            legend.entry(&[sample], grey, words);
        }
        if triangles {
            legend.entry(&[], grey, "triangle: predicted order");
        }
        legend.space();
        legend.entry(&[], grey, &self.note);
    }
}

#[cfg(test)]
mod tests;
