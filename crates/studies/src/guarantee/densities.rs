//! f0 in the body and the given part of σν on its boundary, from the formulas of a scene: f2 on Γ2, and on Γ3 what a
//! manufactured solution adds to the contact pressure.

use fem::contact::Discretization;
use fem::space::quadrature::{Rule, edge, triangle_degree_8};
use formula::{BoundProgram, Graph, Node, Program};
use scene::Data;
use scene::setup::{Setup, side_numbers};
use vhi::law::TensorField;

use super::edges::Edges;
use super::equilibrium::{Equilibrium, Given};
use super::error::GuaranteeError;
use super::triangle::Moments;

/// Gauss points on an edge.
const ON_EDGES: usize = 8;

/// Formulas bound to the points of the rules.
pub(super) struct Densities {
    inside: Rule,
    outside: Rule,
    body: BoundProgram,
    sides: Vec<Side>,
}

/// Boundary edges with one formula.
struct Side {
    /// Free edges, with their ends in the order of the points.
    edges: Vec<(u32, [u32; 2])>,
    traction: BoundProgram,
}

/// The loads at one time, with what they miss of f0 and of the tractions.
pub(super) struct Loads {
    pub given: Given,
    /// Πf0 at the corners of the cells, Π on linear functions.
    pub corners: Vec<Moments>,
    /// f0 at the points of the cells.
    body: Vec<Vec<f64>>,
    /// ∫ |q - Πq|² on each free edge.
    rough_edges: Vec<f64>,
}

impl Densities {
    /// Binds the formulas of the scene.
    ///
    /// # Errors
    /// [`GuaranteeError::Refused`] for loads that have no density.
    pub(super) fn new(
        setup: &Setup,
        space: &Discretization,
        edges: &Edges,
    ) -> Result<Self, GuaranteeError> {
        let (inside, outside) = (triangle_degree_8(), edge(ON_EDGES));
        let mesh = &space.mesh;
        let cells = (0..mesh.cell_count()).map(|c| mesh.cell(c));
        let points: Vec<[f64; 3]> =
            cells.flat_map(|cell| inside.points.iter().map(|b| mesh.point(cell, b))).collect();
        let mut sides = Vec::new();
        let mut add = |numbers: &[u32], program: &dyn Fn(&[f64]) -> Program| {
            let facets: Vec<u32> = mesh.facets_on(numbers).map(|f| f as u32).collect();
            for part in mesh.plane_parts(&facets) {
                let normal = [part.normal[0], part.normal[1]];
                let members = part.members.iter().map(|&at| facets[at]);
                let on_part: Vec<(u32, [u32; 2])> =
                    members.filter_map(|f| edges.on_facet(f)).collect();
                let places = on_part
                    .iter()
                    .flat_map(|(_, ends)| outside.points.iter().map(|b| mesh.point(ends, b)));
                let traction = program(&normal).bind(&places.collect::<Vec<_>>());
                sides.push(Side { edges: on_part, traction });
            }
        };
        let horizon = setup.scene.time.horizon;
        let compile =
            |mut graph: Graph, outputs: &[Node]| Program::compile(&mut graph, outputs, horizon);
        let domain = &setup.body.domain;
        let body = match (&setup.body.data, &setup.exact) {
            (Data::Loads { body, traction }, _) => {
                let graph = &setup.scene.formulas;
                for (side, formulas) in traction {
                    add(&[side.0], &|_| compile(graph.clone(), formulas));
                }
                compile(graph.clone(), body).bind(&points)
            }
            (Data::Exact { interpolated: true, .. }, _) | (_, None) => {
                return Err(GuaranteeError::refused(
                    "the loads are those of an interpolant on each mesh and have no density",
                ));
            }
            (Data::Exact { .. }, Some(exact)) => {
                add(&side_numbers(&domain.traction), &|normal| {
                    let mut graph = exact.data.graph.clone();
                    let traction = traction(&mut graph, &exact.stress, normal, None);
                    compile(graph, &traction)
                });
                add(&side_numbers(&domain.contact), &|normal| {
                    let formulas = exact.boundary(normal);
                    let mut graph = formulas.graph;
                    let pressure = graph.add(formulas.xi, formulas.lambda);
                    let traction = traction(&mut graph, &exact.stress, normal, Some(pressure));
                    compile(graph, &traction)
                });
                exact.forces.bind(&points)
            }
        };
        Ok(Self { inside, outside, body, sides })
    }

