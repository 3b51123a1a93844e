//! The laws of a scene for the solver.

use std::sync::Arc;

use super::formulas::on_contact_in_time;
use fem::contact::Friction;
use formula::Graph;
use vhi::law::{Curved, NoPotential, PiecewiseLinear, Potential};

/// The law of a scene, without its factor.
pub(super) fn potential(law: Option<&crate::Law>) -> Arc<dyn Potential> {
    let Some(law) = law else { return Arc::new(NoPotential) };
    let points = law.points.iter().map(|&[r, p]| (r, p)).collect();
    match (PiecewiseLinear::new(points, law.slope_before, law.slope_after), law.curve) {
        (Ok(graph), Some(curve)) => Arc::new(Curved::new(graph, curve)),
        (Ok(graph), None) => Arc::new(graph),
        // Not so: the points were validated.
        (Err(_), _) => Arc::new(NoPotential),
    }
}

/// Friction for the solver: S = c(x, t) S_0(|u_τ|), or c p(u_ν) if it follows the normal law.
pub(super) fn friction(written: &crate::Friction, formulas: &Arc<Graph>) -> Friction {
    let (graph, given) = written.graph_and_factor();
    let graph = potential(Some(&graph));
    let coefficient = written.bound.coefficient();
    let follows_pressure = coefficient > 0.0;
    let factor = match follows_pressure {
        true => Box::new(move |_, _| coefficient),
        false => on_contact_in_time(formulas, given, 1.0),
    };
    Friction { factor, graph, follows_pressure }
}
