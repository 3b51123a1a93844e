//! f0 in the body and the given part of σν on its boundary, from the formulas of a scene: f2 on Γ2, and on Γ3 what a
//! manufactured solution adds to the contact pressure.

use super::equilibrium::{Edges, Equilibrium, Given, Linear};
use super::error::{GuaranteeError, Result};
use fem::contact::{Discretization, Model, StepView};
use fem::space::quadrature::{Rule, edge, gauss_legendre, triangle_degree_8};
use formula::{BoundProgram, Graph, Node, Program};
use scene::Data;
use scene::setup::{Setup, side_numbers};
use vhi::law::{Potential, TensorField};

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
    /// [`GuaranteeError::NoBound`] for loads that have no density.
    pub(super) fn new(setup: &Setup, space: &Discretization, edges: &Edges) -> Result<Self> {
        let (inside, outside) = (triangle_degree_8(), edge(ON_EDGES));
        let mesh = &space.mesh;
        let points = mesh.points_of(&mesh.cells(), &inside.points);
        let mut sides = Vec::new();
        let mut add = |numbers: &[u32], program: &dyn Fn(u32, &[f64]) -> Program| {
            let facets: Vec<u32> = mesh.facets_on(numbers).map(|f| f as u32).collect();
            for part in mesh.plane_parts(&facets) {
                let normal = [part.normal[0], part.normal[1]];
                let members = part.members.iter().map(|&at| facets[at]);
                let on_part: Vec<(u32, [u32; 2])> =
                    members.filter_map(|f| edges.on_facet(f as usize)).collect();
                let ends: Vec<&[u32]> = on_part.iter().map(|(_, ends)| &ends[..]).collect();
                let places = mesh.points_of(&ends, &outside.points);
                let traction = program(part.side, &normal).bind(&places);
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
                    add(&[side.0], &|_, _| compile(graph.clone(), formulas));
                }
                compile(graph.clone(), body).bind(&points)
            }
            (Data::Exact { interpolated: true, .. }, _) | (_, None) => {
                return Err(GuaranteeError::no_bound(
                    "the loads are those of an interpolant on each mesh and have no density",
                ));
            }
            (Data::Exact { .. }, Some(exact)) => {
                add(&side_numbers(&domain.traction), &|_, normal| {
                    let mut graph = exact.data.graph.clone();
                    let traction = traction(&mut graph, &exact.stress, normal, None);
                    compile(graph, &traction)
                });
                add(&side_numbers(&domain.contact), &|side, normal| {
                    let formulas = exact.boundary(side, normal);
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
    /// A formula that is not finite.
    pub(super) fn at(&mut self, space: &Discretization, edges: &Edges, t: f64) -> Result<Loads> {
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
fn finite(program: &mut BoundProgram, t: f64, what: &'static str) -> Result<Vec<Vec<f64>>> {
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
    [0, 1].map(|i: usize| {
        let along = [(normal[0], stress[i]), (normal[1], stress[i + 1])];
        graph.weighted_sum(along.into_iter().chain(pressure.map(|pressure| (normal[i], pressure))))
    })
}

// The duality gap on Γ3: G = ∫ ĵ(u_ν) + ĵ*(p) - p u_ν, ĵ = j_ν with the constraint u_ν ≤ g, for u_ν of the
// element and linear p on each edge.
//
// At a point it is ∫ (p - ∂j_ν(r)) dr from u_ν to a displacement that has the pressure p: no potential is needed.

/// Pieces of an edge, with four Gauss points each: kinks of the integrand lie anywhere.
const PIECES: usize = 8;
/// u_ν may exceed g by rounding: this part of the size of both.
const ROUNDING: f64 = 1e-12;

/// ξ + λ at the points of the trace; at a clamped one the pressure of the graph that is nearest to its neighbour's.
pub(super) fn pressures(space: &Discretization, model: &Model, view: &StepView<'_>) -> Vec<f64> {
    let trace = &space.trace;
    let mut pressure: Vec<f64> =
        view.compliance.iter().zip(view.multiplier).map(|(xi, lambda)| xi + lambda).collect();
    for f in 0..trace.measure.len() {
        let ends = [0, 1].map(|end| trace.facet(f)[end] as usize);
        for (end, other) in [(ends[0], ends[1]), (ends[1], ends[0])] {
            let boundary = model.boundary_on(space.side(f)).filter(|_| trace.points[end].clamped);
            let Some(boundary) = boundary else { continue };
            let x = space.mesh.point(&[trace.points[end].vertex], &[1.0]);
            let (lo, hi) = boundary.potential_at(x).subdifferential(-(boundary.shift)(x));
            let hi = if (boundary.gap)(x, view.t) > 0.0 { hi } else { f64::INFINITY };
            pressure[end] = pressure[other].max(lo).min(hi);
        }
    }
    pressure
}

/// Linear pressures on the edges of Γ3 by their values at both ends. That of nodal pressures which are quadratic is the
/// nearest one in L², cut off where it leaves what the nodes have: the law has those pressures.
pub(super) fn along_edges(space: &Discretization, pressure: &[f64]) -> Vec<[f64; 2]> {
    let trace = &space.trace;
    let edge = |f: usize| {
        let on_edge: Vec<f64> = trace.facet(f).iter().map(|&i| pressure[i as usize]).collect();
        let &[first, second, middle] = on_edge.as_slice() else { return [on_edge[0], on_edge[1]] };
        // λ_0 λ_1 is nearest to its mean 1/6.
        let raise = 2.0 / 3.0 * (middle - 0.5 * (first + second));
        let least = on_edge.iter().copied().fold(f64::INFINITY, f64::min);
        let most = on_edge.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        [first, second].map(|end| (end + raise).max(least).min(most))
    };
    (0..trace.measure.len()).map(edge).collect()
}

/// Adds -p ν on Γ3.
pub(super) fn add_pressures(
    space: &Discretization,
    edges: &Edges,
    pressure: &[[f64; 2]],
    tractions: &mut [f64],
) {
    let trace = &space.trace;
    for (f, &facet) in trace.mesh_facet.iter().enumerate() {
        let Some((free, ends)) = edges.on_facet(facet as usize) else { continue };
        for (&point, p) in trace.facet(f).iter().zip(&pressure[f]) {
            let at = &trace.points[point as usize];
            let end = usize::from(ends[1] == at.vertex);
            for i in 0..2 {
                tractions[4 * free as usize + 2 * end + i] -= p * at.normal[i];
            }
        }
    }
}

/// G of the level, and of pressures p at the ends of the edges; infinite where u_ν > g or the law never has the pressure p.
pub(super) fn duality_gap(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    pressure: &[[f64; 2]],
) -> f64 {
    let rule = edge(4);
    let trace = &space.trace;
    let mut sum = 0.0;
    for f in 0..trace.measure.len() {
        let Some(boundary) = model.boundary_on(space.side(f)) else { continue };
        let ends = [trace.facet(f)[0] as usize, trace.facet(f)[1] as usize];
        let vertices = ends.map(|i| trace.points[i].vertex);
        let normal: Vec<f64> =
            trace.facet(f).iter().map(|&i| trace.normal(i as usize, view.u)).collect();
        for piece in 0..PIECES {
            for (weight, b) in rule.weights.iter().zip(&rule.points) {
                let second = (piece as f64 + b[1]) / PIECES as f64;
                let at = [1.0 - second, second];
                let x = space.mesh.point(&vertices, &at);
                let mix = |shape: &[f64], values: &[f64]| {
                    shape.iter().zip(values).map(|(s, value)| s * value).sum::<f64>()
                };
                let (law, shift) = (boundary.potential_at(x), (boundary.shift)(x));
                let normal = mix(&space.element.values(&at), &normal);
                let (r, p) = (normal - shift, mix(&at, &pressure[f]));
                let excess = at_point(&law, (boundary.gap)(x, view.t) - shift, r, p);
                sum += weight * trace.measure[f] / PIECES as f64 * excess;
            }
        }
    }
    sum
}

/// ĵ(r) + ĵ*(p) - p r of a monotone law with the constraint r ≤ g.
fn at_point(law: &dyn Potential, gap: f64, r: f64, p: f64) -> f64 {
    let rounding = ROUNDING * (gap.abs().min(f64::MAX) + r.abs()).min(1e300);
    if r > gap + rounding {
        return f64::INFINITY;
    }
    let r = r.min(gap);
    let (lo, hi) = law.subdifferential(r);
    if p > hi && r < gap {
        return walk(law, r, gap, p, 1.0);
    }
    if p < lo {
        return walk(law, r, f64::NEG_INFINITY, p, -1.0);
    }
    0.0
}

/// ∫ |p - ∂j_ν| from r in a direction to where the monotone law has the pressure p, or to `end`.
fn walk(law: &dyn Potential, r: f64, end: f64, p: f64, direction: f64) -> f64 {
    let short = |at: f64| direction * (p - law.value_and_slope(at).0);
    let mut reach = if end.is_finite() { end } else { r + direction * (1.0 + r.abs()) };
    // An open end: as far as the law asks for, if it ever does.
    for _ in 0..60 {
        if end.is_finite() || short(reach) <= 0.0 {
            break;
        }
        reach += direction * (reach - r).abs();
    }
    if !end.is_finite() && short(reach) > 0.0 {
        return f64::INFINITY;
    }
    let (mut near, mut far) = (r, reach);
    for _ in 0..100 {
        let middle = 0.5 * (near + far);
        if short(middle) > 0.0 { near = middle } else { far = middle }
    }
    let ahead = |at: f64| direction * (at - r) > 0.0 && direction * (far - at) > 0.0;
    let mut stops: Vec<f64> =
        law.kinks().iter().chain(law.jumps()).copied().filter(|&at| ahead(at)).collect();
    stops.sort_by(|a, b| (direction * a).total_cmp(&(direction * b)));
    stops.push(far);
    let gauss = gauss_legendre(8);
    let (mut from, mut sum) = (r, 0.0);
    for stop in stops {
        let at = |z: f64| from + 0.5 * (1.0 + z) * (stop - from);
        let value: f64 = gauss.iter().map(|(z, w)| w * short(at(*z)).max(0.0)).sum();
        sum += 0.5 * (stop - from).abs() * value;
        from = stop;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use vhi::law::PiecewiseLinear;

    /// p(r) = 2 r₊ up to 0.5, a jump of 1 there, slope 2 beyond: j and j* by hand.
    fn law() -> PiecewiseLinear {
        PiecewiseLinear::new(vec![(0.0, 0.0), (0.5, 1.0), (0.5, 2.0)], 0.0, 2.0).unwrap()
    }

    fn close(found: f64, expected: f64) -> bool {
        (found - expected).abs() < 1e-10
    }

    #[test]
    fn the_gap_is_that_of_hand_computed_conjugates() {
        let free = f64::INFINITY;
        // On the graph: zero. r = 0.2: j = 0.04, p = 0.4.
        assert!(close(at_point(&law(), free, 0.2, 0.4), 0.0));
        // r = 0.2, p = 0.8: j*(p) = p²/4 = 0.16, 0.04 + 0.16 - 0.16 = 0.04.
        assert!(close(at_point(&law(), free, 0.2, 0.8), 0.04));
        // r = 0.2, p = 1.5, in the jump: j* = 1.5·0.5 - 0.25 = 0.5; 0.04 + 0.5 - 0.3 = 0.24.
        assert!(close(at_point(&law(), free, 0.2, 1.5), 0.24));
        // r = 0.7, p = 0.4: j(0.7) = 0.25 + 2·0.2 + 0.04 = 0.69, j*(0.4) = 0.04; 0.73 - 0.28 = 0.45.
        assert!(close(at_point(&law(), free, 0.7, 0.4), 0.45));
        // r = 0.7, p = 0: j = 0.69.
        assert!(close(at_point(&law(), free, 0.7, 0.0), 0.69));
    }

    #[test]
    fn the_constraint_takes_any_larger_pressure_at_the_gap() {
        // g = 0.3, r = g: the law has 0.6, all beyond is λ.
        assert!(close(at_point(&law(), 0.3, 0.3, 5.0), 0.0));
        // r = 0.2, p = 5: ĵ*(5) = 1.5 - 0.09, ĵ(0.2) = 0.04, p r = 1: 0.45.
        assert!(close(at_point(&law(), 0.3, 0.2, 5.0), 0.45));
        assert!(at_point(&law(), 0.3, 0.31, 5.0).is_infinite());
    }

    #[test]
    fn a_pressure_that_the_law_never_has_gives_no_bound() {
        let bounded = PiecewiseLinear::new(vec![(0.0, 0.0), (0.5, 1.0)], 0.0, 0.0).unwrap();
        assert!(at_point(&bounded, f64::INFINITY, 0.2, 1.1).is_infinite());
        assert!(at_point(&bounded, f64::INFINITY, 0.2, -0.1).is_infinite());
        assert!(close(at_point(&bounded, f64::INFINITY, 0.5, 1.0), 0.0));
    }
}
