//! Leading-order error of a sound scheme on a case, from the exact solution alone.
//!
//! In space it is the interpolation error ‖ε(u - I_h u)‖ (`interpolation`): on meshes of translated simplices I_h u is
//! closer to u_h than either is to u, for linear and quadratic elements. In time it solves the linearised scheme with
//! the quadrature error of the exact history as source (`in_space` on V^h, `finite` in ℝ^m):
//!
//! ```text
//! A'(u_n) e_n + N_y(Σ' w_nj q(t_n,t_j) e_j) = N(S_n u, u_n) - N(S_n^k u, u_n)
//! ```
//!
//! For smooth data its leading term is k² E(t) by the trapezoidal rule, driven by (1/12)[∂_s(q(t,s) u(s))]_0^t, and k
//! E(t) by the left-endpoint one, driven by (1/2)[q(t,s) u(s)]_0^t; the full source also covers other grids, kernels
//! like (t-s)^a, kinks and jumps.
//!
//! Independence: only numbers and formulas of the scene, the manufactured side's stress and histories, and linear algebra
//! are used. The solver's model, laws, time weights, assembly and march are not, so that mistakes in them do not move the
//! prediction; `tests/commands/house.rs` lists what is shared.

mod cells;
mod contact_answers;
mod error;
mod finite;
mod in_space;
mod interpolation;
mod sums;

pub use error::NoConstant;
pub use interpolation::InterpolationError;
/// A case of a scene whose errors are predicted.
pub use judge::verdict::MeshAndSteps as Case;

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use algebra::in_dimension;
use exact::Exact;
use in_space::Largest;
use judge::verdict::{LeadingLine, LeadingPoint};
use scene::setup::{Setup, Subject};
use scene::{Direction, Norm, Prediction};
use sums::{largest_step, times};

/// Steps of the reference run for time errors, as a multiple of the case's.
pub const TIME_REFERENCE: u32 = 8;
/// The linearisation error is the size of the error over that of the solution: 1e-5 on the finest steps of the shipped
/// scenes, with a safety factor 10. If a contact state changes within the error the share does not fall with k, and the
/// scene has to state it.
const IN_TIME: f64 = 1e-4;
/// Steps beyond which direct sums are not worth their cost: the error is long asymptotic.
const MOST_STEPS: u32 = 1024;

/// The largest step and errors of each computed case of a mesh.
type OfMesh = Vec<(Case, f64, Largest)>;

/// Computed time errors, shared by the norms and predictions of a scene, by the cases of one mesh and whether u(t) had to be
/// in V^h.
#[derive(Debug, Default)]
pub struct InTime(BTreeMap<(Vec<Case>, bool), OfMesh>);

/// The leading errors of `cases` of a scene, in the order of the cases, in a norm and a direction with its predicted order,
/// or why there are none; reuses what has been computed for other norms of the scene.
pub fn leading_errors(
    subject: &Subject,
    (norm, variable, order): (Norm, Direction, f64),
    cases: &[Case],
    known: &mut InTime,
) -> Result<LeadingLine, NoConstant> {
    let setup = match (subject, variable) {
        (Subject::Abstract(setup), _) => {
            let points = of_few_steps(cases, MOST_STEPS).map(|&Case { n, steps }| {
                let times = times(&setup.scene.time, steps);
                let error = finite::largest_error(setup, norm, &times)?;
                Ok(LeadingPoint { n, steps, h: None, k: largest_step(&times), error })
            });
            let points = points.collect::<Result<_, NoConstant>>()?;
            return Ok(LeadingLine { points, limit: None, tolerance: IN_TIME });
        }
        (Subject::Contact(_), Direction::Joint | Direction::Path) => return Err(NoConstant::Joint),
        (Subject::Contact(setup), Direction::H) => {
            return interpolation::in_space_direction(setup, norm, cases);
        }
        (Subject::Contact(setup), Direction::K) => setup,
    };
    let Some(exact) = &setup.exact else { return Err(NoConstant::NoExact) };
    let interpolated = setup.body.data.is_interpolated();
    let of = |errors: Largest| errors.of(norm).ok_or(NoConstant::Norm { norm: norm.name() });
    of(Largest::default())?;
    // A reference of M times the steps has M^-order of the error.
    let beside_finer = norm == Norm::VTimeMax;
    let share = if beside_finer { 1.0 - f64::from(TIME_REFERENCE).powf(-order) } else { 1.0 };
    let mut points = Vec::with_capacity(cases.len());
    let ns: BTreeSet<u32> = cases.iter().filter_map(|case| case.n).collect();
    let h = |n: u32| setup.body.domain.h(n);
    let finest = ns.last().filter(|_| beside_finer);
    let tolerance = finest.map_or(IN_TIME, |&n| interpolation::along_the_interpolant(setup, h(n)));
    let in_space = !beside_finer && !interpolated;
    for n in ns {
        let of_mesh: Vec<Case> = cases.iter().copied().filter(|case| case.n == Some(n)).collect();
        let h = Some(h(n));
        for &(Case { n, steps }, k, errors) in known.of_mesh(setup, exact, of_mesh, in_space)? {
            points.push(LeadingPoint { n, steps, h, k, error: share * of(errors)? });
        }
    }
    Ok(LeadingLine { points, limit: None, tolerance })
}

