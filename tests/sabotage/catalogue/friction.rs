//! Wrong friction: its bound, its direction, where it sticks.

use std::cell::RefCell;
use std::sync::Arc;

use algebra::linalg::FactorError;
use fem::contact::Friction;
use scene::Side;
use scene::setup::side_numbers;
use vhi::law::{PiecewiseLinear, Potential};
use vhi::{
    BoundaryGraph, Coordinate, HistoryInequality, Newton, OpenInequality, StepInequality,
    StepSolver,
};

use super::levels::unchecked;
use super::paths::on_sides;
use super::{Defect, Marched, Run, Term};
use crate::wrong::{as_level, solver};

/// Newton's method with the laws of friction as they were at the end of the level before.
fn late() -> impl StepSolver {
    let kept = RefCell::new(None);
    solver(move |problem, state, scratch| {
        let BoundaryGraph { coordinates, potentials } = problem.graph();
        let (coordinates, now) = (coordinates.clone(), potentials.clone());
        let graph = BoundaryGraph { coordinates, potentials: kept.take().unwrap_or(now) };
        let info = Newton::default().solve(&mut Level::with(problem, graph), state, scratch)?;
        problem.residual(&state.u, &mut vec![0.0; state.u.len()]);
        *kept.borrow_mut() = Some(problem.graph().potentials.clone());
        Ok(info)
    })
}

/// Newton's method with each component of a friction stress within S by itself: a box of stresses, not a ball.
fn boxed() -> impl StepSolver {
    solver(|problem, state, scratch| {
        let BoundaryGraph { coordinates, potentials } = problem.graph();
        if coordinates.iter().all(|at| at.span == 1) {
            return Newton::default().solve(problem, state, scratch);
        }
        let alone = |at: &Coordinate| Coordinate { span: 1, ..*at };
        let coordinates = coordinates.iter().map(alone).collect();
        let graph = BoundaryGraph { coordinates, potentials: potentials.clone() };
        Newton::default().solve(&mut Level::with(problem, graph), state, scratch)
    })
}

/// Newton's method with a Jacobian whose blocks of friction are wrong by factors.
fn misled(mixed: f64, pressures: f64) -> impl StepSolver {
    solver(move |problem, state, scratch| {
        let mut level = Level { problem, graph: None, mixed, pressures: Some(pressures) };
        Newton::default().solve(&mut level, state, scratch)
    })
}

/// A level with the graph of another, or with a Jacobian whose blocks of friction are wrong by factors: the slopes between the
/// two unknowns of a vector, and the pressures that its entries in u_ν are made of.
struct Level<'p> {
    problem: &'p mut dyn OpenInequality,
    graph: Option<BoundaryGraph>,
    mixed: f64,
    /// None leaves them out.
    pressures: Option<f64>,
}

impl<'p> Level<'p> {
    fn with(problem: &'p mut dyn OpenInequality, graph: BoundaryGraph) -> Self {
        Self { problem, graph: Some(graph), mixed: 1.0, pressures: None }
    }
}

impl StepInequality for Level<'_> {
    as_level!(problem: dofs residual solve force_scale);

    fn graph(&self) -> &BoundaryGraph {
        self.graph.as_ref().unwrap_or_else(|| self.problem.graph())
    }

    fn take_pressures(&mut self, pressures: &[f64]) {
        if let Some(factor) = self.pressures {
            let wrong: Vec<f64> = pressures.iter().map(|pressure| factor * pressure).collect();
            self.problem.take_pressures(&wrong);
        }
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        let mut wrong = slopes.to_vec();
        wrong[prescribed.len()..].iter_mut().for_each(|slope| *slope *= self.mixed);
        self.problem.linearize(&wrong, prescribed)
    }
}

/// c(x, t) of the scene.
type Bound<'a> = &'a dyn Fn([f64; 3], f64) -> f64;

/// Another c(x, t), made of the scene's, x and t.
fn bounded(name: &'static str, change: fn(Bound<'_>, [f64; 3], f64) -> f64) -> Defect {
    changed(name, move |friction| {
        let sound = friction.factor;
        Friction { factor: Box::new(move |x, t| change(&sound, x, t)), ..friction }
    })
}

/// A defect on a body in space alone: the scenes in the plane do not show it.
fn in_space(defect: Defect) -> Defect {
    let program = defect.program;
    defect.term.of(defect.name, move |setup| {
        if let (3, Some(program)) = (setup.scene.dimension, &program) {
            program(setup);
        }
    })
}

fn changed(
    name: &'static str,
    change: impl Fn(Friction) -> Friction + Send + Sync + 'static,
) -> Defect {
    Term::Friction.of(name, move |setup| {
        setup.model.friction = setup.model.friction.take().map(&change);
    })
}

