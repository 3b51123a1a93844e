//! An exact solution on a mesh: load vectors and moments, each computed once a time and shared by
//! all cases on the mesh.

use std::sync::{Arc, OnceLock};

use super::constitutive::{Tensor, mandel, stress};
use super::contact_samples::StatePoints;
use super::exact::{Exact, LoadForm};
use super::facet_group::{FacetGroup, facet_groups};
use super::nodal_force::{add_stress, facet_measure};
use super::reduction::{add_cell, project};
use super::sampled::{Sampled, tensor_names, vector_names};
use super::truth::{ByTime, Truth};
use crate::contact::{Discretization, LoadError};
use crate::formula::Program;
use crate::norms::{ContactSamples, Moments, Piecewise, facet_samples, is_locked};
use crate::space::quadrature::{Rule, TruthRules};

/// An exact solution on one mesh of its dimension.
pub struct ExactOnMesh {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    form: LoadForm,
    /// Points of the load rule and of the (stronger) error rule in the cells.
    load_points: Sampled,
    error_points: Sampled,
    /// Points of the strong form in the cells.
    force_points: Sampled,
    /// Facets of Γ3 in groups of one normal: error points, then samples for the locked set.
    contact: Vec<FacetGroup>,
    /// Facets of Γ2.
    traction: Vec<FacetGroup>,
    /// Of each cell.
    regions: Vec<usize>,
    loads: ByTime<Vec<f64>>,
    moments: ByTime<Moments>,
    state_points: OnceLock<StatePoints>,
}

impl ExactOnMesh {
    /// Binds the formulas of `exact` to the points of `rules` on `space`; `traction` are the sides
    /// of Γ2.
    pub fn new(
        exact: Arc<Exact>,
        space: Arc<Discretization>,
        form: LoadForm,
        traction: &[u32],
        rules: &TruthRules,
    ) -> Self {
        let cell_points = |rule: &Rule| {
            let cells = (0..space.mesh.cell_count()).map(|c| space.mesh.cell(c));
            Sampled::new(cells, rule)
        };
        let contact = facet_groups(&exact, &space, &space.trace.mesh_facet, &rules.side);
        let free: Vec<u32> = space.mesh.facets_on(traction).map(|f| f as u32).collect();
        Self {
            load_points: cell_points(&rules.load),
            force_points: cell_points(&rules.load),
            error_points: cell_points(&rules.error),
            regions: exact.cell_regions(&space.mesh),
            contact,
            traction: facet_groups(&exact, &space, &free, &rules.side),
            exact,
            space,
            form,
            loads: ByTime::default(),
            moments: ByTime::default(),
            state_points: OnceLock::new(),
        }
    }

    /// The formulas of [u, ε, H], how many they are, and the names of those that must be finite.
    fn interior(&self) -> ((&Program, usize), Vec<String>) {
        let d = self.exact.dimension();
        let outputs = d + self.exact.strain.len() + self.exact.memory.len();
        let names = [vector_names("u", d), tensor_names("ε", d)].concat();
        ((&self.exact.interior, outputs), names)
    }

    fn weak_load<const D: usize>(&self, t: f64) -> Result<Vec<f64>, LoadError> {
        let space = &self.space;
        let kappa = self.exact.kappa(t);
        let mut force = vec![0.0; space.nodes.len()];
        let (rule, mut memory) = (&self.load_points.rule, Vec::new());
        let (program, names) = self.interior();
        self.load_points.each_block(&space.mesh, program, (t, 0.0), &names, |cells, values| {
            for (index, c) in cells.enumerate() {
                let (mut mean, material) = ([[0.0; D]; D], self.exact.material_in(self.regions[c]));
                for (q, weight) in rule.weights.iter().enumerate() {
                    let p = rule.weights.len() * index + q;
                    let strain: Tensor<D> = self.exact.tensors(values, p, &mut memory);
                    let sigma = stress(material, &strain, &memory, kappa);
                    let pairs = mean.as_flattened_mut().iter_mut().zip(sigma.as_flattened());
                    pairs.for_each(|(target, value)| *target += weight * value);
                }
                add_stress(&space.mesh, c, space.cell_nodes(c), &mean, &mut force);
            }
        })?;
        self.add_contact_pressure(t, &mut force)?;
        force.truncate(space.dofs());
        Ok(force)
    }

