//! Ladders of bodies: material, contact, the error in space, and what is next to nothing. First those of the projection,
//! μ and κ, and of u(t) through zero, on exact solutions in V^h.

use super::UnderTest;
use super::rung::{
    Ladder, Measured, Relation, Result, Rung, SceneAnswer, Unanswered, march, power_of_ten,
    relative, set_up, solve,
};
use super::scalars::step_in_words;
use algebra::linalg::largest;
use fem::norms::strain_error;
use formula::EvaluationPoint;
use scene::setup::{MeshData, Setup};

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
fn relative_strain_error(answer: &SceneAnswer) -> f64 {
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
        Rung::body(at, bound, projected(mu, 0.1), relative_strain_error)
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
            let ratio = relative_strain_error(&coarse) / relative_strain_error(&fine);
            Ok(Measured::of(ratio.log2() / 3.0, &fine))
        })
    };
    let on_level = |label: &str, at: f64| {
        let expected = Relation::AtMost(2.0 * ROUNDING);
        Rung::body(label, expected, (moving(at), 4, 8), relative_strain_error)
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
        Rung::body(step_in_words(k), expected, (remembering(-1.0, k), 8, 1), relative_strain_error)
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
        Rung::body(
            format!("1e{e}"),
            bound,
            (remembering(0.1, 1.0), 2, steps),
            relative_strain_error,
        )
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

// Ladders of contact: loads from nothing to 1e100, gaps of 0, ±∞ and next to nothing, one vertex, a short clamp.

/// Answers of which one is the other but for rounding: 16ε of the forces times a condition number of about
/// 10 n² = 160 on n = 4 make 6e-13.
const SAME: f64 = 1e-12;

/// The factor of the load on the scene `punch`. Below 1e-6 of it κ, the kinks of the law at 0.04 and the gap are out
/// of reach, and the rest is homogeneous of degree one: the answer is that at 1e-6 to scale, while the pressures that
/// the law gives to u_ν scale as well. At 1e20 and above, gap, law and κ are nothing beside the load: homogeneous again.
pub(crate) fn load() -> Ladder {
    let nothing = Rung::new("0", Relation::AtMost(0.0), |under_test| {
        let answer = solve(punch("0.10", 0.0), 4, 4, under_test.prepare)?;
        let size = largest(&answer.displacement) + f64::from(answer.iterations);
        Ok(Measured::of(size, &answer).noted("u = 0 without an iteration"))
    });
    let to_scale = |e: i32, of: i32| {
        Rung::new(format!("1e{e}"), Relation::AtMost(SAME), move |under_test: &UnderTest<'_>| {
            let found = solve(punch("0.10", power_of_ten(e)), 4, 4, under_test.prepare)?;
            let known = solve(punch("0.10", power_of_ten(of)), 4, 4, under_test.prepare)?;
            let scaled = |field: &[f64], e: i32| -> Vec<f64> {
                field.iter().map(|v| v / power_of_ten(e)).collect()
            };
            let distance =
                relative(&scaled(&found.displacement, e), &scaled(&known.displacement, of));
            Ok(Measured::of(distance, &found))
        })
    };
    let mut rungs = vec![nothing];
    rungs.extend([-150, -100, -50, -20].map(|e| to_scale(e, -6)));
    rungs.extend([50, 100, 140].map(|e| to_scale(e, 20)));
    Ladder {
        name: "load",
        parameter: "factor of the load",
        quantity: "difference to the answer at 1e-6 or 1e20, to scale",
        why: "homogeneous of degree one where κ, kinks and gap are out of reach, or are nothing",
        rungs,
    }
}

/// Gaps: 1e-300 is 0; 1e300 is none; none may be written `inf`; a gap of -∞ or NaN is refused.
pub(crate) fn gap() -> Ladder {
    const NOT_FINITE: &str = "`gap` is";
    let like = |gap: &'static str, other: &'static str| {
        Rung::new(gap, Relation::AtMost(SAME), move |under_test| {
            let found = solve(punch(gap, 1.0), 4, 4, under_test.prepare)?;
            let known = solve(punch(other, 1.0), 4, 4, under_test.prepare)?;
            Ok(Measured::of(found.distance(&known), &found).noted(format!("against g = {other}")))
        })
    };
    let refused = |gap: &'static str, saying: &'static str| {
        let run = (punch(gap, 1.0), 4, 4);
        Rung::body(gap, Relation::Refused(saying), run, |found| largest(&found.displacement))
    };
    Ladder {
        name: "gap",
        parameter: "g",
        quantity: "difference to the answer of the gap it stands for",
        why: "the constraint set depends on g continuously; g must be a number or +∞",
        rungs: vec![
            like("1e-300", "0"),
            like("-1e-99", "0"),
            like("5e-324", "0"),
            like("1e300", "inf"),
            like("inf", "1e10"),
            refused("-inf", "unknown name `inf`"),
            refused("-1/0", NOT_FINITE),
            refused("0/0", NOT_FINITE),
        ],
    }
}

