//! What to check in an external solver if a verdict does not pass; a finer case seldom helps.

use super::cause::cause_of;
use fem::space::Element;
use judge::verdict::{Cause, Decision, Explanation, Variable, Verdict};
use scene::setup::{MeshData, Scheme, Setup};
use scene::{Body, Data, LoadForm, Scene, SceneError};

/// What becomes of the pressures of a solver beside the verdicts: `handed` over where no claim needs them, or claims that
/// need them where they are not. A wrong pressure must not pass for one that was judged.
pub fn on_pressures(scene: &Scene, handed: bool) -> Option<String> {
    let needing = scene.predicts.iter().filter(|claim| claim.norm.wants_pressure()).count();
    let name = &scene.name;
    let touches = scene.as_contact().is_some_and(|body| !body.domain.contact.is_empty());
    match (needing, handed) {
        (_, true) if !touches => {
            Some(format!("{name} has no contact: --pressure measures nothing"))
        }
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

/// Open or failed verdicts of which the solver may be the reason. Failed cases give their reasons themselves, and where
/// there are too few cases for an order, more of them help.
fn in_doubt(verdict: &Verdict) -> bool {
    verdict.complete && verdict.decision != Decision::Pass && verdict.observed.is_some()
}

/// Cases in which a cause is looked for, and the numbers of one that are still looked at: levels times unknowns, and
/// levels squared times unknowns, by which sums over the past grow.
const LOOKED_AT: usize = 3;
const MOST: [u64; 2] = [1_000_000, 200_000_000];

/// What the smallest cases say of the solver, where a verdict does not pass or loads are functions: the first that says something, else the last.
/// `scheme` answers them once more.
pub fn look_for_cause(
    verdicts: &[Verdict],
    setup: &Setup,
    mut runs: Vec<(u32, u32)>,
    scheme: &dyn Scheme,
) -> Option<Explanation> {
    let doubted = verdicts.iter().any(in_doubt);
    // Some mistakes in assembling loads keep every order.
    if !doubted && !matches!(setup.body.data, Data::Exact { form: LoadForm::Strong, .. }) {
        return None;
    }
    let d = setup.scene.dimension as u32;
    runs.sort_unstable_by_key(|&(n, steps)| {
        (u64::from(n).saturating_pow(d).saturating_mul(u64::from(steps)), n)
    });
    runs.dedup();
    let mut last = None;
    for &(n, steps) in runs.iter().take(LOOKED_AT) {
        let data = MeshData::new(setup, n, None).ok()?;
        let (levels, dofs) = (u64::from(steps) + 1, data.space.dofs() as u64);
        if levels * dofs > MOST[0] || levels * levels * dofs > MOST[1] {
            break;
        }
        let Ok(mut found) = cause_of(setup, scheme, &data, steps) else { continue };
        found.numbers = format!("n = {n}, N = {steps}: {}", found.numbers);
        let wrong = found.cause != Cause::Nothing;
        last = Some(found);
        if wrong {
            break;
        }
    }
    last.filter(|found| doubted || found.cause != Cause::Nothing)
}

/// Prefixes the reasons of open or failed verdicts on an external solver with the cause that was found, or with what to
/// check in the solver.
pub fn solver_first(verdicts: &mut [Verdict], setup: &Setup, found: Option<&Explanation>) {
    for verdict in verdicts.iter_mut().filter(|verdict| in_doubt(verdict)) {
        verdict.reason = match found {
            Some(Explanation { cause: Cause::Nothing, says, .. }) => {
                format!("{says}; {}", verdict.reason)
            }
            Some(Explanation { fits: true, says, .. }) => {
                format!("look at the solver first: {says}; {}", verdict.reason)
            }
            _ => {
                let first = match verdict.observed.is_some_and(|order| order < STUCK) {
                    true => format!("its errors do not fall; {}", OF_EVERY_SOLVER.join(", ")),
                    false => questions(setup, verdict.variable).join(", "),
                };
                format!("look at the solver first: {first}? {}", verdict.reason)
            }
        };
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
    if !body.contact.is_empty() {
        questions.push("are gap, shift and law those of each vertex in contact".to_owned());
    }
    if body.element != Element::P1 {
        questions
            .push("has every midpoint of an edge a value of its own, in its own row".to_owned());
    }
    questions.extend(OF_EVERY_SOLVER.map(str::to_owned));
    questions
}

/// Smaller orders mean none: a wrong weight of the sums or a kink of the fields leaves at least a half.
const STUCK: f64 = 0.25;

/// What every solver takes from the case.
const OF_EVERY_SOLVER: [&str; 2] = [
    "are the given loads added as they are",
    "is every vertex in its own row, level 0 solved like the others",
];

// Scenes whose loads a solver assembles itself.

/// The scene with the loads of the strong form, which are functions: cases then have them beside the assembled ones.
///
/// # Errors
/// A scene whose loads are no functions: one without exact solution, or with u in V^h, whose stress jumps from cell to cell.
pub fn by_density(mut scene: Scene) -> Result<Scene, SceneError> {
    let data = scene.as_contact().map(|body| &body.data);
    let interpolated = data.is_some_and(Data::is_interpolated);
    let what =
        "the loads of the scene are no functions: u is in V^h, and its stress jumps between cells";
    let hint = "leave out --loads, or take a scene of an order in h, such as viscoelastic or state-grazing";
    scene.refuse_if(interpolated, "exact.interpolated", what, hint)?;
    if let Body::Contact(body) = &mut scene.body
        && let Data::Exact { form, .. } = &mut body.data
    {
        *form = LoadForm::Strong;
    }
    Ok(scene)
}
