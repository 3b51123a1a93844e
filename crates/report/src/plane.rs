//! The error over the plane of k and h: measured in classes, contours of the fitted model between them, and the path on
//! which its two terms are equal.

use super::chart::{Axis, Chart, Datum, Part, Series};
use super::ruler::Scale;
use super::surface::grid;
use super::{ReportError, SceneSummary};
use judge::fit::{JointFit, Point, joint_fits};
use judge::record::{CaseRecord, norm_label};

/// Classes of errors, of equal width on the logarithm.
const CLASSES: i32 = 5;
/// Places along k at which a contour is found, and halvings for each.
const PLACES: i32 = 64;
const HALVINGS: usize = 50;

/// The picture of one scene; none if no norm has a grid of h and k on which both orders can be fitted.
///
/// # Errors
/// [`ReportError::Drawing`].
pub fn plane_svg(
    scene: &SceneSummary,
    records: &[CaseRecord],
) -> Result<Option<String>, ReportError> {
    let Some((norm, curves)) = grid(scene, records) else { return Ok(None) };
    let points: Vec<Point> = curves.into_iter().flatten().collect();
    let Ok(fits) = joint_fits(&points, false) else { return Ok(None) };
    let (fit, region) = (&fits.best, Region::of(&points));
    let x = Axis::new("time step k = T/N", Scale::Steps);
    // Lines have heights of their own: steps as ticks would be theirs.
    let y = Axis::new("mesh size h", Scale::Log);
    let mut chart = Chart::new(&scene.name, &scene.question, x, y);
    let (low, high) = region.error;
    let edge = |i: i32| low * (high / low).powf(f64::from(i) / f64::from(CLASSES));
    for class in (0..CLASSES).rev() {
        let (from, to) = (edge(class), edge(class + 1));
        // The largest error belongs to the last class.
        let inside = |p: &&Point| p.error >= from && (p.error < to || class + 1 == CLASSES);
        let own: Vec<Datum> = points.iter().filter(inside).map(|p| (p.k, p.h)).collect();
        let mut parts = vec![Part::Points(own)];
        if class > 0 {
            parts.push(Part::Line(contour(fit, &region, from)));
        }
        parts.retain(|part| !part.points().is_empty());
        chart.series.push(Series::new(format!("{from:.1e} to {to:.1e}"), parts));
    }
    let equal = equal_terms(fit, &region);
    if equal.len() > 1 {
        let path = vec![Part::Dashed(equal)];
        let words = format!(
            "C_h h^p = C_k k^q, p = {:.2}, q = {:.2}",
            fit.order_h.value, fit.order_k.value
        );
        chart.series.push(Series { grey: true, ..Series::new(words, path) });
    }
    chart.note = format!(
        "classes of {}, each with the contour of the {} model at its lower end",
        norm_label(&norm),
        fit.model.name()
    );
    chart.svg()
}

/// What the points span.
struct Region {
    h: (f64, f64),
    k: (f64, f64),
    error: (f64, f64),
}

impl Region {
    fn of(points: &[Point]) -> Self {
        let span = |pick: fn(&Point) -> f64| {
            let values = points.iter().map(pick);
            values.fold((f64::INFINITY, 0.0f64), |(lo, hi), v| (lo.min(v), hi.max(v)))
        };
        Self { h: span(|p| p.h), k: span(|p| p.k), error: span(|p| p.error) }
    }

    /// Steps from the largest to the smallest.
    fn steps(&self) -> impl Iterator<Item = f64> {
        let (from, to) = self.k;
        (0..=PLACES).map(move |i| from * (to / from).powf(f64::from(i) / f64::from(PLACES)))
    }
}

/// Where the model has an error, along k; it grows with h.
fn contour(fit: &JointFit, region: &Region, error: f64) -> Vec<Datum> {
    let at = |k: f64| {
        let (mut low, mut high) = (region.h.0.ln(), region.h.1.ln());
        let above = |h: f64| fit.error(h.exp(), k) > error;
        // No crossing within the meshes: a point without a place interrupts the line.
        if above(low) || !above(high) {
            return (k, f64::NAN);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if above(middle) { high = middle } else { low = middle }
        }
        (k, (0.5 * (low + high)).exp())
    };
    let found: Vec<Datum> = region.steps().map(at).collect();
    if found.iter().any(|point| point.1.is_finite()) { found } else { Vec::new() }
}

/// The path on which space and time have equal parts.
fn equal_terms(fit: &JointFit, region: &Region) -> Vec<Datum> {
    let at = |k: f64| {
        let time = fit.constant_k * k.powf(fit.order_k.value);
        (k, (time / fit.constant_h).powf(1.0 / fit.order_h.value))
    };
    region.steps().map(at).filter(|(_, h)| (region.h.0..=region.h.1).contains(h)).collect()
}
