//! Ladders of the projection, μ and κ, and of u(t) through zero, on exact solutions in V^h.

use super::answer::{SceneAnswer, solve};
use super::rung::{Ladder, Measured, Relation, Rung, power_of_ten};
use super::scene_text::SceneText;
use super::small::step_in_words;
use algebra::linalg::largest;

/// A solution in V^h without history has no error but the accepted residual, 16ε of the forces, times
/// ‖K⁻¹‖‖K‖: about 10 n² = 640 on n = 8, and more by the largest over the smallest modulus.
const ROUNDING: f64 = 16.0 * f64::EPSILON * 640.0;

const PROFILE: &str =
    "\"{f}*0.2*sin(pi*x)*(1 - y^2)\", \"-{f}*0.1*(1 + cos(pi*x))*(1 - y)*(1 + y/2)\"";

fn in_space(projection: &str, course: &str) -> String {
    let profile = PROFILE.replace("{f}", course);
    SceneText::free(format!("{projection}[exact]\nu = [{profile}]\ninterpolated = true\n")).text()
}

/// The largest error of the stresses relative to them.
fn stress_error(answer: &SceneAnswer) -> f64 {
    // An L² norm on the unit square against the largest entry: at most √3 above, and of its order.
    answer.errors.map_or(f64::NAN, |errors| errors[2]) / largest(&answer.stress)
}

/// The largest error of the strains relative to the displacements.
pub(super) fn strain_error(answer: &SceneAnswer) -> f64 {
    // ‖ε(u)‖ of the profile is 0.5 at its largest; the displacement is 0.2 there.
    answer.errors.map_or(f64::NAN, |errors| errors[0]) / largest(&answer.displacement)
}

/// The run of a body with a projection.
fn projected(mu: f64, kappa: f64) -> (String, u32, u32) {
    let projection = format!("[material.projection]\nmu = {mu:?}\nkappa = \"{kappa:?}\"\n");
    (in_space(&projection, "(0.2 + t)"), 8, 4)
}

/// μ from 0 to 1e6 μ_L with κ = 0.1.
pub(crate) fn projection() -> Ladder {
    let rung = |at: &str, mu: f64| {
        let bound = Relation::AtMost(ROUNDING * (1.0 + mu));
        Rung::body(at, bound, projected(mu, 0.1), strain_error)
    };
    let mut rungs = vec![rung("0", 0.0)];
    rungs.extend((-6..=6).step_by(2).map(|e| rung(&format!("1e{e}"), power_of_ten(e))));
    Ladder {
        name: "projection",
        parameter: "μ/μ_L of the projection",
        quantity: "error of a solution in V^h, relative",
        why: "no error but rounding, times the condition number, which grows like 1 + μ/μ_L",
        rungs,
    }
}

/// κ from 1e-300 (nothing is below it) to 1e300 (everything is).
pub(crate) fn yield_limit() -> Ladder {
    let rung = |e: i32| {
        let bound = Relation::AtMost(2.0 * ROUNDING);
        Rung::body(format!("1e{e}"), bound, projected(1.0, power_of_ten(e)), stress_error)
    };
    Ladder {
        name: "kappa",
        parameter: "κ",
        quantity: "error of the stress of a solution in V^h, relative",
        why: "no error but rounding, times the condition number; κ = 0+ and ∞ are linear bodies",
        rungs: [-300, -150, -10, -3, -1, 0, 3, 10, 150, 300].map(rung).into(),
    }
}

/// The part of t* in its step, and what the trapezoidal rule then adds to ∫|t - t*|: a(1 - a) k².
fn kink(at: f64, steps: u32) -> f64 {
    let part = (at * f64::from(steps)).fract();
    part * (1.0 - part)
}

/// What the next order, k³ and more, may do to the slope from N = 8 on.
const NEXT_ORDER: f64 = 0.15;