/// One cell with one free vertex, on Γ3: the triangle (0,0), (1,0), (0,1), clamped on x = 0. With u = (p, q) at
/// (1,0): ½(λ + 2μ)p = 0, ½ μ q + ½ λ_c s = -c/6 for f0 = (0, -c); u_ν = -q ≤ g. For λ = μ = 1 and g = 0.1 it is
/// open for c ≤ 0.3, q = -c/3, and locked beyond, the pressure being c/3 - 0.1.
pub(crate) fn one_vertex() -> Ladder {
    let rung = |(label, c): (&str, f64)| {
        let bound = Relation::AtMost(16.0 * f64::EPSILON);
        let domain = "shape = \"polygon\"\nvertices = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]\nsides = [\"bottom\", \"slope\", \"left\"]\nclamped = [\"left\"]\ntraction = [\"slope\"]\ncontact = [\"bottom\"]\n".to_owned();
        let rest = format!(
            "[contact]\ngap = \"0.1\"\nlaw = {{ kind = \"none\" }}\n[loads]\nbody = [\"0\", \"{:?}\"]\n",
            -c
        );
        let text = SceneText { domain, ..SceneText::free(rest) }.text();
        let (q, pressure) = (-(c / 3.0).min(0.1), (c / 3.0 - 0.1).max(0.0));
        Rung::body(label, bound, (text, 1, 1), move |answer| {
            let least = answer.displacement.iter().copied().fold(0.0, f64::min);
            let most = answer.pressure.iter().copied().fold(0.0, f64::max);
            relative(&[least, most], &[q, pressure])
        })
    };
    let loads = [
        ("0.2", 0.2),
        ("0.3 - 1e-12", 0.3 - 1e-12),
        ("0.3 - 1e-16", 0.3 - 1e-16),
        ("0.3", 0.3),
        ("0.3 + 1e-16", 0.3 + 1e-16),
        ("0.3 + 1e-12", 0.3 + 1e-12),
        ("0.6", 0.6),
        ("1e10", 1e10),
    ];
    Ladder {
        name: "one-vertex",
        parameter: "load on one cell with one vertex in contact: open below 0.3, locked above",
        quantity: "error against the closed form, relative",
        why: "two unknowns, solved by hand: open, nearly touching, grazing, locked",
        rungs: loads.map(rung).into(),
    }
}

/// The unit square held on a part δ of one edge alone, with an exact solution in V^h: only rounding is left. A
/// clamp of length δ leaves a turn that strains of size 1/δ hold: the condition number grows like 1/δ². Strains at
/// the clamp round to ε/δ, which the separate KKT evaluation sees beside nodal forces of order one: from δ = 1e-6 on
/// it says so, and at 1e-8 1/δ² is 1/ε: no pivot is safe. Coarse triangles are flat below 1e-10, and points the same below 1e-11.
pub(crate) fn short_clamp() -> Ladder {
    let rung = |e: i32| {
        let expected = match e {
            ..=5 => Relation::AtMost(160.0 * 16.0 * f64::EPSILON * power_of_ten(2 * e)),
            6..=7 => Relation::Refused("KKT residual"),
            8..=10 => Relation::Refused("not positive definite"),
            11 => Relation::Refused("has no area"),
            _ => Relation::Refused("are the same point"),
        };
        let end = 0.5 + power_of_ten(-e);
        let domain = format!(
            "shape = \"polygon\"\nvertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [{end:?}, 1.0], [0.5, 1.0], [0.0, 1.0]]\nsides = [\"bottom\", \"right\", \"top-right\", \"clamp\", \"top-left\", \"left\"]\ntriangles = [[0, 1, 4], [1, 3, 4], [1, 2, 3], [0, 4, 5]]\nclamped = [\"clamp\"]\ntraction = [\"bottom\", \"right\", \"top-right\", \"top-left\", \"left\"]\n"
        );
        let rest =
            "[exact]\nu = [\"t*(1 - y)*(1 + x)\", \"0.3*t*(1 - y)*x\"]\ninterpolated = true\n";
        let text = SceneText { domain, ..SceneText::free(rest) }.text();
        Rung::body(format!("1e-{e}"), expected, (text, 4, 1), relative_strain_error)
    };
    Ladder {
        name: "clamp",
        parameter: "length of the clamped part of one edge",
        quantity: "error of a solution in V^h, relative",
        why: "rounding times the condition number, 1/δ² for the turn about the clamp",
        rungs: [1, 2, 3, 4, 6, 8, 11, 12].map(rung).into(),
    }
}

