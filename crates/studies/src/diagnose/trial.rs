//! The trials of a diagnosis: which variants of a scene are run, and what each must show.

use formula::{EvaluationPoint, Graph, Node, Scope, Variable};
use scene::{
    Body, Change, ContactScene, Data, Direction, Domain, Expectation, Hypothesis, LoadForm, Norm,
    Prediction, Projection, RelaxationTerm, Scene, SceneError, Sweep, TimeRule,
};
use serde::{Serialize, Serializer};
use vhi::law::FourthOrder;

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
    // The scene's coarsest mesh, or 8 cells per unit length where that divides the sides and is coarser.
    let n = least(0).filter(|&n| n <= 8 || scene.check_cells(8).is_err()).unwrap_or(8);
    let coarsest = (vec![n], vec![least(1).unwrap_or(4).max(4)]);
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

fn predicted(scene: &Scene, variable: Direction) -> Option<&Prediction> {
    scene.predicts.iter().find(|prediction| prediction.variable == variable)
}

/// What Theorem 7 gives of u(t) ∈ V^h, or the order that the scene predicts where it violates a hypothesis of it.
fn order_in_k(scene: &Scene) -> Prediction {
    let promised = predicted(scene, Direction::K).map(|prediction| prediction.order.min(2.0));
    let smooth = !scene.violates.contains(&Hypothesis::RegularInTime);
    // A scene without a prediction that is not smooth in time promises no more than order 1.
    // Nor does a rule promise more than its own order.
    let order = promised.unwrap_or(if smooth { 2.0 } else { 1.0 }).min(scene.time.rule.order());
    at_least(Direction::K, order, "Theorem 7, (3.17), u(t) in V^h")
}

// What a defect can sit in: the terms of a scene that a variant can do without, and what is always there.

/// How many suspects are terms: the first of [`Suspect::all`].
const TERMS: usize = 5;

/// The terms of (5.1)-(5.5) that a variant of a scene has: whether it has each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SceneTerms([bool; TERMS]);

impl SceneTerms {
    /// No term: linear elasticity.
    pub const NONE: SceneTerms = SceneTerms([false; TERMS]);

    pub(crate) fn of(body: &ContactScene) -> Self {
        let projection = body.material.projection.as_ref().filter(|p| p.mu > 0.0);
        Self([
            projection.is_some(),
            projection.is_some_and(|projection| projection.lipschitz > 0.0),
            !body.material.memory.is_empty(),
            body.laws().next().is_some(),
            body.has_gap(),
        ])
    }

    /// Whether the term is there; what is no term is everywhere.
    pub(crate) fn has(self, term: Suspect) -> bool {
        self.0.get(term as usize).is_none_or(|present| *present)
    }

    /// These terms and another one.
    pub(crate) fn with(mut self, term: Suspect) -> Self {
        self.0[term as usize] = true;
        self
    }

    /// These terms but for one; ζ goes with the projection that it acts on.
    pub(crate) fn without(mut self, term: Suspect) -> Self {
        self.0[term as usize] = false;
        match term {
            Suspect::Projection => self.without(Suspect::Accumulation),
            _ => self,
        }
    }

    fn present(self) -> impl Iterator<Item = Suspect> {
        Suspect::all().into_iter().take(TERMS).filter(move |&term| self.has(term))
    }

    /// Each term with the terms that remain without it.
    pub(crate) fn removals(self) -> impl Iterator<Item = (Suspect, SceneTerms)> {
        self.present().map(move |term| (term, self.without(term)))
    }

    /// Whether an integral over the past remains.
    pub(crate) fn has_history(self) -> bool {
        self.has(Suspect::Memory) || self.has(Suspect::Accumulation)
    }

    /// What takes part in a run with these terms.
    pub(crate) fn suspects(self) -> Vec<Suspect> {
        let nonlinear =
            [Suspect::Projection, Suspect::Compliance, Suspect::Gap].iter().any(|&t| self.has(t));
        let shared = [(self.has_history(), Suspect::TimeRule), (nonlinear, Suspect::Solver)];
        let shared = shared.into_iter().filter_map(|(used, suspect)| used.then_some(suspect));
        self.present().chain(shared).chain([Suspect::Elasticity, Suspect::Loads]).collect()
    }

