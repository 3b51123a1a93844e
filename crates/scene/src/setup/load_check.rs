//! Checks total force and first moments of a load against an independent integral: a wrong load drives a sound solver
//! to a wrong answer without changing an order.
//!
//! The sums are Σ F_i m(x_i) over the unknowns, for each component and m = 1, x, y, z: total force, and first moments
//! including the moment. For P1 that is F(v) of v = m at free nodes and 0 on Γ1.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use super::{Setup, side_numbers};
use crate::{Data, Scene, Side};
use exact::{Exact, ExactOnMesh, LoadForm, Shapes, Truth};
use fem::contact::{Discretization, LoadError};
use fem::space::quadrature::{
    Rule, TruthRules, edge, tetrahedron_product, triangle_degree_8, triangle_product,
};
use fem::space::{Nodes, Simplex};
use formula::{Node, Program};

/// Shares of [0, T] at which a load is checked.
const TIMES: [f64; 2] = [0.5, 1.0];
/// Sums of up to a million terms of both signs, each good to a few units of rounding.
const ROUNDING: f64 = 1e-11;
/// A sound sum differs from the integral by its quadrature error, which is the difference of the two rules of the
/// integral; twice that allows for rounding.
const BY_RULES: f64 = 2.0;
/// σ and Div σ are different integrands: the change by the next rules estimates both errors without bounding them.
const BY_FORMS: f64 = 10.0;

/// Compares the loads of `truth` with the formulas of the scene. Weak-form loads of an exact solution have no cheaper
/// second form; the orders check them.
///
/// # Errors
/// [`LoadError::Resultant`]; a formula that is not finite.
pub(super) fn check(
    setup: &Setup,
    space: &Arc<Discretization>,
    truth: &dyn Truth,
) -> Result<(), LoadError> {
    let times = TIMES.map(|share| share * setup.scene.time.horizon);
    match (&setup.body.data, &setup.exact) {
        (Data::Loads { body, traction }, _) => {
            let integrals = Integrals::new(&setup.scene, body, traction, space);
            let [by_own, by_other] = [0, 1].map(|rule| integrals.at(times, rule));
            times.iter().zip(by_own.iter().zip(&by_other)).try_for_each(
                |(&t, (by_own, by_other))| {
                    let rules = Sums::largest_difference(by_own, by_other);
                    let sums = Sums::of(space, &truth.load(t)?);
                    sums.compare(by_other, BY_RULES * rules, t)
                },
            )
        }
        (Data::Exact { form: LoadForm::Strong, .. }, Some(exact)) => {
            of_forms(setup, exact, space, truth, times)
        }
        _ => Ok(()),
    }
}

/// ∫ f0·v + ∫ f2·v + ∫ h3·v against ∫ σ:ε(v) + ∫ (ξ + λ) v_ν: which uses no traction, and no derivative of σ.
fn of_forms(
    setup: &Setup,
    exact: &Arc<Exact>,
    space: &Arc<Discretization>,
    truth: &dyn Truth,
    times: [f64; 2],
) -> Result<(), LoadError> {
    let sides = side_numbers(&setup.body.domain.traction);
    let by = |form, rules: TruthRules| -> Result<Vec<Sums>, LoadError> {
        let exact = ExactOnMesh::new(exact.clone(), space.clone(), form, &sides, &rules);
        let exact = exact.time_by_time();
        times.iter().map(|&t| Ok(Sums::of(space, &exact.load(t)?))).collect()
    };
    // By the usual rules, and by the next. The strong form uses the scene's loads, since errors in `truth` must not
    // widen the tolerance.
    let by_both = |form| -> Result<[Vec<Sums>; 2], LoadError> {
        let (element, d) = (space.element, space.mesh.dimension);
        let next = by(form, TruthRules::stronger_for(element, d))?;
        Ok([by(form, TruthRules::for_element(element, d))?, next])
    };
    let (strong, weak) = (by_both(LoadForm::Strong)?, by_both(LoadForm::Weak)?);
    let missed =
        |[usual, next]: &[Vec<Sums>; 2], at: usize| Sums::largest_difference(&usual[at], &next[at]);
    times.iter().enumerate().try_for_each(|(at, &t)| {
        let missed = missed(&strong, at) + missed(&weak, at);
        Sums::of(space, &truth.load(t)?).compare(&weak[1][at], BY_FORMS * missed, t)
    })
}

