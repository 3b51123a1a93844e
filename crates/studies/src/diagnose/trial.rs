//! The trials of a diagnosis: which variants of a scene are run, and what each must show.

use super::term::{SceneTerms, Suspect};
use super::variant::{
    Course, asked, at_least, factor_rate, in_space, on_course, single_rate, with_memory,
    with_projection, with_terms,
};
use scene::{ContactScene, Direction, Hypothesis, Prediction, Scene, TimeRule};

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
    /// The variant; its name says what it is.
    pub scene: Scene,
    /// What is asked of it.
    pub question: Question,
    /// Its terms.
    pub terms: SceneTerms,
    /// What takes part in it.
    pub suspects: Vec<Suspect>,
    /// The term that it lacks, in the ladder of removals.
    pub removed: Option<Suspect>,
}

/// Numbers of steps of an order in k: from the coarsest at which contact events are told apart to one
/// at which an error of 1e-5 of the solution that does not fall outweighs one that falls like k².
const STEPS: [u32; 5] = [16, 32, 64, 128, 256];
/// The finest mesh of an order in h: one more costs as much as all others together.
const FINEST: u32 = 64;
/// Steps of a trial in h: the time error of the shipped scenes is then below 5 % of that in space.
const STEPS_IN_SPACE: u32 = 8;

struct Design<'a> {
    scene: &'a Scene,
    body: &'a ContactScene,
    terms: SceneTerms,
    n: u32,
    trials: Vec<Trial>,
}

/// The trials in V^h: all terms, each term removed, each term alone. Without contact scene: none.
pub(crate) fn trials_in_time(scene: &Scene) -> Vec<Trial> {
    let Some(body) = scene.as_contact() else { return Vec::new() };
    let terms = SceneTerms::of(body);
    let n = coarse_mesh(scene);
    let mut design = Design { scene, body, terms, n, trials: Vec::new() };
    design.removals();
    design.alone();
    design.trials
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
    let why = "(5.26)";
    let mut variants = vec![("all terms, in h".to_owned(), None, terms)];
    for (suspect, rest) in terms.removals() {
        variants.push((format!("without {}, in h", suspect.name()), Some(suspect), rest));
    }
    if terms != SceneTerms::NONE {
        variants.push(("elasticity alone, in h".into(), None, SceneTerms::NONE));
    }
    let trial = |(name, removed, kept): (String, Option<Suspect>, SceneTerms)| {
        let mut suspects = kept.suspects();
        suspects.push(Suspect::Space);
        let question = Prediction { constant, ..at_least(Direction::H, order, why) };
        let scene = asked(with_terms(scene, kept), &name, &n, &[STEPS_IN_SPACE], Some(question));
        Trial { scene, question: Question::Order, terms: kept, suspects, removed }
    };
    variants.into_iter().map(trial).collect()
}

