//! What to check in an external solver if a verdict does not pass; a finer case seldom helps.

use fem::space::Element;
use judge::verdict::{Decision, Variable, Verdict};
use scene::Scene;
use scene::setup::Setup;

/// What becomes of the pressures of a solver beside the verdicts: `handed` over where no claim needs them, or claims that
/// need them where they are not. A wrong pressure must not pass for one that was judged.
pub fn on_pressures(scene: &Scene, handed: bool) -> Option<String> {
    let needing = scene.predicts.iter().filter(|claim| claim.norm.wants_pressure()).count();
    let name = &scene.name;
    match (needing, handed) {
        (0, true) => Some(format!(
            "no claim of {name} needs the pressures: their errors are in cases.csv, and no verdict judges them; signorini, state-instant and affine-graded do"
        )),
        (0, false) | (_, true) => None,
        (1, false) => Some(format!("one claim of {name} needs pressures: --pressure judges it")),
        (more, false) => {
            Some(format!("{more} claims of {name} need pressures: --pressure judges them"))
        }
    }
}

/// Prefixes the reasons of open or failed verdicts on an external solver with what to check in it. Failed cases give
/// their reasons themselves, and where there are too few cases for an order, more of them help.
pub fn solver_first(verdicts: &mut [Verdict], setup: &Setup) {
    for verdict in verdicts.iter_mut().filter(|verdict| verdict.complete) {
        if verdict.decision != Decision::Pass && verdict.observed.is_some() {
            let first = match verdict.observed.is_some_and(|order| order < STUCK) {
                true => format!("its errors do not fall; {}", of_every_solver().join(", ")),
                false => questions(setup, verdict.variable).join(", "),
            };
            verdict.reason = format!("look at the solver first: {first}? {}", verdict.reason);
        }
    }
}

/// Most likely first: sums over the past, then contact, then what every solver takes from the case.
fn questions(setup: &Setup, variable: Variable) -> Vec<String> {
    let (model, body) = (&setup.model, &setup.body);
    let mut questions = Vec::new();
    if !model.memory.is_empty() {
        let rule = setup.scene.time.rule.in_words();
        questions.push(format!("are the weights of its memory sum those of the scene ({rule})"));
    }
    if body.material.projection.is_some() {
        questions.push("is zeta summed by the same rule, this level included".to_owned());
    }
    // A time error is the difference of two runs on one mesh under equal loads.
    if variable == Variable::K && !questions.is_empty() {
        return questions;
    }
    if body.friction().is_some() {
        questions.push("is friction that of each vertex and level".to_owned());
    }
    if body.contact.is_some() {
        questions.push("are gap, shift and law those of each vertex in contact".to_owned());
    }
    if body.element != Element::P1 {
        questions
            .push("has every midpoint of an edge a value of its own, in its own row".to_owned());
    }
    questions.extend(of_every_solver().map(str::to_owned));
    questions
}

/// Smaller orders mean none: a wrong weight of the sums or a kink of the fields leaves at least a half.
const STUCK: f64 = 0.25;

/// What every solver takes from the case.
fn of_every_solver() -> [&'static str; 2] {
    [
        "are the given loads added as they are",
        "is every vertex in its own row, level 0 solved like the others",
    ]
}
