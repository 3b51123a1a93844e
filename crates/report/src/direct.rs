//! Names of series at the ends of their lines, in place of a legend.

use super::ReportError;
use super::canvas::{Anchor, Canvas, CanvasPoint};
use super::chart::Chart;
use super::frame::{BOTTOM, Frame, LINE, RIGHT, TOP};
use super::legend::LEGEND_CHARACTERS;

const BESIDE: f64 = 56.0;

/// Whether all names fit beside their lines, in one line each and within the frame.
pub(super) fn fits(chart: &Chart) -> bool {
    let names = chart.series.iter().map(|series| series.name.chars().count());
    let lines = names.clone().filter(|count| *count > 0).count() as f64;
    names.max().is_none_or(|longest| longest <= LEGEND_CHARACTERS) && lines * LINE <= BOTTOM - TOP
}

/// Writes the names; returns the height of the lowest one, or the top if there is none.
pub(super) fn draw(canvas: &Canvas<'_>, chart: &Chart, frame: &Frame) -> Result<f64, ReportError> {
    let end = |at: usize| -> Option<(usize, CanvasPoint)> {
        let series = &chart.series[at];
        let runs = series.parts.iter().flat_map(|part| chart.runs(frame, part));
        let last = runs.filter_map(|run| run.last().copied()).max_by(|a, b| a.0.total_cmp(&b.0))?;
        (!series.name.is_empty()).then_some((at, last))
    };
    let mut ends: Vec<(usize, CanvasPoint)> = (0..chart.series.len()).filter_map(end).collect();
    ends.sort_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let heights = spread(&ends.iter().map(|(_, place)| place.1).collect::<Vec<_>>());
    let inks = chart.inks();
    for ((at, place), y) in ends.iter().zip(&heights) {
        let beside = [*place, (RIGHT + 0.3 * BESIDE, *y), (RIGHT + 0.8 * BESIDE, *y)];
        canvas.line(&beside, inks[*at].0, 2)?;
        canvas.text(&chart.series[*at].name, (RIGHT + BESIDE, *y), Anchor::Left)?;
    }
    Ok(heights.last().copied().unwrap_or(TOP))
}

/// Heights in ascending order, moved apart by a line each, within the frame if possible.
fn spread(wanted: &[f64]) -> Vec<f64> {
    let mut heights = wanted.to_vec();
    let mut least = TOP;
    for height in &mut heights {
        *height = height.max(least);
        least = *height + LINE;
    }
    let mut most = BOTTOM;
    for height in heights.iter_mut().rev() {
        *height = height.min(most);
        most = *height - LINE;
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::{Axis, Series};
    use crate::ruler::Scale;

    #[test]
    fn names_stand_a_line_apart_and_near_their_ends() {
        assert_eq!(spread(&[300.0, 500.0]), [300.0, 500.0]);
        assert_eq!(spread(&[300.0, 300.0, 310.0]), [300.0, 300.0 + LINE, 300.0 + 2.0 * LINE]);
        let low = spread(&[BOTTOM, BOTTOM]);
        assert_eq!(low, [BOTTOM - LINE, BOTTOM]);
        assert!(spread(&[]).is_empty());
    }

    #[test]
    fn names_that_have_no_room_go_to_the_legend() {
        let axis = || Axis::new("h", Scale::Log);
        let with = |names: &[&str]| {
            let mut chart = Chart::new("title", "question", axis(), axis());
            chart.series = names.iter().map(|name| Series::new(*name, Vec::new())).collect();
            fits(&chart)
        };
        assert!(with(&["measured", "", "bound"]) && with(&[]));
        assert!(!with(&["measured", "a norm with a name of more than one line"]));
        assert!(with(&["name"; 20]) == (20.0 * LINE <= BOTTOM - TOP) && !with(&["name"; 200]));
    }
}
