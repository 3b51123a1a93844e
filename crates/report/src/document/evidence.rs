//! Evidence of a verdict: its points, and the scene's cases, as tables.

use super::{Run, Table, Tone};
use crate::curve::norms;
use judge::fit::{Direction, Point};
use judge::record::{CaseRecord, Status, V_MAX, is_by_state};
use judge::verdict::{JudgedPoint, Verdict};

/// Norms in the table of cases that fit a page; cases.csv has all.
const NORM_COLUMNS: usize = 4;

pub(super) fn scientific(value: f64) -> String {
    if value.is_finite() { format!("{value:.3e}") } else { "–".into() }
}

/// A step, as a fraction if possible.
fn step(value: f64) -> String {
    if value.is_finite() { crate::ticks::step_label(value) } else { "–".into() }
}

/// The points of a verdict, coarse to fine, with the orders between used neighbours.
pub(super) fn points(verdict: &Verdict) -> Table {
    let mut points: Vec<&JudgedPoint> =
        verdict.points_used.iter().chain(&verdict.points_left_out).collect();
    let direction = verdict.variable.direction();
    let along = |point: &Point| direction.unwrap_or(Direction::Space).step(point);
    points.sort_by(|a, b| {
        let (a, b) = (&a.point, &b.point);
        along(b).total_cmp(&along(a)).then(b.k.total_cmp(&a.k))
    });
    let mut before: Option<(f64, f64)> = None;
    let mut rows = Vec::new();
    for JudgedPoint { point, place, reason } in points {
        let at = along(point);
        let order = match before.filter(|_| reason.is_none() && direction.is_some()) {
            Some((step, other)) => {
                format!("{:.3}", (other / point.error).ln() / (step / at).ln())
            }
            None => "–".into(),
        };
        if reason.is_none() {
            before = Some((at, point.error));
        }
        let use_of =
            reason.as_ref().map_or_else(|| "served".into(), |why| format!("left out: {why}"));
        let cells = [
            place.n.map_or_else(|| "–".to_owned(), |n| n.to_string()),
            place.steps.to_string(),
            step(point.h),
            step(point.k),
            scientific(point.error),
            order,
            if point.floor > 0.0 { scientific(point.floor) } else { "–".into() },
            use_of,
        ];
        rows.push(cells.map(Run::plain).into());
    }
    let (norm, variable) = (&verdict.norm, verdict.variable.name());
    let caption = format!("{}: points of the verdict on {norm} in {variable}.", verdict.scene);
    let heads = [">n", ">N", ">h", ">k", ">error", ">local order", ">floor", "use"];
    Table::new(caption, &heads, rows).evidence()
}

/// All cases of a scene with their sizes and errors.
pub(super) fn cases(scene: &str, records: &[CaseRecord]) -> Table {
    let of_scene: Vec<&CaseRecord> = records.iter().filter(|r| r.scene == scene).collect();
    let mut norms = norms(of_scene.iter().copied());
    norms.retain(|norm| *norm == V_MAX || !is_by_state(norm));
    let rest = norms.split_off(norms.len().min(NORM_COLUMNS));
    let row = |record: &&CaseRecord| {
        let ended = match &record.status {
            Status::Converged => Run::plain("converged"),
            Status::Failed { .. } => Run::of("failed", Tone::Miss),
            Status::Skipped => Run::plain("skipped"),
        };
        let error = |norm: &&str| record.norm(norm).and_then(|entry| entry.error);
        let cells = norms.iter().map(|norm| error(norm).map_or_else(|| "–".into(), scientific));
        let sizes = [
            record.n.map_or_else(|| "–".into(), |n| n.to_string()),
            record.steps.to_string(),
            record.dofs.to_string(),
            record.newton_iterations.to_string(),
        ];
        let plain = sizes.into_iter().chain(cells).map(Run::plain);
        plain.chain([ended]).collect::<Vec<Run>>()
    };
    let rows: Vec<Vec<Run>> = of_scene.iter().map(row).collect();
    let sizes = [">n", ">N", ">unknowns", ">Newton"].map(str::to_owned);
    let named = norms.iter().map(|norm| format!(">{norm}"));
    let heads: Vec<String> = sizes.into_iter().chain(named).chain(["status".into()]).collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let more = match rest.is_empty() {
        true => String::new(),
        false => format!(" Also in cases.csv: {}.", rest.join(", ")),
    };
    let caption = format!(
        "{scene}: all cases; unknowns of a time level, Newton iterations over all levels, errors in the norms named.{more}"
    );
    Table::new(caption, &heads, rows).evidence()
}
