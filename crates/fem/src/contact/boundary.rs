//! The constraint graphs of Γ3 for the solver.

use std::sync::Arc;

use super::{Boundary, BoundaryRule, Discretization, Model, friction_graph};
use vhi::law::{NoPotential, Potential};
use vhi::{BoundaryGraph, Coordinate};

/// The graphs of Γ3: the shift at the vertices, the potential where the vertex rule is used; after them those of friction. Gaps
/// are those of [`set_gaps`].
pub(crate) fn boundary_graph(
    space: &Discretization,
    model: &Model,
    elastic: &[f64],
) -> BoundaryGraph {
    let none: Arc<dyn Potential> = Arc::new(NoPotential);
    let mut graph = match &model.boundary {
        Some(boundary) => normal_graph(space, boundary, none, elastic),
        None => BoundaryGraph { coordinates: Vec::new(), potentials: vec![none] },
    };
    friction_graph::append_graphs(space, model, elastic, &mut graph);
    graph
}

/// The gaps of the time t. The graphs of the normal law come first, in the order of the points.
pub(super) fn set_gaps(space: &Discretization, model: &Model, t: f64, graph: &mut BoundaryGraph) {
    let Some(boundary) = &model.boundary else { return };
    let points = space.trace.points.iter().filter(|point| point.carries());
    for (point, at) in points.zip(&mut graph.coordinates) {
        at.gap = (boundary.gap)(space.mesh.point(&[point.vertex], &[1.0]), t);
    }
}

fn normal_graph(
    space: &Discretization,
    boundary: &Boundary,
    none: Arc<dyn Potential>,
    elastic: &[f64],
) -> BoundaryGraph {
    // A law with a factor is one law per vertex.
    let mut potentials = match (boundary.rule, &boundary.scale) {
        (BoundaryRule::Vertex, None) => vec![boundary.potential.clone()],
        (BoundaryRule::Vertex, Some(_)) => Vec::new(),
        (BoundaryRule::Gauss | BoundaryRule::Exact, _) => vec![none],
    };
    let one_each = potentials.is_empty();
    let coordinates = space
        .trace
        .points
        .iter()
        .filter(|point| point.carries())
        .map(|point| {
            let x = space.mesh.point(&[point.vertex], &[1.0]);
            if one_each {
                potentials.push(Arc::new(boundary.potential_at(x)));
            }
            let stiffness = elastic[space.pattern.diagonal(point.unknown as usize)];
            Coordinate {
                dof: point.unknown,
                sign: point.sign,
                weight: point.weight,
                gap: f64::INFINITY,
                floor: f64::NEG_INFINITY,
                law: potentials.len() as u32 - 1,
                shift: (boundary.shift)(x),
                // γ α_ν = α_ν w/K_ii is of order h α_ν/m_𝒜: below one wherever (2.9) holds.
                gamma: point.weight / stiffness,
                span: 1,
            }
        })
        .collect();
    BoundaryGraph { coordinates, potentials }
}
