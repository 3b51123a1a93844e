//! Errors on the parts of Γ3 where the truth is open, on a branch of the law, at a jump or locked, and
//! the measure by which contact sets differ.

use crate::contact::{Discretization, StepView};
use crate::space::quadrature::{Rule, edge};

/// What the truth does at a point of Γ3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ContactState {
    /// u_ν < g, and ∂j_ν is zero around u_ν.
    Open,
    /// u_ν < g where ∂j_ν does not fall; a constant pressure counts here.
    Rising,
    /// u_ν < g where ∂j_ν falls.
    Falling,
    /// u_ν < g at a jump of ∂j_ν: ξ is chosen from an interval.
    AtJump,
    /// u_ν = g, with or without λ > 0.
    Locked,
}

impl ContactState {
    /// Every state, in the order of tables.
    pub const ALL: [Self; 5] =
        [Self::Open, Self::Rising, Self::Falling, Self::AtJump, Self::Locked];
}

/// The truth at one time at the points of [`state_rule`] on each facet of Γ3 (plane scenes).
#[derive(Debug, Clone, Default)]
pub struct ContactSamples {
    /// u_ν, facet by facet.
    pub normal: Vec<f64>,
    /// ξ + λ.
    pub pressure: Vec<f64>,
    /// The states.
    pub state: Vec<ContactState>,
    /// g at the two corners of each facet; ∞ without constraint.
    pub gap: Vec<f64>,
}

/// Parts of an edge, and Gauss points in each.
const PARTS: usize = 8;
const POINTS: usize = 3;

/// The rule by which errors are split: an edge in eight parts, each with three Gauss points.
/// Within a part exact for degree 5; where the edge of a zone cuts a part, that part is shared among the
/// states by its points, an error in measure of at most h/8.
pub fn state_rule() -> Rule {
    let part = edge(POINTS);
    let count = PARTS as f64;
    let mut rule = Rule { points: Vec::new(), weights: Vec::new() };
    for s in 0..PARTS {
        for (point, weight) in part.points.iter().zip(&part.weights) {
            let place = (s as f64 + point[1]) / count;
            rule.points.push(vec![1.0 - place, place]);
            rule.weights.push(weight / count);
        }
    }
    rule
}

/// Errors at one time level by the state of the truth.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StateErrors {
    /// Measure of the part of Γ3 in each state, in the order of [`ContactState::ALL`].
    pub measure: [f64; 5],
    /// ‖u_ν - u_ν^{kh}‖ on that part.
    pub trace: [f64; 5],
    /// ‖(ξ + λ) - (ξ + λ)^{kh}‖ on that part, the discrete pressure interpolated by the element.
    pub pressure: [f64; 5],
    /// Measure of the points that are locked in one of truth and discrete solution, not in both.
    pub set_difference: f64,
}

/// All of them for `view`. An edge counts as locked in the discrete solution if both its ends are.
pub fn state_errors(
    space: &Discretization,
    view: &StepView<'_>,
    samples: &ContactSamples,
) -> StateErrors {
    let rule = state_rule();
    let shapes: Vec<Vec<f64>> = rule.points.iter().map(|b| space.element.values(b)).collect();
    let mut errors = StateErrors::default();
    for (f, &measure) in space.trace.measure.iter().enumerate() {
        let members = || space.trace.facet(f).iter().map(|&i| i as usize);
        let normal: Vec<f64> = members().map(|i| space.trace.normal(i, view.u)).collect();
        let pressure: Vec<f64> =
            members().map(|i| view.compliance[i] + view.multiplier[i]).collect();
        let locked = (0..2).all(|a| super::is_locked(normal[a], samples.gap[2 * f + a]));
        for (q, (shape, weight)) in shapes.iter().zip(&rule.weights).enumerate() {
            let at = rule.weights.len() * f + q;
            let state = samples.state[at];
            let share = measure * weight;
            let squared = |exact: f64, values: &[f64]| {
                let left = values.iter().zip(shape).fold(exact, |left, (v, s)| left - s * v);
                share * left.powi(2)
            };
            errors.measure[state as usize] += share;
            errors.trace[state as usize] += squared(samples.normal[at], &normal);
            errors.pressure[state as usize] += squared(samples.pressure[at], &pressure);
            if (state == ContactState::Locked) != locked {
                errors.set_difference += share;
            }
        }
    }
    errors.trace = errors.trace.map(f64::sqrt);
    errors.pressure = errors.pressure.map(f64::sqrt);
    errors
}
