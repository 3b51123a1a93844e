//! The trials of a diagnosis: which variants of a scene are run, and what each must show.

use super::term::{SceneTerms, Suspect};
use super::variant::{
    Course, asked, at_least, factor_rate, in_space, on_course, single_rate, with_memory,
    with_projection, with_terms,
};
use scene::{Change, Direction, Hypothesis, Prediction, Scene, SceneError, TimeRule};

/// What a variant must show of a sound solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Question {
    /// The order that its scene predicts.
    Order,
    /// No error at all but rounding: space and history are exact for this solution.
    Exact,
}

/// One variant to run.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// What is different from the scene.
    pub change: Change,
    /// What is asked of it.
    pub question: Question,
    /// Its terms.
    pub terms: SceneTerms,
    /// What takes part in it.
    pub suspects: Vec<Suspect>,
    /// The term that it lacks, in the ladder of removals.
    pub removed: Option<Suspect>,
}

impl Trial {
    /// The scene with the terms `kept`, varied, on a grid of n and N: an order is asked for, or exactness.
    fn new(
        name: impl Into<String>,
        kept: SceneTerms,
        order: Option<Prediction>,
        (n, steps): (Vec<u32>, Vec<u32>),
        vary: impl Fn(Scene) -> Scene + Send + Sync + 'static,
    ) -> Self {
        let question = if order.is_some() { Question::Order } else { Question::Exact };
        let change = Change::new(name, move |scene| {
            Ok(asked(vary(with_terms(scene, kept)), &n, &steps, order.clone()))
        });
        Self { change, question, terms: kept, suspects: kept.suspects(), removed: None }
    }

    /// The variant; its name says what it is.
    pub(crate) fn of(&self, scene: &Scene) -> Result<Scene, SceneError> {
        Ok(Scene { name: self.change.words().to_owned(), ..self.change.of(scene)? })
    }
}

/// Numbers of steps of an order in k: from the coarsest at which contact events are told apart to one
/// at which an error of 1e-5 of the solution that does not fall outweighs one that falls like k².
const STEPS: [u32; 5] = [16, 32, 64, 128, 256];
/// The finest mesh of an order in h: one more costs as much as all others together.
const FINEST: u32 = 64;
/// Steps of a trial in h: the time error of the shipped scenes is then below 5 % of that in space.
const STEPS_IN_SPACE: u32 = 8;

/// The trials in V^h: all terms, each term removed, each term alone. Without contact scene: none.
pub(crate) fn trials_in_time(scene: &Scene) -> Vec<Trial> {
    let Some(body) = scene.as_contact() else { return Vec::new() };
    let terms = SceneTerms::of(body);
    // Exactness needs no fine grid; four levels see every kind of weight, and the scene's coarsest step is known to be
    // solvable.
    let listed = scene.sweep.as_ref().map(|sweep| [&sweep.n, &sweep.steps]);
    let least = |i: usize| listed.and_then(|lists| lists[i].iter().min().copied());
    let coarsest = (vec![coarse_mesh(scene, least(0))], vec![least(1).unwrap_or(4).max(4)]);
    // A trial with u(t) of the scene, in V^h: exact unless there is a history.
    let of_scene = |name: String, kept: SceneTerms| {
        let order = kept.has_history().then(|| order_in_k(scene));
        let fine = (coarsest.0.clone(), STEPS.to_vec());
        let grid = if order.is_some() { fine } else { coarsest.clone() };
        Trial::new(name, kept, order, grid, in_space)
    };
    // On a course on which the history is integrated exactly; `control` adds a term that the scene lacks.
    let exact = |name: &str, kept: SceneTerms, course: Course, control: fn(Scene) -> Scene| {
        Trial::new(name, kept, None, coarsest.clone(), move |scene| {
            control(on_course(scene, course))
        })
    };
    let mut trials = vec![of_scene("all terms".into(), terms)];
    for (suspect, rest) in terms.removals().filter(|(_, rest)| *rest != SceneTerms::NONE) {
        let trial = of_scene(format!("without {}", suspect.name()), rest);
        trials.push(Trial { removed: Some(suspect), ..trial });
    }
    trials.push(of_scene("elasticity alone".into(), SceneTerms::NONE));
    for term in [Suspect::Projection, Suspect::Compliance, Suspect::Gap] {
        let kept = SceneTerms::NONE.with(term);
        if terms.has(term) && kept != terms {
            trials.push(of_scene(format!("{} alone", term.name()), kept));
        }
    }
    let still = terms.without(Suspect::Memory);
    if terms.has_history() && still != SceneTerms::NONE {
        trials.push(exact("u constant in time", still, Course::Constant, |scene| scene));
    }
    // κ(ζ) of the scene, or of a control: the time rule must serve it as well as memory.
    let zeta = SceneTerms::NONE.with(Suspect::Projection).with(Suspect::Accumulation);
    // What the rule integrates exactly.
    let whole = scene.time.rule.order() < 2.0;
    let course = if whole { Course::Constant } else { Course::Linear };
    trials.push(match terms.has(Suspect::Accumulation) {
        true => exact("zeta alone", zeta, course, |scene| scene),
        false => exact("zeta alone, a control", zeta, course, with_projection),
    });
    let memory = SceneTerms::NONE.with(Suspect::Memory);
    // Of several terms none is taken alone: their course is that of the scene.
    let written = &body.material.memory;
    let course = match (scene.time.rule, &written[..]) {
        (TimeRule::Trapezoid, []) => Some(Course::Fading(1.0 / scene.time.horizon)),
        (TimeRule::Trapezoid, [memory]) => single_rate(memory).map(Course::Fading),
        // v, or the product of it with what a singular kernel has beside its power, is interpolated linearly.
        (TimeRule::ProductIntegration, [memory]) if memory.singular.is_some() => {
            factor_rate(&scene.formulas, memory).map(Course::Fading)
        }
        (TimeRule::ProductIntegration, several) => {
            several.iter().all(|term| term.singular.is_none()).then_some(Course::Linear)
        }
        _ => None,
    };
    match course {
        Some(course) if written.is_empty() => {
            trials.push(exact("memory alone, a control", memory, course, with_memory));
        }
        Some(course) => trials.push(exact("memory alone", memory, course, |scene| scene)),
        None if !written.is_empty() && memory != terms => {
            trials.push(of_scene("memory alone".into(), memory));
        }
        None => {}
    }
    trials
}

