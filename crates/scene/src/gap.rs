//! The gap g and the shift s: finite, and g concave on each contact side.

use std::collections::BTreeMap;

use formula::{EvaluationPoint, Node};

use super::data::AXES;
use super::diagnostic::SceneError;
use super::domain::{Domain, Face, place};
use super::heading::Hypothesis;
use super::reading::{Reading, last};
use super::values::Formula;

/// Intervals of a side at whose ends the gap is examined.
const SAMPLES: u32 = 256;
/// Samples along each edge of a face in space.
const SAMPLES_OF_A_FACE: u32 = 32;
/// Smaller second differences, relative to the gap, are rounding.
const ROUNDING: f64 = 1e-12;

pub(super) fn finite_on_contact(
    reading: &mut Reading,
    key: &str,
    domain: &Domain,
) -> Result<Node, SceneError> {
    let dimension = domain.dimension();
    let scope = reading.scope(&AXES[..dimension]);
    let node = reading.formula(key, &scope)?;
    for &side in &domain.contact {
        let points = domain.points_on(side, samples(domain, &domain.faces(side)));
        let points = points.into_iter().map(EvaluationPoint::from);
        reading.everywhere((key, node), points, f64::is_finite, |at, value| {
            let (what, here, side) = (last(key), place(at, dimension), domain.name(side));
            let hint = "it must be finite on every contact side; for no constraint at all write gap = \"inf\"";
            (format!("`{what}` is {value} at {here} on the side {side}"), hint)
        })?;
    }
    Ok(node)
}

/// g, or None for `inf`; concave on each contact side, unless the scene violates that on purpose.
pub(super) fn gap(
    reading: &mut Reading,
    key: &str,
    domain: &Domain,
) -> Result<Option<Node>, SceneError> {
    if matches!(reading.required::<Formula>(key)?.0.trim(), "inf" | "+inf" | "infinity") {
        return Ok(None);
    }
    let gap = finite_on_contact(reading, key, domain)?;
    if !reading.violates.contains(&Hypothesis::ConcaveGap) {
        concave(reading, gap, domain)?;
    }
    Ok(Some(gap))
}

/// Refuses a gap that is not concave on a plane piece of a side: (5.14) uses U^h ⊂ U.
fn concave(reading: &mut Reading, gap: Node, domain: &Domain) -> Result<(), SceneError> {
    for side in &domain.contact {
        let faces = domain.faces(*side);
        let intervals = samples(domain, &faces);
        let bends = faces.iter().filter_map(|face| steepest_bend(reading, gap, face, intervals));
        let Some((point, bend)) = steeper(bends) else {
            continue;
        };
        let message = format!(
            "the gap is not concave on the side {}: second derivative {bend:.4} at {}",
            domain.name(*side),
            place(&point, domain.dimension())
        );
        let hint = "U^h ⊂ U needs a concave gap; to run it on purpose, write violates = [\"concave_gap\"] in [scene]";
        return Err(reading.error("contact.gap", message, hint));
    }
    Ok(())
}

/// The point with the largest bend; the first of several up to rounding.
fn steeper(bends: impl Iterator<Item = (EvaluationPoint, f64)>) -> Option<(EvaluationPoint, f64)> {
    bends.reduce(|steepest, next| if next.1 > 1.001 * steepest.1 { next } else { steepest })
}

/// The point of a face with the largest upward second derivative; None if concave. Second differences of the samples
/// detect kinks, which the exact derivative misses.
fn steepest_bend(
    reading: &mut Reading,
    gap: Node,
    face: &Face,
    intervals: u32,
) -> Option<(EvaluationPoint, f64)> {
    let points: Vec<EvaluationPoint> =
        face.points(intervals).into_iter().map(EvaluationPoint::from).collect();
    let value =
        |reading: &Reading, node: Node, at: &EvaluationPoint| reading.formulas.evaluate(node, at);
    let values: Vec<f64> = points.iter().map(|point| value(reading, gap, point)).collect();
    let size = values.iter().fold(f64::MIN_POSITIVE, |size, value| size.max(value.abs()));
    let steps: Vec<[f64; 3]> =
        face.edges.iter().map(|edge| edge.map(|e| e / f64::from(intervals))).collect();
    let length = |v: [f64; 3]| v.iter().map(|e| e * e).sum::<f64>().sqrt();
    let spacing = steps.iter().map(|&step| length(step)).fold(f64::INFINITY, f64::min);
    let bends = Bends::new(reading, gap, face);
    let mut found: Vec<(EvaluationPoint, f64)> =
        points.iter().map(|at| (*at, bends.largest(|node| value(reading, node, at)))).collect();
    // Neighbours on both sides of a sample, along the edges and across a face.
    let pairs: &[[i64; 2]] =
        if steps.len() == 1 { &[[1, 0]] } else { &[[1, 0], [0, 1], [1, 1], [1, -1]] };
    // Rows first, in the order of the points.
    let grid: BTreeMap<[i64; 2], usize> = (0..)
        .zip(face.grid(intervals))
        .map(|(at, ([i, j], _))| ([j, i].map(i64::from), at))
        .collect();
    for (&[j, i], &at) in &grid {
        for &[p, q] in pairs {
            let ends = [[j - q, i - p], [j + q, i + p]].map(|ji| grid.get(&ji));
            let [Some(&before), Some(&after)] = ends else { continue };
            let second = steps.get(1).copied().unwrap_or_default();
            let way = length([0, 1, 2].map(|a| p as f64 * steps[0][a] + q as f64 * second[a]));
            let bend = (values[before] - 2.0 * values[at] + values[after]) / way.powi(2);
            found.push((points[at], bend));
        }
    }
    steeper(found.into_iter().filter(|(_, bend)| bend * spacing * spacing > ROUNDING * size))
}

/// Second derivatives along a face.
struct Bends {
    first: Directional,
    /// g_ab and g_bb on a face in space.
    others: Option<[Directional; 2]>,
}

/// Σ w_ij g_ij over the axes.
struct Directional(Vec<(f64, Node)>);

impl Bends {
    fn new(reading: &mut Reading, gap: Node, face: &Face) -> Self {
        let along = face.tangents();
        let mut second = |a: [f64; 3], b: [f64; 3]| {
            let mut terms = Vec::new();
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                if a[i] * b[j] != 0.0 {
                    let slope = reading.formulas.derivative(gap, AXES[i]);
                    terms.push((a[i] * b[j], reading.formulas.derivative(slope, AXES[j])));
                }
            }
            Directional(terms)
        };
        let first = second(along[0], along[0]);
        let others = along.get(1).map(|&b| [second(along[0], b), second(b, b)]);
        Self { first, others }
    }

    /// The largest second derivative over all directions: the larger eigenvalue.
    fn largest(&self, value: impl Fn(Node) -> f64) -> f64 {
        let sum = |d: &Directional| d.0.iter().map(|(weight, node)| weight * value(*node)).sum();
        let first: f64 = sum(&self.first);
        let Some(others) = &self.others else {
            return first;
        };
        let [mixed, second]: [f64; 2] = [sum(&others[0]), sum(&others[1])];
        0.5 * (first + second) + (0.5 * (first - second)).hypot(mixed)
    }
}

/// Intervals per plane piece, fewer for a side of many pieces.
fn samples(domain: &Domain, faces: &[Face]) -> u32 {
    let whole = if domain.dimension() == 2 { SAMPLES } else { SAMPLES_OF_A_FACE };
    (whole / faces.len().max(1) as u32).max(8)
}
