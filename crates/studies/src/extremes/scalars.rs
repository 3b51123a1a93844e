//! Ladders of Problem 1 in ℝ: smallness m0 → 0±, and step sizes up to and beyond every bound of (3.4).

use super::rung::{Ladder, Measured, Relation, Result, Rung, Unanswered, UnderTest, power_of_ten};
use scene::setup::{AbstractSetup, Subject, check_step_sizes};
use scene::{Scene, Source};
use vhi::{FixedPoint, StepSolver};

/// Units of rounding in a solution of one level, before the condition number: 16 in the accepted residual
/// of forces whose sizes sum to at most 2 |A u| + |f| ≤ 3, and 2 of the data.
const UNITS: f64 = 50.0;

/// An abstract scene in ℝ: u + q ∫u + p(u) = f with p(r) = -alpha r. With q > 0 a step from 2 on has one solution,
/// which the constants of an abstract scene do not show: the scene says that it violates (3.4) on purpose.
fn scalar(q: f64, alpha: f64, horizon: f64, u: &str) -> String {
    let declared = if q > 0.0 && horizon >= 2.0 { "violates = [\"3.4\"]\n" } else { "" };
    let history = format!("[history]\nkernels = [{{ q = \"{q:?}\", matrix = [[1.0]] }}]\n");
    let trace = format!(
        "[[trace]]\nfunctional = [1.0]\nlaw = {{ kind = \"piecewise-linear\", points = [[-1.0, {alpha:?}], [1.0, {:?}]], slope_before = {:?}, slope_after = {:?} }}\n",
        -alpha, -alpha, -alpha
    );
    format!(
        "[scene]\nname = \"scalar\"\nkind = \"abstract\"\nquestion = \"How near is too near?\"\ndimension = 1\njudge = false\n{declared}[time]\nhorizon = {horizon:?}\n[operator]\nmatrix = [[1.0]]\n{}{}[exact]\nu = [\"{u}\"]\n",
        if q == 0.0 { "" } else { &history },
        if alpha == 0.0 { "" } else { &trace },
    )
}

/// The relative error of a scene in ℝ after so many steps.
fn error(text: String, steps: u32, solver: &dyn StepSolver) -> Result<Measured> {
    let scene =
        Scene::from_source(Source::from_text("scalar.toml", text)).map_err(Unanswered::refused)?;
    let setup = AbstractSetup::new(scene).map_err(Unanswered::refused)?;
    // As every sweep does before it runs.
    let subject = Subject::Abstract(Box::new(setup));
    check_step_sizes(&subject, &[steps]).map_err(Unanswered::refused)?;
    let Subject::Abstract(setup) = subject else { return Err(Unanswered::refused("no body")) };
    let run = setup.run(steps, solver).map_err(Unanswered::refused)?;
    let grid = setup.grid(steps);
    let size = grid.times().iter().map(|&t| setup.state(t).u[0].abs()).fold(0.0, f64::max);
    Ok(Measured { kkt: Some(run.info.kkt_residual), ..Measured::number(run.error / size) })
}

/// m0 = 1 - α from 0.1 to 1e-12, 0 and below. u = f/m0, so a rounding of the forces is divided by m0; at
/// m0 ≤ 0 (2.9) fails and the setup refuses.
pub(crate) fn smallness() -> Ladder {
    let rung = |m0: f64| {
        let expected = match m0 > 0.0 {
            true => Relation::AtMost(UNITS * f64::EPSILON / m0),
            false => Relation::Refused("(2.9)"),
        };
        Rung::new(format!("{m0:e}"), expected, move |under_test: &UnderTest<'_>| {
            let text = scalar(0.0, 1.0 - m0, 1.0, "1 + 0.5*sin(t)");
            error(text, 8, &under_test.newton)
        })
    };
    let above = [-1, -2, -4, -8, -12].map(power_of_ten);
    let below = [0.0, -1e-14, -1e-8, -0.1];
    Ladder {
        name: "smallness",
        parameter: "m0 = m_A − α_j c_j²",
        quantity: "error against the exact solution, relative",
        why: "(2.9): rounding of the forces over m0; no promise at m0 ≤ 0, so refused",
        rungs: above.into_iter().chain(below).map(rung).collect(),
    }
}

