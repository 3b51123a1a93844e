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
use super::triangle::Linear;

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
    /// Πf0 and Πq, Π on linear functions.
    pub given: Given,
    /// ∫ |f0 - Πf0|² on each cell.
    rough_cells: Vec<f64>,
    /// ∫ |q - Πq|² on each free edge.
    rough_edges: Vec<f64>,
}

/// The linear function nearest to a density on a simplex with C corners of measure one.
struct Nearest<const C: usize> {
    /// Values at the corners.
    corners: [[f64; 2]; C],
    /// ∫ of the square that is missed.
    missed: f64,
}

impl<const C: usize> Nearest<C> {
    fn new(rule: &Rule, density: impl Fn(usize) -> [f64; 2]) -> Self {
        let points = || rule.weights.iter().zip(&rule.points).enumerate();
        let mut means = [[0.0; 2]; C];
        for (q, (weight, b)) in points() {
            for (mean, shape) in means.iter_mut().zip(b) {
                (0..2).for_each(|i| mean[i] += weight * shape * density(q)[i]);
            }
        }
        // The inverse of (1 + δ)/(C (C + 1)).
        let size = (C * (C + 1)) as f64;
        let shift = [0, 1].map(|i| means.iter().map(|m| m[i]).sum::<f64>() / (C + 1) as f64);
        let corners = means.map(|mean| [0, 1].map(|i| size * (mean[i] - shift[i])));
        let mut missed = 0.0;
        for (q, (weight, b)) in points() {
            for i in 0..2 {
                let linear: f64 = b.iter().zip(&corners).map(|(b, corner)| b * corner[i]).sum();
                missed += weight * (density(q)[i] - linear).powi(2);
            }
        }
        Self { corners, missed }
    }
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
                    members.filter_map(|f| edges.on_facet(f as usize)).collect();
                let places = on_part
                    .iter()
                    .flat_map(|(_, ends)| outside.points.iter().map(|b| mesh.point(ends, b)));
                let traction = program(&normal).bind(&places.collect::<Vec<_>>());
                sides.push(Side { edges: on_part, traction });
            }
        };
        let horizon = setup.scene.time.horizon;
        let compile = |graph: Graph, outputs: &[Node]| Program::compile(&graph, outputs, horizon);
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
        let body = finite(&mut self.body, t, "f0")?;
        let count = self.inside.weights.len();
        let (mut linear, mut rough_cells) = (Vec::new(), Vec::new());
        for (c, measure) in space.geometry.measure.iter().enumerate() {
            let density = |q: usize| [0, 1].map(|i: usize| body[i][count * c + q]);
            let found = Nearest::<3>::new(&self.inside, density);
            linear.push(Linear::from_fn(|row, _| found.corners[row / 2][row % 2]));
            rough_cells.push(measure * found.missed);
        }
        let mut tractions = vec![0.0; 4 * edges.free()];
        let mut rough_edges = vec![0.0; edges.free()];
        for side in &mut self.sides {
            let values = finite(&mut side.traction, t, "a traction")?;
            let count = self.outside.weights.len();
            for (e, (free, ends)) in side.edges.iter().enumerate() {
                let corner = ends.map(|v| space.mesh.vertex(v));
                let length = (corner[1][0] - corner[0][0]).hypot(corner[1][1] - corner[0][1]);
                let density = |q: usize| [0, 1].map(|i: usize| values[i][count * e + q]);
                let found = Nearest::<2>::new(&self.outside, density);
                let (at, free) = (4 * *free as usize, *free as usize);
                let on_edge = tractions[at..at + 4].iter_mut();
                on_edge.zip(found.corners.as_flattened()).for_each(|(sum, q)| *sum += q);
                rough_edges[free] += length * found.missed;
            }
        }
        Ok(Loads { given: Given { body: linear, tractions }, rough_cells, rough_edges })
    }
}

/// The two components at the points of a program.
fn finite(
    program: &mut BoundProgram,
    t: f64,
    what: &'static str,
) -> Result<Vec<Vec<f64>>, GuaranteeError> {
    let values = program.values_at(t, 0.0);
    match values.iter().flatten().all(|value| value.is_finite()) {
        true => Ok(values),
        false => Err(GuaranteeError::NotFinite { what, t }),
    }
}

impl Loads {
    /// The root of Σ (C_T ‖f0 - Πf0‖_T + Σ C_E ‖q - Πq‖_E)²/m_𝒜 over the cells: what no linear load has, as a functional
    /// on the energy space.
    pub(super) fn oscillation(
        &self,
        space: &Discretization,
        equilibrium: &Equilibrium,
        elasticity: &TensorField,
    ) -> f64 {
        let edges = &equilibrium.edges;
        let least: Vec<f64> =
            elasticity.regions().iter().map(|tensor| tensor.eigenvalues(2).0).collect();
        let cell = |c: usize| {
            let constants = equilibrium.constants(c);
            let mut missed = constants.inside * self.rough_cells[c].sqrt();
            for (s, edge) in edges.of_cell(c) {
                missed += constants.on_edge[s] * self.rough_edges[edge as usize].sqrt();
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
