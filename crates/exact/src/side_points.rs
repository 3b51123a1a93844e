//! The points of the trace by side, with the formulas of the contact state bound to them.

use std::collections::HashMap;

use super::exact::Exact;
use super::friction::{Sliding, Tangents};
use super::nodal_force::facet_measure;
use super::shapes::Shapes;
use super::shared_program::SharedProgram;
use fem::contact::Discretization;
use fem::mesh::PlanePart;

/// [u_ν, ξ + λ, g, …] at points of the trace with one normal.
pub(super) struct SidePoints {
    /// ν, padded with zeros.
    pub(super) normal: [f64; 3],
    /// The side they are on.
    pub(super) side: u32,
    pub(super) members: Vec<usize>,
    pub(super) facets: Vec<usize>,
    /// ∫ φ over the side, of each member.
    pub(super) weights: Vec<f64>,
    bound: SharedProgram,
    friction: Option<(Tangents, SharedProgram)>,
}

impl SidePoints {
    /// The values of all five at t.
    pub(super) fn evaluate(&self, t: f64) -> Vec<Vec<f64>> {
        self.bound.values_at(t)
    }

    /// The friction at t in dimension d; None without friction.
    pub(super) fn friction(&self, t: f64, d: usize) -> Option<Vec<Sliding>> {
        let (tangents, bound) = self.friction.as_ref()?;
        let out = bound.values_at(t);
        let state = |p: usize| Sliding::new(*tangents, d, |i| out[i][p]);
        Some((0..self.members.len()).map(state).collect())
    }
}

pub(super) fn side_points(exact: &Exact, space: &Discretization) -> Vec<SidePoints> {
    let (mesh, trace, d) = (&space.mesh, &space.trace, space.mesh.dimension);
    let of_part = |part: PlanePart| {
        let facets = part.members;
        let mut members: Vec<usize> =
            facets.iter().flat_map(|&f| trace.facet(f)).map(|&i| i as usize).collect();
        members.sort_unstable();
        members.dedup();
        let points: Vec<[f64; 3]> =
            members.iter().map(|&i| mesh.point(&[trace.points[i].vertex], &[1.0])).collect();
        let normal = part.normal;
        let formulas = exact.boundary(part.side, &normal[..d]);
        let mut of_vertex = HashMap::new();
        let means = Shapes::of_facet(space.element, d).means();
        for &f in &facets {
            let facet = trace.mesh_facet[f] as usize;
            for (&vertex, mean) in space.nodes.on_facet(facet).iter().zip(&means) {
                let share = mean * facet_measure(mesh, facet);
                *of_vertex.entry(vertex).or_insert(0.0) += share;
            }
        }
        let weights = members.iter().map(|&i| of_vertex[&trace.points[i].vertex]).collect();
        let bound = formulas.program.bind(&points).into();
        let friction = exact.friction(part.side, &normal[..d]);
        let friction =
            friction.map(|on_side| (on_side.tangents, on_side.program.bind(&points).into()));
        SidePoints { normal, side: part.side, facets, weights, bound, members, friction }
    };
    mesh.plane_parts(&trace.mesh_facet).into_iter().map(of_part).collect()
}
