//! The loads of an exact solution as functions: f0 in the cells, σν and the contact pressure on the facets.

use fem::contact::LoadError;
use fem::space::quadrature::Rule;

use super::ExactOnMesh;
use crate::constitutive::{Tensor, full};
use crate::cuts::Cut;
use crate::densities::Densities;
use crate::onto::Projector;
use crate::sampled::vector_names;
use crate::shapes::Shapes;

impl ExactOnMesh {
    /// Replaces f0 in cells across which it jumps, or has a kink, by its nearest function of the element in L², by a rule on the
    /// pieces: the rule of the cells gives the integrals of the element's functions with that one, but would miss a share of
    /// those with f0 that depends on how a line lies in its cells, so that no order is seen. A cell with a value that is not
    /// finite is left as it is.
    fn put_nearest<const D: usize>(&self, t: f64, zeta: f64, body: &mut [f64]) {
        let Some(cuts) = &self.force_cuts else { return };
        let (mesh, rule) = (&self.space.mesh, &self.force_points.rule);
        let cut = cuts.rules(mesh, rule, t);
        let points = cuts.points(mesh, cut.iter().map(|cut| (cut.simplex, &cut.rule)));
        let values = self.exact.forces.values(&points, t, zeta);
        let onto = Projector::new(rule, Shapes::of_cell(self.space.element, D));
        let functions = Shapes::of_cell(self.space.element, D);
        let shapes: Vec<Vec<f64>> = rule.points.iter().map(|b| functions.at(b)).collect();
        let mut first = 0;
        for Cut { simplex, rule: pieces } in &cut {
            let places = first..first + pieces.weights.len();
            first = places.end;
            let fields: Vec<_> =
                values[..D].iter().map(|of_all| (&of_all[places.clone()], 1.0)).collect();
            if fields.iter().any(|(field, _)| field.iter().any(|f| !f.is_finite())) {
                continue;
            }
            let mut at_nodes = Vec::new();
            onto.by(pieces).split(&fields, &[1.0], &mut at_nodes);
            let count = rule.weights.len();
            let of_cell = &mut body[D * count * simplex..][..D * count];
            for (target, shapes) in of_cell.chunks_mut(D).zip(&shapes) {
                for (i, f) in target.iter_mut().enumerate() {
                    *f = shapes.iter().zip(at_nodes.chunks(D)).map(|(s, node)| s * node[i]).sum();
                }
            }
        }
    }

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
        self.put_nearest::<D>(t, fields.zeta, &mut body);
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
