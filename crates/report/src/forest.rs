//! The forest plot: every observed order with its interval and prediction, a row each.

use super::canvas::{Anchor, Canvas, CanvasPoint};
use super::document::Group;
use super::palette::{COLOURS, Colour, GRID, INK};
use judge::fit::TOLERANCE;
use judge::verdict::{Decision, Verdict};

/// Width of a column and height of a row in units: words of 20 units have 7 pt where a column is 84 mm wide, half of a page.
const COLUMN: f64 = 680.0;
const ROW: f64 = 25.0;
const TEXT: f64 = 20.0;
/// In a column: end of norms, the axis, start of predictions.
const NORM: f64 = 408.0;
const AXIS: (f64, f64) = (418.0, 570.0);
const PREDICTION: f64 = 590.0;
/// Lines of a piece: a few pieces fill what a page has left.
pub(super) const PIECE: usize = 12;
/// Ends of the axis of observed minus predicted order, on which a lost order of one has its place; what exceeds it gets an
/// arrow, and an interval beyond it the number.
const RANGE: (f64, f64) = (-1.25, 1.0);
/// Labelled ticks.
const TICKS: [(f64, &str); 3] = [(-1.0, "−1"), (0.0, "0"), (1.0, "+1")];
const POINT: f64 = 6.0;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Line {
    /// A group with the number of verdicts as expected; repeated at the top of a column that continues it.
    Heading {
        title: &'static str,
        held: String,
    },
    Row(Row),
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    scene: String,
    norm: String,
    /// The printed prediction.
    prediction: String,
    /// Observed minus predicted: lower end, order, upper end; None without an order.
    apart: Option<[f64; 3]>,
    decision: Decision,
    as_expected: bool,
}

/// The rows of these verdicts, by group and then in order.
pub(super) fn lines(verdicts: &[Verdict], group: impl Fn(&str) -> Group) -> Vec<Line> {
    let mut lines = Vec::new();
    for kind in Group::ALL {
        let of: Vec<&Verdict> = verdicts.iter().filter(|v| group(&v.scene) == kind).collect();
        if of.is_empty() {
            continue;
        }
        let met = of.iter().filter(|verdict| verdict.as_expected()).count();
        let held = format!("{met} of {}", of.len());
        lines.push(Line::Heading { title: kind.title(), held });
        lines.extend(of.into_iter().flat_map(rows).map(Line::Row));
    }
    lines
}

/// A row, or one for h and one for k.
fn rows(verdict: &Verdict) -> Vec<Row> {
    let Verdict { scene, norm, variable, decision, .. } = verdict;
    let row =
        |variable: &str, predicted: f64, observed: Option<f64>, interval: Option<[f64; 2]>| {
            let bound = match verdict.at_least {
                true if predicted == 0.0 => "→ ",
                true => "≥ ",
                false => "",
            };
            Row {
                scene: scene.clone(),
                norm: format!("{}, {variable}", norm.trim_end_matches("_max")),
                prediction: format!("{bound}{}", (predicted * 1e3).round() / 1e3),
                apart: observed
                    .zip(interval)
                    .map(|(order, [lo, hi])| [lo, order, hi].map(|order| order - predicted)),
                decision: *decision,
                as_expected: verdict.as_expected(),
            }
        };
    let (observed, interval) = (verdict.observed, verdict.interval);
    match verdict.predicted_k {
        None => vec![row(variable.name(), verdict.predicted, observed, interval)],
        Some(k) => vec![
            row("h", verdict.predicted, observed, interval),
            row("k", k, verdict.observed_k, verdict.interval_k),
        ],
    }
}

