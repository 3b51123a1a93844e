//! The graphs of friction behind those of the normal law, one a tangent of each free point, and what follows p in them.
//!
//! r ↦ S(|r|) sign r is the graph of a potential with one jump, at r = 0, which is a vertex that sticks. So it is solved as
//! the normal law is: a graph on the unknown that carries u_τ, at each vertex with the weight of the vertex rule; in space
//! on the vector of the two unknowns that carry it.

use std::sync::Arc;

use super::tangents::Tangential;
use super::{Discretization, Model};
use vhi::{BoundaryGraph, Coordinate};

/// Friction that follows p, at the open level: empty where it does not.
#[derive(Default)]
pub(super) struct Following {
    /// c(x, t) at the free points of the trace.
    pub(super) factors: Vec<f64>,
    /// The pressures of all graphs on the pieces that were chosen last.
    pub(super) pressures: Vec<f64>,
}

impl Following {
    pub(super) fn take_pressures(&mut self, pressures: &[f64]) {
        if !self.factors.is_empty() {
            self.pressures.clear();
            self.pressures.extend_from_slice(pressures);
        }
    }
}

/// Appends the graphs of friction, one a free point of the trace in its order, without their laws, which
/// `ContactProblem::set_friction` gives at each time.
pub(super) fn append_graphs(
    space: &Discretization,
    model: &Model,
    elastic: &[f64],
    graph: &mut BoundaryGraph,
) {
    if model.friction.is_none() {
        return;
    }
    for point in space.trace.points.iter().filter(|point| point.carries()) {
        let unknowns = point.tangential_unknowns(space);
        let stiffness = |at: &Tangential| elastic[space.pattern.diagonal(at.unknown as usize)];
        let stiffness = unknowns.iter().map(stiffness).sum::<f64>() / unknowns.len() as f64;
        for (k, Tangential { unknown, sign }) in unknowns.iter().enumerate() {
            graph.coordinates.push(Coordinate {
                dof: *unknown,
                sign: *sign,
                weight: point.weight,
                gap: f64::INFINITY,
                floor: f64::NEG_INFINITY,
                law: graph.potentials.len() as u32,
                shift: 0.0,
                // As for the normal law: a vertex changes its side of the jump by way of the jump.
                gamma: point.weight / stiffness,
                span: if k == 0 { unknowns.len() as u8 } else { 0 },
            });
        }
        graph.potentials.push(Arc::new(vhi::law::NoPotential));
    }
}

/// The multipliers s of the last graphs, at the points of the trace; 0 on Γ1.
pub(super) fn show(space: &Discretization, pressures: &[f64], shown: &mut [f64]) {
    let m = space.mesh.dimension - 1;
    let points = space.trace.points.iter().zip(shown.chunks_exact_mut(m));
    let free = points.filter(|(point, _)| point.carries());
    for ((_, at_point), s) in free.rev().zip(pressures.rchunks_exact(m)) {
        at_point.copy_from_slice(s);
    }
}
