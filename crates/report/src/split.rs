//! The error over h and k: a cell per run, with its error and the share that the fitted model attributes to either
//! step.

use plotters::style::RGBColor;

use super::canvas::{Anchor, Canvas, CanvasPoint, SIZE};
use super::curve::norms;
use super::palette::{INK, mixed};
use super::sheet::with_sheet;
use super::ticks::step_label;
use super::{ReportError, SceneSummary};
use judge::fit::{ErrorCombination, JointFit, Point, joint_fits, screen};
use judge::record::{CaseRecord, norm_label};

/// The cells: left, top, right, row height. Text of 30 units is 7.5 pt at a picture width of 16 cm.
const ROOM: (f64, f64, f64, f64) = (170.0, 70.0, 1770.0, 88.0);
const TEXT: f64 = 30.0;
const WIDEST: f64 = 320.0;
/// Below the cells: the name of k, the words.
const BELOW: [f64; 3] = [40.0, 92.0, 134.0];

/// All of the error from h, from both alike, from k: light enough for dark words.
const OF_H: [f64; 3] = [140.0, 190.0, 226.0];
const OF_BOTH: [f64; 3] = [246.0, 246.0, 246.0];
const OF_K: [f64; 3] = [242.0, 180.0, 134.0];

/// The picture of one scene; None if no norm has a grid of h and k from which both parts can be fitted.
pub fn split_svg(
    scene: &SceneSummary,
    records: &[CaseRecord],
) -> Result<Option<String>, ReportError> {
    let Some((norm, rows)) = grid(scene, records) else { return Ok(None) };
    let points: Vec<Point> = rows.iter().flatten().copied().collect();
    let Ok(fits) = joint_fits(&points, false) else { return Ok(None) };
    let mut steps: Vec<f64> = points.iter().map(|point| point.k).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    let (left, top, right, height) = ROOM;
    let width = ((right - left) / steps.len() as f64).min(WIDEST);
    let bottom = top + height * rows.len() as f64;
    let size = (SIZE.0, (bottom + BELOW[2] + 36.0) as u32);
    let mut svg = String::new();
    let canvas = Canvas::of_size(&mut svg, size, TEXT)?;
    let best = &fits.best;
    for (r, row) in rows.iter().enumerate() {
        let y = top + height * r as f64;
        let name = row.first().map_or_else(String::new, |point| step_label(point.h));
        canvas.text(&name, (left - 16.0, y + 0.5 * height), Anchor::Right)?;
        for point in row {
            let column = steps.iter().position(|k| *k == point.k).unwrap_or(0);
            let x = left + width * column as f64;
            cell(&canvas, [x, y, x + width - 4.0, y + height - 4.0], point, best)?;
        }
    }
    for (c, k) in steps.iter().enumerate() {
        let at = (left + width * (c as f64 + 0.5), top - 28.0);
        canvas.text(&step_label(*k), at, Anchor::Centre)?;
    }
    canvas.text("h", (left - 60.0, top - 28.0), Anchor::Centre)?;
    canvas.text("k", (left - 22.0, top - 28.0), Anchor::Centre)?;
    let words = |line: usize| (left, bottom + BELOW[line]);
    legend(&canvas, words(0))?;
    let text = format!(
        "{}; {} model, p = {:.2} in h, q = {:.2} in k",
        norm_label(&norm),
        best.model.name(),
        best.order_h.value,
        best.order_k.value
    );
    canvas.text(&text, words(1), Anchor::Left)?;
    if points.iter().any(|point| screen(point).is_err()) {
        canvas.text("in brackets: below the floor of the error", words(2), Anchor::Left)?;
    }
    canvas.finish()?;
    Ok(Some(with_sheet(&svg)))
}

/// A run: its error, and the share of the larger part.
fn cell(
    canvas: &Canvas<'_>,
    [left, top, right, bottom]: [f64; 4],
    point: &Point,
    fit: &JointFit,
) -> Result<(), ReportError> {
    let of_k = share_of_k(fit, point.h, point.k);
    canvas.fill_box([left, top, right, bottom], tint(of_k), 1.0)?;
    let (x, middle) = (0.5 * (left + right), 0.5 * (top + bottom));
    let error = match screen(point) {
        Ok(_) => format!("{:.1e}", point.error),
        Err(_) => format!("[{:.1e}]", point.error),
    };
    canvas.on_tint(&error, (x, middle - 19.0))?;
    let share = match of_k {
        more if more >= 0.5 => format!("{:.0} % of k", 100.0 * more),
        less => format!("{:.0} % of h", 100.0 * (1.0 - less)),
    };
    canvas.on_tint(&share, (x, middle + 19.0))
}