/// The lines in columns of equal length; a column that begins within a group repeats its heading, none ends with one.
pub(super) fn columns(lines: &[Line], count: usize) -> Vec<Vec<Line>> {
    let length = (lines.len() + count).div_ceil(count.max(1));
    let mut columns: Vec<Vec<Line>> = vec![Vec::new()];
    let mut group = "";
    for line in lines {
        let column = columns.last_mut().map_or(0, |column| column.len());
        let room = length.saturating_sub(column);
        let starts = matches!(line, Line::Heading { .. });
        if (room == 0 || room == 1 && starts) && columns.len() < count {
            let again = Line::Heading { title: group, held: "continued".into() };
            columns.push(if starts { Vec::new() } else { vec![again] });
        }
        if let Line::Heading { title, .. } = line {
            group = title;
        }
        if let Some(column) = columns.last_mut() {
            column.push(line.clone());
        }
    }
    columns.retain(|column| !column.is_empty());
    columns
}

/// The lines in pieces for a page that arranges them; none where they are few.
pub(super) fn pieces(lines: &[Line]) -> Vec<String> {
    let count = lines.len().div_ceil(PIECE);
    let pieces = if count > 1 { columns(lines, count) } else { Vec::new() };
    pieces.into_iter().filter_map(|piece| svg(&[piece])).collect()
}

/// Columns side by side; None without lines.
pub(super) fn svg(columns: &[Vec<Line>]) -> Option<String> {
    let longest = columns.iter().map(Vec::len).max()?;
    let size = (COLUMN * columns.len() as f64, ROW * (longest as f64 + 0.5));
    let mut canvas = Canvas::of_size((size.0 as u32, size.1 as u32), TEXT);
    for (i, column) in columns.iter().enumerate() {
        draw_column(&mut canvas, COLUMN * i as f64, column);
    }
    Some(canvas.finish())
}

fn draw_column(canvas: &mut Canvas, left: f64, lines: &[Line]) {
    let mut scene = "";
    for (i, line) in lines.iter().enumerate() {
        let y = ROW * (i as f64 + 0.75);
        match line {
            Line::Heading { title, held } => {
                scene = "";
                canvas.bold(title, (left + 4.0, y));
                canvas.text(held, (left + NORM - 22.0, y), Anchor::Right);
                for (at, label) in TICKS {
                    canvas.text(label, (left + across(at), y), Anchor::Centre);
                }
            }
            Line::Row(row) => {
                let named = if row.scene == scene { "" } else { &row.scene };
                scene = &row.scene;
                draw_row(canvas, left, y, named, row);
            }
        }
    }
}

fn draw_row(canvas: &mut Canvas, left: f64, y: f64, named: &str, row: &Row) {
    let (zero, ends) = (left + across(0.0), [y - 0.5 * ROW, y + 0.5 * ROW]);
    let upright = ends.map(|y| (zero, y));
    canvas.line(&upright, GRID, (across(TOLERANCE) - across(-TOLERANCE)) as u32);
    canvas.line(&upright, INK, 1);
    canvas.text(named, (left + 4.0, y), Anchor::Left);
    canvas.text(&row.norm, (left + NORM, y), Anchor::Right);
    canvas.text(&row.prediction, (left + PREDICTION, y), Anchor::Left);
    let ink = if row.as_expected { COLOURS[0] } else { COLOURS[1] };
    let Some([lo, order, hi]) = row.apart.filter(|ends| ends.iter().all(|end| end.is_finite()))
    else {
        return canvas.text("no order", (left + across(0.5), y), Anchor::Centre);
    };
    canvas.line(&[(left + across(lo), y), (left + across(hi), y)], ink, 3);
    for (end, outwards) in [(lo, -1.0), (hi, 1.0)] {
        if across(end) != unclipped(end) {
            arrow(canvas, (left + across(end), y), outwards, ink);
        }
    }
    let at = (left + across(order), y);
    if across(lo) == across(hi) {
        let (beside, anchor) = match order < 0.0 {
            true => (at.0 + 2.0 * POINT, Anchor::Left),
            false => (at.0 - 2.0 * POINT, Anchor::Right),
        };
        canvas.text(&format!("{order:+.2}").replace('-', "−"), (beside, y), anchor);
    }
    match row.decision {
        Decision::Pass => canvas.fill_box(square(at, POINT), ink, 1.0),
        Decision::Fail | Decision::Unresolved => {
            canvas.fill_box(square(at, POINT), super::sheet::PAPER, 1.0);
            canvas.line_box(square(at, POINT), ink, 2)
        }
    }
}

