//! The axes of a picture, with room for a title above and a legend beside.

use super::ReportError;
use super::canvas::{Anchor, Canvas, CanvasPoint};
use super::chart::{Chart, Mark};
use super::legend::wrapped;
use super::palette::{GRID, INK};
use super::ruler::{Room, Ruler};

pub(super) const LEFT: f64 = 170.0;
pub(super) const RIGHT: f64 = 1140.0;
pub(super) const TOP: f64 = 190.0;
pub(super) const BOTTOM: f64 = 990.0;
/// Height of title and question, above the letters of marks.
pub(super) const TITLE_ROOM: u32 = 136;

/// Line spacing.
pub(super) const LINE: f64 = 44.0;

/// Characters in the width of the picture.
const TITLE_CHARACTERS: usize = 92;

/// Space for labels along the axes: five digits side by side, twice a line of text above another.
const ROOM_X: Room = Room { length: RIGHT - LEFT, label: 100.0 };
const ROOM_Y: Room = Room { length: BOTTOM - TOP, label: 80.0 };

/// Length of an unlabelled tick.
const STROKE: f64 = 12.0;

pub(super) struct Frame {
    x: Ruler,
    y: Ruler,
}

impl Frame {
    /// Axes for the data and marks of a chart, and for `more` heights; None without data.
    pub(super) fn new(chart: &Chart, more: &[f64]) -> Option<Self> {
        let scales = (chart.x.scale, chart.y.scale);
        let shown = |(x, y): &&(f64, f64)| scales.0.holds(*x) && scales.1.holds(*y);
        let parts = || chart.series.iter().flat_map(|series| &series.parts);
        let all = parts().flat_map(|part| part.points()).filter(shown);
        let (xs, mut ys): (Vec<f64>, Vec<f64>) = all.copied().unzip();
        if xs.is_empty() {
            return None;
        }
        ys.extend(more);
        let marks = |marks: &[Mark]| marks.iter().map(|mark| mark.at).collect::<Vec<_>>();
        // Steps are those of the markers, not the corners of lines.
        let markers = parts().filter(|part| part.has_markers()).flat_map(|part| part.points());
        let levels: Vec<f64> = markers.filter(shown).map(|point| point.0).collect();
        let (data, beside) = if levels.is_empty() { (&xs, &levels) } else { (&levels, &xs) };
        let beside = [&beside[..], &marks(&chart.verticals)].concat();
        let x = Ruler::new(scales.0, data, &beside, ROOM_X)?;
        let y = Ruler::new(scales.1, &ys, &marks(&chart.horizontals), ROOM_Y)?;
        Some(Self { x, y })
    }

    pub(super) fn place(&self, (x, y): (f64, f64)) -> CanvasPoint {
        (self.across(x), self.up(y))
    }

    pub(super) fn across(&self, x: f64) -> f64 {
        LEFT + self.x.share(x) * (RIGHT - LEFT)
    }

    /// Clamped to the frame, which a fitted line may leave.
    pub(super) fn up(&self, y: f64) -> f64 {
        BOTTOM - self.y.share(y).clamp(0.0, 1.0) * (BOTTOM - TOP)
    }

    /// Height of a decade of y, if logarithmic.
    pub(super) fn decade(&self) -> Option<f64> {
        self.y.decade().map(|share| share * (BOTTOM - TOP))
    }

    pub(super) fn draw(&self, canvas: &Canvas<'_>, chart: &Chart) -> Result<(), ReportError> {
        if !chart.title.is_empty() {
            canvas.bold(&chart.title, (30.0, 44.0))?;
        }
        for (i, line) in wrapped(&chart.question, TITLE_CHARACTERS, 2).iter().enumerate() {
            canvas.text(line, (30.0, 44.0 + LINE * (i + 1) as f64), Anchor::Left)?;
        }
        for tick in &self.x.ticks {
            let x = self.across(tick.at);
            match &tick.label {
                Some(label) => {
                    canvas.line(&[(x, TOP), (x, BOTTOM)], GRID, 2)?;
                    canvas.text(label, (x, BOTTOM + 36.0), Anchor::Centre)?;
                }
                None => canvas.line(&[(x, BOTTOM), (x, BOTTOM - STROKE)], INK, 2)?,
            }
        }
        for tick in &self.y.ticks {
            let y = self.up(tick.at);
            match &tick.label {
                Some(label) => {
                    canvas.line(&[(LEFT, y), (RIGHT, y)], GRID, 2)?;
                    canvas.text(label, (LEFT - 16.0, y), Anchor::Right)?;
                }
                None => canvas.line(&[(LEFT, y), (LEFT + STROKE, y)], INK, 2)?,
            }
        }
        canvas.line_box([LEFT, TOP, RIGHT, BOTTOM], INK, 3)?;
        canvas.text(&chart.x.label, (0.5 * (LEFT + RIGHT), BOTTOM + 96.0), Anchor::Centre)?;
        canvas.text(&chart.y.label, (30.0, 0.5 * (TOP + BOTTOM)), Anchor::Upwards)
    }
}