    /// The loads at t.
    ///
    /// # Errors
    /// [`GuaranteeError::NotFinite`].
    pub(super) fn at(
        &mut self,
        space: &Discretization,
        edges: &Edges,
        t: f64,
    ) -> Result<Loads, GuaranteeError> {
        let mut body = vec![Vec::new(); 2];
        self.body.evaluate(t, 0.0, &mut body);
        if body.iter().flatten().any(|f| !f.is_finite()) {
            return Err(GuaranteeError::NotFinite { what: "f0", t });
        }
        let count = self.inside.weights.len();
        let moments = (0..space.mesh.cell_count()).map(|c| {
            let mut of_cell = Moments::zeros();
            for (q, (weight, shapes)) in
                self.inside.weights.iter().zip(&self.inside.points).enumerate()
            {
                let share = weight * space.geometry.measure[c];
                for (a, shape) in shapes.iter().enumerate() {
                    for i in 0..2 {
                        of_cell[2 * a + i] += share * shape * body[i][count * c + q];
                    }
                }
            }
            of_cell
        });
        let moments: Vec<Moments> = moments.collect();
        // The inverse of |T|/12 (1 + δ).
        let corners = moments.iter().zip(&space.geometry.measure).map(|(moments, measure)| {
            let mean = |i: usize| (0..3).map(|a| moments[2 * a + i]).sum::<f64>() / 4.0;
            let means = [mean(0), mean(1)];
            Moments::from_fn(|row, _| 12.0 / measure * (moments[row] - means[row % 2]))
        });
        let corners = corners.collect();
        let mut tractions = vec![0.0; 4 * edges.free_count];
        let mut rough_edges = vec![0.0; edges.free_count];
        for side in &mut self.sides {
            side.project(space, &self.outside, t, &mut tractions, &mut rough_edges)?;
        }
        Ok(Loads { given: Given { moments, tractions }, corners, body, rough_edges })
    }

    /// The root of Σ (C_T ‖f0 - Πf0‖_T + Σ C_E ‖q - Πq‖_E)²/m_𝒜 over the cells: what no linear load has, as a functional
    /// on the energy space.
    pub(super) fn oscillation(
        &self,
        space: &Discretization,
        equilibrium: &Equilibrium<'_>,
        loads: &Loads,
        elasticity: &TensorField,
    ) -> f64 {
        let (count, edges) = (self.inside.weights.len(), &equilibrium.edges);
        let least: Vec<f64> =
            elasticity.regions().iter().map(|tensor| tensor.eigenvalues(2).0).collect();
        let cell = |c: usize| {
            let (mut rest, corner) = (0.0, &loads.corners[c]);
            for (q, (weight, b)) in self.inside.weights.iter().zip(&self.inside.points).enumerate()
            {
                for i in 0..2 {
                    let linear: f64 = (0..3).map(|a| b[a] * corner[2 * a + i]).sum();
                    let missed = loads.body[i][count * c + q] - linear;
                    rest += weight * space.geometry.measure[c] * missed * missed;
                }
            }
            let constants = equilibrium.constants(c);
            let mut missed = constants.inside * rest.sqrt();
            for (s, &edge) in edges.of_cell[c].iter().enumerate() {
                if let Some(free) = edges.free[edge as usize] {
                    missed += constants.on_edge[s] * loads.rough_edges[free as usize].sqrt();
                }
            }
            // One tensor for all regions, or one each.
            missed * missed / least.get(space.region(c)).unwrap_or(&least[0])
        };
        (0..space.mesh.cell_count()).map(cell).sum::<f64>().sqrt()
    }
}

/// σν + p ν by its components, σ given as xx, xy, yy.
fn traction(
    graph: &mut Graph,
    stress: &[Node],
    normal: &[f64],
    pressure: Option<Node>,
) -> [Node; 2] {
    let nu = [normal[0], normal[1]].map(|component| graph.constant(component));
    [0, 1].map(|i: usize| {
        let [first, second] = [stress[i], stress[i + 1]];
        let (first, second) = (graph.mul(first, nu[0]), graph.mul(second, nu[1]));
        let sum = graph.add(first, second);
        let Some(pressure) = pressure else { return sum };
        let pressed = graph.mul(pressure, nu[i]);
        graph.add(sum, pressed)
    })
}

impl Side {
    /// Adds the linear functions nearest to σν on the edges of the side, and what they miss.
    fn project(
        &mut self,
        space: &Discretization,
        rule: &Rule,
        t: f64,
        tractions: &mut [f64],
        rough: &mut [f64],
    ) -> Result<(), GuaranteeError> {
        let mut values = vec![Vec::new(); 2];
        self.traction.evaluate(t, 0.0, &mut values);
        if values.iter().flatten().any(|value| !value.is_finite()) {
            return Err(GuaranteeError::NotFinite { what: "a traction", t });
        }
        let density = |at: usize| [values[0][at], values[1][at]];
        for (e, (free, ends)) in self.edges.iter().enumerate() {
            let corner = ends.map(|v| space.mesh.vertex(v));
            let length = (corner[1][0] - corner[0][0]).hypot(corner[1][1] - corner[0][1]);
            let at = |q: usize| density(rule.weights.len() * e + q);
            // Means against both linear functions give the values 4m_a - 2m_b at the ends.
            let mut means = [[0.0; 2]; 2];
            for (q, (weight, b)) in rule.weights.iter().zip(&rule.points).enumerate() {
                for (end, shape) in b.iter().enumerate() {
                    (0..2).for_each(|i| means[end][i] += weight * shape * at(q)[i]);
                }
            }
            let ends = [0, 1]
                .map(|end: usize| [0, 1].map(|i| 4.0 * means[end][i] - 2.0 * means[1 - end][i]));
            for (end, at_end) in ends.iter().enumerate() {
                (0..2).for_each(|i| tractions[4 * *free as usize + 2 * end + i] += at_end[i]);
            }
            for (q, (weight, b)) in rule.weights.iter().zip(&rule.points).enumerate() {
                for i in 0..2 {
                    let missed = at(q)[i] - b[0] * ends[0][i] - b[1] * ends[1][i];
                    rough[*free as usize] += weight * length * missed * missed;
                }
            }
        }
        Ok(())
    }
}
