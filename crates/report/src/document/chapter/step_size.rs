//! The bound (3.4): in numbers that follow from the data of every scene, and as measured by `sweep bound`.

use super::{Pen, digits, held, id, number, outcome, sides};
use crate::document::{Equation, Run, Tone};
use crate::studies::theory::{Bound, Rung};
use crate::studies::{Number, Studies};
use crate::{SceneSummary, StepLimits};

/// Hypotheses without which there is no bound: (2.9) and κ Lipschitz, by their names in scene files.
const NEEDED: [&str; 2] = ["2.9", "5.1"];

pub(super) fn write(pen: &mut Pen<'_>, studies: &mut Studies) {
    pen.chapter(
        "chapter-step-size",
        "Step size: the bound (3.4)",
        "A step of the scheme has one solution, and the map Λ, which freezes the last slot of the history and solves, contracts, \
         if k is below the bound (3.4). The bound is sufficient only. Four numbers say how far:",
    );
    pen.formulas(formulas());
    pen.words(
        "1, the bound (3.4), with the norm that the paper takes of ℬ and with the operator norm; 2, sharpened: the last slot has the weight k/2, \
         and each part of the history its own factor; 3, the k at which Λ stops contracting, as measured; 4, the k below which each \
         step is a strongly monotone problem (solvable), and the k at which its solution ends, as followed. 1, 2 and 4 follow from the data of a scene.",
    );
    if studies.bounds.is_empty() {
        pen.absent("There is no measured contraction factor", "bound SCENE");
    }
    pen.section("chapter-step-sizes", "Bounds of all scenes");
    let rows: Vec<Vec<Run>> =
        pen.report.scenes.iter().map(|scene| row(scene, pen, &studies.bounds)).collect();
    pen.table(
        "Step sizes: bounds on k, and the largest k of the records.",
        &[
            "scene",
            ">m0",
            ">(3.4), paper's norm",
            ">(3.4)",
            ">sharpened",
            ">Λ measured",
            ">solvable",
            ">largest k",
            "which is",
        ],
        rows,
    );
    for bound in std::mem::take(&mut studies.bounds) {
        study(pen, &bound);
        pen.figures(studies.take(&bound.scene, "-bound"));
    }
    pen.figures(studies.rest_of("-bound"));
}

fn formulas() -> Vec<Equation> {
    vec![
        Equation::new(
            "m0 = m_A − α_φ − α_j c_j² > 0",
            "m_0 = m_A - alpha_phi - alpha_j c_j^2 > 0",
            "(2.9)",
        ),
        Equation::new("k β_φ ‖R‖ ‖q‖ < m0", "k beta_phi norm(R) thin norm(q) < m_0", "(3.4)"),
        Equation::new(
            "‖Λη − Λη′‖ ≤ (k β_φ ‖R‖ ‖q‖ / m0) ‖η − η′‖",
            "norm(Lambda eta - Lambda eta') <= (k beta_phi norm(R) thin norm(q))/m_0 norm(eta - eta')",
            "(3.15)",
        ),
    ]
}

/// Nothing is violated, and there was something that could have been.
pub(super) fn holds(bound: &Bound) -> bool {
    let samples = bound.samples.iter().all(|sample| sample.holds);
    bound.violations.is_empty() && samples && !bound.rungs.is_empty()
}

fn row(scene: &SceneSummary, pen: &Pen<'_>, studies: &[Bound]) -> Vec<Run> {
    let own = pen.report.records.iter().filter(|record| record.scene == scene.name);
    let largest = own.map(|record| record.k).reduce(f64::max);
    let study = studies.iter().find(|bound| bound.scene == scene.name);
    let measured = study.map_or_else(
        || Run::plain("–"),
        |bound| Run::plain(followed(bound, bound.thresholds.radius_one)).to(target(bound)),
    );
    let link = |text: &str| Run::plain(text).to(format!("#{}", pen.report.stem(scene)));
    let Some(limits) = scene.step else {
        let mut cells = vec![link(&scene.name)];
        cells.extend((0..4).map(|_| Run::plain("–")));
        cells.extend([measured, Run::plain("–"), number(largest), Run::plain("not computed")]);
        return cells;
    };
    let broken = scene.violates.iter().find(|name| NEEDED.contains(&name.as_str()));
    let limit = |k: f64| match broken {
        Some(_) => Run::plain("–"),
        None => Run::plain(up_to(Some(k).filter(|k| !k.is_infinite()))),
    };
    let standing = match broken {
        Some(name) => Run::plain(format!("without a bound: ({name}) is broken")),
        None => standing(&limits, largest),
    };
    vec![
        link(&scene.name),
        number(Some(limits.m0)),
        limit(limits.paper),
        limit(limits.theorem),
        limit(limits.sharpened),
        measured,
        limit(limits.solvable),
        number(largest),
        standing,
    ]
}

/// Where a factor reaches one, if the solution was followed in k.
fn followed(bound: &Bound, bracket: Option<[Number; 2]>) -> String {
    match bound.thresholds.not_followed {
        Some(_) => "–".into(),
        None => crossing(bracket),
    }
}

fn target(bound: &Bound) -> String {
    format!("#{}", id("bound", &bound.scene))
}

/// Where the largest step of the records stands.
fn standing(limits: &StepLimits, largest: Number) -> Run {
    match largest {
        None => Run::plain("–"),
        Some(k) if k < limits.theorem => Run::plain("within (3.4)"),
        Some(k) if k < limits.solvable => Run::plain("beyond (3.4), one solution"),
        // NaN limits end here as well.
        Some(_) => Run::of("not guaranteed", Tone::Strong),
    }
}

