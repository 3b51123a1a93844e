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
use fem::mesh::Mesh;
use fem::space::quadrature::{Rule, TruthRules, edge, tetrahedron_product, triangle_degree_8};
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

impl Sums {
    /// Those of forces over nodes, with the sizes of what each is summed from.
    fn of_sized(space: &Discretization, forces: &[f64], sizes: &[f64]) -> Self {
        let d = space.mesh.dimension;
        let mut values = vec![0.0; d * (d + 1)];
        let mut of_sizes = values.clone();
        let nodes = forces.chunks_exact(d).zip(sizes.chunks_exact(d)).zip(&space.nodes.vertex);
        for ((forces, sizes), &vertex) in nodes {
            let place = space.mesh.vertex(vertex);
            for (component, (force, size)) in forces.iter().zip(sizes).enumerate() {
                let first = (d + 1) * component;
                values[first] += force;
                of_sizes[first] += size;
                for (m, at) in (first + 1..).zip(place) {
                    values[m] += force * at;
                    of_sizes[m] += size * at.abs();
                }
            }
        }
        Self { values, size: of_sizes.into_iter().fold(0.0, f64::max) }
    }

    /// Of the forces that do work in V.
    fn of(space: &Discretization, forces: &[f64]) -> Self {
        let mut forces = forces.to_vec();
        space.frames.without_support(&mut forces);
        Self::of_sized(space, &forces, &forces.iter().map(|force| force.abs()).collect::<Vec<_>>())
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

/// The corners of a cell or facet, and its nodes in the order of shape functions.
struct Loaded<'a> {
    corners: &'a [u32],
    nodes: Vec<u32>,
}

/// A formula with the simplices that it acts on.
struct Acting<'a> {
    formula: Program,
    component: usize,
    simplices: Rc<[Loaded<'a>]>,
    /// The rule of the loads, and another one.
    rules: [Rule; 2],
}

/// ∫ f0·v + ∫ f2·v of the formulas.
struct Integrals<'a> {
    space: &'a Discretization,
    acting: Vec<Acting<'a>>,
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
            2 => ([rules.load, triangle_degree_8()], [rules.traction, edge(7)]),
            _ => ([rules.load, tetrahedron_product(4)], [rules.traction, triangle_degree_8()]),
        };
        let mut acting = Vec::new();
        let mut add = |formulas: &[Node], simplices: Rc<[Loaded<'a>]>, rules: &[Rule; 2]| {
            for (component, &formula) in formulas.iter().enumerate() {
                if graph.value_of_constant(formula) != Some(0.0) {
                    let formula = Program::compile(&graph, &[formula], scene.time.horizon);
                    let (simplices, rules) = (simplices.clone(), rules.clone());
                    acting.push(Acting { formula, component, simplices, rules });
                }
            }
        };
        let cell = |c| Loaded { corners: mesh.cell(c), nodes: space.cell_nodes(c).to_vec() };
        add(body, (0..mesh.cell_count()).map(cell).collect(), &inside);
        let facets = if traction.is_empty() { Vec::new() } else { boundary_facets(mesh) };
        for (side, formulas) in traction {
            let node = |&vertex: &u32| space.nodes.of_vertex[vertex as usize];
            let facet = |f: usize| Loaded {
                corners: mesh.facet(f),
                nodes: space.nodes.on_facet(f).iter().map(node).collect(),
            };
            let of_side = facets.iter().filter(|&&f| mesh.facet_side[f] == side.0);
            add(formulas, of_side.map(|&f| facet(f)).collect(), &outside);
        }
        Self { space, acting }
    }

    /// The sums at the times, by one of the two rules.
    fn at(&self, times: [f64; 2], which: usize) -> [Sums; 2] {
        let space = self.space;
        let mut forces = times.map(|t| (t, [(); 2].map(|()| vec![0.0; space.nodes.len()])));
        for acting in &self.acting {
            self.add(acting, &acting.rules[which], &mut forces);
        }
        // v vanishes on Γ1.
        let free = space.mesh.dimension * space.nodes.free;
        forces.map(|(_, [mut forces, sizes])| {
            space.frames.without_support(&mut forces);
            Sums::of_sized(space, &forces[..free], &sizes[..free])
        })
    }

    /// Adds forces and the sizes of their terms, over nodes, at each time.
    fn add(&self, acting: &Acting<'_>, rule: &Rule, forces: &mut [(f64, [Vec<f64>; 2]); 2]) {
        let space = self.space;
        let simplices = acting.simplices.iter();
        let points: Vec<[f64; 3]> = simplices
            .flat_map(|simplex| rule.points.iter().map(|b| space.mesh.point(simplex.corners, b)))
            .collect();
        // Independent of the shape functions that assemble the loads.
        let (d, corners) = (space.mesh.dimension, rule.points[0].len());
        let of = if corners == d { Shapes::of_facet } else { Shapes::of_cell };
        let functions = of(space.element, d);
        let shapes: Vec<Vec<f64>> = rule.points.iter().map(|b| functions.at(b)).collect();
        let measures: Vec<f64> =
            acting.simplices.iter().map(|simplex| measure(space, simplex.corners)).collect();
        let mut formula = acting.formula.bind(&points);
        for (t, [forces, sizes]) in forces {
            let values = formula.values_at(*t, 0.0).swap_remove(0);
            let of_simplices = values.chunks_exact(rule.points.len());
            for ((simplex, measure), f) in acting.simplices.iter().zip(&measures).zip(of_simplices)
            {
                for ((weight, shapes), f) in rule.weights.iter().zip(&shapes).zip(f) {
                    for (shape, &node) in shapes.iter().zip(&simplex.nodes) {
                        let (at, share) = (d * node as usize, weight * measure * f * shape);
                        forces[at + acting.component] += share;
                        sizes[at + acting.component] += share.abs();
                    }
                }
            }
        }
    }
}

/// The facets that are faces of single cells, once each, however often they are listed.
fn boundary_facets(mesh: &Mesh) -> Vec<usize> {
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
    let mut once = |f: &usize| count.remove(&sorted(mesh.facet(*f))) == Some(1);
    (0..mesh.facet_side.len()).filter(|f| once(f)).collect()
}

/// Length, area or volume by the minors of the matrix of edges, in units of the longest, against over- and underflow. Gram's
/// determinant has their squares, and loses all digits of flat cells.
fn measure(space: &Discretization, simplex: &[u32]) -> f64 {
    let corner = |i: usize| space.mesh.vertex(simplex[i]);
    let mut edges = vec![[0.0; 3]; simplex.len() - 1];
    for (i, edge) in edges.iter_mut().enumerate() {
        let ends = corner(i + 1).iter().zip(corner(0));
        edge.iter_mut().zip(ends).for_each(|(value, (to, from))| *value = to - from);
    }
    let unit = edges.iter().flatten().fold(0.0f64, |most, value| most.max(value.abs()));
    let vectors: Vec<_> = edges.iter().map(|&edge| nalgebra::Vector3::from(edge) / unit).collect();
    let content = match vectors[..] {
        [a] => a.norm(),
        [a, b] => a.cross(&b).norm() / 2.0,
        [a, b, c] => a.cross(&b).dot(&c).abs() / 6.0,
        _ => f64::NAN,
    };
    content * unit.powi(vectors.len() as i32)
}
