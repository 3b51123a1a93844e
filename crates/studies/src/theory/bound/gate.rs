//! The order of things: measured factors ≤ sharpened ≤ (3.15) at every k, thresholds the other way.

use super::branch::Branch;
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
    let mut found = Vec::new();
    for rung in rungs {
        of_rung(bounds, rung, &mut found);
    }
    of_thresholds(bounds, thresholds, &mut found);
    found
}

/// Notes left ≤ right unless it holds; a NaN does not.
pub(super) fn demand(
    found: &mut Vec<BoundViolation>,
    k: Option<f64>,
    what: &str,
    left: f64,
    right: f64,
) {
    if left.is_nan() || right.is_nan() || left > right {
        found.push(BoundViolation { k, ..BoundViolation::new(what, left, right) });
    }
}

fn of_rung(bounds: &StepBounds, rung: &StepRung, found: &mut Vec<BoundViolation>) {
    let k = Some(rung.k);
    let sharp = rung.sharpened;
    demand(found, k, "|DLambda| <= sharpened factor", rung.norm, sharp * (1.0 + NORM));
    demand(found, k, "spectral radius <= |DLambda|", rung.radius, rung.norm * (1.0 + FINITE));
    let finite = sharp * (1.0 + FINITE) + FINITE * f64::from(u8::from(sharp == 0.0));
    demand(found, k, "finite factor, worst direction <= sharpened", rung.finite_worst, finite);
    demand(found, k, "finite factor, random directions <= sharpened", rung.finite_random, finite);
    let off = (rung.finite_worst - rung.norm).abs();
    demand(found, k, "|finite - derivative|, worst direction", off, DERIVATIVE * rung.norm);
    demand(found, k, "sharpened factor <= (3.15)", sharp, rung.theorem * (1.0 + NORM));
    demand(found, k, "(3.15) <= (3.15) in the paper's norm", rung.theorem, rung.paper);
    if rung.k < bounds.solvable_limit() {
        let solved = f64::from(u8::from(rung.newton.is_ok()));
        demand(found, k, "1 <= Newton finds the guaranteed solution", 1.0, solved);
        let others = f64::from(rung.distinct);
        demand(found, k, "solutions beside the one guaranteed <= 0", others, 0.0);
    }
    if sharp < SURE {
        let solved = f64::from(u8::from(rung.fixed_point.is_ok()));
        demand(found, k, "1 <= Lambda converges where it must contract", 1.0, solved);
    }
}

fn of_thresholds(bounds: &StepBounds, thresholds: &Branch, found: &mut Vec<BoundViolation>) {
    let slack = 1.0 + THRESHOLD;
    let mut ordered = |what: &str, left: f64, right: f64| {
        demand(found, None, what, left, right * slack);
    };
    ordered("k of (3.4), the paper's norm <= k of (3.4)", bounds.paper_limit(), bounds.limit());
    ordered("k of (3.4) <= sharpened k", bounds.limit(), bounds.sharpened_limit());
    ordered("sharpened k <= solvable k", bounds.sharpened_limit(), bounds.solvable_limit());
    if let Some(norm) = thresholds.norm {
        ordered("sharpened k <= k with |DLambda| = 1", bounds.sharpened_limit(), norm[1]);
    }
    if let (Some(norm), Some(radius)) = (thresholds.norm, thresholds.radius) {
        let what = "k with |DLambda| = 1 <= k with spectral radius 1";
        ordered(what, norm[0], radius[1]);
    }
    if let Some(loss) = &thresholds.loss {
        let lost = loss.bracket.1;
        ordered("solvable k <= k that loses solvability", bounds.solvable_limit(), lost);
        if let Some(radius) = thresholds.radius {
            ordered("k with spectral radius 1 <= k that loses solvability", radius[0], lost);
        }
    }
}
