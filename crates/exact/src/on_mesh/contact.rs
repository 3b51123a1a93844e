//! Γ3 of an exact solution on a mesh: the pressure as a load, moments of u_ν and of the pressure, the locked set.

use super::ExactOnMesh;
use crate::nodal_force::facet_measure;
use crate::onto::Projector;
use crate::shapes::Shapes;
use fem::contact::LoadError;
use fem::norms::{Moments, facet_samples, is_locked};

impl ExactOnMesh {
    /// Adds ∫_{Γ3} c v_ν + s v_τ to a vector over all nodes.
    pub(super) fn add_contact_pressure(&self, t: f64, force: &mut [f64]) -> Result<(), LoadError> {
        let (d, trace) = (self.space.mesh.dimension, &self.space.trace);
        let first = |point: u32| d * trace.points[point as usize].node as usize;
        for group in &self.contact {
            let values = group.contact_values(&self.space.mesh, &group.points, t)?;
            let friction = group.friction(&self.space.mesh, t)?;
            let rule = &group.points.rule;
            let functions = Shapes::of_facet(self.space.element, d);
            let shape: Vec<_> = rule.points.iter().map(|b| functions.at(b)).collect();
            for (index, (&f, &facet)) in group.facets.iter().zip(&group.mesh_facets).enumerate() {
                let measure = facet_measure(&self.space.mesh, facet);
                for (q, weight) in rule.weights.iter().enumerate() {
                    let at = rule.weights.len() * index + q;
                    let pressure = weight * measure * values[1][at];
                    for (&point, shape) in trace.facet(f).iter().zip(&shape[q]) {
                        for i in 0..d {
                            force[first(point) + i] += pressure * group.normal[i] * shape;
                        }
                    }
                    for (tangent, s) in &friction {
                        let sliding = weight * measure * s[at];
                        for (&point, shape) in trace.facet(f).iter().zip(&shape[q]) {
                            for (i, along) in tangent[..d].iter().enumerate() {
                                force[first(point) + i] += sliding * along * shape;
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds u_ν and ξ + λ on the facets of Γ3, and where u_ν = g.
    pub(super) fn add_contact<const D: usize>(
        &self,
        t: f64,
        Moments { normal, pressure, locked, .. }: &mut Moments,
    ) -> Result<(), LoadError> {
        let facets = self.space.trace.measure.len();
        let nodes = self.space.trace.stride;
        normal.node.resize(nodes * facets, 0.0);
        pressure.node.resize(nodes * facets, 0.0);
        locked.resize(facets * facet_samples(D).len(), false);
        for group in &self.contact {
            let values = group.contact_values(&self.space.mesh, &group.points, t)?;
            let samples = group.contact_values(&self.space.mesh, &group.samples, t)?;
            let (rule, sampled) = (&group.points.rule, group.samples.rule.points.len());
            let count = rule.weights.len();
            let functions = Shapes::of_facet(self.space.element, D);
            let (onto, mut of_nodes) = (Projector::new(rule, functions), Vec::new());
            for (index, &f) in group.facets.iter().enumerate() {
                let measure = self.space.trace.measure[f];
                for (field, target) in [(0, &mut *normal), (1, &mut *pressure)] {
                    let of_facet = &values[field][count * index..count * (index + 1)];
                    of_nodes.clear();
                    target.rest += onto.split(&[(of_facet, 1.0)], &[measure], &mut of_nodes);
                    target.node[nodes * f..nodes * (f + 1)].copy_from_slice(&of_nodes);
                }
                for s in 0..sampled {
                    let p = sampled * index + s;
                    locked[sampled * f + s] = is_locked(samples[0][p], samples[2][p]);
                }
            }
        }
        Ok(())
    }
}