/// The trials outside V^h, for an order in h: all terms, each term removed, elasticity alone.
pub(crate) fn trials_in_space(scene: &Scene) -> Vec<Trial> {
    let Some(body) = scene.as_contact() else { return Vec::new() };
    let terms = SceneTerms::of(body);
    let listed = scene.sweep.as_ref().map_or(Vec::new(), |sweep| sweep.n.clone());
    let mut n: Vec<u32> = listed.into_iter().filter(|&n| n <= FINEST).collect();
    n.sort_unstable();
    let promised = predicted(scene, Direction::H);
    let order = promised.map_or(1.0, |prediction| prediction.order);
    // The variants keep u and drop the claim on its regularity: where u is not in H² the interpolation error is not what
    // C_h must be.
    let singular = scene.violates.contains(&Hypothesis::RegularInSpace);
    let constant = !singular && promised.is_none_or(|prediction| prediction.constant);
    let trial = |name: String, kept: SceneTerms, removed| {
        let order = Prediction { constant, ..at_least(Direction::H, order, "(5.26)") };
        let grid = (n.clone(), vec![STEPS_IN_SPACE]);
        let mut trial = Trial::new(name, kept, Some(order), grid, |scene| scene);
        trial.suspects.push(Suspect::Space);
        Trial { removed, ..trial }
    };
    let mut trials = vec![trial("all terms, in h".to_owned(), terms, None)];
    for (suspect, rest) in terms.removals() {
        trials.push(trial(format!("without {}, in h", suspect.name()), rest, Some(suspect)));
    }
    if terms != SceneTerms::NONE {
        trials.push(trial("elasticity alone, in h".into(), SceneTerms::NONE, None));
    }
    trials
}

/// The scene's coarsest mesh, or 8 cells per unit length where that divides the sides and is coarser.
fn coarse_mesh(scene: &Scene, coarsest: Option<u32>) -> u32 {
    coarsest.filter(|&n| n <= 8 || scene.check_cells(8).is_err()).unwrap_or(8)
}

fn predicted(scene: &Scene, variable: Direction) -> Option<&Prediction> {
    scene.predicts.iter().find(|prediction| prediction.variable == variable)
}

/// What Theorem 7 gives of u(t) ∈ V^h, or the order that the scene predicts where it violates a hypothesis of it.
fn order_in_k(scene: &Scene) -> Prediction {
    let promised = predicted(scene, Direction::K).map(|prediction| prediction.order.min(2.0));
    let smooth = !scene.violates.contains(&Hypothesis::RegularInTime);
    // A scene without a prediction that is not smooth in time promises no more than order 1.
    let order = promised.unwrap_or(if smooth { 2.0 } else { 1.0 });
    at_least(Direction::K, order, "Theorem 7, (3.17), u(t) in V^h")
}
