//! The error over h and k: against k, one curve an h, with the fitted joint model.

use super::ReportError;
use super::SceneSummary;
use super::canvas::Canvas;
use super::curve::norms;
use super::frame::{Frame, Title, step_label};
use super::legend::{Legend, Sample};
use super::palette::{INK, colour};
use crate::fit::{JointFit, Point, joint_fits, screen};
use crate::record::{CaseRecord, norm_label};

/// Strokes of the model, shorter than their gaps: dots.
const DOTS: (f64, f64) = (4.0, 9.0);

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
    let records: Vec<CaseRecord> =
        records.iter().filter(|record| record.scene == scene.name).cloned().collect();
    let grids = norms(&records).into_iter().map(|norm| (norm, curves(&records, norm)));
    let Some((norm, curves)) = grids.into_iter().find(|(_, curves)| is_grid(curves)) else {
        return Ok(None);
    };
    let points: Vec<Point> = curves.iter().flatten().copied().collect();
    let data: Vec<(f64, f64)> = points.iter().map(|point| (point.k, point.error)).collect();
    let Some(frame) = Frame::new(&data) else {
        return Ok(None);
    };
    let fitted = joint_fits(&points, false);
    let title = Title {
        scene: &scene.name,
        question: &scene.question,
        x_label: "time step k = T/N",
        y_label: norm_label(norm),
    };
    let mut svg = String::new();
    let canvas = Canvas::new(&mut svg)?;
    frame.draw(&canvas, &title)?;
    draw_curves(&canvas, &frame, &curves, fitted.as_ref().ok().map(|fits| &fits.best))?;
    draw_legend(&canvas, &curves, fitted.map(|fits| fits.best).map_err(|error| error.to_string()))?;
    canvas.finish()?;
    Ok(Some(svg))
}

fn draw_curves(
    canvas: &Canvas<'_>,
    frame: &Frame,
    curves: &[Vec<Point>],
    model: Option<&JointFit>,
) -> Result<(), ReportError> {
    for (index, curve) in curves.iter().enumerate() {
        let path: Vec<_> = curve.iter().map(|point| frame.place(point.k, point.error)).collect();
        canvas.line(&path, colour(index), 3)?;
        if let Some(model) = model {
            canvas.dashed(&model_path(frame, model, curve), INK, DOTS)?;
        }
        for (place, point) in path.into_iter().zip(curve) {
            canvas.marker(place, index, colour(index), screen(point).is_err())?;
        }
    }
    Ok(())
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

fn model_path(frame: &Frame, model: &JointFit, curve: &[Point]) -> Vec<(f64, f64)> {
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else {
        return Vec::new();
    };
    (0..=MODEL_PIECES)
        .map(|i| first.k * (last.k / first.k).powf(f64::from(i) / f64::from(MODEL_PIECES)))
        .map(|k| frame.place(k, model.error(first.h, k)))
        .collect()
}

fn draw_legend(
    canvas: &Canvas<'_>,
    curves: &[Vec<Point>],
    model: Result<JointFit, String>,
) -> Result<(), ReportError> {
    let mut legend = Legend::new(canvas);
    for (index, point) in curves.iter().filter_map(|curve| curve.first()).enumerate() {
        let words = format!("h = {}", step_label(point.h));
        legend.entry(Sample::Curve(index), colour(index), &words)?;
    }
    if curves.iter().flatten().any(|point| screen(point).is_err()) {
        legend.entry(Sample::Hollow, INK, "below floor")?;
    }
    legend.space();
    match model {
        Ok(fit) => {
            let (p, q) = (fit.order_h.value, fit.order_k.value);
            let words = format!("model {}: p = {p:.2} in h, q = {q:.2} in k", fit.model.name());
            legend.entry(Sample::Dashed(DOTS), INK, &words)
        }
        Err(reason) => legend.entry(Sample::Text, INK, &reason),
    }
}
