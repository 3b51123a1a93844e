//! Error against h, and against k: one curve a norm, with what was predicted and fitted.

use super::ReportError;
use super::SceneSummary;
use super::canvas::{Anchor, Canvas};
use super::curve::{Curve, curve, norms};
use super::frame::{Frame, Title};
use super::legend::{Legend, Sample};
use super::palette::{INK, colour};
use crate::fit::Direction;
use crate::record::{CaseRecord, norm_label};
use crate::verdict::{Verdict, cell_texts};

const FLOOR_DASHES: (f64, f64) = (8.0, 10.0);

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
    let Some(frame) = Frame::new(&extent(&curves)) else {
        return Ok(None);
    };
    let title = Title {
        scene: &scene.name,
        question: &scene.question,
        x_label: step_name(&records, direction),
        y_label: "error in the norm named",
    };
    let mut svg = String::new();
    let canvas = Canvas::new(&mut svg)?;
    frame.draw(&canvas, &title)?;
    for (index, curve) in curves.iter().enumerate() {
        draw_fit(&canvas, &frame, curve, index)?;
        draw_points(&canvas, &frame, curve, index)?;
    }
    draw_legend(&canvas, &curves)?;
    canvas.finish()?;
    Ok(Some(svg))
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

fn extent(curves: &[Curve<'_>]) -> Vec<(f64, f64)> {
    let all = curves.iter().flat_map(|curve| {
        let triangle = curve.triangle().into_iter().flatten();
        curve.points().chain(curve.visible_floor().iter().copied()).chain(triangle)
    });
    all.collect()
}

fn draw_points(
    canvas: &Canvas<'_>,
    frame: &Frame,
    curve: &Curve<'_>,
    index: usize,
) -> Result<(), ReportError> {
    let place = |(x, y): &(f64, f64)| frame.place(*x, *y);
    let path: Vec<_> = curve.used.iter().map(place).collect();
    if curve.verdict.and_then(|verdict| verdict.interval).is_none() {
        canvas.line(&path, colour(index), 4)?;
    }
    for point in path {
        canvas.marker(point, index, colour(index), false)?;
    }
    for point in &curve.left_out {
        canvas.marker(place(point), index, colour(index), true)?;
    }
    let floor: Vec<_> = curve.visible_floor().iter().map(place).collect();
    canvas.dashed(&floor, colour(index), FLOOR_DASHES)?;
    let Some([fine, corner, coarse]) = curve.triangle() else {
        return Ok(());
    };
    canvas.line(&[fine, corner, coarse, fine].map(|point| place(&point)), INK, 3)?;
    let order = curve.verdict.map_or_else(String::new, |verdict| cell_texts(verdict)[3].clone());
    let (x, y) = place(&(corner.0, (corner.1 * coarse.1).sqrt()));
    canvas.text(&order, (x + 12.0, y), Anchor::Left)
}

/// The fitted line through the centre of the points, and the lines of the interval's ends.
fn draw_fit(
    canvas: &Canvas<'_>,
    frame: &Frame,
    curve: &Curve<'_>,
    index: usize,
) -> Result<(), ReportError> {
    let fitted = curve.verdict.and_then(|verdict| verdict.observed.zip(verdict.interval));
    let ends = curve.used.first().zip(curve.used.last());
    let (Some((order, [lo, hi])), Some((first, last))) = (fitted, ends) else {
        return Ok(());
    };
    let count = curve.used.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| curve.used.iter().map(f).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0.ln()), mean(|point| point.1.ln()));
    let at = |step: f64, slope: f64| frame.place(step, (y + slope * (step.ln() - x)).exp());
    let centre = frame.place(x.exp(), y.exp());
    let (a, b) = (first.0, last.0);
    for corners in [[at(a, lo), centre, at(a, hi)], [at(b, lo), centre, at(b, hi)]] {
        canvas.fill(&corners, colour(index), 0.22)?;
    }
    canvas.line(&[at(a, order), at(b, order)], colour(index), 4)
}

fn draw_legend(canvas: &Canvas<'_>, curves: &[Curve<'_>]) -> Result<(), ReportError> {
    let mut legend = Legend::new(canvas);
    for (index, curve) in curves.iter().enumerate() {
        legend.entry(Sample::Curve(index), colour(index), norm_label(curve.norm))?;
        if let Some(verdict) = curve.verdict {
            let [_, _, _, _, observed, decision, _] = cell_texts(verdict);
            legend.entry(Sample::Text, INK, &format!("{observed} {decision}"))?;
        }
        legend.space();
    }
    if curves.iter().any(|curve| curve.verdict.is_some_and(|verdict| verdict.interval.is_some())) {
        legend.entry(Sample::Band, INK, "fitted line, its interval")?;
    }
    if curves.iter().any(|curve| curve.triangle().is_some()) {
        legend.entry(Sample::Text, INK, "triangle: predicted order")?;
    }
    if curves.iter().any(|curve| !curve.left_out.is_empty()) {
        legend.entry(Sample::Hollow, INK, "left out")?;
    }
    if curves.iter().any(|curve| !curve.visible_floor().is_empty()) {
        legend.entry(Sample::Dashed(FLOOR_DASHES), INK, "floor of the solver")?;
    }
    Ok(())
}