// Ladders of the error in space against Céa's bound: λ/μ_L, mesh size, aspect ratio.
//
// For a linear body the discrete solution is the nearest element of V^h in the energy norm, so for the nodal
// interpolant I_h u
//
// ```text
// 2μ_L ‖ε(u - u_h)‖² ≤ 2μ_L ‖ε(u - I_h u)‖² + λ ‖div(u - I_h u)‖² ≤ (2μ_L + dλ) ‖ε(u - I_h u)‖²,
// ```
//
// with |tr τ|² ≤ d |τ|².  With v = 0 in place of I_h u, and div u = 0: ‖ε(u - u_h)‖ ≤ ‖ε(u)‖.  No constant is
// hidden, whatever the shape of the cells: the V norm is that of strains.

/// Loads come from a rule, not from exact integrals: what that may add to the ratio.
const QUADRATURE: f64 = 0.01;

/// A run of a scene that does not depend on time, with what the bound needs.
pub(super) struct InSpace {
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
            interpolation: strain_error(&data.space, &interpolant(&setup, &data), &truth),
            size: strain_error(&data.space, &nothing, &truth),
        })
    }

    /// The error over Céa's bound with the interpolant.
    fn ratio(&self, [lambda, mu]: [f64; 2]) -> f64 {
        self.error / ((1.0 + lambda / mu).sqrt() * self.interpolation)
    }
}

/// u at the nodes.
fn interpolant(setup: &Setup, data: &MeshData) -> Vec<f64> {
    let Some(exact) = &setup.exact else { return Vec::new() };
    let (space, mut values) = (&data.space, vec![0.0; data.space.nodes.len()]);
    for (node, &vertex) in space.nodes.vertex.iter().enumerate() {
        let [x, y, z] = space.mesh.point(&[vertex], &[1.0]);
        let at = EvaluationPoint { x, y, z, ..EvaluationPoint::default() };
        for (i, &component) in exact.data.u.iter().enumerate() {
            values[2 * node + i] = exact.data.graph.evaluate(component, &at);
        }
    }
    values
}

/// A displacement without divergence, the curl of (1-y)² sin πx.
const SOLENOIDAL: &str = "[exact]\nu = [\"-2*(1 - y)*sin(pi*x)\", \"-pi*(1 - y)^2*cos(pi*x)\"]\n";

/// λ/μ_L from 1 to 1e8 on n = 16, 32: the bound at n = 32, and the order that is left there. P1 locks: V^h
/// has few fields without divergence, so the error stays near ‖ε(u)‖ until h is below √(μ_L/λ) or so. λ tr ε is a
/// sum of terms λ‖ε‖ that cancel, so it rounds to ελ‖ε‖ and more beside loads of order one: the KKT residual counts that.
pub(crate) fn locking() -> Ladder {
    let rung = |e: i32| {
        let lame = [power_of_ten(e), 1.0];
        let run = move |under_test: &UnderTest<'_>| {
            let text = SceneText { lame, ..SceneText::free(SOLENOIDAL) }.text();
            let [coarse, fine] = [16, 32].map(|n| InSpace::run(text.clone(), n, under_test));
            let (coarse, fine) = (coarse?, fine?);
            let order = (coarse.error / fine.error).log2();
            let note = format!(
                "order {order:.2} at n = 16…32, error {:.1} h‖ε(u)‖",
                32.0 * fine.error / fine.size
            );
            // The bound is the smaller of Céa's and ‖ε(u)‖, for u without divergence.
            let ratio = fine.ratio(lame).max(fine.error / fine.size);
            Ok(Measured::of(ratio, &fine.answer).noted(note))
        };
        Rung::new(format!("1e{e}"), Relation::AtMost(1.0 + QUADRATURE), run)
    };
    Ladder {
        name: "locking",
        parameter: "λ/μ_L",
        quantity: "error over Céa's bound",
        why: "Céa with the interpolant, factor √(1 + λ/μ_L), or with 0: ‖ε(u)‖ where div u = 0",
        rungs: [0, 1, 2, 4, 6, 8].map(rung).into(),
    }
}

