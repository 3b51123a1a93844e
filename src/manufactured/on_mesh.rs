//! An exact solution on a mesh: load vectors and moments, each computed once a time and shared by
//! all cases on the mesh.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::constitutive::{self, Tensor};
use super::contact_samples::StatePoints;
use super::exact::{Exact, LoadForm};
use super::nodal_force::{add_stress, length};
use super::reduction::{add_cell, project};
use super::symbolic::components;
use super::truth::{ByTime, Truth};
use crate::contact::{Discretization, LoadError};
use crate::formula::{Bound, Program};
use crate::norms::{ContactSamples, FACET_SAMPLES, Moments, Piecewise, facet_sample, is_locked};
use crate::space::quadrature::{Rule, TruthRules};

/// Points with their formulas bound to them.
struct Sampled {
    rule: Rule,
    points: Vec<[f64; 3]>,
    bound: Mutex<Option<Bound>>,
}

impl Sampled {
    /// Values of all outputs at all points at time t.
    fn evaluate(&self, program: &Program, outputs: usize, t: f64, zeta: f64) -> Vec<Vec<f64>> {
        let mut out = vec![Vec::new(); outputs];
        let mut bound = self.bound.lock().unwrap_or_else(PoisonError::into_inner);
        bound.get_or_insert_with(|| program.bind(&self.points)).evaluate(t, zeta, &mut out);
        out
    }
}

/// A plane exact solution on one mesh.
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

/// Facets with one normal.
struct FacetGroup {
    normal: [f64; 2],
    /// Positions in the list that was grouped: for Γ3 those of the trace.
    facets: Vec<usize>,
    /// The same facets by their numbers in the mesh.
    mesh_facets: Vec<usize>,
    /// The regions of their midpoints.
    regions: Vec<usize>,
    formulas: super::exact::BoundaryFormulas,
    points: Sampled,
    samples: Sampled,
    strains: Sampled,
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
            let points = (0..space.mesh.cell_count())
                .flat_map(|c| {
                    let cell = space.mesh.cell(c);
                    rule.points.iter().map(|b| space.mesh.point(cell, b)).collect::<Vec<_>>()
                })
                .collect();
            Sampled { rule: rule.clone(), points, bound: Mutex::new(None) }
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

    /// Full ε at point p of interior outputs [u, ε, H_1, …], the H_i to `memory`.
    fn tensors(&self, values: &[Vec<f64>], p: usize, memory: &mut Vec<Tensor<2>>) -> Tensor<2> {
        let list = components(2);
        let tensor = |fields: &[Vec<f64>]| {
            let mut tensor = [[0.0; 2]; 2];
            for (field, &(i, j)) in fields.iter().zip(&list) {
                (tensor[i][j], tensor[j][i]) = (field[p], field[p]);
            }
            tensor
        };
        memory.clear();
        memory.extend(values[2 + list.len()..].chunks(list.len()).map(tensor));
        tensor(&values[2..])
    }

    fn interior(&self, points: &Sampled, t: f64) -> Result<Vec<Vec<f64>>, LoadError> {
        let outputs = 5 + self.exact.memory.len();
        let values = points.evaluate(&self.exact.interior, outputs, t, 0.0);
        finite(&values, &points.points, t, &["u_x", "u_y", "ε_xx", "ε_xy", "ε_yy"])?;
        Ok(values)
    }

    fn weak_load(&self, t: f64) -> Result<Vec<f64>, LoadError> {
        let space = &self.space;
        let values = self.interior(&self.load_points, t)?;
        let kappa = self.exact.kappa(t);
        let mut force = vec![0.0; space.nodes.len()];
        let mut memory = Vec::new();
        let count = self.load_points.rule.weights.len();
        for c in 0..space.mesh.cell_count() {
            let (mut mean, material) = ([[0.0; 2]; 2], self.exact.material_in(self.regions[c]));
            for (q, weight) in self.load_points.rule.weights.iter().enumerate() {
                let strain = self.tensors(&values, count * c + q, &mut memory);
                let stress = constitutive::stress(material, &strain, &memory, kappa);
                for (target, row) in mean.iter_mut().zip(&stress) {
                    target[0] += weight * row[0];
                    target[1] += weight * row[1];
                }
            }
            add_stress(&space.mesh, c, space.cell_nodes(c), &mean, &mut force);
        }
        self.add_contact_pressure(t, &mut force)?;
        force.truncate(space.dofs());
        Ok(force)
    }

