//! What the rungs of ladders measure.

use super::rung::{
    Measure, Measured, Result, Rung, SceneAnswer, Unanswered, UnderTest, march, relative, set_up,
    solve,
};
use super::units::{Unitless, Units, difference};
use algebra::linalg::largest;
use exact::{ComplianceRule, InterpolatedOnMesh};
use fem::norms::strain_error;
use scene::setup::{MeshData, Setup, Subject, check_step_sizes};
use scene::{Scene, Source};
use vhi::{FixedPoint, StepSolver};

impl Rung {
    /// The number.
    ///
    /// # Errors
    /// What scene, setup or solver refuse.
    pub(super) fn measured(&self, under_test: &UnderTest<'_>) -> Result<Measured> {
        let Self { n, steps, value: p, text, other: (named, of_other, other), units, .. } = self;
        let run = |text: &String, steps: u32| solve(text.clone(), *n, steps, under_test.prepare);
        let with = |of: &dyn Fn(&SceneAnswer) -> f64| {
            run(text, *steps).map(|answer| Measured::of(of(&answer), &answer))
        };
        let beside = |of: &dyn Fn(&SceneAnswer, &SceneAnswer) -> f64| {
            let (found, known) = (run(text, *steps)?, run(other, *steps)?);
            Ok(Measured::of(of(&found, &known), &found))
        };
        let in_space = |n: u32| InSpace::run(text.clone(), n, under_test);
        let below_bound = |note: &dyn Fn(&InSpace) -> String| {
            let found = in_space(*n)?;
            Ok(Measured::of(found.ratio(1.0), &found.answer).noted(note(&found)))
        };
        match self.measure {
            Measure::Strain => with(&strain),
            Measure::Stress => with(&stress),
            Measure::Order => {
                let (coarse, fine) = (run(text, *steps)?, run(text, 8 * steps)?);
                Ok(Measured::of((strain(&coarse) / strain(&fine)).log2() / 3.0, &fine))
            }
            Measure::Nothing => {
                let size = |of: &SceneAnswer| largest(&of.displacement) + f64::from(of.iterations);
                Ok(with(&size)?.noted("u = 0 without an iteration"))
            }
            Measure::Displacement => beside(&|a, b| relative(&a.displacement, &b.displacement)),
            Measure::Scaled => beside(&|a, b| {
                let over = |u: &[f64], load: f64| u.iter().map(|u| u / load).collect::<Vec<_>>();
                relative(&over(&a.displacement, *p), &over(&b.displacement, *of_other))
            }),
            Measure::Distance => {
                Ok(beside(&SceneAnswer::distance)?.noted(format!("against g = {named}")))
            }
            Measure::Cea => below_bound(&|_| String::new()),
            Measure::CeaAndError => below_bound(&|found| format!("error {:.2e}", found.error)),
            Measure::CeaAndAngle => {
                let angle = (1.0 / p.max(1.0)).to_degrees();
                below_bound(&|_| format!("angles down to about {angle:.1e} degrees"))
            }
            Measure::Locking => {
                let (coarse, fine) = (in_space(n / 2)?, in_space(*n)?);
                let order = (coarse.error / fine.error).log2();
                let (before, error) = (n / 2, f64::from(*n) * fine.error / fine.size);
                let note =
                    format!("order {order:.2} at n = {before}…{n}, error {error:.1} h‖ε(u)‖");
                // The bound is the smaller of Céa's and ‖ε(u)‖, for u without divergence.
                let ratio = fine.ratio(*p).max(fine.error / fine.size);
                Ok(Measured::of(ratio, &fine.answer).noted(note))
            }
            Measure::Vertex => with(&|answer| {
                let least = answer.displacement.iter().copied().fold(0.0, f64::min);
                let most = answer.pressure.iter().copied().fold(0.0, f64::max);
                relative(&[least, most], &[-(p / 3.0).min(0.1), (p / 3.0 - 0.1).max(0.0)])
            }),
            Measure::Newton => in_line(text, *steps, &under_test.newton),
            Measure::Lambda => {
                let newton = under_test.newton;
                in_line(text, *steps, &FixedPoint { newton, ..FixedPoint::default() })
            }
            Measure::Plane => difference(&Unitless::PLANE, Units::new(*units), under_test),
            Measure::All => difference(&Unitless::ALL, Units::new(*units), under_test),
        }
    }
}

fn strain(answer: &SceneAnswer) -> f64 {
    // ‖ε(u)‖ of the profile is 0.5 at its largest; the displacement is 0.2 there.
    answer.errors.map_or(f64::NAN, |errors| errors[0]) / largest(&answer.displacement)
}

fn stress(answer: &SceneAnswer) -> f64 {
    // An L² norm on the unit square against the largest entry: at most √3 above, and of its order.
    answer.errors.map_or(f64::NAN, |errors| errors[2]) / largest(&answer.stress)
}

/// A run of a scene that does not depend on time, with what Céa's bound needs.
struct InSpace {
    answer: SceneAnswer,
    /// ‖ε(u - u_h)‖.
    error: f64,
    /// ‖ε(u - I_h u)‖.
    interpolation: f64,
    /// ‖ε(u)‖.
    size: f64,
}

impl InSpace {
    fn run(text: String, n: u32, under_test: &UnderTest<'_>) -> Result<Self> {
        let setup = set_up(text, under_test.prepare)?;
        let data = MeshData::new(&setup, n, None).map_err(Unanswered::refused)?;
        let answer = march(&setup, &data, 1)?;
        let error = answer.errors.map_or(f64::NAN, |errors| errors[0]);
        let truth = data.truth.moments(0.0).map_err(Unanswered::refused)?;
        let nothing = vec![0.0; data.space.nodes.len()];
        Ok(Self {
            answer,
            error,
            interpolation: strain_error(&data.space, &interpolant(&setup, &data)?, &truth),
            size: strain_error(&data.space, &nothing, &truth),
        })
    }

    /// The error over Céa's bound with the interpolant, for λ/μ_L.
    fn ratio(&self, lambda: f64) -> f64 {
        self.error / ((1.0 + lambda).sqrt() * self.interpolation)
    }
}

/// u at the nodes.
fn interpolant(setup: &Setup, data: &MeshData) -> Result<Vec<f64>> {
    let Some(exact) = &setup.exact else { return Ok(Vec::new()) };
    // The rule affects loads only.
    let rule = ComplianceRule::Vertex;
    let interpolant = InterpolatedOnMesh::new(exact.clone(), data.space.clone(), rule);
    Ok(interpolant.displacements(0.0).map_err(Unanswered::refused)?.0)
}

/// The relative error of a scene in ℝ after so many steps.
fn in_line(text: &str, steps: u32, solver: &dyn StepSolver) -> Result<Measured> {
    let source = Source::from_text("scalar.toml", text.to_owned());
    let scene = Scene::from_source(source).map_err(Unanswered::refused)?;
    let subject = Subject::new(scene).map_err(Unanswered::refused)?;
    // As every sweep does before it runs.
    check_step_sizes(&subject, &[steps]).map_err(Unanswered::refused)?;
    let Subject::Abstract(setup) = subject else { return Err(Unanswered::refused("no body")) };
    let run = setup.run(steps, solver).map_err(Unanswered::refused)?;
    let grid = setup.grid(steps);
    let size = grid.times().iter().map(|&t| setup.state(t).u[0].abs()).fold(0.0, f64::max);
    Ok(Measured { kkt: Some(run.info.kkt_residual), ..Measured::number(run.error / size) })
}