/// The error, on the finest of `cases`, of the direction that is not refined: in time that along the interpolant on the
/// coarsest mesh, where it is cheap, in space that of the interpolant. None where it is not known or cannot be in the way.
pub fn other_error(
    subject: &Subject,
    &Prediction { norm, variable, .. }: &Prediction,
    cases: &[Case],
    known: &mut InTime,
) -> Option<f64> {
    let Subject::Contact(setup) = subject else { return None };
    let exact = setup.exact.as_ref()?;
    let steps = cases.iter().map(|case| case.steps).max().filter(|steps| *steps <= MOST_STEPS)?;
    let ns = cases.iter().filter_map(|case| case.n);
    match variable {
        Direction::H => {
            let coarsest = Case { n: Some(ns.min()?), steps };
            let errors = known.of_mesh(setup, exact, vec![coarsest], false).ok()?;
            errors.first()?.2.of(norm)
        }
        Direction::K if norm == Norm::VTimeMax || setup.body.data.is_interpolated() => None,
        Direction::K => {
            let finest = Case { n: Some(ns.max()?), steps };
            let line = interpolation::in_space_direction(setup, norm, &[finest]).ok()?;
            line.points.first().map(|point| point.error)
        }
        Direction::Joint | Direction::Path => None,
    }
}

impl InTime {
    /// The errors of the cases of one mesh; with `in_space`, u(t) must be in V^h.
    fn of_mesh(
        &mut self,
        setup: &Setup,
        exact: &Arc<Exact>,
        cases: Vec<Case>,
        in_space: bool,
    ) -> Result<&[(Case, f64, Largest)], NoConstant> {
        let new = match self.0.entry((cases, in_space)) {
            Entry::Occupied(known) => return Ok(known.into_mut()),
            Entry::Vacant(new) => new,
        };
        let (time, memory) = (&setup.scene.time, &setup.body.material.memory);
        let cases = &new.key().0;
        let n = cases.first().and_then(|case| case.n).unwrap_or_default();
        let space = setup.space(n).map_err(|error| NoConstant::Setup(error.to_string()))?;
        if memory.iter().any(|term| term.inner.is_some()) {
            return Err(NoConstant::Nested);
        }
        let errors = in_dimension!(space.mesh.dimension, D, S => {
            let body = in_space::InSpace::<S>::new(exact.clone(), space, time.rule, memory)?;
            if in_space && !body.holds_the_solution(time.horizon)? {
                return Err(NoConstant::NotInSpace);
            }
            let error = |&case: &Case| {
                let times = times(time, case.steps);
                Ok((case, largest_step(&times), body.largest_errors(&times)?))
            };
            of_few_steps(cases, body.most_steps()).map(error).collect::<Result<_, NoConstant>>()?
        });
        Ok(new.insert(errors))
    }
}

/// The cases of up to `most` steps; if all have more, those of the fewest.
fn of_few_steps(cases: &[Case], most: u32) -> impl Iterator<Item = &Case> {
    let fewest = cases.iter().map(|case| case.steps).min().unwrap_or(0);
    cases.iter().filter(move |case| case.steps <= most.max(fewest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_steps_are_told_however_many_they_are() {
        let told = |steps: &[u32], most: u32| -> Vec<u32> {
            let cases: Vec<Case> = steps.iter().map(|&steps| Case { n: None, steps }).collect();
            of_few_steps(&cases, most).map(|case| case.steps).collect()
        };
        assert_eq!(told(&[64, 4096, 1024], 1024), [64, 1024]);
        assert_eq!(told(&[4096, 2048, 8192], 1024), [2048]);
        assert!(told(&[], 1024).is_empty());
    }
}
