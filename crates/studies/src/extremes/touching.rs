//! Ladders of contact: loads from nothing to 1e100, gaps of 0, ±∞ and next to nothing, one vertex, a short clamp.

use super::UnderTest;
use super::answer::{relative, solve};
use super::material::strain_error;
use super::rung::{Ladder, Measured, Relation, Rung, power_of_ten};
use super::scene_text::{SceneText, punch};
use algebra::linalg::largest;

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
        Rung::body(format!("1e-{e}"), expected, (text, 4, 1), strain_error)
    };
    Ladder {
        name: "clamp",
        parameter: "length of the clamped part of one edge",
        quantity: "error of a solution in V^h, relative",
        why: "rounding times the condition number, 1/δ² for the turn about the clamp",
        rungs: [1, 2, 3, 4, 6, 8, 11, 12].map(rung).into(),
    }
}