/// k below which something holds.
fn up_to(limit: Number) -> String {
    limit.map_or_else(|| "every k".into(), digits)
}

/// Where a factor reaches one.
fn crossing(bracket: Option<[Number; 2]>) -> String {
    match bracket {
        None => "every k".into(),
        Some([Some(low), Some(high)]) if low > 0.0 => digits(0.5 * (low + high)),
        Some([Some(low), None]) => format!("> {}", digits(low)),
        Some([_, Some(high)]) => format!("< {}", digits(high)),
        Some([None, None]) => "–".into(),
    }
}

fn study(pen: &mut Pen<'_>, bound: &Bound) {
    pen.section(&id("bound", &bound.scene), &format!("The bound measured: {}", bound.scene));
    pen.of_this_text(&bound.scene, &bound.fingerprint);
    let mesh = bound.n.map_or_else(String::new, |n| format!("n = {n}, "));
    pen.words(&format!(
        "A run with {mesh}N = {}; at its level {} (t = {}), where the factor is largest, the last step is taken again with other k.",
        bound.steps,
        bound.worst.level,
        digits(bound.worst.t)
    ));
    let violated = bound.violations.iter().map(|v| {
        let at = v.k.map_or_else(String::new, |k| format!("k = {}: ", digits(k)));
        format!("{at}{}: {}", v.what, sides(v.left, v.right))
    });
    let exceeded = bound.samples.iter().filter(|sample| !sample.holds).map(|s| {
        format!("{}, declared and needed by a sample: {}", s.what, sides(s.declared, s.needed))
    });
    let all =
        "Every inequality between measured and proved factors holds, and every declared constant.";
    outcome(pen, holds(bound), all, violated.chain(exceeded).collect());
    thresholds(pen, bound);
    pen.table(
        format!(
            "{}: contraction factor of Λ for a last step of size k, bounds, and what solves it.",
            bound.scene
        ),
        &[
            ">k",
            ">spectral radius",
            ">‖DΛ‖",
            ">sharpened",
            ">(3.15)",
            ">paper's norm",
            "Newton",
            "Λ",
        ],
        bound.rungs.iter().map(rung).collect(),
    );
    let constant = |c: &crate::studies::theory::Constant| {
        let side = if c.safe { "safe side" } else { "no bound" };
        vec![
            Run::plain(&*c.name),
            number(c.value),
            Run::plain(c.uncertainty.map_or_else(|| "–".into(), |off| format!("{off:.1e}"))),
            Run::plain(format!("{}, {side}", c.how)),
            Run::plain(&*c.note),
        ]
    };
    pen.table(
        format!(
            "{}: constants, how each was obtained, and whether the true one is certainly on the safe side; those of single meshes are in {0}-bound.json.",
            bound.scene
        ),
        &["constant", ">value", ">±", "how", "note"],
        bound.constants.iter().filter(|c| !c.name.contains(", n = ")).map(constant).collect(),
    );
    let sample = |s: &crate::studies::theory::Sampled| {
        vec![Run::plain(&*s.what), number(s.declared), number(s.needed), held(s.holds)]
    };
    pen.table(
        format!("{}: declared constants beside the largest that a sample needs.", bound.scene),
        &["constant", ">declared", ">needed", "so it"],
        bound.samples.iter().map(sample).collect(),
    );
}

fn thresholds(pen: &mut Pen<'_>, bound: &Bound) {
    let t = &bound.thresholds;
    let row = |what: &str, k: String| vec![Run::plain(what), Run::plain(k)];
    let mut rows = vec![
        row("1: (3.4), the paper's norm of ℬ", up_to(t.paper_norm)),
        row("1: (3.4), operator norm", up_to(t.theorem)),
        row("2: sharpened", up_to(t.sharpened)),
        row("3: measured, ‖DΛ‖ = 1", followed(bound, t.norm_one)),
        row("3: measured, spectral radius of DΛ = 1", followed(bound, t.radius_one)),
        row("4: one solution guaranteed, by monotonicity", up_to(t.solvable)),
    ];
    let last = bound.rungs.last().map_or_else(|| "–".into(), |rung| digits(rung.k));
    rows.push(match (t.loss, &t.loss_reason) {
        _ if t.not_followed.is_some() => row("4: the solution was not followed in k", "–".into()),
        (Some(bracket), reason) => {
            let why = reason.as_deref().unwrap_or("no reason given");
            row(&format!("4: the solution followed in k ends: {why}"), crossing(Some(bracket)))
        }
        (None, _) => row("4: the solution followed in k does not end", format!("> {last}")),
    });
    if let Some(ratio) = bound.ratio {
        rows.push(row("3 over 1, the paper's norm", digits(ratio)));
    }
    pen.table(
        format!("{}: the bound in four numbers, k below each.", bound.scene),
        &["number", ">k"],
        rows,
    );
}

fn rung(rung: &Rung) -> Vec<Run> {
    let solved = |value: &serde_json::Value| match value.as_u64() {
        Some(iterations) => Run::plain(format!("{iterations} it.")),
        None => Run::plain("fails"),
    };
    vec![
        number(Some(rung.k)),
        number(rung.radius),
        number(rung.norm),
        number(rung.sharpened),
        number(rung.theorem),
        number(rung.paper_norm),
        solved(&rung.newton),
        solved(&rung.fixed_point),
    ]
}