fn legend(canvas: &Canvas<'_>, (mut x, y): CanvasPoint) -> Result<(), ReportError> {
    for (of_k, words) in [(0.0, "the error is of h"), (0.5, "of both alike"), (1.0, "of k")] {
        let sides = [x, y - 16.0, x + 60.0, y + 16.0];
        canvas.fill_box(sides, tint(of_k), 1.0)?;
        canvas.line_box(sides, INK, 1)?;
        canvas.text(words, (x + 76.0, y), Anchor::Left)?;
        x += 120.0 + 16.0 * words.chars().count() as f64;
    }
    Ok(())
}

fn tint(of_k: f64) -> RGBColor {
    let end = if of_k < 0.5 { OF_H } else { OF_K };
    let part = (2.0 * of_k - 1.0).abs().min(1.0);
    mixed(OF_BOTH, end, part)
}

/// The share of E^m that the model attributes to the time step.
fn share_of_k(fit: &JointFit, h: f64, k: f64) -> f64 {
    let m = match fit.model {
        ErrorCombination::Sum => 1.0,
        ErrorCombination::RootSumSquare => 2.0,
    };
    let space = (fit.constant_h * h.powf(fit.order_h.value)).powf(m);
    let time = (fit.constant_k * k.powf(fit.order_k.value)).powf(m);
    time / (space + time)
}

/// The first norm with two levels of h and of k, and its points: a row per h, coarse to fine, along falling k.
fn grid(scene: &SceneSummary, records: &[CaseRecord]) -> Option<(String, Vec<Vec<Point>>)> {
    let records: Vec<CaseRecord> =
        records.iter().filter(|record| record.scene == scene.name).cloned().collect();
    let mut all = norms(&records).into_iter().map(|norm| (norm, rows(&records, norm)));
    let is_grid = |rows: &[Vec<Point>]| rows.len() >= 2 && rows.iter().any(|row| row.len() >= 2);
    let (norm, rows) = all.find(|(_, rows)| is_grid(rows))?;
    Some((norm.to_owned(), rows))
}

fn rows(records: &[CaseRecord], norm: &str) -> Vec<Vec<Point>> {
    let mut points: Vec<Point> = records.iter().filter_map(|record| point(record, norm)).collect();
    points.sort_by(|a, b| b.h.total_cmp(&a.h).then(b.k.total_cmp(&a.k)));
    points.chunk_by(|a, b| a.h == b.h).map(<[Point]>::to_vec).collect()
}

fn point(record: &CaseRecord, norm: &str) -> Option<Point> {
    let entry = record.norm(norm).filter(|_| record.converged())?;
    let error = entry.error.filter(|error| *error > 0.0 && error.is_finite())?;
    Some(Point { h: record.h?, k: record.k, error, floor: entry.floor.unwrap_or(0.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::record::{NormError, Status};

    fn drawn(error: impl Fn(f64, f64) -> f64) -> String {
        let grid = [4u32, 8, 16, 32].into_iter().flat_map(|n| [4u32, 8, 16, 32].map(|s| (n, s)));
        let case = |(n, steps): (u32, u32)| {
            let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
            let error = Some(error(h, k));
            CaseRecord {
                status: Status::Converged,
                errors: vec![NormError { norm: "V_max".into(), error, floor: Some(1e-12) }],
                ..CaseRecord::without_work("s", Some(n), steps, k)
            }
        };
        let records: Vec<CaseRecord> = grid.map(case).collect();
        let scene = SceneSummary { name: "s".into(), ..SceneSummary::default() };
        split_svg(&scene, &records).unwrap().unwrap()
    }

    /// h + k² with equal constants: a coarse mesh with many steps has the error of h, few steps on a fine mesh that of
    /// k; and the reverse with exchanged roles.
    #[test]
    fn the_larger_part_is_named() {
        let of_space = drawn(|h, k| h + k * k);
        let of_time = drawn(|h, k| h * h + k);
        let count = |svg: &str, words: &str| svg.matches(words).count();
        assert!(count(&of_space, " % of h") > count(&of_space, " % of k"));
        assert!(count(&of_time, " % of k") > count(&of_time, " % of h"));
        for svg in [&of_space, &of_time] {
            assert_eq!(count(svg, " % of h") + count(svg, " % of k"), 16);
            assert!(!svg.contains("NaN"));
        }
        // h = k = 1/4: 1/4 against 1/16.
        assert!(of_space.contains("80 % of h") && of_time.contains("80 % of k"));
    }
}
