//! The error over h and k: against k, one curve an h, with the fitted joint model.

use super::chart::{Axis, Chart, Datum, Key, Part, Series};
use super::curve::norms;
use super::ruler::Scale;
use super::ticks::step_label;
use super::{ReportError, SceneSummary};
use judge::fit::{JointFit, Point, joint_fits, screen};
use judge::record::{CaseRecord, norm_label};

/// Intervals of the model's curve: more would not be seen.
const MODEL_PIECES: i32 = 48;

/// The picture of one scene; none if no norm has two levels of h and of k.
///
/// # Errors
/// [`ReportError::Drawing`].
pub fn surface_svg(
    scene: &SceneSummary,
    records: &[CaseRecord],
) -> Result<Option<String>, ReportError> {
    let Some((norm, curves)) = grid(scene, records) else { return Ok(None) };
    let points: Vec<Point> = curves.iter().flatten().copied().collect();
    let x = Axis::new("time step k = T/N", Scale::Steps);
    let y = Axis::new(norm_label(&norm), Scale::Log);
    let mut chart = Chart::new(&scene.name, &scene.question, x, y);
    chart.series = curves.iter().map(|curve| series(curve)).collect();
    match joint_fits(&points, false) {
        Ok(fits) => chart.series.push(model(&fits.best, &curves)),
        Err(reason) => chart.note = reason.to_string(),
    }
    if chart.series.iter().flat_map(|s| &s.parts).any(|part| matches!(part, Part::Hollow(_))) {
        chart.keys.push(Key::Hollow("below floor".into()));
    }
    chart.svg()
}

/// The points of one h, those below the floor hollow.
fn series(curve: &[Point]) -> Series {
    let line = |points: &[&Point]| points.iter().map(|p| (p.k, p.error)).collect::<Vec<Datum>>();
    let all: Vec<&Point> = curve.iter().collect();
    let (good, lost): (Vec<&Point>, Vec<&Point>) = curve.iter().partition(|p| screen(p).is_ok());
    let mut parts = vec![Part::Line(line(&all)), Part::Points(line(&good))];
    if !lost.is_empty() {
        parts.push(Part::Hollow(line(&lost)));
    }
    let h = curve.first().map_or(f64::NAN, |point| point.h);
    Series::new(format!("h = {}", step_label(h)), parts)
}

/// The model on the curve of every h.
fn model(fit: &JointFit, curves: &[Vec<Point>]) -> Series {
    let (p, q) = (fit.order_h.value, fit.order_k.value);
    let words = format!("model {}: p = {p:.2} in h, q = {q:.2} in k", fit.model.name());
    let parts = curves.iter().map(|curve| Part::Dotted(model_path(fit, curve))).collect();
    Series { grey: true, ..Series::new(words, parts) }
}

/// The first norm of a scene with two levels of h and of k, and its [`curves`].
pub(super) fn grid(
    scene: &SceneSummary,
    records: &[CaseRecord],
) -> Option<(String, Vec<Vec<Point>>)> {
    let records: Vec<CaseRecord> =
        records.iter().filter(|record| record.scene == scene.name).cloned().collect();
    let mut all = norms(&records).into_iter().map(|norm| (norm, curves(&records, norm)));
    let (norm, curves) = all.find(|(_, curves)| is_grid(curves))?;
    Some((norm.to_owned(), curves))
}

/// The points that can be drawn, one curve an h from coarse to fine, along falling k.
fn curves(records: &[CaseRecord], norm: &str) -> Vec<Vec<Point>> {
    let mut points: Vec<Point> = records.iter().filter_map(|record| point(record, norm)).collect();
    points.sort_by(|a, b| b.h.total_cmp(&a.h).then(b.k.total_cmp(&a.k)));
    points.chunk_by(|a, b| a.h == b.h).map(<[Point]>::to_vec).collect()
}

fn point(record: &CaseRecord, norm: &str) -> Option<Point> {
    let entry = record.norm(norm).filter(|_| record.converged())?;
    let error = entry.error.filter(|error| *error > 0.0 && error.is_finite())?;
    Some(Point { h: record.h?, k: record.k, error, floor: entry.floor.unwrap_or(0.0) })
}

fn is_grid(curves: &[Vec<Point>]) -> bool {
    curves.len() >= 2 && curves.iter().any(|curve| curve.len() >= 2)
}

fn model_path(model: &JointFit, curve: &[Point]) -> Vec<Datum> {
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else {
        return Vec::new();
    };
    (0..=MODEL_PIECES)
        .map(|i| first.k * (last.k / first.k).powf(f64::from(i) / f64::from(MODEL_PIECES)))
        .map(|k| (k, model.error(first.h, k)))
        .collect()
}
