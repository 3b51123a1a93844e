//! Error against h, and against k: one curve a norm, with what was predicted and fitted.

use super::chart::{Axis, Chart, Datum, Key, Part, Series};
use super::curve::{Curve, curve, leaves_out_contact_set, norms};
use super::ruler::Scale;
use super::{ReportError, SceneSummary};
use crate::fit::Direction;
use crate::record::{CONTACT_SET_MAX, CaseRecord, norm_label};
use crate::verdict::{Verdict, cell_texts};

/// The picture of one scene in one direction; none if no norm has two points there.
///
/// # Errors
/// [`ReportError::Drawing`].
pub fn convergence_svg(
    scene: &SceneSummary,
    records: &[CaseRecord],
    verdicts: &[Verdict],
    direction: Direction,
) -> Result<Option<String>, ReportError> {
    let records: Vec<CaseRecord> =
        records.iter().filter(|record| record.scene == scene.name).cloned().collect();
    let curves: Vec<Curve<'_>> = norms(&records)
        .into_iter()
        .filter_map(|norm| curve(scene, &records, verdicts, norm, direction))
        .collect();
    let level = |fixed: Option<u32>| match (fixed, direction) {
        (Some(steps), Direction::Space) => format!("N = {steps}"),
        (Some(n), Direction::Time) => format!("n = {n}"),
        (None, _) => String::new(),
    };
    let first = curves.first().and_then(|curve| curve.fixed);
    // Curves from different cases each say from which; else the axis says it for all.
    let common = curves.iter().all(|curve| curve.fixed == first);
    let mut step = step_name(&records, direction).to_owned();
    if let Some(common) = first.filter(|_| common) {
        step = format!("{step}, {}", level(Some(common)));
    }
    let x = Axis::new(step, Scale::Steps);
    let y = Axis::new("error in the norm named", Scale::Log);
    let mut chart = Chart::new(&scene.name, &scene.question, x, y);
    chart.series =
        curves.iter().map(|curve| series(curve, &level(curve.fixed.filter(|_| !common)))).collect();
    chart.keys = keys(&chart.series);
    if leaves_out_contact_set(&records, &curves) {
        chart.note = format!("{}: in cases.csv", norm_label(CONTACT_SET_MAX));
    }
    chart.svg()
}

/// What the abscissa is, with its convention.
fn step_name(records: &[CaseRecord], direction: Direction) -> &'static str {
    // 1/n is off by a rounding at most.
    let cells = |record: &CaseRecord| match (record.n, record.h) {
        (Some(n), Some(h)) => (f64::from(n) * h - 1.0).abs() < 1e-9,
        _ => true,
    };
    match direction {
        Direction::Space if records.iter().all(cells) => {
            "mesh size h = 1/n, n cells per unit length"
        }
        Direction::Space => "mesh size h, the longest edge",
        Direction::Time => "time step k = T/N",
    }
}

fn series(curve: &Curve<'_>, level: &str) -> Series {
    let fitted = fitted(curve);
    let mut parts = match &fitted {
        Some(fit) => fit.to_vec(),
        None => vec![Part::Line(curve.used.clone())],
    };
    parts.push(Part::Points(curve.used.clone()));
    let rest = [Part::Hollow(curve.left_out.clone()), Part::Dashed(curve.visible_floor().to_vec())];
    parts.extend(rest.into_iter().filter(|part| !part.points().is_empty()));
    let mut series = Series::new(norm_label(curve.norm), parts);
    let judged = curve.verdict.map(|verdict| {
        let [_, _, _, _, observed, decision, _] = cell_texts(verdict);
        format!("{observed} {decision}")
    });
    series.detail = [Some(level.to_owned()), judged].map(Option::unwrap_or_default).join("\n");
    series.slope = curve.slope();
    series
}

/// The fitted line through the centre of the points, and the lines of the interval's ends.
fn fitted(curve: &Curve<'_>) -> Option<[Part; 3]> {
    let (order, [lo, hi]) = curve.verdict.and_then(|v| v.observed.zip(v.interval))?;
    let (a, b) = (curve.used.first()?.0, curve.used.last()?.0);
    let count = curve.used.len() as f64;
    let mean = |f: fn(&Datum) -> f64| curve.used.iter().map(f).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0.ln()), mean(|point| point.1.ln()));
    let at = |step: f64, slope: f64| (step, (y + slope * (step.ln() - x)).exp());
    let centre = (x.exp(), y.exp());
    let band = |end: f64| Part::Band(vec![at(end, lo), centre, at(end, hi)]);
    Some([band(a), band(b), Part::Line(vec![at(a, order), at(b, order)])])
}

/// What the signs mean that occur.
fn keys(series: &[Series]) -> Vec<Key> {
    let occurs = |part: fn(&Part) -> bool| series.iter().flat_map(|s| &s.parts).any(part);
    let mut keys = Vec::new();
    if occurs(|part| matches!(part, Part::Band(_))) {
        keys.push(Key::Band("fitted line, its interval".into()));
    }
    if occurs(|part| matches!(part, Part::Hollow(_))) {
        keys.push(Key::Hollow("left out".into()));
    }
    if occurs(|part| matches!(part, Part::Dashed(_))) {
        keys.push(Key::Dashed("floor of the solver".into()));
    }
    keys
}
