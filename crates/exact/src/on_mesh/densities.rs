//! Loads as functions: f0 in the cells, σν and the contact pressure on the facets, at the points of their rules.

use fem::contact::{Discretization, LoadError};
use fem::space::quadrature::Rule;

use super::ExactOnMesh;
use crate::constitutive::{Tensor, full};
use crate::nodal_force::facet_measure;
use crate::sampled::vector_names;
use crate::shapes::Shapes;

/// f0 and the tractions at the points of two rules, on all cells and boundary facets of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Densities {
    /// Of the cells, of the facets.
    pub rules: [Rule; 2],
    /// Cell by cell, in it point by point, in it component by component.
    pub body: Vec<f64>,
    /// Likewise by the facets of the boundary: f2 on Γ2, h3 on Γ3, zero on Γ1.
    pub traction: Vec<f64>,
}

impl ExactOnMesh {
    /// The densities at t.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    pub(super) fn densities_at<const D: usize>(&self, t: f64) -> Result<Densities, LoadError> {
        let (space, fields) = (&*self.space, self.at(t));
        let mesh = &space.mesh;
        let points = &self.force_points;
        let count = points.rule.weights.len();
        let mut body = vec![0.0; D * count * mesh.cell_count()];
        let (names, at) = (vector_names("f0", D), (t, fields.zeta));
        points.each_block(mesh, &self.exact.forces, at, &names, |cells, values| {
            for (index, c) in cells.clone().enumerate() {
                for (q, target) in body[D * count * c..][..D * count].chunks_mut(D).enumerate() {
                    let of = |i: usize| values[i][cells.len() * q + index];
                    target.iter_mut().enumerate().for_each(|(i, f)| *f = of(i));
                }
            }
        })?;
        let side = self.traction.iter().chain(&self.contact).next();
        let side = side.map_or_else(|| Rule::barycentre(D - 1), |group| group.points.rule.clone());
        let count = side.weights.len();
        let mut traction = vec![0.0; D * count * mesh.facet_side.len()];
        let first_stress = D + self.exact.strain.len();
        for group in self.traction.iter().chain(&self.contact) {
            fields.each_block(&group.strains, |facets, values| {
                for (local, index) in facets.clone().enumerate() {
                    let first = D * count * group.mesh_facets[index];
                    for (q, target) in traction[first..][..D * count].chunks_mut(D).enumerate() {
                        let p = facets.len() * q + local;
                        let sigma: Tensor<D> = full(|k| values[first_stress + k][p]);
                        for (f, row) in target.iter_mut().zip(&sigma) {
                            *f += row.iter().zip(&group.normal).map(|(s, n)| s * n).sum::<f64>();
                        }
                    }
                }
            })?;
        }
        for group in &self.contact {
            let values = group.contact_values(mesh, &group.points, t)?;
            let along_normal = [(group.normal, values[1].clone())];
            for (direction, sizes) in along_normal.into_iter().chain(group.friction(mesh, t)?) {
                for (sizes, &facet) in sizes.chunks(count).zip(&group.mesh_facets) {
                    let target = traction[D * count * facet..][..D * count].chunks_mut(D);
                    for (target, size) in target.zip(sizes) {
                        target.iter_mut().zip(direction).for_each(|(f, e)| *f += size * e);
                    }
                }
            }
        }
        Ok(Densities { rules: [points.rule.clone(), side], body, traction })
    }
}

impl Densities {
    /// ∫ f0·v + ∫ f2·v over the unknowns. With `flat` shape functions stand at their values in the barycentre: each cell and
    /// facet then gives all its nodes the same share, as lumping does.
    pub fn assembled(&self, space: &Discretization, flat: bool) -> Vec<f64> {
        let (mesh, d) = (&space.mesh, space.mesh.dimension);
        let mut force = vec![0.0; space.nodes.len()];
        let shapes = |functions: Shapes, rule: &Rule| -> Vec<Vec<f64>> {
            let corners = rule.points[0].len();
            let middle = vec![1.0 / corners as f64; corners];
            rule.points.iter().map(|b| functions.at(if flat { &middle } else { b })).collect()
        };
        let mut add = |values: &[f64], weights: &[f64], shapes: &[Vec<f64>], nodes: &[u32]| {
            for ((value, weight), shape) in values.chunks(d).zip(weights).zip(shapes) {
                for (&node, shape) in nodes.iter().zip(shape) {
                    let force = force[d * node as usize..][..d].iter_mut();
                    force.zip(value).for_each(|(force, f)| *force += weight * shape * f);
                }
            }
        };
        let scaled = |rule: &Rule, measure: f64| -> Vec<f64> {
            rule.weights.iter().map(|w| measure * w).collect()
        };
        let [in_cell, on_facet] = &self.rules;
        let of_cell = shapes(Shapes::of_cell(space.element, d), in_cell);
        for (c, values) in self.body.chunks(d * in_cell.weights.len()).enumerate() {
            let weights = scaled(in_cell, space.geometry.measure[c]);
            add(values, &weights, &of_cell, space.cell_nodes(c));
        }
        let of_facet = shapes(Shapes::of_facet(space.element, d), on_facet);
        for (f, values) in self.traction.chunks(d * on_facet.weights.len()).enumerate() {
            let vertices = space.nodes.on_facet(f).iter();
            let nodes: Vec<u32> = vertices.map(|&v| space.nodes.of_vertex[v as usize]).collect();
            add(values, &scaled(on_facet, facet_measure(mesh, f)), &of_facet, &nodes);
        }
        force.truncate(space.dofs());
        force
    }
}