    /// In a few words: `elasticity, mu, zeta, memory, law, gap`.
    pub(crate) fn words(self) -> String {
        let word = |term: Suspect| if term == Suspect::Projection { "mu" } else { term.name() };
        let words: Vec<&str> = ["elasticity"].into_iter().chain(self.present().map(word)).collect();
        words.join(", ")
    }
}

/// What may be at fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Suspect {
    /// The projection term of (5.1).
    Projection,
    /// ζ and the dependence of κ on it.
    Accumulation,
    /// The memory term of (5.1).
    Memory,
    /// The law on Γ3.
    Compliance,
    /// The constraint on Γ3.
    Gap,
    /// The quadrature of all integrals over the past.
    TimeRule,
    /// The iteration that solves a level, with its tolerance.
    Solver,
    /// 𝒜.
    Elasticity,
    /// The loads as the solver takes them, and what else every run has: clamped sides, the linear solver, the error.
    Loads,
    /// What only runs have whose exact solution is not in V^h: quadrature of the loads and of the error.
    Space,
}

impl Serialize for Suspect {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Suspect {
    /// Every suspect, terms of the scene first, with its name in JSON and what it is.
    const DESCRIBED: [(Self, &'static str, &'static str); 10] = [
        (Self::Projection, "projection", "the projection term mu (eps - P eps)"),
        (Self::Accumulation, "zeta", "zeta, the yield limit's dependence on the past"),
        (Self::Memory, "memory", "the memory term B"),
        (Self::Compliance, "law", "the compliance law"),
        (Self::Gap, "gap", "the constraint u_nu <= g"),
        (Self::TimeRule, "time-rule", "the time rule that memory and zeta share"),
        (Self::Solver, "solver", "the iteration that solves a nonlinear level, or its tolerance"),
        (Self::Elasticity, "elasticity", "elasticity A"),
        (
            Self::Loads,
            "loads",
            "the loads as the solver takes them, or what else every run has (clamped sides, the linear solver, the measured error)",
        ),
        (
            Self::Space,
            "space",
            "what only a solution outside V^h has: quadrature of its loads or of its error, interpolation",
        ),
    ];

    pub(crate) fn all() -> [Self; 10] {
        Self::DESCRIBED.map(|(suspect, ..)| suspect)
    }

    pub fn name(self) -> &'static str {
        Self::DESCRIBED[self as usize].1
    }

    pub(crate) fn words(self) -> &'static str {
        Self::DESCRIBED[self as usize].2
    }

    /// Whether a variant of a scene can do without it.
    pub(crate) fn is_term(self) -> bool {
        (self as usize) < TERMS
    }
}

// Variants of a scene: terms removed, u(t) put into V^h, or replaced by a profile whose history is integrated exactly.
//
// The loads of a variant are derived from its exact solution and its terms, so each of them is
// a sound manufactured scene, and whatever it shows is the solver's doing.

/// How the profile U(x) of a probe goes with time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Course {
    /// u(t) = U: every rule whose weights sum to t_n integrates ‖ε(u)‖ exactly; a multiplier may act.
    Constant,
    /// u(t) = U (1 + t/T)/2: the trapezoidal rule integrates ‖ε(u)‖ exactly.
    Linear,
    /// u(t) = U exp(-c t) (1 + t/T)/2: it integrates exp(-c (t - s)) u(s) exactly, which is linear in s.
    Fading(f64),
}

/// Interior points per side at which a profile is sampled.
const SAMPLES: u32 = 6;

/// A scene with its body and its formulas changed.
fn changed(mut scene: Scene, change: impl FnOnce(&mut ContactScene, &mut Graph)) -> Scene {
    if let Body::Contact(body) = &mut scene.body {
        change(body, &mut scene.formulas);
    }
    scene
}

/// The scene with no terms but `kept`; u stays what it is.
pub(super) fn with_terms(mut scene: Scene, kept: SceneTerms) -> Scene {
    // Claims about regularity speak of terms that may be gone.
    scene
        .violates
        .retain(|claim| !matches!(claim, Hypothesis::RegularInTime | Hypothesis::RegularInSpace));
    changed(scene, |body, graph| {
        if !kept.has(Suspect::Memory) {
            body.material.memory.clear();
        }
        if !kept.has(Suspect::Projection) {
            body.material.projection = None;
        }
        let projection = body.material.projection.as_mut();
        if let Some(projection) = projection.filter(|_| !kept.has(Suspect::Accumulation)) {
            *projection = frozen(graph, projection);
        }
        for contact in &mut body.contact {
            contact.law = contact.law.take().filter(|_| kept.has(Suspect::Compliance));
            contact.gap = contact.gap.filter(|_| kept.has(Suspect::Gap));
        }
        if let Data::Exact { multiplier, selection, .. } = &mut body.data {
            multiplier.retain(|_| kept.has(Suspect::Gap));
            selection.retain(|_| kept.has(Suspect::Compliance));
        }
    })
}