/// A displacement without symmetries.
pub(super) const SMOOTH: &str =
    "[exact]\nu = [\"0.2*sin(pi*x)*(1 - y^2)\", \"-0.1*(1 + cos(pi*x))*(1 - y)*(1 + y/2)\"]\n";

/// A linear body with λ = μ_L below Céa's bound √2 ‖ε(u - I_h u)‖, with a remark on the run.
pub(super) fn below_bound(
    at: impl Into<String>,
    scene: &SceneText,
    n: u32,
    note: impl Fn(&InSpace) -> String + Send + Sync + 'static,
) -> Rung {
    let text = scene.text();
    Rung::new(at, Relation::AtMost(1.0 + QUADRATURE), move |under_test| {
        let found = InSpace::run(text.clone(), n, under_test)?;
        Ok(Measured::of(found.ratio([1.0, 1.0]), &found.answer).noted(note(&found)))
    })
}

/// h from one cell to 1/finest: between the best approximation and Céa's bound √2 ‖ε(u - I_h u)‖.
pub(crate) fn mesh_size(finest: u32) -> Ladder {
    let scene = SceneText::free(SMOOTH);
    let error = |found: &InSpace| format!("error {:.2e}", found.error);
    let rung =
        |n: u32| below_bound(n.to_string(), &scene, n, error).with_largest(scene.text(), n, 1);
    let ns = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512].into_iter().filter(|&n| n <= finest);
    Ladder {
        name: "mesh",
        parameter: "n = 1/h",
        quantity: "error over Céa's bound",
        why: "Céa with the interpolant, factor √(1 + λ/μ_L) = √2",
        rungs: ns.map(rung).collect(),
    }
}

/// A strip 1 × δ of cells with aspect ratio 1/δ, n = 8: the bound has no constant of shape.
pub(crate) fn aspect_ratio() -> Ladder {
    let rung = |e: i32| {
        let height = power_of_ten(-e);
        let domain = SceneText::parallelogram([0.0, height]);
        let exact = SMOOTH.replace('y', &format!("(y/{height:?})"));
        let scene = SceneText { domain, ..SceneText::free(exact) };
        below_bound(format!("1e{e}"), &scene, 8, |_| String::new())
    };
    Ladder {
        name: "aspect",
        parameter: "aspect ratio of the cells",
        quantity: "error over Céa's bound",
        why: "as mesh: no constant of shape in the norm of strains",
        rungs: [0, 1, 2, 3, 4, 6].map(rung).into(),
    }
}

// Ladders of what is next to nothing: subnormal numbers in a scene, and slivers.

/// One number of a scene is 1e-310, below the normal numbers: the answer is that without the term. Where the load is
/// the only force, nothing stands beside it: the displacements are 1e-310 as well, and are refused.
pub(crate) fn subnormal() -> Ladder {
    const LOAD: &str = "[loads]\nbody = [\"0\", \"-3*t*x\"]\n";
    type Body = fn(String) -> SceneText;
    let beside = |label: &'static str, body: Body, with: &'static str, without: &'static str| {
        Rung::new(label, Relation::AtMost(SAME), move |under_test| {
            let [found, known] = [with, without].map(|term| {
                let text = body(format!("{term}{LOAD}")).text();
                solve(text, 4, 4, under_test.prepare)
            });
            let (found, known) = (found?, known?);
            let distance = relative(&found.displacement, &known.displacement);
            Ok(Measured::of(distance, &found))
        })
    };
    let load = SceneText::free("[loads]\nbody = [\"0\", \"-1e-310*t*x\"]\n").text();
    let refused = Relation::Refused("state the scene in other units");
    let size = |answer: &SceneAnswer| largest(&answer.displacement);
    let alone = Rung::body("load alone", refused, (load, 4, 4), size);
    let (free, touching): (Body, Body) = (SceneText::free, SceneText::in_contact);
    let memory = "[material.memory]\nkernel = \"1e-310*exp(-t)\"\nlambda = 1.0\nmu = 1.0\n";
    let projection = "[material.projection]\nmu = 1e-310\nkappa = \"0.001\"\n";
    let law = "[contact]\nlaw = { kind = \"piecewise-linear\", points = [[0.0, 0.0], [1.0, 1e-310]], slope_before = 0.0, slope_after = 0.0 }\n";
    Ladder {
        name: "subnormal",
        parameter: "which number of a scene is 1e-310",
        quantity: "difference to the answer without that term, relative",
        why: "1e-310 of a term changes no digit, whether or not subnormal numbers are flushed to zero",
        rungs: vec![
            beside("memory", free, memory, ""),
            beside("projection", free, projection, ""),
            beside("law", touching, law, "[contact]\nlaw = { kind = \"none\" }\n"),
            beside(
                "gap",
                touching,
                "[contact]\ngap = \"1e-310\"\nlaw = { kind = \"none\" }\n",
                "[contact]\ngap = \"0\"\nlaw = { kind = \"none\" }\n",
            ),
            alone,
        ],
    }
}