/// Σ F_i m(x_i), component by component, m = 1, x, y, z.
struct Sums {
    values: Vec<f64>,
    /// Largest Σ |F_i m(x_i)|.
    size: f64,
}

/// 1 and the coordinates of a point.
fn moments(x: &[f64]) -> impl Iterator<Item = f64> + '_ {
    std::iter::once(1.0).chain(x.iter().copied())
}

impl Sums {
    fn zero(dimension: usize) -> (Vec<f64>, Vec<f64>) {
        (vec![0.0; dimension * (dimension + 1)], vec![0.0; dimension * (dimension + 1)])
    }

    fn new((values, sizes): (Vec<f64>, Vec<f64>)) -> Self {
        Self { values, size: sizes.into_iter().fold(0.0, f64::max) }
    }

    fn of(space: &Discretization, force: &[f64]) -> Self {
        let d = space.mesh.dimension;
        let mut sums = Self::zero(d);
        for (node, of_node) in force.chunks_exact(d).enumerate() {
            let place = space.mesh.vertex(space.nodes.vertex[node]);
            for (i, f) in of_node.iter().enumerate() {
                for (m, value) in moments(place).enumerate() {
                    sums.0[(d + 1) * i + m] += f * value;
                    sums.1[(d + 1) * i + m] += (f * value).abs();
                }
            }
        }
        Self::new(sums)
    }

    fn largest_difference(a: &Self, b: &Self) -> f64 {
        a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// Refuses a sum that is farther from `integral` than `quadrature` and rounding allow.
    fn compare(&self, integral: &Self, quadrature: f64, t: f64) -> Result<(), LoadError> {
        let allowed = quadrature + ROUNDING * self.size.max(integral.size);
        let components = self.values.len().isqrt();
        for (index, (&assembled, &integrated)) in
            self.values.iter().zip(&integral.values).enumerate()
        {
            let off = (assembled - integrated).abs();
            // NaN is refused.
            if off <= allowed {
                continue;
            }
            let (i, m) = (index / (components + 1), index % (components + 1));
            let axis = |i: usize| ["x", "y", "z"][i];
            let what = match m {
                0 => format!("total force along {}", axis(i)),
                _ => format!("first moment in {} of the force along {}", axis(m - 1), axis(i)),
            };
            return Err(LoadError::Resultant { what, t, assembled, integrated, allowed });
        }
        Ok(())
    }
}

/// A simplex, and the vertices with its nodes.
struct Loaded {
    corners: Vec<u32>,
    nodes: Vec<u32>,
}

/// A formula with the simplices that it acts on.
struct Acting {
    formula: Program,
    component: usize,
    simplices: Rc<[Loaded]>,
    /// The rule of the loads, and another one.
    rules: [Rule; 2],
}

/// ∫ f0·v + ∫ f2·v of the formulas; simplices are derived from the cells only.
struct Integrals<'a> {
    space: &'a Discretization,
    acting: Vec<Acting>,
}

