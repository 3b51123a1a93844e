//! Scenes whose exact u(t) is, on each mesh, the nodal interpolant of given formulas (u(t) ∈ V^h): strain, memory, ζ
//! and stress are those of the interpolant at the strain points of the element (one per cell for P1), and ∫_{Γ3} c v_ν
//! uses the boundary rule of the scheme. Only the time error remains.

use fem::mesh::in_dimension;
use std::sync::{Arc, OnceLock};

use super::Sliding;
use super::constitutive::{self, Tensor, mandel};
use super::contact_samples::StatePoints;
use super::edge_compliance::{ComplianceRule, facet_moments};
use super::exact::Exact;
use super::nodal_force::{add_force_along, facet_measure, force_of_means};
use super::nodal_strain::NodalStrain;
use super::running_integral::RunningIntegral;
use super::sampled::vector_names;
use super::shapes::Shapes;
use super::shared_program::SharedProgram;
use super::side_points::{SidePoints, side_points};
use super::sign_changes::Guards;
use super::truth::{ByTime, Truth};
use fem::contact::{Discretization, LoadError};
use fem::norms::{ContactSamples, Moments, facet_samples, is_locked};
use formula::{EvaluationPoint, Node, Program};

/// Intervals of the horizon in which guards are watched.
const WATCHES: usize = 64;

/// The nodal interpolant of an exact solution on one mesh.
pub struct InterpolatedOnMesh {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    /// The scheme's quadrature of ∂j_ν.
    rule: ComplianceRule,
    /// The components of u, then those of each H_i u, at the nodes.
    bound: SharedProgram,
    /// Of each cell.
    regions: Vec<usize>,
    strains: NodalStrain,
    /// Formulas on each side of Γ3, bound to its points of the trace.
    boundary: Vec<SidePoints>,
    /// Times in [0, T] at which a guard changes sign at some vertex, sorted.
    events: OnceLock<Vec<f64>>,
    accumulated: RunningIntegral,
    loads: ByTime<Vec<f64>>,
    moments: ByTime<Moments>,
    state_points: OnceLock<StatePoints>,
}

impl InterpolatedOnMesh {
    /// Binds the nodal values of `exact` to the vertices of `space`.
    pub fn new(exact: Arc<Exact>, space: Arc<Discretization>, rule: ComplianceRule) -> Self {
        let mut graph = exact.data.graph.clone();
        let mut outputs: Vec<Node> = exact.data.u.clone();
        for (i, &kernel) in exact.data.kernels.iter().enumerate() {
            let inner = exact.data.inner.iter().find(|(term, _)| *term == i);
            for &u in &exact.data.u {
                let v = inner.map_or(u, |&(_, r)| graph.convolve(r, u));
                outputs.push(graph.convolve(kernel, v));
            }
        }
        let horizon = exact.data.horizon;
        let nodal = Program::compile(&graph, &outputs, horizon);
        let points = points_of_nodes(&space);
        let boundary = side_points(&exact, &space);
        Self {
            bound: nodal.bind(&points).into(),
            regions: exact.cell_regions(&space.mesh),
            strains: NodalStrain::new(
                space.clone(),
                &space.element.strain_rule(space.mesh.dimension),
            ),
            boundary,
            events: OnceLock::new(),
            accumulated: RunningIntegral::new(horizon),
            loads: ByTime::default(),
            moments: ByTime::default(),
            state_points: OnceLock::new(),
            exact,
            space,
            rule,
        }
    }

    /// u and the ∫ b_i(t-s) u(s) ds, one per term of the memory, as nodal vectors at time t.
    ///
    /// # Errors
    /// A formula that is not finite at a vertex.
    pub fn displacements(&self, t: f64) -> Result<(Vec<f64>, Vec<Vec<f64>>), LoadError> {
        let d = self.space.mesh.dimension;
        let out = self.bound.values_at(t);
        let nodes = self.space.nodes.vertex.len();
        let remembered = vector_names("H u", d);
        let names = vector_names("u", d).into_iter().chain(remembered.into_iter().cycle());
        for (field, what) in out.iter().zip(names) {
            if let Some(p) = field.iter().position(|v| !v.is_finite()) {
                let place = self.space.mesh.vertex(self.space.nodes.vertex[p]).to_vec();
                return Err(LoadError::NotFinite { what, value: field[p], place, t });
            }
        }
        let interleave = |fields: &[Vec<f64>]| -> Vec<f64> {
            let mut all = vec![0.0; nodes * fields.len()];
            for (i, field) in fields.iter().enumerate() {
                let component = all[i..].iter_mut().step_by(fields.len());
                component.zip(field).for_each(|(component, value)| *component = *value);
            }
            all
        };
        let (u, memory) = out.split_at(d);
        Ok((interleave(u), memory.chunks(d).map(interleave).collect()))
    }

    fn strain_norm<const D: usize>(&self, t: f64) -> Result<f64, LoadError> {
        let (u, _) = self.displacements(t)?;
        Ok(self.strains.norm::<D>(&u))
    }

