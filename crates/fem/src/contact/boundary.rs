//! The constraint graphs of Γ3 for the solver, and what their pressures are made of.

use std::sync::Arc;

use super::{BoundaryRule, Discretization, Model, friction};
use vhi::law::{NoPotential, Potential};
use vhi::{BoundaryGraph, Coordinate, GraphPiece, StepState};

/// The graphs of Γ3, those of the normal laws first, one a free point of the trace in its order: the shift at the vertices,
/// the potential where the vertex rule is used, else none, which is the first. After them those of friction. Gaps are those
/// of [`set_gaps`].
pub(crate) fn boundary_graph(
    space: &Discretization,
    model: &Model,
    elastic: &[f64],
) -> BoundaryGraph {
    let none: Arc<dyn Potential> = Arc::new(NoPotential);
    let mut graph = BoundaryGraph { coordinates: Vec::new(), potentials: vec![none] };
    // A law with a factor is one law per vertex.
    let mut laws = Vec::with_capacity(model.boundary.len());
    for boundary in &model.boundary {
        laws.push(match (boundary.rule, &boundary.scale) {
            (BoundaryRule::Vertex, Some(_)) => None,
            (BoundaryRule::Vertex, None) => {
                graph.potentials.push(boundary.potential.clone());
                Some(graph.potentials.len() - 1)
            }
            (BoundaryRule::Gauss | BoundaryRule::Exact, _) => Some(0),
        });
    }
    for point in space.trace.points.iter().filter(|point| point.carries()) {
        let known = model.boundary.iter().zip(&laws).find(|(known, _)| known.is_on(point.side));
        let Some((boundary, law)) = known else { continue };
        let x = space.mesh.point(&[point.vertex], &[1.0]);
        let law = law.unwrap_or_else(|| {
            graph.potentials.push(Arc::new(boundary.potential_at(x)));
            graph.potentials.len() - 1
        });
        let stiffness = elastic[space.pattern.diagonal(point.unknown as usize)];
        graph.coordinates.push(Coordinate {
            dof: point.unknown,
            sign: point.sign,
            weight: point.weight,
            gap: f64::INFINITY,
            floor: f64::NEG_INFINITY,
            law: law as u32,
            shift: (boundary.shift)(x),
            // γ α_ν = α_ν w/K_ii is of order h α_ν/m_𝒜: below one wherever (2.9) holds.
            gamma: point.weight / stiffness,
            span: 1,
        });
    }
    friction::append_graphs(space, model, elastic, &mut graph);
    graph
}

/// The gaps of the time t. The graphs of the normal law come first, in the order of the points.
pub(super) fn set_gaps(space: &Discretization, model: &Model, t: f64, graph: &mut BoundaryGraph) {
    if model.boundary.is_empty() {
        return;
    }
    let points = space.trace.points.iter().filter(|point| point.carries());
    for (point, at) in points.zip(&mut graph.coordinates) {
        at.gap = model.gap(point.side, space.mesh.point(&[point.vertex], &[1.0]), t);
    }
}

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