impl<'a> Integrals<'a> {
    fn new(
        scene: &Scene,
        body: &[Node],
        traction: &[(Side, Vec<Node>)],
        space: &'a Discretization,
    ) -> Self {
        let (mesh, graph) = (&space.mesh, scene.formulas.clone());
        let rules = TruthRules::for_element(space.element, mesh.dimension);
        let (inside, outside) = match mesh.dimension {
            2 => ([rules.load, triangle_product(5)], [rules.traction, edge(7)]),
            _ => ([rules.load, tetrahedron_product(4)], [rules.traction, triangle_degree_8()]),
        };
        let mut acting = Vec::new();
        let middles = middles(space);
        let mut add = |formulas: &[Node], simplices: Vec<Vec<u32>>, rules: &[Rule; 2]| {
            let loaded = |corners: Vec<u32>| {
                let nodes = nodes_of(space, &middles, &corners);
                Loaded { corners, nodes }
            };
            let simplices: Rc<[Loaded]> = simplices.into_iter().map(loaded).collect();
            for (component, &formula) in formulas.iter().enumerate() {
                if graph.value_of_constant(formula) != Some(0.0) {
                    let formula = Program::compile(&graph, &[formula], scene.time.horizon);
                    let (simplices, rules) = (simplices.clone(), rules.clone());
                    acting.push(Acting { formula, component, simplices, rules });
                }
            }
        };
        add(body, (0..mesh.cell_count()).map(|c| mesh.cell(c).to_vec()).collect(), &inside);
        if !traction.is_empty() {
            let faces = boundary_faces(space);
            for (side, formulas) in traction {
                add(formulas, faces.get(&side.0).cloned().unwrap_or_default(), &outside);
            }
        }
        Self { space, acting }
    }

    /// The sums at the times, by one of the two rules.
    fn at(&self, times: [f64; 2], which: usize) -> [Sums; 2] {
        let mut sums = [(); 2].map(|()| Sums::zero(self.space.mesh.dimension));
        for acting in &self.acting {
            self.add(acting, &acting.rules[which], times, &mut sums);
        }
        sums.map(Sums::new)
    }

    fn add(
        &self,
        acting: &Acting,
        rule: &Rule,
        times: [f64; 2],
        sums: &mut [(Vec<f64>, Vec<f64>); 2],
    ) {
        let space = self.space;
        let simplices = acting.simplices.iter();
        let points: Vec<[f64; 3]> = simplices
            .flat_map(|simplex| rule.points.iter().map(|b| space.mesh.point(&simplex.corners, b)))
            .collect();
        // Independent of the shape functions that assemble the loads.
        let (d, corners) = (space.mesh.dimension, rule.points[0].len());
        let of = if corners == d { Shapes::of_facet } else { Shapes::of_cell };
        let functions = of(space.element, d);
        let shapes: Vec<Vec<f64>> = rule.points.iter().map(|b| functions.at(b)).collect();
        let measures: Vec<f64> =
            acting.simplices.iter().map(|simplex| measure(space, &simplex.corners)).collect();
        let mut formula = acting.formula.bind(&points);
        let mut values = vec![Vec::new()];
        for (t, sums) in times.into_iter().zip(sums) {
            formula.evaluate(t, 0.0, &mut values);
            let of_simplices = values[0].chunks_exact(rule.points.len());
            for ((simplex, measure), f) in acting.simplices.iter().zip(&measures).zip(of_simplices)
            {
                for (a, &vertex) in simplex.nodes.iter().enumerate() {
                    // v vanishes on Γ1.
                    if space.nodes.of_vertex[vertex as usize] as usize >= space.nodes.free {
                        continue;
                    }
                    let (mut force, mut size) = (0.0, 0.0);
                    for ((weight, shapes), f) in rule.weights.iter().zip(&shapes).zip(f) {
                        let share = weight * measure * f * shapes[a];
                        force += share;
                        size += share.abs();
                    }
                    self.add_moments(acting.component, vertex, [force, size], sums);
                }
            }
        }
    }

    fn add_moments(
        &self,
        component: usize,
        vertex: u32,
        [force, size]: [f64; 2],
        sums: &mut (Vec<f64>, Vec<f64>),
    ) {
        let first = (self.space.mesh.dimension + 1) * component;
        for (m, at) in moments(self.space.mesh.vertex(vertex)).enumerate() {
            sums.0[first + m] += force * at;
            sums.1[first + m] += size * at.abs();
        }
    }
}

/// A node as a mean of corners: their numbers, sorted, and the bits of their weights.
type Place = Vec<(u32, u64)>;