/// A graph of slope ±1 through 0 to a slip of a tenth: it resists in proportion to the slip and does not stick, or it pushes
/// along, the wrong sign without the jump that would have no solution.
fn sloped(name: &'static str, end: f64) -> Defect {
    changed(name, move |sound| {
        let points = vec![(-0.1, -end), (0.0, 0.0), (0.1, end)];
        let graph = PiecewiseLinear::new(points, 0.0, 0.0).expect("a graph");
        Friction { graph: Arc::new(graph), ..sound }
    })
}

pub fn defects() -> Vec<Defect> {
    vec![
        sloped("friction pushes along with the slip", -1.0),
        sloped("friction in proportion to the slip: nothing sticks", 1.0),
        Term::Friction.of("friction left out", |setup| setup.model.friction = None),
        bounded("friction bound 10 % too large", |sound, x, t| 1.1 * sound(x, t)),
        bounded("friction bound of t = 0 at all times", |sound, x, _| sound(x, 0.0)),
        bounded("half of Γ3 sticks", |sound, x, t| {
            sound(x, t) * if x[0] > 0.5 { 1e6 } else { 1.0 }
        }),
        bounded("no friction on every second vertex", |sound, x, t| {
            // Vertices at multiples of 1/16: the odd ones of the finest mesh of the suite.
            let odd = (16.0 * x[0]).round() as i64 % 2 == 1;
            if odd { 0.0 } else { sound(x, t) }
        }),
        Term::Friction.run("friction bound of the level before", |run| run.by(&late())),
        Term::Friction.run("friction bound of the level before, KKT system not checked", |run| {
            unchecked(run, &late())
        }),
    ]
}

/// The march with u = 0 on the first of these sides and u_ν = 0 on the second, where contact is bilateral.
fn held(run: Run<'_>, clamped: &[Side]) -> Marched {
    let domain = &run.setup.body.domain;
    if !domain.bilateral {
        return run.sound();
    }
    let mesh = run.data.space.mesh.clone();
    on_sides(run, mesh, [&side_numbers(clamped), &side_numbers(&domain.symmetry)])
}

/// Defects of vectors, and of bounds that follow the slip or p.
pub fn others() -> Vec<Defect> {
    vec![
        in_space(sloped("in space friction pushes along with the slip", -1.0)),
        in_space(bounded("in space half of Γ3 sticks", |sound, x, t| {
            sound(x, t) * if x[2] > 0.5 { 1e6 } else { 1.0 }
        })),
        in_space(bounded("in space every second vertex sticks", |sound, x, t| {
            // Vertices at multiples of 1/2: the mesh of the suite.
            let number = (2.0 * x[0]).round() + (2.0 * x[2]).round();
            sound(x, t) * if number % 2.0 == 0.0 { 1e6 } else { 1.0 }
        })),
        changed("friction bound of no slip at any slip", |sound| {
            let (lo, hi) = sound.graph.subdifferential(0.0);
            let constant = PiecewiseLinear::new(vec![(0.0, lo), (0.0, hi)], 0.0, 0.0);
            Friction { graph: Arc::new(constant.expect("a graph")), ..sound }
        }),
        Term::Friction.run(
            "slopes between the components of u_τ with the other sign in the Jacobian",
            |run| run.by(&misled(-1.0, 1.0)),
        ),
        Term::Friction
            .run("slopes of friction in u_ν with the other sign in the Jacobian", |run| {
                run.by(&misled(1.0, -1.0))
            }),
        Term::Friction
            .run("a box of friction stresses in place of the ball", |run| run.by(&boxed())),
        Term::Friction.run(
            "a box of friction stresses in place of the ball, KKT system not checked",
            |run| unchecked(run, &boxed()),
        ),
        // As fast as the sound one falls.
        changed("friction bound rises with the slip where it falls", |sound| {
            let (lo, hi) = sound.graph.subdifferential(0.0);
            let end = 2.0 * hi - sound.graph.subdifferential(0.1).0;
            let points = vec![(-0.1, -end), (0.0, lo), (0.0, hi), (0.1, end)];
            let graph = PiecewiseLinear::new(points, 0.0, 0.0).expect("a graph");
            Friction { graph: Arc::new(graph), ..sound }
        }),
        Term::Gap.run("bilateral contact opens", |run| {
            let setup = run.setup;
            held(run, &setup.body.domain.clamped)
        }),
        Term::Gap.run("bilateral contact holds the whole displacement", |run| {
            let domain = &run.setup.body.domain;
            held(run, &[&domain.clamped[..], &domain.contact].concat())
        }),
        changed("friction that follows p takes a constant bound", |sound| {
            match sound.follows_pressure {
                true => {
                    Friction { factor: Box::new(|_, _| 0.02), follows_pressure: false, ..sound }
                }
                false => sound,
            }
        }),
    ]
}
