//! The facets of Γ2 and Γ3 of an exact solution, in groups of one outward normal.

use super::exact::{BoundaryFormulas, Exact};
use super::friction::{FrictionOnSide, Sliding};
use super::sampled::Sampled;
use fem::contact::{Discretization, LoadError};
use fem::mesh::Mesh;
use fem::norms::facet_samples;
use fem::space::quadrature::Rule;
use formula::Variable;

pub(super) struct FacetGroup {
    /// ν, padded with zeros.
    pub(super) normal: [f64; 3],
    /// Positions in the grouped list: for Γ3 those of the trace.
    pub(super) facets: Vec<usize>,
    /// The facets by their numbers in the mesh.
    pub(super) mesh_facets: Vec<usize>,
    formulas: BoundaryFormulas,
    /// For [u_ν, c, …], for the locked set, and for ε.
    pub(super) points: Sampled,
    pub(super) samples: Sampled,
    pub(super) strains: Sampled,
    /// Friction, with separate points.
    friction: Option<(FrictionOnSide, Sampled)>,
}

/// A tangent, and s along it at some points.
pub(super) type AlongTangent = ([f64; 3], Vec<f64>);

impl FacetGroup {
    /// [u_ν, c, g, ξ, λ] at the points.
    pub(super) fn contact_values(
        &self,
        mesh: &Mesh,
        points: &Sampled,
        t: f64,
    ) -> Result<Vec<Vec<f64>>, LoadError> {
        let names = ["u_ν", "ξ + λ"].map(String::from);
        points.evaluate(mesh, (&self.formulas.program, 5), t, &names)
    }

    /// The friction stress at the points of the error rule: each tangent, and s along it.
    pub(super) fn friction(&self, mesh: &Mesh, t: f64) -> Result<Vec<AlongTangent>, LoadError> {
        let Some((friction, points)) = &self.friction else { return Ok(Vec::new()) };
        let d = mesh.dimension;
        let names = vec![String::from("s"); d - 1];
        let outputs = Sliding::numbers(d);
        let values = points.evaluate(mesh, (&friction.program, outputs), t, &names)?;
        Ok(friction.tangents.into_iter().zip(values).take(d - 1).collect())
    }
}

/// The coordinate that all vertices of some facets share, if their normal is along an axis.
fn plane(mesh: &Mesh, facets: &[usize], normal: &[f64; 3]) -> Option<(Variable, f64)> {
    let axis = normal.iter().position(|component| component.abs() == 1.0)?;
    let vertices = facets.iter().flat_map(|&facet| mesh.facet(facet));
    let mut places = vertices.map(|&vertex| mesh.vertex(vertex)[axis]);
    let first = places.next()?;
    let variable = [Variable::X, Variable::Y, Variable::Z][axis];
    places.all(|place| place == first).then_some((variable, first))
}

pub(super) fn facet_groups(
    exact: &Exact,
    space: &Discretization,
    mesh_facets: &[u32],
    rule: &Rule,
) -> Vec<FacetGroup> {
    let (mesh, d) = (&space.mesh, space.mesh.dimension);
    let samples = facet_samples(d);
    let samples = Rule { weights: vec![0.0; samples.len()], points: samples };
    let mut groups = Vec::new();
    for part in mesh.plane_parts(mesh_facets) {
        let members: Vec<(usize, usize)> = part
            .members
            .into_iter()
            .map(|position| (position, mesh_facets[position] as usize))
            .collect();
        let normal = part.normal;
        let sampled = |rule: &Rule| Sampled::new(members.iter().map(|(_, f)| mesh.facet(*f)), rule);
        let facets: Vec<usize> = members.iter().map(|(_, f)| *f).collect();
        let plane = plane(mesh, &facets, &normal);
        let friction = exact.friction_at(part.side, &normal[..d], plane);
        groups.push(FacetGroup {
            normal,
            formulas: exact.boundary_at(part.side, &normal[..d], plane),
            friction: friction.map(|friction| (friction, sampled(rule))),
            points: sampled(rule),
            samples: sampled(&samples),
            strains: sampled(rule),
            facets: members.iter().map(|(position, _)| *position).collect(),
            mesh_facets: facets,
        });
    }
    groups
}