    /// ζ(t) = ∫ ‖ε(I_h u(s))‖ ds of the interpolant, cut at the events.
    ///
    /// # Errors
    /// A formula that is not finite at a vertex.
    pub fn zeta(&self, t: f64) -> Result<f64, LoadError> {
        let all = self.events.get_or_init(|| events(&self.exact, &self.space));
        let events =
            |from: f64, to: f64| all.iter().copied().filter(|&s| s > from && s < to).collect();
        let norm = in_dimension!(self.space.mesh.dimension, D => Self::strain_norm::<D>);
        self.accumulated.at(t, events, |s| norm(self, s))
    }

    fn kappa(&self, t: f64) -> Result<f64, LoadError> {
        let Some(kappa) = self.exact.data.kappa else { return Ok(f64::INFINITY) };
        let at = EvaluationPoint { zeta: self.zeta(t)?, ..EvaluationPoint::default() };
        Ok(self.exact.data.graph.evaluate(kappa, &at))
    }

    /// [u_ν, ξ + λ, g, ξ, λ] at the points of the trace.
    pub fn contact_state(&self, t: f64) -> Vec<[f64; 5]> {
        let mut state = vec![[0.0; 5]; self.space.trace.points.len()];
        for side in &self.boundary {
            let out = side.evaluate(t);
            for (p, &i) in side.members.iter().enumerate() {
                state[i] = [0, 1, 2, 3, 4].map(|field: usize| out[field][p]);
            }
        }
        state
    }

    /// The friction at the points of the trace; None without friction.
    pub fn friction_state(&self, t: f64) -> Option<Vec<Sliding>> {
        let mut state = vec![Sliding::default(); self.space.trace.points.len()];
        for side in &self.boundary {
            let side_state = side.friction(t, self.space.mesh.dimension)?;
            side.members.iter().zip(side_state).for_each(|(&i, side_state)| state[i] = side_state);
        }
        (!self.boundary.is_empty()).then_some(state)
    }

    /// Adds ∫_{Γ3} c v_ν + s v_τ: λ and s at the vertices, where their conditions are, ξ by the rule.
    fn add_contact_pressure(&self, t: f64, force: &mut [f64]) {
        for side in &self.boundary {
            let contact = self.exact.contact_on(side.side);
            let law = contact.and_then(|contact| contact.law.as_ref());
            let on_facets = law.filter(|_| self.rule != ComplianceRule::Vertex);
            // Of [u_ν, ξ + λ, g, ξ, λ]: all of the pressure, or only λ.
            let field = if on_facets.is_some() { 4 } else { 1 };
            let values = side.evaluate(t);
            for ((&i, weight), pressure) in
                side.members.iter().zip(&side.weights).zip(&values[field])
            {
                add_force_along(&self.space, i, side.normal, weight * pressure, force);
            }
            let sliding = side.friction(t, self.space.mesh.dimension).unwrap_or_default();
            let members = side.members.iter().zip(&side.weights);
            for ((&i, weight), point_sliding) in members.zip(sliding) {
                for (tangent, s) in point_sliding.tangents.into_iter().zip(point_sliding.s) {
                    add_force_along(&self.space, i, tangent, weight * s, force);
                }
            }
            let Some(law) = on_facets else { continue };
            for &f in &side.facets {
                let corners = self.space.trace.facet(f);
                let normal: Vec<f64> = corners
                    .iter()
                    .map(|&i| {
                        let at = side.members.iter().position(|&member| member == i as usize);
                        at.map_or(f64::NAN, |at| values[0][at])
                    })
                    .collect();
                let vertices: Vec<u32> =
                    corners.iter().map(|&i| self.space.trace.points[i as usize].vertex).collect();
                let at = |node: Option<Node>, b: &[f64]| Some(self.on_facet(node?, &vertices, b));
                let shift = |b: &[f64]| at(contact.and_then(|c| c.shift), b).unwrap_or(0.0);
                let scale = |b: &[f64]| at(contact.and_then(|c| c.scale), b).unwrap_or(1.0);
                let moments = facet_moments(law, self.rule, &normal, shift, scale);
                let size = facet_measure(&self.space.mesh, self.space.trace.mesh_facet[f] as usize);
                for (&i, moment) in corners.iter().zip(moments) {
                    add_force_along(&self.space, i as usize, side.normal, size * moment, force);
                }
            }
        }
    }

    /// A formula in space at a point of a facet.
    fn on_facet(&self, node: Node, vertices: &[u32], barycentric: &[f64]) -> f64 {
        let place = self.space.mesh.point(vertices, barycentric);
        self.exact.data.graph.evaluate(node, &place.into())
    }

    /// ξ + λ at the points of the trace.
    pub fn pressures(&self, t: f64) -> Vec<f64> {
        self.contact_state(t).into_iter().map(|at| at[1]).collect()
    }

    fn compute_load<const D: usize, const N: usize>(&self, t: f64) -> Result<Vec<f64>, LoadError> {
        let space = &self.space;
        let mut force = match self.moments.known(t) {
            Some(moments) => force_of_means::<D>(space, &moments.stress.at),
            None => force_of_means::<D>(space, &self.cells::<D, N>(t)?.stress),
        };
        self.add_contact_pressure(t, &mut force);
        force.truncate(space.dofs());
        Ok(force)
    }

