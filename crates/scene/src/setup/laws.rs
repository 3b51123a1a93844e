//! The laws of a scene for the solver.

use std::sync::Arc;

use super::formulas::on_contact_in_time;
use fem::contact::Friction;
use formula::Graph;
use vhi::law::{Curved, NoPotential, PiecewiseLinear, Potential};

/// The law of a scene, without its factor. Its points were validated, so the fallback to no law does not occur.
pub(super) fn potential(law: Option<&crate::Law>) -> Arc<dyn Potential> {
    let graph = law.and_then(|law| {
        let points = law.points.iter().map(|&[r, p]| (r, p)).collect();
        let graph = PiecewiseLinear::new(points, law.slope_before, law.slope_after).ok()?;
        Some((graph, law.curve))
    });
    match graph {
        Some((graph, Some(curve))) => Arc::new(Curved::new(graph, curve)),
        Some((graph, None)) => Arc::new(graph),
        None => Arc::new(NoPotential),
    }
}

/// Friction for the solver: S = c(x, t) S_0(|u_τ|), or c p(u_ν) if it follows the normal law.
pub(super) fn friction(written: &crate::Friction, formulas: &Arc<Graph>) -> Friction {
    let (graph, given) = written.graph_and_factor();
    let coefficient = written.coefficient();
    let follows_pressure = coefficient > 0.0;
    let factor = if follows_pressure {
        Box::new(move |_, _| coefficient)
    } else {
        on_contact_in_time(formulas, given)
    };
    Friction { factor, graph, follows_pressure }
}
