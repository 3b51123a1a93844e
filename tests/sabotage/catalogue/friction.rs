//! Wrong friction: its bound, its direction, where it sticks.

use std::cell::RefCell;
use std::sync::Arc;

use algebra::linalg::FactorError;
use fem::contact::{CaseError, CaseInfo, Friction, Observer};
use scene::Side;
use scene::setup::{MeshData, Setup, side_numbers};
use vhi::law::{PiecewiseLinear, Potential};
use vhi::{
    BoundaryGraph, Coordinate, HistoryInequality, Newton, OpenInequality, Scratch, StepError,
    StepInequality, StepInfo, StepSolver, StepState,
};

use super::levels::unchecked;
use super::paths::on_sides;
use super::{Defect, Term, marched};

/// Newton's method with the laws of friction as they were at the end of the level before.
#[derive(Default)]
struct Late(RefCell<Option<Vec<Arc<dyn Potential>>>>);

impl StepSolver for Late {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        let BoundaryGraph { coordinates, potentials } = problem.graph();
        let graph = BoundaryGraph {
            coordinates: coordinates.clone(),
            potentials: self.0.take().unwrap_or_else(|| potentials.clone()),
        };
        let info = Newton::default().solve(&mut Before { problem, graph }, state, scratch)?;
        problem.residual(&state.u, &mut vec![0.0; state.u.len()]);
        *self.0.borrow_mut() = Some(problem.graph().potentials.clone());
        Ok(info)
    }
}

/// A level with the graphs of another.
struct Before<'p> {
    problem: &'p mut dyn OpenInequality,
    graph: BoundaryGraph,
}

impl StepInequality for Before<'_> {
    fn dofs(&self) -> usize {
        self.problem.dofs()
    }

    fn graph(&self) -> &BoundaryGraph {
        &self.graph
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        self.problem.residual(u, out);
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        self.problem.linearize(slopes, prescribed)
    }

    fn solve(&mut self, rhs: &mut [f64], forcing: f64) -> Result<(), FactorError> {
        self.problem.solve(rhs, forcing)
    }

    fn force_scale(&self, u: &[f64]) -> f64 {
        self.problem.force_scale(u)
    }
}

/// Newton's method with each component of a friction stress within S by itself: a box of stresses, not a ball.
struct Boxed;

impl StepSolver for Boxed {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        let BoundaryGraph { coordinates, potentials } = problem.graph();
        if coordinates.iter().all(|at| at.span == 1) {
            return Newton::default().solve(problem, state, scratch);
        }
        let alone = |at: &Coordinate| Coordinate { span: 1, ..*at };
        let coordinates = coordinates.iter().map(alone).collect();
        let graph = BoundaryGraph { coordinates, potentials: potentials.clone() };
        Newton::default().solve(&mut Before { problem, graph }, state, scratch)
    }
}

/// Newton's method with a Jacobian whose blocks of friction are wrong by factors: the slopes between the two unknowns of a
/// vector, and the pressures that its entries in u_ν are made of.
struct Misled {
    mixed: f64,
    pressures: f64,
}

impl StepSolver for Misled {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        let mut level = Tangent { problem, factors: self };
        Newton::default().solve(&mut level, state, scratch)
    }
}

/// A level with another Jacobian.
struct Tangent<'p> {
    problem: &'p mut dyn OpenInequality,
    factors: &'p Misled,
}

impl StepInequality for Tangent<'_> {
    fn dofs(&self) -> usize {
        self.problem.dofs()
    }

    fn graph(&self) -> &BoundaryGraph {
        self.problem.graph()
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        self.problem.residual(u, out);
    }

    fn take_pressures(&mut self, pressures: &[f64]) {
        let wrong: Vec<f64> =
            pressures.iter().map(|pressure| self.factors.pressures * pressure).collect();
        self.problem.take_pressures(&wrong);
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        let mut wrong = slopes.to_vec();
        let mixed = &mut wrong[prescribed.len()..];
        mixed.iter_mut().for_each(|slope| *slope *= self.factors.mixed);
        self.problem.linearize(&wrong, prescribed)
    }

    fn solve(&mut self, rhs: &mut [f64], forcing: f64) -> Result<(), FactorError> {
        self.problem.solve(rhs, forcing)
    }

    fn force_scale(&self, u: &[f64]) -> f64 {
        self.problem.force_scale(u)
    }
}