/// One step k from u linear in time, which the trapezoidal rule integrates exactly: what is left is rounding.
/// The step's equation is (1 + (k/2) q) u_1 = …, so the condition is (1 + k/2)/|1 + (k/2) q|.
fn one_step(k: f64, q: f64, expected: Relation, solver: Solver) -> Rung {
    Rung::new(step_in_words(k), expected, move |under_test| {
        let text = scalar(q, 0.0, k, &format!("1 + t/{k:?}"));
        error(text, 1, &*solver(under_test))
    })
}

/// Who solves a level.
type Solver = fn(&UnderTest<'_>) -> Box<dyn StepSolver>;

fn newton(under_test: &UnderTest<'_>) -> Box<dyn StepSolver> {
    Box::new(under_test.newton)
}

fn lambda(under_test: &UnderTest<'_>) -> Box<dyn StepSolver> {
    Box::new(FixedPoint { newton: under_test.newton, ..FixedPoint::default() })
}

/// A step beside the bound 2 by its distance from it.
pub(super) fn step_in_words(k: f64) -> String {
    match k {
        2.0 => "2".into(),
        _ if (k - 2.0).abs() < 0.01 => format!("2{:+.0e}", k - 2.0),
        _ if k < 100.0 => format!("{k}"),
        _ => format!("{k:e}"),
    }
}

fn conditioned(k: f64, q: f64) -> Relation {
    Relation::AtMost(UNITS * f64::EPSILON * (1.0 + 0.5 * k) / (1.0 + 0.5 * k * q).abs())
}

/// Newton's method with memory -1: (3.4) is k < 1, sharpened k < 2. From k = 2 on the level is not monotone, at
/// k = 2 itself every u solves it: refused, unless the scene says that it violates (3.4).
pub(crate) fn falling_memory() -> Ladder {
    let rung = |k: f64| {
        let expected = match k < 2.0 {
            true => conditioned(k, -1.0),
            false => Relation::Refused("one solution per step is guaranteed only"),
        };
        one_step(k, -1.0, expected, newton)
    };
    let steps = [0.5, 1.0, 1.9, 2.0 - 1e-6, 2.0 - 1e-9, 2.0, 2.0 + 1e-6, 4.0, 1e6];
    Ladder {
        name: "step-falling",
        parameter: "k with ℬ(0) = −m_A (bounds 1 and 2)",
        quantity: "error of one step, relative",
        why: "(3.4) and its sharpened form: rounding over m_A + (k/2)ℬ(0), which is 0 at k = 2",
        rungs: steps.map(rung).into(),
    }
}

/// Newton's method with memory +1: no bound in k.
pub(crate) fn rising_memory() -> Ladder {
    let steps = [0.5, 1.0, 2.0, 1e3, 1e6, 1e12, 1e100];
    Ladder {
        name: "step-rising",
        parameter: "k with ℬ(0) = +m_A (bounds 1 and 2)",
        quantity: "error of one step, relative",
        why: "m_A + (k/2)ℬ(0) > 0 at every k: beyond (3.4) Newton's method does not need it",
        rungs: steps.map(|k| one_step(k, 1.0, conditioned(k, 1.0), newton)).into(),
    }
}

/// Λ with memory +1: it contracts with factor k/2, so the stop at 1e-13 leaves k/(2 - k) 1e-13; from k = 2 on
/// it does not contract, and says so.
pub(crate) fn fixed_point() -> Ladder {
    let rung = |k: f64| {
        let expected = match k < 2.0 {
            true => Relation::AtMost(4e-13 * k / (2.0 - k) + UNITS * f64::EPSILON),
            false => Relation::Refused("Λ does not contract"),
        };
        one_step(k, 1.0, expected, lambda)
    };
    Ladder {
        name: "step-lambda",
        parameter: "k with ℬ(0) = +m_A, solved by Λ",
        quantity: "error of one step, relative",
        why: "(3.15), sharpened: Λ contracts with factor k/2",
        rungs: [0.1, 0.5, 1.0, 1.5, 1.9, 2.0, 2.2, 10.0].map(rung).into(),
    }
}
