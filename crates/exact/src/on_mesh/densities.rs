//! The loads of an exact solution as functions: f0 in the cells, σν and the contact pressure on the facets.

use fem::contact::LoadError;
use fem::space::quadrature::Rule;

use super::ExactOnMesh;
use crate::constitutive::{Tensor, full};
use crate::densities::Densities;
use crate::sampled::vector_names;

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