/// The vertices with nodes at no corner by their places, from the nodes of cells.
fn middles(space: &Discretization) -> HashMap<Place, u32> {
    let mut found = HashMap::new();
    for c in 0..space.mesh.cell_count() {
        let places: Vec<Place> = places(space, space.mesh.cell(c)).collect();
        for &node in space.cell_nodes(c) {
            let vertex = space.nodes.vertex[node as usize];
            let at = space.mesh.vertex(vertex);
            let is_there = |place: &&Place| {
                let mean = |i: usize| {
                    let part = |sum, &(p, weight): &(u32, u64)| {
                        sum + f64::from_bits(weight) * space.mesh.vertex(p)[i]
                    };
                    place.iter().fold(0.0, part)
                };
                at.iter().enumerate().all(|(i, x)| mean(i) == *x)
            };
            found.extend(places.iter().find(is_there).map(|place| (place.clone(), vertex)));
        }
    }
    found
}

/// The places of the nodes of a cell or facet at no corner, in the order of shape functions.
fn places(space: &Discretization, corners: &[u32]) -> impl Iterator<Item = Place> {
    let d = space.mesh.dimension;
    let simplex = if corners.len() == d { Simplex::facet(d) } else { Simplex::cell(d) };
    let place = |b: Vec<f64>| {
        let pairs = corners.iter().zip(b).filter(|(_, b)| *b != 0.0);
        let mut place: Place = pairs.map(|(&corner, b)| (corner, b.to_bits())).collect();
        place.sort_unstable();
        place
    };
    space.element.nodes(simplex).into_iter().map(place).filter(|place| place.len() > 1)
}

/// The corners of a simplex that have nodes, then the middles, in the order of shape functions.
fn nodes_of(space: &Discretization, middles: &HashMap<Place, u32>, corners: &[u32]) -> Vec<u32> {
    let has_node = |&&corner: &&u32| space.nodes.of_vertex[corner as usize] != Nodes::NONE;
    let mut nodes: Vec<u32> = corners.iter().filter(has_node).copied().collect();
    nodes.extend(places(space, corners).filter_map(|place| middles.get(&place)));
    nodes
}

/// The faces of single cells, by side.
fn boundary_faces(space: &Discretization) -> HashMap<u32, Vec<Vec<u32>>> {
    let mesh = &space.mesh;
    let sorted = |simplex: &[u32]| {
        let mut vertices = simplex.to_vec();
        vertices.sort_unstable();
        vertices
    };
    let mut count: HashMap<Vec<u32>, u32> = HashMap::new();
    for c in 0..mesh.cell_count() {
        let cell = sorted(mesh.cell(c));
        for left_out in 0..cell.len() {
            let mut face = cell.clone();
            face.remove(left_out);
            *count.entry(face).or_default() += 1;
        }
    }
    let mut faces: HashMap<u32, Vec<Vec<u32>>> = HashMap::new();
    for (f, &side) in mesh.facet_side.iter().enumerate() {
        let face = sorted(mesh.facet(f));
        // Once each, however often it is listed.
        if count.remove(&face) == Some(1) {
            faces.entry(side).or_default().push(face);
        }
    }
    faces
}

/// Length, area or volume by the determinant of edges (Gram's for a side), in units of the longest, against over- and
/// underflow.
fn measure(space: &Discretization, simplex: &[u32]) -> f64 {
    let d = space.mesh.dimension;
    let corner = |i: usize| space.mesh.vertex(simplex[i]);
    let edges: Vec<Vec<f64>> =
        (1..simplex.len()).map(|i| (0..d).map(|j| corner(i)[j] - corner(0)[j]).collect()).collect();
    let unit = edges.iter().flatten().fold(0.0f64, |most, value| most.max(value.abs()));
    let gram = nalgebra::DMatrix::from_fn(edges.len(), edges.len(), |i, j| {
        edges[i].iter().zip(&edges[j]).map(|(a, b)| (a / unit) * (b / unit)).sum::<f64>()
    });
    let parts: usize = (1..=edges.len()).product();
    gram.determinant().max(0.0).sqrt() / parts as f64 * unit.powi(edges.len() as i32)
}
