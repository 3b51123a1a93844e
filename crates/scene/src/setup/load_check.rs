//! Checks total force and first moments of a load against an independent integral: a wrong load drives a sound solver
//! to a wrong answer without changing an order.
//!
//! The sums are Σ F_i m(x_i) over the unknowns, for each component and m = 1, x, y, z: total force, and first moments
//! including the moment. For P1 that is F(v) of v = m at free nodes and 0 on Γ1.

use std::collections::HashMap;
use std::sync::Arc;

use super::{Setup, side_numbers};
use crate::{Data, Scene, Side};
use exact::{Densities, Exact, ExactOnMesh, LoadForm, Truth, point_by_point};
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
            let (mesh, usual) =
                (&space.mesh, TruthRules::for_element(space.element, space.mesh.dimension));
            let other = match mesh.dimension {
                2 => [triangle_degree_8(), edge(7)],
                _ => [tetrahedron_product(4), triangle_degree_8()],
            };
            let facets = boundary_facets(mesh);
            let given = Given { scene: &setup.scene, space, body, traction, facets };
            let own = [usual.load, usual.traction];
            times.iter().try_for_each(|&t| {
                let [by_own, by_other] = [&own, &other].map(|rules| given.sums(rules, t));
                let rules = Sums::largest_difference(&by_own, &by_other);
                let sums = Sums::of(space, &truth.load(t)?);
                sums.compare(&by_other, BY_RULES * rules, t)
            })
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
    /// Of the forces that do work in V.
    fn of(space: &Discretization, forces: &[f64]) -> Self {
        let mut forces = forces.to_vec();
        space.frames.without_support(&mut forces);
        let d = space.mesh.dimension;
        let mut values = vec![0.0; d * (d + 1)];
        let mut sizes = values.clone();
        for (forces, &vertex) in forces.chunks_exact(d).zip(&space.nodes.vertex) {
            let place = space.mesh.vertex(vertex);
            for (component, force) in forces.iter().enumerate() {
                let first = (d + 1) * component;
                for (m, at) in (first..).zip([1.0].iter().chain(place)) {
                    values[m] += force * at;
                    sizes[m] += (force * at).abs();
                }
            }
        }
        Self { values, size: sizes.into_iter().fold(0.0, f64::max) }
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

/// f0 and f2 by their formulas, on cells and on facets of the boundary.
struct Given<'a> {
    scene: &'a Scene,
    space: &'a Discretization,
    body: &'a [Node],
    traction: &'a [(Side, Vec<Node>)],
    facets: Vec<usize>,
}

impl Given<'_> {
    /// The sums at a time by rules in cells and on facets, with shape functions that do not assemble the loads.
    fn sums(&self, rules: &[Rule; 2], t: f64) -> Sums {
        let mesh = &self.space.mesh;
        let at = |formulas: &[Node], simplices: &[&[u32]], rule: &Rule| -> Vec<f64> {
            let points = mesh.points_of(simplices, &rule.points);
            let horizon = self.scene.time.horizon;
            let program = Program::compile(&self.scene.formulas, formulas, horizon);
            point_by_point(&program.values(&points, t, 0.0))
        };
        let body = at(self.body, &mesh.cells(), &rules[0]);
        let count = mesh.dimension * rules[1].weights.len();
        let mut traction = vec![0.0; count * mesh.facet_side.len()];
        for (side, formulas) in self.traction {
            let mut of_side = self.facets.clone();
            of_side.retain(|&f| mesh.facet_side[f] == side.0);
            let corners: Vec<&[u32]> = of_side.iter().map(|&f| mesh.facet(f)).collect();
            for (f, values) in of_side.iter().zip(at(formulas, &corners, &rules[1]).chunks(count)) {
                traction[count * f..][..count].copy_from_slice(values);
            }
        }
        let densities = Densities { rules: rules.clone(), body, traction };
        Sums::of(self.space, &densities.assembled(self.space, false))
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
