//! Scenes whose exact u(t) is, on each mesh, the nodal interpolant of given formulas (u(t) ∈ V^h):
//! strain, memory, ζ and stress are those of the interpolant, constant on each cell, and
//! ∫_{Γ3} c v_ν takes the boundary rule of the scheme. The error is the time error alone.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::constitutive::{self, Tensor};
use super::edge_compliance::{ComplianceRule, edge_moments};
use super::exact::Exact;
use super::nodal_force::{add_stress, length};
use super::running_integral::RunningIntegral;
use super::sign_changes::sign_changes;
use super::truth::{ByTime, Truth};
use crate::contact::{Discretization, LoadError};
use crate::formula::{Bound, Node, Point, Program};
use crate::mesh::PlanePart;
use crate::norms::{FACET_SAMPLES, Moments, facet_sample, is_locked};

/// Intervals of the horizon in which guards are watched.
const WATCHES: usize = 64;

/// [u_ν, ξ + λ, g, …] at points of the trace with one normal.
struct SidePoints {
    normal: [f64; 2],
    members: Vec<usize>,
    /// Facets of the trace.
    facets: Vec<usize>,
    /// ∫ φ over the side, of each member.
    weights: Vec<f64>,
    bound: Mutex<Bound>,
}

/// The nodal interpolant of an exact solution on one mesh.
pub struct InterpolatedOnMesh {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    /// Where the scheme integrates ∂j_ν.
    rule: ComplianceRule,
    /// [u_x, u_y, H_1 u_x, H_1 u_y, …] at the vertices in node order.
    bound: Mutex<Bound>,
    /// Of each cell.
    regions: Vec<usize>,
    /// Formulas on each side of Γ3, bound to its points of the trace.
    boundary: Vec<SidePoints>,
    /// Times in [0, T] at which a guard changes sign at some vertex, sorted.
    events: Vec<f64>,
    /// ζ.
    accumulated: RunningIntegral,
    loads: ByTime<Vec<f64>>,
    moments: ByTime<Moments>,
}

impl InterpolatedOnMesh {
    /// Binds the nodal values of `exact` to the vertices of `space`.
    pub fn new(exact: Arc<Exact>, space: Arc<Discretization>, rule: ComplianceRule) -> Self {
        let mut graph = exact.data.graph.clone();
        let mut outputs: Vec<Node> = exact.data.u.clone();
        for &kernel in &exact.data.kernels {
            outputs.extend(exact.data.u.iter().map(|&u| graph.convolve(kernel, u)));
        }
        let horizon = exact.data.horizon;
        let nodal = Program::compile(&mut graph, &outputs, horizon);
        let points: Vec<[f64; 3]> =
            space.nodes.vertex.iter().map(|&v| space.mesh.point(&[v], &[1.0])).collect();
        let guards = graph.guards(&exact.data.u);
        let guards_program = Program::compile(&mut graph, &guards, horizon);
        let events = events(&guards_program, guards.len(), &points, horizon);
        let boundary = side_points(&exact, &space);
        Self {
            bound: Mutex::new(nodal.bind(&points)),
            regions: exact.cell_regions(&space.mesh),
            boundary,
            events,
            accumulated: RunningIntegral::new(horizon),
            loads: ByTime::default(),
            moments: ByTime::default(),
            exact,
            space,
            rule,
        }
    }

    /// u and the ∫ b_i(t-s) u(s) ds, one a term of the memory, as nodal vectors at time t.
    ///
    /// # Errors
    /// A formula that is not finite at a vertex.
    pub fn displacements(&self, t: f64) -> Result<(Vec<f64>, Vec<Vec<f64>>), LoadError> {
        let outputs = 2 + 2 * self.exact.data.kernels.len();
        let mut out = vec![Vec::new(); outputs];
        self.bound.lock().unwrap_or_else(PoisonError::into_inner).evaluate(t, 0.0, &mut out);
        let nodes = self.space.nodes.vertex.len();
        let names = ["u_x", "u_y"].into_iter().chain(["H u_x", "H u_y"].into_iter().cycle());
        for (field, name) in out.iter().zip(names) {
            if let Some(p) = field.iter().position(|v| !v.is_finite()) {
                let x = self.space.mesh.vertex(self.space.nodes.vertex[p]);
                let (x, y) = (x[0], x[1]);
                return Err(LoadError::NotFinite { what: name.into(), value: field[p], x, y, t });
            }
        }
        let interleave = |a: usize| -> Vec<f64> {
            (0..nodes).flat_map(|p| [out[a][p], out[a + 1][p]]).collect()
        };
        let memory = (2..outputs).step_by(2).map(interleave).collect();
        Ok((interleave(0), memory))
    }