fn square((x, y): CanvasPoint, half: f64) -> [f64; 4] {
    [x - half, y - half, x + half, y + half]
}

fn arrow(canvas: &mut Canvas, (x, y): CanvasPoint, to: f64, ink: Colour) {
    canvas.fill(&[(x + 10.0 * to, y), (x, y - 8.0), (x, y + 8.0)], ink, 1.0)
}

fn unclipped(apart: f64) -> f64 {
    AXIS.0 + (apart - RANGE.0) / (RANGE.1 - RANGE.0) * (AXIS.1 - AXIS.0)
}

/// Position of a difference, clamped to the axis.
fn across(apart: f64) -> f64 {
    unclipped(apart.clamp(RANGE.0, RANGE.1))
}

#[cfg(test)]
mod tests {
    use super::super::sheet::without;
    use super::*;

    fn row(scene: &str, apart: Option<[f64; 3]>, as_expected: bool) -> Line {
        let (norm, prediction) = ("V, h".into(), "1".into());
        let decision = if as_expected { Decision::Pass } else { Decision::Fail };
        Line::Row(Row { scene: scene.into(), norm, prediction, apart, decision, as_expected })
    }

    fn heading(title: &'static str) -> Line {
        Line::Heading { title, held: "9 of 9".into() }
    }

    #[test]
    fn columns_hold_every_line_once_and_name_their_group() {
        let rows = (0..9).map(|i| row(&format!("s{i}"), None, true));
        let mut all = vec![heading("A")];
        all.extend(rows);
        all.insert(4, heading("B"));
        for count in 1..6 {
            let columns = columns(&all, count);
            assert!(columns.len() <= count);
            let kept = columns.iter().flatten().filter(|line| matches!(line, Line::Row(_)));
            assert_eq!(kept.count(), 9);
            for column in &columns {
                assert!(
                    matches!(column.first(), Some(Line::Heading { .. })),
                    "{count}: {column:?}"
                );
                assert!(matches!(column.last(), Some(Line::Row(_))), "{count}: {column:?}");
            }
        }
        assert!(svg(&columns(&[], 2)).is_none());
    }

    /// A lost order of one is on the axis, one of two has its number.
    #[test]
    fn lost_orders_are_read_off() {
        let of = |apart: [f64; 3]| without(&svg(&[vec![row("s", Some(apart), false)]]).unwrap());
        let polygons = |svg: &str| svg.matches("<polygon").count();
        assert_eq!(polygons(&of([-1.1, -1.0, -0.9])), polygons(&of([-0.1, 0.0, 0.1])), "no arrow");
        let beyond = of([-2.1, -2.0, -1.9]);
        assert!(beyond.contains("−2.00"), "{beyond}");
        assert!(!of([-1.1, -1.0, -0.9]).contains("−1.00"));
    }

    /// Orders off the axis, missed or missing differ from met ones.
    #[test]
    fn rows_say_what_they_found() {
        let drawn = |line: Line| without(&svg(&[vec![line]]).unwrap());
        let met = drawn(row("s", Some([-0.1, 0.0, 0.1]), true));
        let missed = drawn(row("s", Some([-0.1, 0.0, 0.1]), false));
        assert!(met.contains("#0072B2") && !met.contains("#D55E00"));
        assert!(missed.contains("#D55E00") && !missed.contains("#0072B2"));
        assert!(drawn(row("s", None, false)).contains("no order"));
        assert!(drawn(row("s", Some([f64::NAN, 0.0, 1.0]), true)).contains("no order"));
        let polygons = |svg: &str| svg.matches("<polygon").count();
        let beyond = drawn(row("s", Some([-3.0, 0.0, 4.0]), true));
        assert_eq!(polygons(&beyond), polygons(&met) + 2, "an arrow at each end");
    }
}
