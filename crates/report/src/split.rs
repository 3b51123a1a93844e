//! The error over h and k: a cell per run, with its error and the share that the fitted model attributes to either
//! step.

use super::SceneSummary;
use super::curve::norms;
use super::map::{Cell, Map, Shade};
use super::ticks::step_label;
use judge::fit::{Direction, JointFit, Point, joint_fits, screen};
use judge::record::{CaseRecord, norm_label};

/// Text of 30 units is 7.5 pt at a picture width of 16 cm.
const TEXT: f64 = 30.0;

/// The picture of one scene; None if no norm has a grid of h and k from which both parts can be fitted.
pub fn split_svg(scene: &SceneSummary, records: &[CaseRecord]) -> Option<String> {
    let (norm, rows) = grid(scene, records)?;
    let points: Vec<Point> = rows.iter().flatten().copied().collect();
    let best = joint_fits(&points, false).ok()?.best;
    let mut steps: Vec<f64> = points.iter().map(|point| point.k).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    let row = |row: &Vec<Point>| {
        let at = |k: &f64| row.iter().find(|point| point.k == *k);
        let cells = steps.iter().map(|k| at(k).map_or_else(Cell::default, |p| cell(p, &best)));
        (row.first().map_or_else(String::new, |point| step_label(point.h)), cells.collect())
    };
    let mut notes = vec![format!(
        "{}; {} model, p = {:.2} in h, q = {:.2} in k",
        norm_label(&norm),
        best.model.name(),
        best.order_h.value,
        best.order_k.value
    )];
    if points.iter().any(|point| screen(point).is_err()) {
        notes.push("in brackets: below the floor of the error".into());
    }
    let map = Map {
        title: String::new(),
        subtitle: String::new(),
        heads: std::iter::once("h \\ k".into())
            .chain(steps.iter().copied().map(step_label))
            .collect(),
        rows: rows.iter().map(row).collect(),
        legend: [
            (Shade::Shared(0.0), "the error is of h"),
            (Shade::Shared(0.5), "of both alike"),
            (Shade::Shared(1.0), "of k"),
        ],
        notes,
    };
    Some(map.with_text(TEXT))
}

/// The error of a run, and the larger share in it.
fn cell(point: &Point, fit: &JointFit) -> Cell {
    let of_k = fit.share(Direction::Time, point);
    let error = match screen(point) {
        Ok(_) => format!("{:.1e}", point.error),
        Err(_) => format!("[{:.1e}]", point.error),
    };
    let share = match of_k {
        more if more >= 0.5 => format!("{:.0} % of k", 100.0 * more),
        less => format!("{:.0} % of h", 100.0 * (1.0 - less)),
    };
    (format!("{error}\n{share}"), Shade::Shared(of_k))
}

/// The first norm with two levels of h and of k, and its points: a row per h, coarse to fine, along falling k.
fn grid(scene: &SceneSummary, records: &[CaseRecord]) -> Option<(String, Vec<Vec<Point>>)> {
    let records: Vec<&CaseRecord> =
        records.iter().filter(|record| record.scene == scene.name).collect();
    let norms = norms(records.iter().copied()).into_iter();
    let mut all = norms.map(|norm| (norm, rows(&records, norm)));
    let is_grid = |rows: &[Vec<Point>]| rows.len() >= 2 && rows.iter().any(|row| row.len() >= 2);
    let (norm, rows) = all.find(|(_, rows)| is_grid(rows))?;
    Some((norm.to_owned(), rows))
}

fn rows(records: &[&CaseRecord], norm: &str) -> Vec<Vec<Point>> {
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
        split_svg(&scene, &records).unwrap()
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