/// c(x, t) of the scene.
type Bound<'a> = &'a dyn Fn([f64; 3], f64) -> f64;

/// The setup with another c(x, t), made of the scene's, x and t.
fn bounded(setup: Setup, change: fn(Bound<'_>, [f64; 3], f64) -> f64) -> Setup {
    changed(setup, |friction| {
        let sound = friction.factor;
        Friction { factor: Box::new(move |x, t| change(&sound, x, t)), ..friction }
    })
}

/// What is wrong on a body in space alone: the scenes in the plane do not show it.
fn in_space(setup: Setup, change: impl Fn(Setup) -> Setup) -> Setup {
    if setup.scene.dimension == 3 { change(setup) } else { setup }
}

fn changed(mut setup: Setup, change: impl Fn(Friction) -> Friction) -> Setup {
    setup.model.friction = setup.model.friction.map(change);
    setup
}

/// A graph that pushes along with the slip, S at a slip of a tenth: the wrong sign, without the jump that would have no
/// solution.
fn pushing() -> Arc<dyn Potential> {
    let points = vec![(-0.1, 1.0), (0.0, 0.0), (0.1, -1.0)];
    Arc::new(PiecewiseLinear::new(points, 0.0, 0.0).expect("a graph"))
}

/// A graph that resists in proportion to the slip, without sticking.
fn viscous() -> Arc<dyn Potential> {
    let points = vec![(-0.1, -1.0), (0.0, 0.0), (0.1, 1.0)];
    Arc::new(PiecewiseLinear::new(points, 0.0, 0.0).expect("a graph"))
}

pub fn defects() -> Vec<Defect> {
    vec![
        Defect::of(Term::Friction, "friction pushes along with the slip", |setup| {
            changed(setup, |sound| Friction { graph: pushing(), ..sound })
        }),
        Defect::of(Term::Friction, "friction in proportion to the slip: nothing sticks", |setup| {
            changed(setup, |sound| Friction { graph: viscous(), ..sound })
        }),
        Defect::of(Term::Friction, "friction left out", |mut setup| {
            setup.model.friction = None;
            setup
        }),
        Defect::of(Term::Friction, "friction bound 10 % too large", |setup| {
            bounded(setup, |sound, x, t| 1.1 * sound(x, t))
        }),
        Defect::of(Term::Friction, "friction bound of t = 0 at all times", |setup| {
            bounded(setup, |sound, x, _| sound(x, 0.0))
        }),
        Defect::of(Term::Friction, "half of Γ3 sticks", |setup| {
            bounded(setup, |sound, x, t| sound(x, t) * if x[0] > 0.5 { 1e6 } else { 1.0 })
        }),
        Defect::of(Term::Friction, "no friction on every second vertex", |setup| {
            bounded(setup, |sound, x, t| {
                // Vertices at multiples of 1/16: the odd ones of the finest mesh of the suite.
                let odd = (16.0 * x[0]).round() as i64 % 2 == 1;
                if odd { 0.0 } else { sound(x, t) }
            })
        }),
        Defect::of(Term::Friction, "friction bound of the level before", |setup| {
            marched(setup, |setup, data, steps, observe| {
                data.march(setup, steps, &Late::default(), observe)
            })
        }),
        Defect::of(
            Term::Friction,
            "friction bound of the level before, KKT system not checked",
            |setup| {
                marched(setup, |setup, data, steps, observe| {
                    unchecked(setup, data, steps, observe, &Late::default())
                })
            },
        ),
    ]
}

/// The march with u = 0 on the first of these sides and u_ν = 0 on the second, where contact is bilateral.
fn held(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
    [clamped, across]: [&[Side]; 2],
) -> Result<CaseInfo, CaseError> {
    if !setup.body.domain.bilateral {
        return data.march(setup, steps, &Newton::default(), observe);
    }
    let [clamped, across] = [clamped, across].map(side_numbers);
    on_sides(setup, data, steps, observe, (data.space.mesh.clone(), [&clamped, &across]))
}

/// The graph of a bound that rises with the slip as fast as the sound one falls.
fn rising(sound: Friction) -> Friction {
    let (lo, hi) = sound.graph.subdifferential(0.0);
    let end = 2.0 * hi - sound.graph.subdifferential(0.1).0;
    let points = vec![(-0.1, -end), (0.0, lo), (0.0, hi), (0.1, end)];
    let graph = PiecewiseLinear::new(points, 0.0, 0.0).expect("a graph");
    Friction { graph: Arc::new(graph), ..sound }
}

/// Defects of vectors, and of bounds that follow the slip or p.
pub fn others() -> Vec<Defect> {
    vec![
        Defect::of(Term::Friction, "in space friction pushes along with the slip", |setup| {
            in_space(setup, |setup| changed(setup, |sound| Friction { graph: pushing(), ..sound }))
        }),
        Defect::of(Term::Friction, "in space half of Γ3 sticks", |setup| {
            in_space(setup, |setup| {
                bounded(setup, |sound, x, t| sound(x, t) * if x[2] > 0.5 { 1e6 } else { 1.0 })
            })
        }),
        Defect::of(Term::Friction, "in space every second vertex sticks", |setup| {
            in_space(setup, |setup| {
                bounded(setup, |sound, x, t| {
                    // Vertices at multiples of 1/2: the mesh of the suite.
                    let number = (2.0 * x[0]).round() + (2.0 * x[2]).round();
                    sound(x, t) * if number % 2.0 == 0.0 { 1e6 } else { 1.0 }
                })
            })
        }),
        Defect::of(Term::Friction, "friction bound of no slip at any slip", |setup| {
            changed(setup, |sound| {
                let (lo, hi) = sound.graph.subdifferential(0.0);
                let constant = PiecewiseLinear::new(vec![(0.0, lo), (0.0, hi)], 0.0, 0.0);
                Friction { graph: Arc::new(constant.expect("a graph")), ..sound }
            })
        }),
        Defect::of(
            Term::Friction,
            "slopes between the components of u_τ with the other sign in the Jacobian",
            |setup| {
                marched(setup, |setup, data, steps, observe| {
                    let misled = Misled { mixed: -1.0, pressures: 1.0 };
                    data.march(setup, steps, &misled, observe)
                })
            },
        ),
        Defect::of(
            Term::Friction,
            "slopes of friction in u_ν with the other sign in the Jacobian",
            |setup| {
                marched(setup, |setup, data, steps, observe| {
                    let misled = Misled { mixed: 1.0, pressures: -1.0 };
                    data.march(setup, steps, &misled, observe)
                })
            },
        ),
        Defect::of(Term::Friction, "a box of friction stresses in place of the ball", |setup| {
            marched(setup, |setup, data, steps, observe| data.march(setup, steps, &Boxed, observe))
        }),
        Defect::of(
            Term::Friction,
            "a box of friction stresses in place of the ball, KKT system not checked",
            |setup| {
                marched(setup, |setup, data, steps, observe| {
                    unchecked(setup, data, steps, observe, &Boxed)
                })
            },
        ),
        Defect::of(Term::Friction, "friction bound rises with the slip where it falls", |setup| {
            changed(setup, rising)
        }),
        Defect::of(Term::Gap, "bilateral contact opens", |setup| {
            marched(setup, |setup, data, steps, observe| {
                let domain = &setup.body.domain;
                held(setup, data, steps, observe, [&domain.clamped, &domain.symmetry])
            })
        }),
        Defect::of(Term::Gap, "bilateral contact holds the whole displacement", |setup| {
            marched(setup, |setup, data, steps, observe| {
                let domain = &setup.body.domain;
                let clamped = [&domain.clamped[..], &domain.contact].concat();
                held(setup, data, steps, observe, [&clamped, &domain.symmetry])
            })
        }),
        Defect::of(Term::Friction, "friction that follows p takes a constant bound", |setup| {
            changed(setup, |sound| match sound.follows_pressure {
                true => {
                    Friction { factor: Box::new(|_, _| 0.02), follows_pressure: false, ..sound }
                }
                false => sound,
            })
        }),
    ]
}