    /// ε of a nodal vector on cell c, as a full tensor: from differences along the edges, apart
    /// from the solver's shape gradients.
    fn strain(&self, nodal: &[f64], c: usize) -> Tensor<2> {
        let cell = self.space.mesh.cell(c);
        let corner = [0, 1, 2].map(|a| self.space.mesh.vertex(cell[a]));
        let value = |a: usize, i: usize| {
            nodal[2 * self.space.nodes.of_vertex[cell[a] as usize] as usize + i]
        };
        let (p, q) = (
            [corner[1][0] - corner[0][0], corner[1][1] - corner[0][1]],
            [corner[2][0] - corner[0][0], corner[2][1] - corner[0][1]],
        );
        let determinant = p[0] * q[1] - p[1] * q[0];
        let mut gradient = [[0.0; 2]; 2];
        for (i, row) in gradient.iter_mut().enumerate() {
            let (a, b) = (value(1, i) - value(0, i), value(2, i) - value(0, i));
            *row = [(a * q[1] - b * p[1]) / determinant, (b * p[0] - a * q[0]) / determinant];
        }
        let shear = 0.5 * (gradient[0][1] + gradient[1][0]);
        [[gradient[0][0], shear], [shear, gradient[1][1]]]
    }

    fn strain_norm(&self, t: f64) -> Result<f64, LoadError> {
        let (u, _) = self.displacements(t)?;
        let mut sum = 0.0;
        for c in 0..self.space.mesh.cell_count() {
            let e = self.strain(&u, c);
            let square = e[0][0] * e[0][0] + 2.0 * e[0][1] * e[0][1] + e[1][1] * e[1][1];
            sum += self.space.geometry.measure[c] * square;
        }
        Ok(sum.sqrt())
    }

    /// ζ(t) = ∫ ‖ε(I_h u(s))‖ ds of the interpolant, cut at the events.
    ///
    /// # Errors
    /// A formula that is not finite at a vertex.
    pub fn zeta(&self, t: f64) -> Result<f64, LoadError> {
        let events = |from: f64, to: f64| {
            self.events.iter().copied().filter(|&s| s > from && s < to).collect()
        };
        self.accumulated.at(t, events, |s| self.strain_norm(s))
    }

    fn kappa(&self, t: f64) -> Result<f64, LoadError> {
        let Some(kappa) = self.exact.data.kappa else { return Ok(f64::INFINITY) };
        let at = Point { zeta: self.zeta(t)?, ..Point::default() };
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

    /// Adds ∫_{Γ3} c v_ν: λ at the vertices, where the constraint is, ξ by the rule.
    fn add_contact_pressure(&self, t: f64, force: &mut [f64]) {
        let contact = self.exact.data.contact.as_ref();
        let law = contact.and_then(|contact| contact.law.as_ref());
        let on_facets = law.filter(|_| self.rule != ComplianceRule::Vertex);
        // Of [u_ν, ξ + λ, g, ξ, λ]: all of the pressure, or λ alone.
        let field = if on_facets.is_some() { 4 } else { 1 };
        for side in &self.boundary {
            let values = side.evaluate(t);
            for ((&i, weight), pressure) in
                side.members.iter().zip(&side.weights).zip(&values[field])
            {
                self.add_normal_force(i, side.normal, weight * pressure, force);
            }
            let Some(law) = on_facets else { continue };
            for &f in &side.facets {
                let ends = [0, 1].map(|a| self.space.trace.facet(f)[a] as usize);
                let normal = ends.map(|i| {
                    let at = side.members.iter().position(|&member| member == i);
                    at.map_or(f64::NAN, |at| values[0][at])
                });
                let vertices = ends.map(|i| self.space.trace.points[i].vertex);
                let shift = |x: f64| self.shift(&vertices, x);
                let scale = |x: f64| self.scale(&vertices, x);
                let moments = edge_moments(law, self.rule, normal, shift, scale);
                let size = length(&self.space.mesh, self.space.trace.mesh_facet[f] as usize);
                for (i, moment) in ends.into_iter().zip(moments) {
                    self.add_normal_force(i, side.normal, size * moment, force);
                }
            }
        }
    }

    /// Adds a force along the outward normal at a point of the trace.
    fn add_normal_force(&self, i: usize, normal: [f64; 2], size: f64, force: &mut [f64]) {
        let vertex = self.space.trace.points[i].vertex;
        let node = self.space.nodes.of_vertex[vertex as usize] as usize;
        for (j, component) in normal.iter().enumerate() {
            force[2 * node + j] += size * component;
        }
    }

    /// s at a place of an edge.
    fn shift(&self, vertices: &[u32], place: f64) -> f64 {
        let contact = self.exact.data.contact.as_ref();
        contact
            .and_then(|contact| contact.shift)
            .map_or(0.0, |shift| self.on_edge(shift, vertices, place))
    }

    /// c at a place of an edge.
    fn scale(&self, vertices: &[u32], place: f64) -> f64 {
        let contact = self.exact.data.contact.as_ref();
        contact
            .and_then(|contact| contact.scale)
            .map_or(1.0, |scale| self.on_edge(scale, vertices, place))
    }

    fn on_edge(&self, node: Node, vertices: &[u32], place: f64) -> f64 {
        let [x, y, z] = self.space.mesh.point(vertices, &[1.0 - place, place]);
        self.exact.data.graph.evaluate(node, &Point { x, y, z, ..Point::default() })
    }

    /// ξ + λ at the points of the trace.
    pub fn pressures(&self, t: f64) -> Vec<f64> {
        self.contact_state(t).into_iter().map(|at| at[1]).collect()
    }

    fn compute_load(&self, t: f64) -> Result<Vec<f64>, LoadError> {
        let (u, memory) = self.displacements(t)?;
        let kappa = self.kappa(t)?;
        let space = &self.space;
        let mut force = vec![0.0; space.nodes.len()];
        for c in 0..space.mesh.cell_count() {
            let stress = self.stress(&u, &memory, kappa, c);
            add_stress(&space.mesh, c, space.cell_nodes(c), &stress, &mut force);
        }
        self.add_contact_pressure(t, &mut force);
        force.truncate(space.dofs());
        Ok(force)
    }

    fn stress(&self, u: &[f64], memory: &[Vec<f64>], kappa: f64, c: usize) -> Tensor<2> {
        let strain = self.strain(u, c);
        let remembered: Vec<Tensor<2>> = memory.iter().map(|h| self.strain(h, c)).collect();
        let material = self.exact.material_in(self.regions[c]);
        constitutive::stress(material, &strain, &remembered, kappa)
    }

    fn compute_moments(&self, t: f64) -> Result<Moments, LoadError> {
        let (u, memory) = self.displacements(t)?;
        let kappa = self.kappa(t)?;
        let mut moments = Moments::default();
        for c in 0..self.space.mesh.cell_count() {
            moments.strain.mean.extend(mandel(&self.strain(&u, c)));
            moments.stress.mean.extend(mandel(&self.stress(&u, &memory, kappa, c)));
            for &node in self.space.cell_nodes(c) {
                moments.displacement.corner.extend(&u[2 * node as usize..2 * node as usize + 2]);
            }
        }
        let state = self.contact_state(t);
        for f in 0..self.space.trace.measure.len() {
            let ends = self.space.trace.facet(f);
            let [a, b] = [state[ends[0] as usize], state[ends[1] as usize]];
            moments.normal.corner.extend([a[0], b[0]]);
            moments.pressure.corner.extend([a[1], b[1]]);
            for s in 0..=FACET_SAMPLES {
                let [p, q] = facet_sample(s);
                moments.locked.push(is_locked(p * a[0] + q * b[0], p * a[2] + q * b[2]));
            }
        }
        Ok(moments)
    }
}

impl SidePoints {
    fn evaluate(&self, t: f64) -> Vec<Vec<f64>> {
        let mut out = vec![Vec::new(); 5];
        self.bound.lock().unwrap_or_else(PoisonError::into_inner).evaluate(t, 0.0, &mut out);
        out
    }
}

impl Truth for InterpolatedOnMesh {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        self.loads.get_or(t, || self.compute_load(t))
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        self.moments.get_or(t, || self.compute_moments(t))
    }
}

