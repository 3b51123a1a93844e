//! Ladders of what is next to nothing: subnormal numbers in a scene, slivers, and memories whose parts cancel.

use super::answer::{SceneAnswer, relative, solve};
use super::history::opposed;
use super::rung::{Ladder, Measured, Relation, Rung};
use super::scene_text::SceneText;
use super::space_error::{SMOOTH, below_bound};
use algebra::linalg::largest;

/// A term that is 1e-310 of what it stands beside changes nothing that a double can hold; the answers agree but for
/// the rounding of two ways of solving: 16ε of the forces times a condition number of about 10 n² = 160 on n = 4.
const SAME: f64 = 1e-12;

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

/// A kernel e^{-t} - w e^{-2t} that changes its sign at t = ln w, w from 0.5 to 1e6: rounding is that of both parts,
/// whatever is left of their difference.
pub(crate) fn sign_change() -> Ladder {
    let weights = [0.5, 1.0, 2.0, 1e3, 1e6];
    Ladder {
        name: "sign-change",
        parameter: "w of the kernel e^{−t} − w e^{−2t}, N = 1000",
        quantity: "recursion − sum in full, over the sum of magnitudes",
        why: "rounding of either part, as in relaxation; a difference of the two adds ε/2",
        rungs: weights.map(|weight| opposed(weight, 1e-3, 1000)).into(),
    }
}
