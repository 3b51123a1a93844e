//! Error against h, and against k: one curve per norm, with a triangle of the predicted order.

use std::mem::discriminant;

use super::SceneSummary;
use super::chart::{Axis, Chart, Datum, Part, Series};
use super::curve::{Curve, curves, is_path};
use super::ruler::Scale;
use judge::fit::Direction;
use judge::record::{CaseRecord, is_by_state, norm_label, norm_label_in_time};
use judge::verdict::{Verdict, cell_texts, most_frequent};

/// The picture of one scene in one direction; None if no norm has two points.
pub fn convergence_svg(
    scene: &SceneSummary,
    records: &[CaseRecord],
    verdicts: &[Verdict],
    direction: Direction,
) -> Option<String> {
    let (curves, not_drawn): (Vec<Curve<'_>>, Vec<Curve<'_>>) =
        curves(scene, records, verdicts, direction)
            .filter(|curve| curve.verdict.is_some() || !is_by_state(curve.norm))
            .partition(Curve::is_drawn);
    let of_scene = || records.iter().filter(|record| record.scene == scene.name);
    let level = |fixed: u32| match direction {
        Direction::Space => format!("N = {fixed}"),
        Direction::Time => format!("n = {fixed}"),
    };
    // Curves may come from different cases: the axis names the most frequent level, other curves theirs.
    let usual = most_frequent(curves.iter().filter_map(|curve| curve.fixed));
    let others = curves.iter().any(|curve| curve.fixed != usual);
    let mut step = step_name(of_scene(), direction).to_owned();
    if let Some(usual) = usual {
        let rest = if others { " where not named" } else { "" };
        step = format!("{step}, {}{rest}", level(usual));
    }
    let x = Axis::new(step, Scale::Steps);
    let y = Axis::new("error in the norm named", Scale::Log);
    let mut chart = Chart::new("", "", x, y);
    let label = |norm| match of_scene().any(|record| record.n.is_some()) {
        true => norm_label(norm),
        false => norm_label_in_time(norm),
    };
    let named = |curve: &Curve<'_>| match curve.verdict.is_some_and(is_path) {
        true => Some("N grows with n".to_owned()),
        false => curve.fixed.filter(|level_of_curve| Some(*level_of_curve) != usual).map(level),
    };
    // Floors of judged curves explain omitted points; those of all others would hide them.
    let judged = curves.iter().any(|curve| curve.verdict.is_some());
    let floor = |curve: &Curve<'_>| match judged && curve.verdict.is_none() {
        true => Vec::new(),
        false => curve.visible_floor().to_vec(),
    };
    let drawn = |curve| series(curve, label(curve.norm), named(curve), floor(curve));
    chart.series = curves.iter().map(drawn).collect();
    chart.keys = keys(&chart.series);
    let names: Vec<&str> = not_drawn.iter().map(|curve| label(curve.norm)).collect();
    if !names.is_empty() {
        chart.note = format!("not drawn, in cases.csv: {}", names.join("; "));
    }
    chart.svg()
}

/// The abscissa and its convention.
fn step_name<'a>(
    records: impl Iterator<Item = &'a CaseRecord>,
    direction: Direction,
) -> &'static str {
    let records: Vec<&CaseRecord> = records.collect();
    // 1/n is off by a rounding at most.
    let cells = |record: &&CaseRecord| match (record.n, record.h) {
        (Some(n), Some(h)) => (f64::from(n) * h - 1.0).abs() < 1e-9,
        _ => true,
    };
    let horizon = |record: &CaseRecord| record.k * f64::from(record.steps);
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
    match direction {
        Direction::Space if records.iter().all(cells) => {
            "mesh size h = 1/n, n cells per unit length"
        }
        Direction::Space => "mesh size h, the longest edge",
        // On equal steps k N is T for every N; a graded or random grid has its largest step as k.
        Direction::Time
            if records.iter().all(|record| same(horizon(record), horizon(records[0]))) =>
        {
            "time step k = T/N"
        }
        Direction::Time => "largest time step k",
    }
}

fn series(curve: &Curve<'_>, label: &str, level: Option<String>, floor: Vec<Datum>) -> Series {
    let mut parts = vec![Part::Line(curve.used.clone()), Part::Points(curve.used.clone())];
    let rest = [Part::Hollow(curve.left_out.clone()), Part::Dashed(floor)];
    parts.extend(rest.into_iter().filter(|part| !part.points().is_empty()));
    let mut series = Series::new(label, parts);
    let judged = curve.verdict.map(|verdict| {
        let [_, _, _, _, observed, decision, _] = cell_texts(verdict);
        format!("{observed} {decision}")
    });
    series.detail = [level, judged].into_iter().flatten().collect::<Vec<_>>().join("\n");
    series.slope = curve.slope();
    series
}

/// Explains the signs that occur.
fn keys(series: &[Series]) -> Vec<(Part, String)> {
    let keys =
        [(Part::Hollow(Vec::new()), "left out"), (Part::Dashed(Vec::new()), "floor of the error")];
    let occurs = |key: &Part| {
        let mut parts = series.iter().flat_map(|series| &series.parts);
        parts.any(|part| discriminant(part) == discriminant(key))
    };
    let occurring = keys.into_iter().filter(|(key, _)| occurs(key));
    occurring.map(|(key, words)| (key, words.to_owned())).collect()
}