    /// u, and ε and σ at the strain points of all cells.
    fn cells<const D: usize, const N: usize>(&self, t: f64) -> Result<CellFields, LoadError> {
        let (u, memory) = self.displacements(t)?;
        let kappa = self.kappa(t)?;
        let (cells, points) = (self.space.mesh.cell_count(), self.strains.points());
        let [mut strains, mut stresses] = [(); 2].map(|()| Vec::with_capacity(N * cells * points));
        let mut remembered: Vec<Tensor<D>> = Vec::new();
        for (c, p) in (0..cells).flat_map(|c| (0..points).map(move |p| (c, p))) {
            let strain = self.strains.at(&u, c, p);
            remembered.clear();
            remembered.extend(memory.iter().map(|h| self.strains.at(h, c, p)));
            let material = self.exact.material_in(self.regions[c]);
            let stress = constitutive::stress(material, &strain, &remembered, kappa);
            for (all, tensor) in [(&mut strains, strain), (&mut stresses, stress)] {
                let numbers: [f64; N] = mandel(&tensor);
                all.extend_from_slice(&numbers);
            }
        }
        Ok(CellFields { u, strain: strains, stress: stresses })
    }

    /// Between laws the pressure is the mean of the surrounding points, as the discrete one is displayed.
    fn pressures_between_laws(&self, state: &mut [[f64; 5]]) {
        let mut pressure: Vec<f64> = state.iter().map(|at| at[1]).collect();
        self.space.trace.extend(&mut pressure);
        state.iter_mut().zip(pressure).for_each(|(at, pressure)| at[1] = pressure);
    }

    fn compute_moments<const D: usize, const N: usize>(
        &self,
        t: f64,
    ) -> Result<Moments, LoadError> {
        let CellFields { u, strain, stress } = self.cells::<D, N>(t)?;
        let mut moments = Moments::default();
        (moments.strain.at, moments.stress.at) = (strain, stress);
        let nodes = &self.space.nodes.cells;
        moments.displacement.node.reserve(D * nodes.len());
        for &node in nodes {
            moments.displacement.node.extend_from_slice(&u.as_chunks::<D>().0[node as usize]);
        }
        let mut state = self.contact_state(t);
        self.pressures_between_laws(&mut state);
        let functions = Shapes::of_facet(self.space.element, D);
        let samples: Vec<Vec<f64>> = facet_samples(D).iter().map(|b| functions.at(b)).collect();
        for f in 0..self.space.trace.measure.len() {
            let at = self.space.trace.facet(f).iter().map(|&i| state[i as usize]);
            moments.normal.node.extend(at.clone().map(|at| at[0]));
            moments.pressure.node.extend(at.clone().map(|at| at[1]));
            for b in &samples {
                let value = |field: usize| -> f64 {
                    // An infinite gap must not affect a node of weight zero.
                    let parts = b.iter().zip(at.clone()).filter(|(b, _)| **b != 0.0);
                    parts.map(|(b, at)| b * at[field]).sum()
                };
                moments.locked.push(is_locked(value(0), value(2)));
            }
        }
        Ok(moments)
    }
}

impl Truth for InterpolatedOnMesh {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        let load = in_dimension!(self.space.mesh.dimension, D, S => Self::compute_load::<D, S>);
        self.loads.get_or(t, || load(self, t))
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        let moments =
            in_dimension!(self.space.mesh.dimension, D, S => Self::compute_moments::<D, S>);
        self.moments.get_or(t, || moments(self, t))
    }

    fn expect(&self, times: &[f64]) -> Result<(), LoadError> {
        times.iter().try_for_each(|&t| self.moments(t).map(drop))
    }

    fn contact_samples(&self, t: f64) -> Result<Option<ContactSamples>, LoadError> {
        if self.space.mesh.dimension != 2 {
            return Ok(None);
        }
        let points = || StatePoints::new(&self.exact, &self.space, true);
        Ok(Some(self.state_points.get_or_init(points).at(t)))
    }
}

/// u in the nodes, ε and σ at the strain points, in the notation of moments.
struct CellFields {
    u: Vec<f64>,
    strain: Vec<f64>,
    stress: Vec<f64>,
}

/// The places of all nodes.
pub fn points_of_nodes(space: &Discretization) -> Vec<[f64; 3]> {
    space.nodes.vertex.iter().map(|&v| space.mesh.point(&[v], &[1.0])).collect()
}

/// Times at which a guard of u changes sign at some node.
fn events(exact: &Exact, space: &Discretization) -> Vec<f64> {
    let (graph, horizon) = (&exact.data.graph, exact.data.horizon);
    let guards = Guards::new(graph, &graph.guards(&exact.data.u), horizon);
    // Guards of contact scenes depend on x and t: one vertex per distinct x suffices.
    let mut distinct = points_of_nodes(space);
    distinct.sort_by(|a, b| a[0].total_cmp(&b[0]));
    distinct.dedup_by(|a, b| a[0] == b[0]);
    let mut events = guards.in_time([0.0, horizon], WATCHES, &distinct);
    events.dedup();
    events
}
