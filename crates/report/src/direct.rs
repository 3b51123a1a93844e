//! Names of series at the ends of their lines, in place of a legend.

use super::canvas::{Anchor, Canvas, CanvasPoint, LINE};
use super::chart::Chart;
use super::frame::Frame;
use super::legend::{LEGEND_CHARACTERS, spread};

const BESIDE: f64 = 56.0;

/// Whether all names fit beside their lines, in one line each and between these heights.
pub(super) fn fits(chart: &Chart, [top, bottom]: [f64; 2]) -> bool {
    let names = chart.series.iter().map(|series| series.name.chars().count());
    let lines = names.clone().filter(|count| *count > 0).count() as f64;
    names.max().is_none_or(|longest| longest <= LEGEND_CHARACTERS) && lines * LINE <= bottom - top
}

/// Writes the names; returns the height of the lowest one, or the top if there is none.
pub(super) fn draw(canvas: &mut Canvas, chart: &Chart, frame: &Frame) -> f64 {
    let ([_, top, right, bottom], unit) = (frame.room, frame.unit);
    let end = |at: usize| -> Option<(usize, CanvasPoint)> {
        let series = &chart.series[at];
        let runs = series.parts.iter().flat_map(|part| chart.runs(frame, part));
        let last = runs.filter_map(|run| run.last().copied()).max_by(|a, b| a.0.total_cmp(&b.0))?;
        (!series.name.is_empty()).then_some((at, last))
    };
    let mut ends: Vec<(usize, CanvasPoint)> = (0..chart.series.len()).filter_map(end).collect();
    ends.sort_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let wanted: Vec<f64> = ends.iter().map(|(_, place)| place.1).collect();
    let heights = spread(&wanted, LINE * unit, [top, bottom]);
    let inks = chart.inks();
    for ((at, place), y) in ends.iter().zip(&heights) {
        let stub = [0.3, 0.8].map(|share| (right + share * BESIDE * unit, *y));
        canvas.line(&[*place, stub[0], stub[1]], inks[*at].0, 2);
        canvas.text(&chart.series[*at].name, (right + BESIDE * unit, *y), Anchor::Left);
    }
    heights.last().copied().unwrap_or(top)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::{Axis, Series};
    use crate::ruler::Scale;

    #[test]
    fn names_that_have_no_room_go_to_the_legend() {
        let axis = || Axis::new("h", Scale::Log);
        let with = |names: &[&str]| {
            let mut chart = Chart::new("title", "question", axis(), axis());
            chart.series = names.iter().map(|name| Series::new(*name, Vec::new())).collect();
            fits(&chart, [190.0, 990.0])
        };
        assert!(with(&["measured", "", "bound"]) && with(&[]));
        assert!(!with(&["measured", "a norm with a name of more than one line"]));
        assert!(with(&["name"; 20]) == (20.0 * LINE <= 800.0) && !with(&["name"; 200]));
    }
}