    /// Adds ∫_{Γ3} c v_ν by the error rule of the facets.
    fn add_contact_pressure(&self, t: f64, force: &mut [f64]) -> Result<(), LoadError> {
        for group in &self.contact {
            let values = group.contact_values(&group.points, t)?;
            let count = group.points.rule.weights.len();
            for (index, &facet) in group.mesh_facets.iter().enumerate() {
                let measure = length(&self.space.mesh, facet);
                for (q, weight) in group.points.rule.weights.iter().enumerate() {
                    let pressure = weight * measure * values[1][count * index + q];
                    for (&vertex, shape) in
                        self.space.mesh.facet(facet).iter().zip(&group.points.rule.points[q])
                    {
                        let node = self.space.nodes.of_vertex[vertex as usize] as usize;
                        for i in 0..2 {
                            force[2 * node + i] += pressure * group.normal[i] * shape;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    fn strong_load(&self, t: f64) -> Result<Vec<f64>, LoadError> {
        let space = &self.space;
        let zeta = self.exact.zeta.at(t);
        let points = &self.force_points;
        let values = points.evaluate(&self.exact.forces, 2, t, zeta);
        finite(&values, &points.points, t, &["f0_x", "f0_y"])?;
        let mut force = vec![0.0; space.nodes.len()];
        let count = points.rule.weights.len();
        for c in 0..space.mesh.cell_count() {
            let measure = space.geometry.measure[c];
            for (q, weight) in points.rule.weights.iter().enumerate() {
                for (&node, shape) in space.cell_nodes(c).iter().zip(&points.rule.points[q]) {
                    for i in 0..2 {
                        force[2 * node as usize + i] +=
                            weight * measure * shape * values[i][count * c + q];
                    }
                }
            }
        }
        for group in self.traction.iter().chain(&self.contact) {
            self.add_boundary_stress(group, t, &mut force)?;
        }
        self.add_contact_pressure(t, &mut force)?;
        force.truncate(space.dofs());
        Ok(force)
    }

    /// Adds ∫ (σν)·v over a group of facets.
    fn add_boundary_stress(
        &self,
        group: &FacetGroup,
        t: f64,
        force: &mut [f64],
    ) -> Result<(), LoadError> {
        let values = self.interior(&group.strains, t)?;
        let kappa = self.exact.kappa(t);
        let rule = &group.strains.rule;
        let mut memory = Vec::new();
        for (index, &facet) in group.mesh_facets.iter().enumerate() {
            let measure = length(&self.space.mesh, facet);
            let material = self.exact.material_in(group.regions[index]);
            for (q, weight) in rule.weights.iter().enumerate() {
                let p = rule.weights.len() * index + q;
                let strain = self.tensors(&values, p, &mut memory);
                let stress = constitutive::stress(material, &strain, &memory, kappa);
                for (&vertex, shape) in self.space.mesh.facet(facet).iter().zip(&rule.points[q]) {
                    let node = self.space.nodes.of_vertex[vertex as usize] as usize;
                    for (i, row) in stress.iter().enumerate() {
                        let traction = row[0] * group.normal[0] + row[1] * group.normal[1];
                        force[2 * node + i] += weight * measure * shape * traction;
                    }
                }
            }
        }
        Ok(())
    }

    fn compute_moments(&self, t: f64) -> Result<Moments, LoadError> {
        let values = self.interior(&self.error_points, t)?;
        let mut moments = self.cell_moments(&values, self.exact.kappa(t));
        let facets = self.space.trace.measure.len();
        moments.normal.corner = vec![0.0; 2 * facets];
        moments.pressure.corner = vec![0.0; 2 * facets];
        moments.locked = vec![false; facets * (FACET_SAMPLES + 1)];
        for group in &self.contact {
            self.facet_moments(group, t, &mut moments)?;
        }
        Ok(moments)
    }

    fn cell_moments(&self, values: &[Vec<f64>], kappa: f64) -> Moments {
        let space = &self.space;
        let rule = &self.error_points.rule;
        let (count, cells) = (rule.weights.len(), space.mesh.cell_count());
        let mut moments = Moments::default();
        moments.strain.mean = Vec::with_capacity(3 * cells);
        moments.stress.mean = Vec::with_capacity(3 * cells);
        moments.displacement.corner = vec![0.0; 6 * cells];
        let mut memory = Vec::new();
        let (mut strains, mut stresses) = (vec![[0.0; 3]; count], vec![[0.0; 3]; count]);
        for c in 0..cells {
            let material = self.exact.material_in(self.regions[c]);
            for q in 0..count {
                let strain = self.tensors(values, count * c + q, &mut memory);
                let stress = constitutive::stress(material, &strain, &memory, kappa);
                strains[q] = mandel(&strain);
                stresses[q] = mandel(&stress);
            }
            let measure = space.geometry.measure[c];
            add_cell(&strains, &rule.weights, measure, &mut moments.strain);
            add_cell(&stresses, &rule.weights, measure, &mut moments.stress);
            for i in 0..2 {
                let at = &values[i][count * c..count * (c + 1)];
                let corner = &mut moments.displacement.corner[6 * c..6 * (c + 1)];
                moments.displacement.rest +=
                    measure * project(at, rule, |a, v| corner[2 * a + i] = v);
            }
        }
        moments
    }

    fn facet_moments(
        &self,
        group: &FacetGroup,
        t: f64,
        moments: &mut Moments,
    ) -> Result<(), LoadError> {
        let values = group.contact_values(&group.points, t)?;
        let samples = group.contact_values(&group.samples, t)?;
        let rule = &group.points.rule;
        let count = rule.weights.len();
        for (index, &f) in group.facets.iter().enumerate() {
            let measure = self.space.trace.measure[f];
            for (field, target) in [(0, &mut moments.normal), (1, &mut moments.pressure)] {
                let at = &values[field][count * index..count * (index + 1)];
                let Piecewise { corner, rest } = target;
                *rest += measure * project(at, rule, |a, v| corner[2 * f + a] = v);
            }
            for s in 0..=FACET_SAMPLES {
                let p = (FACET_SAMPLES + 1) * index + s;
                moments.locked[(FACET_SAMPLES + 1) * f + s] =
                    is_locked(samples[0][p], samples[2][p]);
            }
        }
        Ok(())
    }
}

impl Truth for ExactOnMesh {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        self.loads.get_or(t, || match self.form {
            LoadForm::Weak => self.weak_load(t),
            LoadForm::Strong => self.strong_load(t),
        })
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        self.moments.get_or(t, || self.compute_moments(t))
    }

    fn contact_samples(&self, t: f64) -> Result<Option<ContactSamples>, LoadError> {
        let points = || StatePoints::new(&self.exact, &self.space, false);
        Ok(Some(self.state_points.get_or_init(points).at(t)))
    }
}

impl FacetGroup {
    /// [u_ν, c, g, ξ, λ] at the points.
    fn contact_values(&self, points: &Sampled, t: f64) -> Result<Vec<Vec<f64>>, LoadError> {
        let values = points.evaluate(&self.formulas.program, 5, t, 0.0);
        finite(&values[..2], &points.points, t, &["u_ν", "ξ + λ"])?;
        Ok(values)
    }
}

/// Groups mesh facets by side and normal.
fn facet_groups(
    exact: &Exact,
    space: &Discretization,
    mesh_facets: &[u32],
    rule: &Rule,
) -> Vec<FacetGroup> {
    let mut groups = Vec::new();
    for part in space.mesh.plane_parts(mesh_facets) {
        let members: Vec<(usize, usize)> = part
            .members
            .into_iter()
            .map(|position| (position, mesh_facets[position] as usize))
            .collect();
        let normal = [part.normal[0], part.normal[1]];
        let sampled = |rule: Rule| {
            let points = members
                .iter()
                .flat_map(|(_, f)| {
                    let facet = space.mesh.facet(*f);
                    rule.points.iter().map(|b| space.mesh.point(facet, b)).collect::<Vec<_>>()
                })
                .collect();
            Sampled { rule, points, bound: Mutex::new(None) }
        };
        let samples = Rule {
            points: (0..=FACET_SAMPLES).map(|s| facet_sample(s).to_vec()).collect(),
            weights: vec![0.0; FACET_SAMPLES + 1],
        };
        let facets: Vec<usize> = members.iter().map(|(_, f)| *f).collect();
        groups.push(FacetGroup {
            regions: exact.facet_regions(&space.mesh, &facets),
            normal,
            facets: members.iter().map(|(position, _)| *position).collect(),
            mesh_facets: facets,
            formulas: exact.boundary(&normal),
            points: sampled(rule.clone()),
            samples: sampled(samples),
            strains: sampled(rule.clone()),
        });
    }
    groups
}

fn mandel(tensor: &Tensor<2>) -> [f64; 3] {
    [tensor[0][0], tensor[1][1], std::f64::consts::SQRT_2 * tensor[0][1]]
}

/// Refuses values that are not finite, naming the place.
fn finite(
    values: &[Vec<f64>],
    points: &[[f64; 3]],
    t: f64,
    names: &[&str],
) -> Result<(), LoadError> {
    for (field, name) in values.iter().zip(names) {
        if let Some(p) = field.iter().position(|v| !v.is_finite()) {
            let [x, y, _] = points[p];
            return Err(LoadError::NotFinite {
                what: (*name).to_string(),
                value: field[p],
                x,
                y,
                t,
            });
        }
    }
    Ok(())
}
