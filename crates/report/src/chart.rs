//! A picture of series over two axes.

use super::ReportError;
use super::canvas::{Anchor, Canvas, CanvasPoint, SIZE};
use super::direct;
use super::frame::{Frame, RIGHT, TITLE_ROOM};
use super::legend::{Legend, Sample, Stroke};
use super::marks::{draw_marks, mark_entries};
use super::palette::{INK, colour};
use super::ruler::Scale;
use super::sheet::with_sheet;
use super::slope::{self, Slope};
use plotters::style::RGBColor;

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
    Points(Vec<Datum>),
    /// Shown but not counted.
    Hollow(Vec<Datum>),
    /// A light area with these corners.
    Band(Vec<Datum>),
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

/// The meaning of a sign that no series explains.
#[derive(Debug, Clone, PartialEq)]
pub enum LegendKey {
    /// Of an area.
    Band(String),
    /// Of hollow markers.
    Hollow(String),
    /// Of dashed lines.
    Dashed(String),
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
    pub labels: Vec<(Datum, String)>,
    pub keys: Vec<LegendKey>,
    pub note: String,
    /// Writes names at the ends of lines, not in the legend.
    pub direct: bool,
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

    fn sample(&self, shape: usize) -> Sample {
        let marker = self.parts.iter().any(Part::has_markers);
        let stroke = self.parts.iter().find_map(|part| match part {
            Part::Line(_) => Some(Stroke::Full),
            Part::Dashed(_) => Some(Stroke::Broken(DASHES)),
            Part::Dotted(_) => Some(Stroke::Broken(DOTS)),
            Part::Points(_) | Part::Hollow(_) | Part::Band(_) => None,
        });
        Sample::Series { stroke, shape: marker.then_some(shape) }
    }
}

/// Strokes and gaps of dashed lines, and of dotted ones.
const DASHES: (f64, f64) = (14.0, 10.0);
const DOTS: (f64, f64) = (4.0, 9.0);

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
            | Part::Points(points)
            | Part::Hollow(points)
            | Part::Band(points) => points,
        }
    }

    pub(super) fn has_markers(&self) -> bool {
        matches!(self, Part::Points(_) | Part::Hollow(_))
    }

    /// Areas lie below lines, lines below markers.
    fn layer(&self) -> usize {
        match self {
            Part::Band(_) => 0,
            Part::Line(_) | Part::Dashed(_) | Part::Dotted(_) => 1,
            Part::Points(_) | Part::Hollow(_) => 2,
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
        }
    }

    /// The picture as SVG; none if no point has a place.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub fn svg(&self) -> Result<Option<String>, ReportError> {
        let Some((frame, slopes)) = self.arranged() else {
            return Ok(None);
        };
        let mut svg = String::new();
        let canvas = Canvas::new(&mut svg)?;
        frame.draw(&canvas, self)?;
        draw_marks(&canvas, &frame, self)?;
        for layer in 0..3 {
            for (series, (ink, shape)) in self.series.iter().zip(self.inks()) {
                for part in series.parts.iter().filter(|part| part.layer() == layer) {
                    self.draw_part(&canvas, &frame, part, ink, shape)?;
                }
            }
        }
        for placed in &slopes {
            placed.draw(&canvas, self.inks()[placed.series].0)?;
        }
        for (point, words) in &self.labels {
            let (x, y) = frame.place(*point);
            let end = x + LABEL.0 + CHARACTER * words.chars().count() as f64;
            let (x, anchor) = match end > RIGHT {
                true => (RIGHT - LABEL.0, Anchor::Right),
                false => (x + LABEL.0, Anchor::Left),
            };
            canvas.text(words, (x, y + LABEL.1), anchor)?;
        }
        self.draw_legend(&canvas, &frame, !slopes.is_empty())?;
        canvas.finish()?;
        let svg = if self.title.is_empty() { without_head(&svg) } else { svg };
        Ok(Some(with_sheet(&svg)))
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
    pub(super) fn inks(&self) -> Vec<(RGBColor, usize)> {
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

    fn draw_part(
        &self,
        canvas: &Canvas<'_>,
        frame: &Frame,
        part: &Part,
        ink: RGBColor,
        shape: usize,
    ) -> Result<(), ReportError> {
        for run in self.runs(frame, part) {
            match part {
                Part::Line(_) => canvas.line(&run, ink, 4)?,
                Part::Dashed(_) => canvas.dashed(&run, ink, DASHES)?,
                Part::Dotted(_) => canvas.dashed(&run, ink, DOTS)?,
                Part::Band(_) => canvas.fill(&run, ink, 0.22)?,
                Part::Points(_) | Part::Hollow(_) => {
                    let hollow = matches!(part, Part::Hollow(_));
                    run.into_iter().try_for_each(|at| canvas.marker(at, shape, ink, hollow))?;
                }
            }
        }
        Ok(())
    }

    fn draw_legend(
        &self,
        canvas: &Canvas<'_>,
        frame: &Frame,
        triangles: bool,
    ) -> Result<(), ReportError> {
        let mut legend = Legend::new(canvas);
        let direct = self.direct && direct::fits(self);
        if direct {
            legend.below(direct::draw(canvas, self, frame)?);
        }
        for (series, (ink, shape)) in self.series.iter().zip(self.inks()) {
            if !series.name.is_empty() && !direct {
                legend.entry(series.sample(shape), ink, &series.name)?;
                for words in series.detail.lines() {
                    legend.entry(Sample::Text, INK, words)?;
                }
                legend.space();
            }
        }
        for (sample, words) in mark_entries(self) {
            legend.entry(sample, INK, &words)?;
        }
        for key in &self.keys {
            let (sample, words) = match key {
                LegendKey::Band(words) => (Sample::Band, words),
                LegendKey::Hollow(words) => (Sample::Hollow, words),
                LegendKey::Dashed(words) => {
                    (Sample::Series { stroke: Some(Stroke::Broken(DASHES)), shape: None }, words)
                }
            };
            legend.entry(sample, INK, words)?;
        }
        if triangles {
            legend.entry(Sample::Text, INK, "triangle: predicted order")?;
        }
        legend.space();
        legend.entry(Sample::Text, INK, &self.note)
    }
}

/// The picture without the room for its title.
fn without_head(svg: &str) -> String {
    let ((width, height), head) = (SIZE, TITLE_ROOM);
    let size = |from: u32| {
        let left = height - from;
        format!("height=\"{left}\" viewBox=\"0 {from} {width} {left}\"")
    };
    svg.replacen(&size(0), &size(head), 1)
}

#[cfg(test)]
mod tests;