fn mandel(tensor: &Tensor<2>) -> [f64; 3] {
    [tensor[0][0], tensor[1][1], std::f64::consts::SQRT_2 * tensor[0][1]]
}

/// The points of the trace, by side and normal.
fn side_points(exact: &Exact, space: &Discretization) -> Vec<SidePoints> {
    let (mesh, trace) = (&space.mesh, &space.trace);
    let of_part = |part: PlanePart| {
        let facets = part.members;
        let mut members: Vec<usize> =
            facets.iter().flat_map(|&f| trace.facet(f)).map(|&i| i as usize).collect();
        members.sort_unstable();
        members.dedup();
        let points: Vec<[f64; 3]> =
            members.iter().map(|&i| mesh.point(&[trace.points[i].vertex], &[1.0])).collect();
        let normal = [part.normal[0], part.normal[1]];
        let formulas = exact.boundary(&normal);
        let mut of_vertex = HashMap::new();
        for &f in &facets {
            let facet = trace.mesh_facet[f] as usize;
            for &vertex in mesh.facet(facet) {
                *of_vertex.entry(vertex).or_insert(0.0) += 0.5 * length(mesh, facet);
            }
        }
        let weights = members.iter().map(|&i| of_vertex[&trace.points[i].vertex]).collect();
        let bound = Mutex::new(formulas.program.bind(&points));
        SidePoints { normal, facets, weights, bound, members }
    };
    mesh.plane_parts(&trace.mesh_facet).into_iter().map(of_part).collect()
}

/// Times at which a guard changes sign at some vertex.
fn events(program: &Program, count: usize, points: &[[f64; 3]], horizon: f64) -> Vec<f64> {
    // Guards of contact scenes depend on x and t: one vertex a distinct x will do.
    let mut distinct: Vec<[f64; 3]> = points.to_vec();
    distinct.sort_by(|a, b| a[0].total_cmp(&b[0]));
    distinct.dedup_by(|a, b| a[0] == b[0]);
    let mut events = sign_changes(0.0, horizon, WATCHES, |times| {
        let mut bound = program.bind(&distinct);
        let mut values = vec![Vec::new(); count];
        let mut rows = vec![Vec::with_capacity(times.len()); count * distinct.len()];
        for &t in times {
            bound.evaluate(t, 0.0, &mut values);
            for (row, value) in rows.iter_mut().zip(values.iter().flatten()) {
                row.push(*value);
            }
        }
        rows
    });
    events.dedup();
    events
}
