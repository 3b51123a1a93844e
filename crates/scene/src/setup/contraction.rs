//! Bound of the contraction factor of the decomposition of Remark 3, from the scene's constants.

use super::constants::with_needed;
use super::{AbstractSetup, Result, Setup, SetupError, TraceConstant};
use fem::contact::{Discretization, TraceMass, trace_constants};
use vhi::law::TensorField;

/// (α_ν c_j² + α_τ c_τ²)/m on this mesh and grid, with m = m_𝒜 - w(μ L_κ √|Ω| + max(0, -λ_min ℬ(0))), less what
/// friction that follows the normal law adds to α_ν c_j² in (2.9), (A - α_ν) c_j² + B c_τ²; c_j² and c_τ² by the lumped
/// trace mass. Below one if and only if the step satisfies (2.9) with these constants. Infinite for m ≤ 0, 0 for convex
/// potentials. w is the largest weight of the last slot, k/2 for the trapezoidal rule.
///
/// # Errors
/// [`SetupError::Constant`].
pub fn decomposition_bound(
    setup: &Setup,
    space: &Discretization,
    n: u32,
    steps: u32,
) -> Result<f64> {
    let constants = with_needed(setup, |part| {
        trace_constants(space, &TensorField::identity(), [(part, TraceMass::Lumped)])
            .map(|[found]| TraceConstant::exactly(found.value))
            .map_err(|source| SetupError::Constant { n, source })
    })?;
    let bounds = constants.step_bounds(setup.model.time_rule.as_ref());
    let last = bounds.taken(setup.grid(steps).largest_step());
    let falls = constants.falls();
    let m = constants.m_elastic - last - (constants.concave() - falls);
    Ok(quotient(falls, m))
}

/// The contraction factor of the decomposition for an abstract problem: α_j c_j²/(m_A - α_φ - w β_φ‖R‖‖q(t,t)‖).
pub fn abstract_decomposition_bound(setup: &AbstractSetup, steps: u32) -> f64 {
    let c = &setup.constants;
    let bounds = c.step_bounds(setup.model.time_rule.as_ref());
    let last = bounds.taken(setup.grid(steps).largest_step());
    quotient(c.alpha_j * c.c_j_squared, c.m_a - c.alpha_phi - last)
}

fn quotient(above: f64, m: f64) -> f64 {
    match (above == 0.0, m > 0.0) {
        (true, _) => 0.0,
        (false, true) => above / m,
        (false, false) => f64::INFINITY,
    }
}