impl Design<'_> {
    /// u(t) in V^h with all terms, and with each term removed.
    fn removals(&mut self) {
        let terms = self.terms;
        self.course_of_scene("all terms".into(), terms, None);
        for (suspect, rest) in terms.removals() {
            if rest != SceneTerms::NONE {
                self.course_of_scene(format!("without {}", suspect.name()), rest, Some(suspect));
            }
        }
    }

    /// Each term alone, on a course on which its history is integrated exactly where there is one.
    fn alone(&mut self) {
        self.course_of_scene("elasticity alone".into(), SceneTerms::NONE, None);
        for term in [Suspect::Projection, Suspect::Compliance, Suspect::Gap] {
            let kept = SceneTerms::NONE.with(term);
            if self.terms.has(term) && kept != self.terms {
                self.course_of_scene(format!("{} alone", term.name()), kept, None);
            }
        }
        let still = self.terms.without(Suspect::Memory);
        if self.terms.has_history() && still != SceneTerms::NONE {
            self.exact("u constant in time", still, Course::Constant, |scene| scene);
        }
        self.zeta_alone();
        self.memory_alone();
    }

    /// κ(ζ) of the scene, or of a control: the time rule must serve it as well as memory.
    fn zeta_alone(&mut self) {
        let kept = SceneTerms::NONE.with(Suspect::Projection).with(Suspect::Accumulation);
        // What the rule integrates exactly.
        let whole = self.scene.time.rule.order() < 2.0;
        let course = if whole { Course::Constant } else { Course::Linear };
        if self.terms.has(Suspect::Accumulation) {
            self.exact("zeta alone", kept, course, |scene| scene);
        } else {
            self.exact("zeta alone, a control", kept, course, with_projection);
        }
    }

    fn memory_alone(&mut self) {
        let kept = SceneTerms::NONE.with(Suspect::Memory);
        let control = 1.0 / self.scene.time.horizon;
        // Of several terms none is taken alone: their course is that of the scene.
        let terms = &self.body.material.memory;
        let course = match (self.scene.time.rule, &terms[..]) {
            (TimeRule::Trapezoid, []) => Some(Course::Fading(control)),
            (TimeRule::Trapezoid, [memory]) => single_rate(memory).map(Course::Fading),
            // v, or the product of it with what a singular kernel has beside its power, is interpolated linearly.
            (TimeRule::ProductIntegration, [memory]) if memory.singular.is_some() => {
                factor_rate(&self.scene.formulas, memory).map(Course::Fading)
            }
            (TimeRule::ProductIntegration, several) => {
                several.iter().all(|term| term.singular.is_none()).then_some(Course::Linear)
            }
            _ => None,
        };
        match (terms.first(), course) {
            (Some(_), Some(course)) => self.exact("memory alone", kept, course, |scene| scene),
            (Some(_), None) if kept != self.terms => {
                self.course_of_scene("memory alone".into(), kept, None);
            }
            (None, Some(course)) => {
                self.exact("memory alone, a control", kept, course, with_memory)
            }
            _ => {}
        }
    }

    /// A trial with u(t) of the scene, in V^h: exact unless there is a history.
    fn course_of_scene(&mut self, name: String, kept: SceneTerms, removed: Option<Suspect>) {
        let order = kept.has_history().then(|| order_in_k(self.scene));
        let variant = in_space(with_terms(self.scene, kept));
        let coarsest = [self.coarse_steps()];
        let steps = if order.is_some() { &STEPS[..] } else { &coarsest[..] };
        let scene = asked(variant, &name, &[self.n], steps, order);
        let question = if kept.has_history() { Question::Order } else { Question::Exact };
        let suspects = kept.suspects();
        self.trials.push(Trial { scene, question, terms: kept, suspects, removed });
    }

    fn exact(&mut self, name: &str, kept: SceneTerms, course: Course, change: fn(Scene) -> Scene) {
        let variant = change(on_course(with_terms(self.scene, kept), course));
        let scene = asked(variant, name, &[self.n], &[self.coarse_steps()], None);
        let (question, suspects) = (Question::Exact, kept.suspects());
        self.trials.push(Trial { scene, question, terms: kept, suspects, removed: None });
    }

    /// Exactness needs no fine grid; four levels see every kind of weight, and the scene's coarsest
    /// step is known to be solvable.
    fn coarse_steps(&self) -> u32 {
        let coarsest =
            self.scene.sweep.as_ref().and_then(|sweep| sweep.steps.iter().min().copied());
        coarsest.unwrap_or(4).max(4)
    }
}

/// The scene's coarsest mesh, or 8 cells per unit length where that divides the sides and is coarser.
fn coarse_mesh(scene: &Scene) -> u32 {
    let coarsest =
        scene.sweep.as_ref().and_then(|sweep| sweep.n.iter().min().copied()).unwrap_or(8);
    if coarsest > 8 && scene.check_cells(8).is_ok() { 8 } else { coarsest }
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