/// κ at ζ = 0 for all ζ.
fn frozen(graph: &mut Graph, projection: &Projection) -> Projection {
    let at_start = graph.evaluate(projection.kappa, &EvaluationPoint::default());
    Projection { mu: projection.mu, kappa: graph.constant(at_start), lipschitz: 0.0 }
}

/// The scene with u(t) replaced by its nodal interpolant on each mesh.
pub(super) fn in_space(scene: Scene) -> Scene {
    changed(scene, |body, _| {
        if let Data::Exact { interpolated, form, .. } = &mut body.data {
            *interpolated = true;
            *form = LoadForm::Weak;
        }
    })
}

/// The scene in V^h with u(t) on the given course through U, the largest of a few states of u.
///
/// Histories inside formulas of u are left out of U: they are the solution's, not the model's.
pub(super) fn on_course(scene: Scene, course: Course) -> Scene {
    let horizon = scene.time.horizon;
    changed(in_space(scene), |body, graph| {
        let Data::Exact { u, multiplier, selection, .. } = &mut body.data else { return };
        let points = interior(&body.domain);
        let at = largest_state(graph, u, horizon, &points);
        let factor = factor(graph, course, horizon);
        for component in u.iter_mut() {
            let profile = graph.instant(*component, at);
            *component = graph.mul(factor, profile);
        }
        let constant = course == Course::Constant;
        for stated in [multiplier, selection] {
            stated.retain(|_| constant);
            stated.iter_mut().for_each(|(_, node)| *node = graph.instant(*node, at));
        }
    })
}

fn factor(graph: &mut Graph, course: Course, horizon: f64) -> Node {
    let line = graph.written("0.5 + slope*t", &[], &[("slope", 0.5 / horizon)]);
    match course {
        Course::Constant => graph.constant(1.0),
        Course::Linear => line,
        // exp(-c t) by the formula language, with c as it reads back.
        Course::Fading(rate) => {
            let text = format!("exp(-({rate:?})*t)");
            let fading = graph.parse(&text, &Scope::new(&[Variable::T]));
            fading.map_or(line, |fading| graph.mul(fading, line))
        }
    }
}

/// Of the quarters of [0, T] the one at which u is largest on a few points.
fn largest_state(graph: &mut Graph, u: &[Node], horizon: f64, points: &[EvaluationPoint]) -> f64 {
    let quarters = [1.0, 0.75, 0.5, 0.25].map(|part| part * horizon);
    let extent = |graph: &mut Graph, t: f64| -> f64 {
        let state: Vec<Node> = u.iter().map(|&node| graph.instant(node, t)).collect();
        let value = |point: &EvaluationPoint| -> f64 {
            state.iter().map(|&node| graph.evaluate(node, point).abs()).sum()
        };
        points.iter().map(value).sum()
    };
    let extents = quarters.map(|t| (t, extent(graph, t))).into_iter();
    extents.fold((quarters[0], 0.0), |best, next| if next.1 > best.1 { next } else { best }).0
}

fn interior(domain: &Domain) -> Vec<EvaluationPoint> {
    let at = |[x, y, z]: [f64; 3]| EvaluationPoint { x, y, z, ..EvaluationPoint::default() };
    domain.inner_points(SAMPLES).into_iter().map(at).collect()
}

/// The Lamé numbers of an isotropic tensor; of another one, those of its smallest eigenvalue times the identity.
fn isotropic(elastic: &FourthOrder, d: usize) -> [f64; 2] {
    match elastic {
        FourthOrder::Isotropic(law) => [law.lambda, law.mu],
        FourthOrder::Full(_) => [0.0, 0.5 * elastic.eigenvalues(d).0],
    }
}

