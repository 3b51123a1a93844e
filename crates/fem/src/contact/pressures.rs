//! Multiplier and compliance at the points of Γ3, from the pressures of the graphs.

use super::{BoundaryRule, Discretization, Model};
use vhi::law::Potential;
use vhi::{BoundaryGraph, GraphPiece, StepState};

/// c = ξ + λ: at the bound ξ is the least element of ∂j_ν(g) and λ the rest, elsewhere ξ is all.
pub(super) fn split_pressures(
    space: &Discretization,
    model: &Model,
    graph: &BoundaryGraph,
    state: &StepState,
    [compliance, multiplier]: [&mut [f64]; 2],
) {
    let mut next = 0;
    for (i, point) in space.trace.points.iter().enumerate() {
        let boundary = model.boundary_on(point.side).filter(|_| point.carries());
        let Some(boundary) = boundary else { continue };
        let pressure = state.pressure[next];
        let at = &graph.coordinates[next];
        let normal = graph.normal(next, &state.u);
        let piece = graph.piece(next, normal + at.gamma * pressure);
        next += 1;
        if boundary.rule == BoundaryRule::Vertex {
            compliance[i] = match piece {
                GraphPiece::Pinned { value, lo, .. } if value == at.gap => lo,
                _ => pressure,
            };
            multiplier[i] = pressure - compliance[i];
        } else {
            let x = space.mesh.point(&[point.vertex], &[1.0]);
            let law = boundary.potential_at(x);
            compliance[i] = law.subdifferential(normal - at.shift).0;
            multiplier[i] = pressure;
        }
    }
    space.trace.extend(compliance);
    space.trace.extend(multiplier);
}
