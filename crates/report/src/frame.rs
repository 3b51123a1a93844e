//! The axes of a picture, with room for a title above and a legend beside.

use super::canvas::{Anchor, Canvas, CanvasPoint, SIZE, TEXT};
use super::canvas::{GRID, INK};
use super::chart::{Chart, Mark};
use super::ruler::{Room, Ruler};

/// Size of a picture, height of its words, room for a label of the axis across, and the axes: left, top, right, bottom.
pub(super) struct Layout {
    pub(super) size: (u32, u32),
    pub(super) text: f64,
    label: f64,
    pub(super) room: [f64; 4],
}

pub(super) const LARGE: Layout =
    Layout { size: SIZE, text: TEXT, label: 100.0, room: [170.0, 190.0, 1140.0, 990.0] };
/// Readable at 240 pixels.
pub(super) const SMALL: Layout =
    Layout { size: (480, 404), text: 22.0, label: 80.0, room: [84.0, 16.0, 336.0, 312.0] };

/// Height of title and question, above the letters of marks.
pub(super) const TITLE_ROOM: u32 = 136;

/// Length of an unlabelled tick.
const STROKE: f64 = 12.0;

/// Lengths beside the axes are those of a large picture times `unit`.
pub(super) struct Frame {
    pub(super) x: Ruler,
    pub(super) y: Ruler,
    pub(super) room: [f64; 4],
    pub(super) unit: f64,
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
        let Layout { room, text, label, .. } = chart.layout();
        let [left, top, right, bottom] = *room;
        let unit = text / TEXT;
        // Twice a line of text for labels above another.
        let room_x = Room { length: right - left, label: *label };
        let room_y = Room { length: bottom - top, label: 80.0 * unit };
        let x = Ruler::new(scales.0, data, &beside, room_x)?;
        let y = Ruler::new(scales.1, &ys, &marks(&chart.horizontals), room_y)?;
        Some(Self { x, y, room: *room, unit })
    }

    pub(super) fn place(&self, (x, y): (f64, f64)) -> CanvasPoint {
        (self.across(x), self.up(y))
    }

    pub(super) fn across(&self, x: f64) -> f64 {
        let [left, _, right, _] = self.room;
        left + self.x.share(x) * (right - left)
    }

    /// Clamped to the frame.
    pub(super) fn up(&self, y: f64) -> f64 {
        let [_, top, _, bottom] = self.room;
        bottom - self.y.share(y).clamp(0.0, 1.0) * (bottom - top)
    }

    /// Height of a decade of y, if logarithmic.
    pub(super) fn decade(&self) -> Option<f64> {
        let [_, top, _, bottom] = self.room;
        self.y.decade().map(|share| share * (bottom - top))
    }

    /// Grid, ticks, and the names of the axes.
    pub(super) fn draw(&self, canvas: &mut Canvas, [name_x, name_y]: [&str; 2]) {
        let ([left, top, right, bottom], unit) = (self.room, self.unit);
        for tick in &self.x.ticks {
            let x = self.across(tick.at);
            match &tick.label {
                Some(label) => {
                    canvas.line(&[(x, top), (x, bottom)], GRID, 2);
                    canvas.text(label, (x, bottom + 36.0 * unit), Anchor::Centre);
                }
                None => canvas.line(&[(x, bottom), (x, bottom - STROKE)], INK, 2),
            }
        }
        for tick in &self.y.ticks {
            let y = self.up(tick.at);
            match &tick.label {
                Some(label) => {
                    canvas.line(&[(left, y), (right, y)], GRID, 2);
                    canvas.text(label, (left - 16.0 * unit, y), Anchor::Right);
                }
                None => canvas.line(&[(left, y), (left + STROKE, y)], INK, 2),
            }
        }
        let middle = (0.5 * (left + right), 0.5 * (top + bottom));
        canvas.text(name_x, (middle.0, bottom + 96.0 * unit), Anchor::Centre);
        canvas.text(name_y, (left - 140.0 * unit, middle.1), Anchor::Upwards);
    }
}
