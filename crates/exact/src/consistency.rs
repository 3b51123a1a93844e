//! Weak-form loads for functions of V^h that jump.
//!
//! By parts on each cell, f0·v + ∫_{Γ2} f2·v is ∫ σ:ε(v) less ∫ σν·v over the boundaries of all cells: these cancel for
//! continuous functions, and otherwise are the consistency error, which belongs to the load. Across a facet both cells
//! share the mean of v, its value at the barycentre; on the boundary of the body the load acts on that mean only, and on
//! Γ1 it is zero. So v minus its mean remains on every facet.

use super::constitutive::{Tensor, stress};
use super::nodal_force::inward;
use super::parts::Parts;
use super::sampled::Sampled;
use super::shapes::Shapes;
use fem::contact::LoadError;
use fem::space::quadrature::Rule;

/// The points of a rule for facets on all facets of a cell, in the order of the opposite corners.
pub(super) fn around(facet: &Rule) -> Rule {
    let d = facet.points[0].len();
    let mut around = Rule { points: Vec::new(), weights: Vec::new() };
    for opposite in 0..=d {
        for (along, weight) in facet.points.iter().zip(&facet.weights) {
            let mut b = vec![0.0; d + 1];
            for (a, along) in along.iter().enumerate() {
                b[(opposite + 1 + a) % (d + 1)] = *along;
            }
            around.points.push(b);
            around.weights.push(*weight);
        }
    }
    around
}

impl Parts<'_> {
    /// Subtracts ∫ σν·(v - v̄) over the boundaries of all cells, for each part; v̄ is the value of v at the
    /// barycentre of a facet, and `points` are those of a rule [`around`] cells.
    pub(super) fn subtract_consistency<const D: usize>(
        &self,
        points: &Sampled,
        forces: &mut [Vec<f64>],
    ) -> Result<(), LoadError> {
        let (space, rule, mut memory) = (self.space, &points.rule, Vec::new());
        let (on_facet, share) = (rule.points.len() / (D + 1), 1.0 / D as f64);
        let functions = Shapes::of_cell(space.element, D);
        let beyond_mean = |(q, b): (usize, &Vec<f64>)| -> Vec<f64> {
            let middle: Vec<f64> =
                (0..=D).map(|corner| if corner == q / on_facet { 0.0 } else { share }).collect();
            let mean = functions.at(&middle);
            functions.at(b).iter().zip(mean).map(|(v, mean)| v - mean).collect()
        };
        let beyond: Vec<Vec<f64>> = rule.points.iter().enumerate().map(beyond_mean).collect();
        let (program, names) = self.inside();
        let at = (self.t, 0.0);
        points.each_block(&space.mesh, program, at, self.again, &names, |cells, values| {
            for (local, c) in cells.clone().enumerate() {
                let material = self.exact.material_in(self.regions[c]);
                let corners = space.mesh.cell(c);
                for (q, (beyond, weight)) in beyond.iter().zip(&rule.weights).enumerate() {
                    let p = cells.len() * q + local;
                    // The measure of the facet times the inward normal is D times that.
                    let normal: [f64; D] = inward(&space.mesh, corners, q / on_facet);
                    for (force, part) in forces.iter_mut().zip(values.chunks(self.fields())) {
                        let strain = self.exact.tensors(|k| part[k][p], &mut memory);
                        let sigma: Tensor<D> = stress(material, &strain, &memory, self.kappa);
                        let along = |row: [f64; D]| -> f64 {
                            row.iter().zip(&normal).map(|(s, n)| D as f64 * weight * s * n).sum()
                        };
                        let traction = sigma.map(along);
                        for (&node, beyond) in space.cell_nodes(c).iter().zip(beyond) {
                            let at_node = force[D * node as usize..][..D].iter_mut();
                            at_node.zip(traction).for_each(|(at_node, t)| *at_node += beyond * t);
                        }
                    }
                }
            }
        })
    }
}