    /// Adds ∫_{Γ3} c v_ν by the error rule of the facets.
    fn add_contact_pressure(&self, t: f64, force: &mut [f64]) -> Result<(), LoadError> {
        let d = self.space.mesh.dimension;
        for group in &self.contact {
            let values = group.contact_values(&self.space.mesh, &group.points, t)?;
            let count = group.points.rule.weights.len();
            for (index, &facet) in group.mesh_facets.iter().enumerate() {
                let measure = facet_measure(&self.space.mesh, facet);
                for (q, weight) in group.points.rule.weights.iter().enumerate() {
                    let pressure = weight * measure * values[1][count * index + q];
                    for (&vertex, shape) in
                        self.space.mesh.facet(facet).iter().zip(&group.points.rule.points[q])
                    {
                        let node = self.space.nodes.of_vertex[vertex as usize] as usize;
                        for i in 0..d {
                            force[d * node + i] += pressure * group.normal[i] * shape;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    fn strong_load<const D: usize>(&self, t: f64) -> Result<Vec<f64>, LoadError> {
        let space = &self.space;
        let zeta = self.exact.zeta.at(t);
        let mut force = vec![0.0; space.nodes.len()];
        let rule = &self.load_points.rule;
        let (program, names) = ((&self.exact.forces, D), vector_names("f0", D));
        self.force_points.each_block(
            &space.mesh,
            program,
            (t, zeta),
            &names,
            |cells, values| {
                for (index, c) in cells.enumerate() {
                    let measure = space.geometry.measure[c];
                    for (q, weight) in rule.weights.iter().enumerate() {
                        let p = rule.weights.len() * index + q;
                        for (&node, shape) in space.cell_nodes(c).iter().zip(&rule.points[q]) {
                            for i in 0..D {
                                force[D * node as usize + i] +=
                                    weight * measure * shape * values[i][p];
                            }
                        }
                    }
                }
            },
        )?;
        for group in self.traction.iter().chain(&self.contact) {
            self.add_boundary_stress::<D>(group, t, &mut force)?;
        }
        self.add_contact_pressure(t, &mut force)?;
        force.truncate(space.dofs());
        Ok(force)
    }

    /// Adds ∫ (σν)·v over a group of facets.
    fn add_boundary_stress<const D: usize>(
        &self,
        group: &FacetGroup,
        t: f64,
        force: &mut [f64],
    ) -> Result<(), LoadError> {
        let (program, names) = self.interior();
        let values = group.strains.evaluate(&self.space.mesh, program, t, &names)?;
        let kappa = self.exact.kappa(t);
        let (rule, mut memory) = (&group.strains.rule, Vec::new());
        for (index, &facet) in group.mesh_facets.iter().enumerate() {
            let measure = facet_measure(&self.space.mesh, facet);
            let material = self.exact.material_in(group.regions[index]);
            for (q, weight) in rule.weights.iter().enumerate() {
                let p = rule.weights.len() * index + q;
                let strain: Tensor<D> = self.exact.tensors(&values, p, &mut memory);
                let sigma = stress(material, &strain, &memory, kappa);
                for (&vertex, shape) in self.space.mesh.facet(facet).iter().zip(&rule.points[q]) {
                    let node = self.space.nodes.of_vertex[vertex as usize] as usize;
                    for (i, row) in sigma.iter().enumerate() {
                        let traction: f64 = row.iter().zip(&group.normal).map(|(s, n)| s * n).sum();
                        force[D * node + i] += weight * measure * shape * traction;
                    }
                }
            }
        }
        Ok(())
    }

    fn compute_moments<const D: usize>(&self, t: f64) -> Result<Moments, LoadError> {
        let mut moments = self.cell_moments::<D>(t)?;
        let facets = self.space.trace.measure.len();
        moments.normal.corner = vec![0.0; D * facets];
        moments.pressure.corner = vec![0.0; D * facets];
        moments.locked = vec![false; facets * facet_samples(D).len()];
        for group in &self.contact {
            self.facet_moments(group, t, &mut moments)?;
        }
        Ok(moments)
    }

    fn cell_moments<const D: usize>(&self, t: f64) -> Result<Moments, LoadError> {
        let (space, kappa) = (&self.space, self.exact.kappa(t));
        let rule = &self.error_points.rule;
        let (count, cells) = (rule.weights.len(), space.mesh.cell_count());
        let numbers = self.exact.strain.len();
        let mut moments = Moments::default();
        moments.strain.mean = Vec::with_capacity(numbers * cells);
        moments.stress.mean = Vec::with_capacity(numbers * cells);
        let corners = D * (D + 1);
        moments.displacement.corner = vec![0.0; corners * cells];
        let (mut strains, mut stresses, mut memory) = (Vec::new(), Vec::new(), Vec::new());
        let (program, names) = self.interior();
        self.error_points.each_block(&space.mesh, program, (t, 0.0), &names, |cells, values| {
            for (index, c) in cells.enumerate() {
                strains.clear();
                stresses.clear();
                let material = self.exact.material_in(self.regions[c]);
                for p in count * index..count * (index + 1) {
                    let strain: Tensor<D> = self.exact.tensors(values, p, &mut memory);
                    mandel(&strain, &mut strains);
                    mandel(&stress(material, &strain, &memory, kappa), &mut stresses);
                }
                let measure = space.geometry.measure[c];
                add_cell(&strains, &rule.weights, measure, &mut moments.strain);
                add_cell(&stresses, &rule.weights, measure, &mut moments.stress);
                for (i, field) in values[..D].iter().enumerate() {
                    let at = &field[count * index..count * (index + 1)];
                    let corner = &mut moments.displacement.corner[corners * c..corners * (c + 1)];
                    moments.displacement.rest +=
                        measure * project(at, rule, |a, v| corner[D * a + i] = v);
                }
            }
        })?;
        Ok(moments)
    }

    fn facet_moments(
        &self,
        group: &FacetGroup,
        t: f64,
        moments: &mut Moments,
    ) -> Result<(), LoadError> {
        let values = group.contact_values(&self.space.mesh, &group.points, t)?;
        let samples = group.contact_values(&self.space.mesh, &group.samples, t)?;
        let (rule, corners) = (&group.points.rule, self.space.mesh.dimension);
        let (count, sampled) = (rule.weights.len(), group.samples.rule.points.len());
        for (index, &f) in group.facets.iter().enumerate() {
            let measure = self.space.trace.measure[f];
            for (field, target) in [(0, &mut moments.normal), (1, &mut moments.pressure)] {
                let at = &values[field][count * index..count * (index + 1)];
                let Piecewise { corner, rest } = target;
                *rest += measure * project(at, rule, |a, v| corner[corners * f + a] = v);
            }
            for s in 0..sampled {
                let p = sampled * index + s;
                moments.locked[sampled * f + s] = is_locked(samples[0][p], samples[2][p]);
            }
        }
        Ok(())
    }
}

impl Truth for ExactOnMesh {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        let load = match (self.form, self.space.mesh.dimension) {
            (LoadForm::Weak, 2) => Self::weak_load::<2>,
            (LoadForm::Weak, _) => Self::weak_load::<3>,
            (LoadForm::Strong, 2) => Self::strong_load::<2>,
            (LoadForm::Strong, _) => Self::strong_load::<3>,
        };
        self.loads.get_or(t, || load(self, t))
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        let moments = match self.space.mesh.dimension {
            2 => Self::compute_moments::<2>,
            _ => Self::compute_moments::<3>,
        };
        self.moments.get_or(t, || moments(self, t))
    }
    fn contact_samples(&self, t: f64) -> Result<Option<ContactSamples>, LoadError> {
        if self.space.mesh.dimension != 2 {
            return Ok(None);
        }
        let points = || StatePoints::new(&self.exact, &self.space, false);
        Ok(Some(self.state_points.get_or_init(points).at(t)))
    }
}
