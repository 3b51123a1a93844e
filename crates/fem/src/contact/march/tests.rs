//! Source: a bar pressed against a springy floor in closed form: with λ = 0, width does not matter.
//! Goal: laws up to 1e9 times as stiff as the body are solved to rounding, by every way that a level has; a law that is
//!   wrong by a ten-thousandth is seen by the separate evaluation.
//! Mesh: unit square and cube, the top clamped, the floor pushed in by `DEPTH` at the bottom.

use std::sync::Arc;

use super::*;
use crate::contact::{Boundary, BoundaryRule, LoadError, StepView, kkt_residual};
use crate::mesh::{Family, Mesh, lattice};
use crate::space::Element;
use vhi::history::Trapezoid;
use vhi::law::{Curve, Curved, FourthOrder, Isotropic, PiecewiseLinear, Potential, TensorField};
use vhi::{InVolume, Newton, StepSolver};

const YOUNG: f64 = 10.0;
const DEPTH: f64 = 0.05;

struct Nothing;

impl Load for Nothing {
    fn assemble(&mut self, _: f64, out: &mut [f64]) -> Result<(), LoadError> {
        out.fill(0.0);
        Ok(())
    }
}

fn model(potential: Arc<dyn Potential>, rule: BoundaryRule) -> Model {
    let tensor = FourthOrder::Isotropic(Isotropic { lambda: 0.0, mu: 0.5 * YOUNG });
    let boundary = Boundary {
        sides: Vec::new(),
        potential,
        scale: None,
        gap: Box::new(|_, _| f64::INFINITY),
        shift: Box::new(|_| -DEPTH),
        rule,
    };
    Model {
        elasticity: TensorField::from(tensor),
        memory: Vec::new(),
        projection: None,
        boundary: vec![boundary],
        friction: None,
        time_rule: Box::new(Trapezoid),
    }
}

fn linear(stiffness: f64) -> Arc<dyn Potential> {
    Arc::new(PiecewiseLinear::new(vec![(0.0, 0.0)], 0.0, stiffness).unwrap())
}

/// p = c r^{3/2}.
fn power(coefficient: f64) -> Arc<dyn Potential> {
    let curve = Curve::Power { coefficient, exponent: 1.5, until: 1.0 };
    Arc::new(Curved::new(PiecewiseLinear::new(vec![(0.0, 0.0)], 0.0, 0.0).unwrap(), curve))
}

fn on(element: Element, mesh: Mesh) -> Discretization {
    let (top, bottom) = (mesh.side("top").unwrap(), mesh.side("bottom").unwrap());
    Discretization::of(element, mesh, &[top], &[bottom])
}

/// The overlap r = d - p/E with p = law(r), by bisection.
fn overlap(law: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, DEPTH);
    for _ in 0..200 {
        let r = 0.5 * (low + high);
        if law(r) < YOUNG * (DEPTH - r) { low = r } else { high = r }
    }
    0.5 * (low + high)
}

#[test]
fn stiff_laws_are_solved_to_rounding() {
    let plane = || lattice([1.0, 1.0], 4, Family::Structured);
    let solid = || lattice([1.0, 1.0, 1.0], 2, Family::Structured);
    let spaces = [
        (
            on(Element::P1, plane()),
            &[BoundaryRule::Vertex, BoundaryRule::Gauss, BoundaryRule::Exact][..],
        ),
        (on(Element::P2, plane()), &[BoundaryRule::Vertex]),
        (on(Element::P1, solid()), &[BoundaryRule::Vertex, BoundaryRule::Gauss]),
        (on(Element::P2, solid()), &[BoundaryRule::Vertex]),
    ];
    let grid = TimeGrid::uniform(1.0, 1);
    for c in [1e5, 1e7, 1e10] {
        let laws = [(linear(c), overlap(|r| c * r)), (power(c), overlap(|r| c * r * r.sqrt()))];
        for ((potential, overlap), (space, rules)) in
            laws.iter().flat_map(|law| spaces.iter().map(move |space| (law, space)))
        {
            for &rule in *rules {
                let newton = Newton::default();
                let ways: [(&str, &dyn StepSolver); 2] =
                    [("condensed", &newton), ("in the volume", &InVolume(newton))];
                for (way, solver) in ways {
                    let about = format!(
                        "{c:e} {rule:?} {:?} {} {way}",
                        space.element, space.mesh.dimension
                    );
                    let model = model(potential.clone(), rule);
                    let expected = overlap - DEPTH;
                    let mut off = 0.0f64;
                    let mut see = |view: &StepView<'_>| {
                        for (i, point) in space.trace.points.iter().enumerate() {
                            if point.weight > 0.0 {
                                off = off.max((space.trace.normal(i, view.u) - expected).abs());
                            }
                        }
                        Ok(())
                    };
                    let info = march(space, &model, &grid, &mut Nothing, solver, &mut see);
                    let info = info.unwrap_or_else(|error| panic!("{about}: {error}"));
                    // u is a double of size 0.05 that a few hundred sums of forces of its size hold to 1e-13.
                    assert!(off < 1e-13, "{about}: {off:e}");
                    // The floor of u_ν holds that, and is no larger than what matters.
                    assert!(info.floors.trace < 1e-11, "{about}: {:e}", info.floors.trace);
                }
            }
        }
    }
}

/// What rounding explains of a stiff law is left out of the balance; a law that is wrong by 1e-4 is not.
#[test]
fn the_separate_evaluation_sees_a_wrong_stiff_law() {
    let space = on(Element::P1, lattice([1.0, 1.0], 4, Family::Structured));
    let grid = TimeGrid::uniform(1.0, 1);
    for rule in [BoundaryRule::Gauss, BoundaryRule::Exact] {
        for c in [1e5, 1e8] {
            let mut worst = [0.0f64; 2];
            let (sound, wrong) = (model(linear(c), rule), model(linear(1.0001 * c), rule));
            let mut see = |view: &StepView<'_>| {
                for (worst, model) in worst.iter_mut().zip([&sound, &wrong]) {
                    *worst = worst.max(kkt_residual(&space, model, view, &vec![0.0; space.dofs()]));
                }
                Ok(())
            };
            march(&space, &sound, &grid, &mut Nothing, &Newton::default(), &mut see).unwrap();
            let [sound, wrong] = worst;
            assert!(sound < 1e-9 && wrong > 1e-5, "{rule:?} {c:e}: {sound:e} {wrong:e}");
        }
    }
}

/// A load that is not known from some time on.
struct Until(f64);

impl Load for Until {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        out.fill(t);
        if t < self.0 { Ok(()) } else { Err(LoadError::NoTruth { t }) }
    }
}

/// Loads are solved with ahead of their levels; one that fails is the fault of its own level, and those before it are shown.
#[test]
fn a_load_that_fails_ends_the_march_at_its_level() {
    let space = on(Element::P1, lattice([1.0, 1.0], 4, Family::Structured));
    let model = model(linear(1.0), BoundaryRule::Vertex);
    let grid = TimeGrid::uniform(1.0, 20);
    let newton = Newton::default();
    for failing in [0, 3, 8, 13, 20] {
        let mut shown = Vec::new();
        let mut see = |view: &StepView<'_>| {
            shown.push(view.n);
            Ok(())
        };
        let mut load = Until(grid.time(failing));
        let outcome = march(&space, &model, &grid, &mut load, &newton, &mut see);
        let wanted = LoadError::NoTruth { t: grid.time(failing) };
        assert!(matches!(outcome, Err(CaseError::Load(error)) if error == wanted), "{failing}");
        assert!(shown.into_iter().eq(0..failing), "{failing}");
    }
}
