//! The order of things: measured factors ≤ sharpened ≤ (3.15) at every k, thresholds the other way.

use super::branch::Branch;
use super::crossing::Crossing;
use super::ladder::StepRung;
use vhi::StepBounds;

/// An inequality that does not hold.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct BoundViolation {
    /// k, if it is of one step size.
    pub k: Option<f64>,
    /// What should hold.
    pub what: String,
    /// Left side of the inequality.
    pub left: f64,
    /// Right side of the inequality.
    pub right: f64,
}

impl BoundViolation {
    /// One that belongs to no k.
    pub(super) fn new(what: impl Into<String>, left: f64, right: f64) -> Self {
        Self { k: None, what: what.into(), left, right }
    }
}

/// Rounding of a norm: eigenvalues settle to 1e-13, and the norm is their root.
const NORM: f64 = 1e-9;
/// Rounding of finite perturbations: 1e-13 over 1e-6, with room for the condition.
const FINITE: f64 = 1e-5;
/// Derivative against differences. A kink of Λ that a perturbation of 1e-6 crosses concerns few cells.
const DERIVATIVE: f64 = 0.02;
/// Thresholds are bracketed to 1e-8 relative, a singular tangent is approached to 1e-6.
const THRESHOLD: f64 = 5e-6;
/// Below this bound of the factor Λ reaches 1e-13 within the iterations it is given.
const SURE: f64 = 0.9;

/// All inequalities that do not hold.
pub fn violations(
    bounds: &StepBounds,
    rungs: &[StepRung],
    thresholds: &Branch,
) -> Vec<BoundViolation> {
    let of_rungs = rungs.iter().flat_map(|rung| of_rung(bounds, rung));
    of_rungs.chain(of_thresholds(bounds, thresholds)).collect()
}

/// left ≤ right, unless it holds; a NaN does not.
pub(super) fn broken(k: Option<f64>, what: &str, left: f64, right: f64) -> Option<BoundViolation> {
    let holds = left <= right;
    (!holds).then(|| BoundViolation { k, ..BoundViolation::new(what, left, right) })
}

fn of_rung(bounds: &StepBounds, rung: &StepRung) -> Vec<BoundViolation> {
    let sharp = rung.sharpened;
    let finite = sharp * (1.0 + FINITE) + FINITE * f64::from(u8::from(sharp == 0.0));
    let off = (rung.finite_worst - rung.norm).abs();
    let mut demands = vec![
        ("|DLambda| <= sharpened factor", rung.norm, sharp * (1.0 + NORM)),
        ("spectral radius <= |DLambda|", rung.radius, rung.norm * (1.0 + FINITE)),
        ("finite factor, worst direction <= sharpened", rung.finite_worst, finite),
        ("finite factor, random directions <= sharpened", rung.finite_random, finite),
        ("|finite - derivative|, worst direction", off, DERIVATIVE * rung.norm),
        ("sharpened factor <= (3.15)", sharp, rung.theorem * (1.0 + NORM)),
        ("(3.15) <= (3.15) in the paper's norm", rung.theorem, rung.paper),
    ];
    let one = |solved: bool| f64::from(u8::from(solved));
    if rung.k < bounds.solvable_limit() {
        let others = f64::from(rung.distinct);
        demands.extend([
            ("1 <= Newton finds the guaranteed solution", 1.0, one(rung.newton.is_ok())),
            ("solutions beside the one guaranteed <= 0", others, 0.0),
        ]);
    }
    if sharp < SURE {
        let solved = one(rung.fixed_point.is_ok());
        demands.push(("1 <= Lambda converges where it must contract", 1.0, solved));
    }
    let broken = |(what, left, right)| broken(Some(rung.k), what, left, right);
    demands.into_iter().filter_map(broken).collect()
}

fn of_thresholds(bounds: &StepBounds, found: &Branch) -> impl Iterator<Item = BoundViolation> {
    let (norm, radius) = (found.norm, found.radius);
    let lost = found.loss.as_ref().map(|loss| loss.bracket.1);
    let [paper, proved] = [bounds.paper_limit(), bounds.limit()].map(Some);
    let [sharpened, solvable] = [bounds.sharpened_limit(), bounds.solvable_limit()].map(Some);
    let [lower, upper] = [0, 1].map(|end: usize| move |crossing: Crossing| crossing[end]);
    let ordered = [
        ("k of (3.4), the paper's norm <= k of (3.4)", paper, proved),
        ("k of (3.4) <= sharpened k", proved, sharpened),
        ("sharpened k <= solvable k", sharpened, solvable),
        ("sharpened k <= k with |DLambda| = 1", sharpened, norm.map(upper)),
        ("k with |DLambda| = 1 <= k with spectral radius 1", norm.map(lower), radius.map(upper)),
        ("solvable k <= k that loses solvability", solvable, lost),
        ("k with spectral radius 1 <= k that loses solvability", radius.map(lower), lost),
    ];
    // What was not found is in no order.
    let broken = |(what, left, right): (&str, Option<f64>, Option<f64>)| {
        broken(None, what, left?, right? * (1.0 + THRESHOLD))
    };
    ordered.into_iter().filter_map(broken)
}