/// A parallelogram with sides (1, 0) and (s, 1), n = 8: cells with two angles near 0 and one near π as s grows. The
/// interpolant is poor on such cells, and Céa's bound is in terms of it: it holds all the same.
pub(crate) fn sliver() -> Ladder {
    let rung = |(label, shear): (&str, f64)| {
        let domain = SceneText::parallelogram([shear, 1.0]);
        let exact = SMOOTH.replace("pi*x", &format!("pi*(x - {shear:?}*y)"));
        let scene = SceneText { domain, ..SceneText::free(exact) };
        let angle = (1.0 / shear.max(1.0)).to_degrees();
        let note = format!("angles down to about {angle:.1e} degrees");
        below_bound(label, &scene, 8, move |_| note.clone())
    };
    let shears = [("0", 0.0), ("1e0", 1.0), ("1e1", 1e1), ("1e2", 1e2), ("1e3", 1e3), ("1e4", 1e4)];
    Ladder {
        name: "sliver",
        parameter: "shear of a parallelogram: angles near 0 and π",
        quantity: "error over Céa's bound",
        why: "as mesh: no constant of shape, no condition on angles",
        rungs: shears.map(rung).into(),
    }
}

// The text of a body in contact, from its parts.

/// Parts of a scene file; what a ladder does not change stays at the unit square of unit material.
#[derive(Debug, Clone)]
pub(super) struct SceneText {
    pub(super) dimension: i32,
    /// `[domain]` without its heading.
    pub(super) domain: String,
    /// T.
    pub(super) horizon: f64,
    /// λ and μ_L.
    pub(super) lame: [f64; 2],
    /// Everything after `[material]`: memory, projection, contact, and `[exact]` or `[loads]`.
    pub(super) rest: String,
}

/// The unit square, clamped at the top.
const SQUARE: &str = "shape = \"rectangle\"\nsize = [1.0, 1.0]\nclamped = [\"top\"]\n";

impl SceneText {
    /// The unit square under tractions on all sides but the clamped one.
    pub(super) fn free(rest: impl Into<String>) -> Self {
        let domain = format!("{SQUARE}traction = [\"left\", \"right\", \"bottom\"]\n");
        Self { dimension: 2, domain, horizon: 1.0, lame: [1.0, 1.0], rest: rest.into() }
    }

    /// The unit square with contact at the bottom.
    pub(super) fn in_contact(rest: impl Into<String>) -> Self {
        let domain = format!("{SQUARE}traction = [\"left\", \"right\"]\ncontact = [\"bottom\"]\n");
        Self { domain, ..Self::free(rest) }
    }

    /// The domain of a parallelogram with the sides (1, 0) and `side`, free but for its clamped top.
    pub(super) fn parallelogram([x, y]: [f64; 2]) -> String {
        format!(
            "shape = \"polygon\"\nvertices = [[0.0, 0.0], [1.0, 0.0], [{:?}, {y:?}], [{x:?}, {y:?}]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\nclamped = [\"top\"]\ntraction = [\"left\", \"right\", \"bottom\"]\n",
            1.0 + x
        )
    }

    pub(super) fn text(&self) -> String {
        let [lambda, mu] = self.lame;
        format!(
            "[scene]\nname = \"extreme\"\nquestion = \"Does it work at the extreme?\"\ndimension = {}\njudge = false\n[domain]\n{}[time]\nhorizon = {:?}\n[material]\nlambda = {lambda:?}\nmu_L = {mu:?}\n{}",
            self.dimension, self.domain, self.horizon, self.rest
        )
    }
}

/// The block of the scene `punch`, every term active, with the given gap and factor of the load.
pub(super) fn punch(gap: &str, load: f64) -> String {
    SceneText::in_contact(format!(
        "[material.memory]\nkernel = \"-exp(-t)\"\nlambda = 0.25\nmu = 0.25\n[material.projection]\nmu = 1.0\nkappa = \"0.10 + 0.05*zeta\"\n[contact]\ngap = \"{gap}\"\nlaw = {{ kind = \"piecewise-linear\", points = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]], slope_before = 0.0, slope_after = 0.0 }}\n[loads]\nbody = [\"0\", \"{:?}*t*x\"]\n",
        -3.0 * load
    ))
    .text()
}