/// The scene with memory b(t) = -exp(-t/T), ℬ₀ = 𝒜/4: a control where the scene has none.
pub(super) fn with_memory(scene: Scene) -> Scene {
    let (rate, d) = (1.0 / scene.time.horizon, scene.dimension);
    changed(scene, |body, graph| {
        let text = format!("-exp(-({rate:?})*t)");
        let Ok(kernel) = graph.parse(&text, &Scope::new(&[Variable::T])) else { return };
        let exponentials = graph.exponential_sum(kernel);
        // Fading memory of unit time scale: its integral over [0, T] stays below 𝒜/4.
        let quarter = 0.25 * rate.min(1.0);
        let share = |elastic: &FourthOrder| isotropic(elastic, d).map(|number| quarter * number);
        let body = &mut body.material;
        let [lambda, mu] = share(&body.elastic);
        let regions = body.regions.iter().map(|region| share(&region.elastic)).collect();
        body.memory = vec![RelaxationTerm {
            kernel,
            singular: None,
            exponentials,
            inner: None,
            lambda,
            mu,
            regions,
        }];
    })
}

/// The scene with a projection that yields in a part of the body: a control where the scene has none.
pub(super) fn with_projection(scene: Scene) -> Scene {
    let horizon = scene.time.horizon;
    changed(scene, |body, graph| {
        let Data::Exact { u, .. } = &body.data else { return };
        let points = interior(&body.domain);
        let strain = mean_gradient(graph, u, horizon, &points);
        // Half of a mean strain, and a fifth more over [0, T].
        let (start, slope) = (0.5 * strain, 0.2 / horizon);
        let text = format!("{start:?} + {slope:?}*zeta");
        if let Ok(kappa) = graph.parse(&text, &Scope::new(&[Variable::Zeta])) {
            let [_, mu] = isotropic(&body.material.elastic, 2);
            body.material.projection = Some(Projection { mu, kappa, lipschitz: slope });
        }
    })
}

/// Mean of |Du| at t = T, by its exact derivatives.
fn mean_gradient(graph: &mut Graph, u: &[Node], t: f64, points: &[EvaluationPoint]) -> f64 {
    let mut parts = Vec::new();
    for &component in u {
        for variable in [Variable::X, Variable::Y, Variable::Z] {
            let state = graph.instant(component, t);
            parts.push(graph.derivative(state, variable));
        }
    }
    let norm = |point: &EvaluationPoint| -> f64 {
        parts.iter().map(|&part| graph.evaluate(part, point).powi(2)).sum::<f64>().sqrt()
    };
    points.iter().map(norm).sum::<f64>() / points.len() as f64
}

/// The grid of a variant, and what is asked of it.
pub(super) fn asked(scene: Scene, n: &[u32], steps: &[u32], question: Option<Prediction>) -> Scene {
    let norms = match &question {
        Some(prediction) => vec![prediction.norm],
        None => vec![Norm::VMax, Norm::StressL2Max, Norm::PressureL2Max],
    };
    let (n, steps) = (n.to_vec(), steps.to_vec());
    Scene {
        judge: question.is_some(),
        expect: Expectation::Pass,
        window_n: None,
        window_steps: None,
        predicts: question.into_iter().collect(),
        sweep: Some(Sweep { n, steps, norms: Some(norms), ..Sweep::default() }),
        ..scene
    }
}

/// Share by which the constant of a variant may be off. A variant without its gap or its memory may stand at a kink of its
/// law, where the linearised step has two slopes: `affine-locked` without its gap is 0.6 % off. A wrong factor in a term is
/// beyond it.
const CONSTANT_WITHIN: f64 = 0.02;

/// A lower bound of an order in V_max: too high an order is no sign of a wrong term.
pub(super) fn at_least(variable: Direction, order: f64, why: &str) -> Prediction {
    Prediction {
        norm: Norm::VMax,
        variable,
        order,
        order_k: None,
        at_least: true,
        exact: false,
        constant: true,
        constant_within: Some(CONSTANT_WITHIN),
        why: why.to_owned(),
        window_n: None,
        window_steps: None,
    }
}

/// The rate c of a kernel a exp(-c t), where it is one.
pub(super) fn single_rate(memory: &RelaxationTerm) -> Option<f64> {
    match memory.exponentials.as_deref() {
        Some(&[(_, rate)]) => Some(rate),
        _ => None,
    }
}

/// The rate c of a kernel t^{-a} b exp(-c t), where it is one.
pub(super) fn factor_rate(formulas: &Graph, memory: &RelaxationTerm) -> Option<f64> {
    let factor = memory.singular?.factor;
    match formulas.exponential_sum(factor)?[..] {
        [(_, rate)] => Some(rate),
        _ => None,
    }
}