/// u(t) = (t - t*) U: ‖ε(u)‖ has a kink at t*, where u = 0 as well. The rule is exact on both sides of a level t*;
/// with t* inside a step ζ is wrong by a(1 - a) k² ‖ε(U)‖, a being its place in the step: order 2 in the mean (the
/// BV lemma), and between N = 8 and N = 64 the slope 2 + log2(a(1 - a) of the first / of the second)/3.
pub(crate) fn through_zero() -> Ladder {
    let moving = |at: f64| {
        let projection = "[material.projection]\nmu = 1.0\nkappa = \"0.02 + 0.5*zeta\"\n";
        in_space(projection, &format!("(t - {at:?})"))
    };
    let between = |label: &str, at: f64| {
        let slope = 2.0 + (kink(at, 8) / kink(at, 64)).log2() / 3.0;
        let expected = Relation::Within([slope - NEXT_ORDER, slope + NEXT_ORDER]);
        Rung::new(label, expected, move |under_test| {
            let [coarse, fine] = [8, 64].map(|n| solve(moving(at), 4, n, under_test.prepare));
            let (coarse, fine) = (coarse?, fine?);
            let ratio = strain_error(&coarse) / strain_error(&fine);
            Ok(Measured::of(ratio.log2() / 3.0, &fine))
        })
    };
    let on_level = |label: &str, at: f64| {
        let expected = Relation::AtMost(2.0 * ROUNDING);
        Rung::body(label, expected, (moving(at), 4, 8), strain_error)
    };
    Ladder {
        name: "through-zero",
        parameter: "t* with u(t*) = 0",
        quantity: "error where t* is a level, else order in k",
        why: "the rule is exact for |t − t*| on levels, else wrong by a(1 − a)k², a the place in the step",
        rungs: vec![
            on_level("0", 0.0),
            on_level("1/2", 0.5),
            between("1/3", 1.0 / 3.0),
            between("0.3", 0.3),
            between("0.51", 0.51),
        ],
    }
}

/// One step k of a body with ℬ = -𝒜, u linear in time and in V^h: the trapezoidal rule is exact, the condition
/// number 1/|1 - k/2| is left. From k = 2 on K(1 - k/2) is not positive definite, and the factorization says so.
pub(crate) fn body_step() -> Ladder {
    let rung = |k: f64| {
        let expected = match k < 2.0 {
            true => Relation::AtMost(ROUNDING / (1.0 - 0.5 * k)),
            false => Relation::Refused("not positive definite"),
        };
        Rung::body(step_in_words(k), expected, (remembering(-1.0, k), 8, 1), strain_error)
    };
    Ladder {
        name: "step-body",
        parameter: "k of a body with ℬ(0) = −𝒜",
        quantity: "error of a solution in V^h, relative",
        why: "(3.4), sharpened: 𝒜 + (k/2)ℬ(0) = (1 − k/2)𝒜",
        rungs: [0.5, 1.0, 1.9, 2.0 - 1e-3, 2.0 - 1e-6, 2.0, 2.0 + 1e-6, 4.0, 1e6].map(rung).into(),
    }
}

/// N steps of a body with ℬ = 𝒜/10, without fading, on n = 2: the rule is exact for u linear in time, and a step of
/// the recursion rounds three times.
pub(crate) fn long_march(most: i32) -> Ladder {
    let rung = |e: i32| {
        let steps = 10u32.pow(e as u32);
        let bound = Relation::AtMost(ROUNDING + 3.0 * f64::EPSILON * f64::from(steps));
        Rung::body(format!("1e{e}"), bound, (remembering(0.1, 1.0), 2, steps), strain_error)
            .with_largest(remembering(0.1, 1.0), 2, steps)
    };
    Ladder {
        name: "march",
        parameter: "number of steps of a body on n = 2",
        quantity: "error of a solution in V^h, relative",
        why: "condition number, and 3ε a step of the recursion",
        rungs: (1..=most).map(rung).collect(),
    }
}

/// The scene with memory b(t) = factor, ℬ₀ = 𝒜.
fn remembering(factor: f64, horizon: f64) -> String {
    let memory = format!("[material.memory]\nkernel = \"{factor:?}\"\nlambda = 1.0\nmu = 1.0\n");
    let profile = PROFILE.replace("{f}", &format!("(1 + t/{horizon:?})"));
    let rest = format!("{memory}[exact]\nu = [{profile}]\ninterpolated = true\n");
    SceneText { horizon, ..SceneText::free(rest) }.text()
}
