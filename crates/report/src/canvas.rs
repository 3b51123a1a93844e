//! Strokes, markers and words on an SVG, in units of 1/1800 of its width.

use plotters::coord::Shift;
use plotters::element::{Circle, PathElement, Polygon};
use plotters::prelude::{DrawingArea, IntoDrawingArea, IntoFont, RGBColor, SVGBackend, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, TextStyle};

use super::ReportError;
use super::sheet::{PAPER, WORDS, WORDS_ON_TINT};
use files::harmless;

pub(super) const SIZE: (u32, u32) = (1800, 1120);

/// Text height: 33 of 1800 units are 8.3 pt at a picture width of 16 cm.
const TEXT: f64 = 33.0;

/// plotters divides font sizes by this.
const PLOTTERS_FONT: f64 = 1.24;

/// Half of the size of a marker.
const MARKER: f64 = 11.0;

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

pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
    text: f64,
}

impl<'a> Canvas<'a> {
    pub(super) fn new(svg: &'a mut String) -> Result<Self, ReportError> {
        Self::of_size(svg, SIZE, TEXT)
    }

    pub(super) fn of_size(
        svg: &'a mut String,
        size: (u32, u32),
        text: f64,
    ) -> Result<Self, ReportError> {
        let area = SVGBackend::with_string(svg, size).into_drawing_area();
        area.fill(&PAPER).map_err(ReportError::drawing)?;
        Ok(Self { area, text })
    }

    pub(super) fn finish(self) -> Result<(), ReportError> {
        self.area.present().map_err(ReportError::drawing)
    }

    pub(super) fn line(
        &self,
        path: &[CanvasPoint],
        colour: RGBColor,
        width: u32,
    ) -> Result<(), ReportError> {
        let style = colour.stroke_width(width);
        self.area.draw(&PathElement::new(pixels(path), style)).map_err(ReportError::drawing)
    }

    /// A path of strokes of length `on` with gaps of length `off`.
    pub(super) fn dashed(
        &self,
        path: &[CanvasPoint],
        colour: RGBColor,
        (on, off): (f64, f64),
    ) -> Result<(), ReportError> {
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
                    self.line(&[along(stroke.0), along(stroke.1)], colour, 4)?;
                }
                start += on + off;
            }
            phase = (phase + length) % (on + off);
        }
        Ok(())
    }

    pub(super) fn fill(
        &self,
        corners: &[CanvasPoint],
        colour: RGBColor,
        opacity: f64,
    ) -> Result<(), ReportError> {
        let shape = Polygon::new(pixels(corners), colour.mix(opacity).filled());
        self.area.draw(&shape).map_err(ReportError::drawing)
    }

    /// A box from [left, top, right, bottom].
    pub(super) fn fill_box(
        &self,
        sides: [f64; 4],
        colour: RGBColor,
        opacity: f64,
    ) -> Result<(), ReportError> {
        self.fill(&corners(sides), colour, opacity)
    }

    pub(super) fn line_box(
        &self,
        sides: [f64; 4],
        colour: RGBColor,
        width: u32,
    ) -> Result<(), ReportError> {
        let corners = corners(sides);
        self.line(&[&corners[..], &corners[..1]].concat(), colour, width)
    }

    /// One of four shapes by number; hollow for a point that is left out.
    pub(super) fn marker(
        &self,
        place: CanvasPoint,
        shape: usize,
        colour: RGBColor,
        hollow: bool,
    ) -> Result<(), ReportError> {
        let corners = outline(shape, place);
        let inside = if hollow { PAPER } else { colour };
        if corners.is_empty() {
            let disc = |radius: f64, ink: RGBColor| {
                Circle::new(pixel(place), radius.round() as i32, ink.filled())
            };
            self.area.draw(&disc(MARKER, colour)).map_err(ReportError::drawing)?;
            return self.area.draw(&disc(MARKER - 4.0, inside)).map_err(ReportError::drawing);
        }
        self.fill(&corners, inside, 1.0)?;
        let closed: Vec<CanvasPoint> = corners.iter().chain(corners.first()).copied().collect();
        self.line(&closed, colour, 4)
    }

    pub(super) fn text(
        &self,
        words: &str,
        place: CanvasPoint,
        anchor: Anchor,
    ) -> Result<(), ReportError> {
        self.styled(words, place, anchor, (FontStyle::Normal, WORDS))
    }

    pub(super) fn bold(&self, words: &str, place: CanvasPoint) -> Result<(), ReportError> {
        self.styled(words, place, Anchor::Left, (FontStyle::Bold, WORDS))
    }

    /// Words centred on an area of light colour.
    pub(super) fn on_tint(&self, words: &str, place: CanvasPoint) -> Result<(), ReportError> {
        self.styled(words, place, Anchor::Centre, (FontStyle::Normal, WORDS_ON_TINT))
    }

    fn styled(
        &self,
        words: &str,
        place: CanvasPoint,
        anchor: Anchor,
        (weight, ink): (FontStyle, RGBColor),
    ) -> Result<(), ReportError> {
        let font = ("sans-serif", self.text * PLOTTERS_FONT).into_font().style(weight);
        let (font, horizontal) = match anchor {
            Anchor::Left => (font, HPos::Left),
            Anchor::Centre => (font, HPos::Center),
            Anchor::Right => (font, HPos::Right),
            Anchor::Upwards => (font.transform(FontTransform::Rotate270), HPos::Center),
        };
        let style = TextStyle::from(font).color(&ink).pos(Pos::new(horizontal, VPos::Center));
        self.area
            .draw(&Text::new(harmless(words).into_owned(), pixel(place), style))
            .map_err(ReportError::drawing)
    }
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

fn pixels(path: &[CanvasPoint]) -> Vec<(i32, i32)> {
    path.iter().copied().map(pixel).collect()
}
