//! The gap g and the shift s: finite, and g concave on each contact side, at all times.

use std::collections::BTreeMap;

use fem::mesh::Face;
use formula::{EvaluationPoint, Node, Variable};

use super::data::AXES;
use super::domain::{Domain, place};
use super::reading::{Formula, Reading, evenly, in_time, last};
use super::source::SceneError;
use super::time::Time;
use super::validated::Hypothesis;
use files::digits;

/// Intervals of a side at whose ends the gap is examined.
const SAMPLES: u32 = 256;
/// Samples along each edge of a face in space.
const SAMPLES_OF_A_FACE: u32 = 32;
/// Intervals of [0, T] at whose ends a function that moves is examined.
pub(super) const TIMES: u32 = 32;
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
    on_contact(reading, (key, node), domain, (0.0, 0), f64::is_finite, FINITE)?;
    Ok(node)
}

const FINITE: &str =
    "it must be finite on every contact side; for no constraint at all write gap = \"inf\"";

/// Refuses a function that does not fit somewhere on a contact side, at the ends of so many intervals of time.
pub(super) fn on_contact(
    reading: &Reading,
    (key, node): (&str, Node),
    domain: &Domain,
    (horizon, times): (f64, u32),
    fits: impl Fn(f64) -> bool,
    hint: &str,
) -> Result<(), SceneError> {
    for &side in &domain.contact {
        let places = domain.points_on(side, samples(domain, &domain.faces(side)));
        let points = in_time(&places, horizon, times);
        reading.everywhere((key, node), points, &fits, |at, value| {
            let (what, here, side) = (last(key), place(at, domain.dimension()), domain.name(side));
            let when = if times > 0 { format!(", t = {}", at.t) } else { String::new() };
            (format!("`{what}` is {value} at {here}{when} on the side {side}"), hint)
        })?;
    }
    Ok(())
}

/// g(x, t), or None for `inf`; concave on each contact side, unless the scene violates that on purpose.
pub(super) fn gap(
    reading: &mut Reading,
    key: &str,
    domain: &Domain,
    time: &Time,
) -> Result<Option<Node>, SceneError> {
    if matches!(reading.required::<Formula>(key)?.0.trim(), "inf" | "+inf" | "infinity") {
        return Ok(None);
    }
    let scope = reading.space_and_time(domain.dimension());
    let gap = reading.formula(key, &scope)?;
    let times = if reading.formulas.depends_on(gap, Variable::T) { TIMES } else { 0 };
    on_contact(reading, (key, gap), domain, (time.horizon, times), f64::is_finite, FINITE)?;
    if !reading.violates.contains(&Hypothesis::ConcaveGap) {
        for t in evenly(0.0, time.horizon, times) {
            concave(reading, (key, gap), domain, t)?;
        }
    }
    Ok(Some(gap))
}

/// Refuses a gap that is not concave on a plane piece of a side: (5.14) uses U^h ⊂ U.
fn concave(
    reading: &Reading,
    (key, gap): (&str, Node),
    domain: &Domain,
    t: f64,
) -> Result<(), SceneError> {
    for side in &domain.contact {
        let faces = domain.faces(*side);
        let intervals = samples(domain, &faces);
        let bends =
            faces.iter().filter_map(|face| steepest_bend(reading, (gap, t), face, intervals));
        let steepest = bends.max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((point, bend)) = steepest else { continue };
        let when = if t > 0.0 { format!(", t = {t}") } else { String::new() };
        let message = format!(
            "the gap is not concave on the side {}: second derivative {} at {}{when}",
            domain.name(*side),
            digits(bend, 5),
            place(&point, domain.dimension())
        );
        let hint = "U^h ⊂ U needs a concave gap; to run it on purpose, write violates = [\"concave_gap\"] in [scene]";
        return Err(reading.error(key, message, hint));
    }
    Ok(())
}

/// The point of a face with the largest upward second derivative along it, by second differences of the samples, which also
/// detect kinks; the first of several up to rounding, None if concave.
fn steepest_bend(
    reading: &Reading,
    (gap, t): (Node, f64),
    face: &Face,
    intervals: u32,
) -> Option<(EvaluationPoint, f64)> {
    let length = |v: [f64; 3]| v.iter().map(|e| e * e).sum::<f64>().sqrt();
    // Rows first, in the order of the points.
    let grid = face.grid(intervals).into_iter();
    let grid: BTreeMap<[i64; 2], (EvaluationPoint, f64)> = grid
        .map(|([i, j, _], place)| {
            let at = EvaluationPoint { t, ..place.into() };
            ([j, i].map(i64::from), (at, reading.formulas.evaluate(gap, &at)))
        })
        .collect();
    let size = grid.values().fold(f64::MIN_POSITIVE, |size, (_, value)| size.max(value.abs()));
    let steps: Vec<[f64; 3]> =
        face.edges.iter().map(|edge| edge.map(|e| e / f64::from(intervals))).collect();
    let spacing = steps.iter().map(|&step| length(step)).fold(f64::INFINITY, f64::min);
    // Neighbours on both sides of a sample, along the edges and across a face.
    let pairs: &[[i64; 2]] =
        if steps.len() == 1 { &[[1, 0]] } else { &[[1, 0], [0, 1], [1, 1], [1, -1]] };
    let second = steps.get(1).copied().unwrap_or_default();
    let ways = pairs.iter().map(|&[p, q]| {
        let way = length([0, 1, 2].map(|a| p as f64 * steps[0][a] + q as f64 * second[a]));
        ([p, q], way)
    });
    let ways: Vec<([i64; 2], f64)> = ways.collect();
    let bends = grid.iter().flat_map(|(&[j, i], &(at, value))| {
        let grid = &grid;
        ways.iter().filter_map(move |&([p, q], way)| {
            let [before, after] = [[j - q, i - p], [j + q, i + p]].map(|ji| Some(grid.get(&ji)?.1));
            Some((at, (before? - 2.0 * value + after?) / way.powi(2)))
        })
    });
    let upward = bends.filter(|(_, bend)| bend * spacing * spacing > ROUNDING * size);
    upward.reduce(|steepest, next| if next.1 > 1.001 * steepest.1 { next } else { steepest })
}

/// Intervals per plane piece, fewer for a side of many pieces.
fn samples(domain: &Domain, faces: &[Face]) -> u32 {
    let whole = if domain.dimension() == 2 { SAMPLES } else { SAMPLES_OF_A_FACE };
    (whole / faces.len().max(1) as u32).max(8)
}
