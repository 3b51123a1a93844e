//! The trials of a diagnosis: which variants of a scene are run, and what each must show.
//!
//! A variant lacks terms, has u(t) in V^h, or has a profile in place of u whose history is integrated exactly. Its loads are
//! derived from its exact solution and its terms, so it is a sound manufactured scene, and whatever it shows is the
//! solver's doing.

use std::collections::BTreeSet;

use formula::{EvaluationPoint, Graph, Node, Variable};
use judge::claim::Claim;
use judge::verdict::Decision;
use scene::{
    Body, ContactScene, Data, Direction, Expectation, Hypothesis, LoadForm, Norm, Prediction,
    Projection, RelaxationTerm, Scene, Sweep, TimeRule,
};
use serde::{Serialize, Serializer};

/// A variant to run, and its outcome before it has shown anything. It is judged where an order is asked for; elsewhere
/// space and history are exact for its solution, and it must have no error but rounding.
pub(super) type Trial = (Scene, Outcome);

/// What a trial showed.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Outcome {
    /// Name of the variant.
    pub name: String,
    /// Its terms in words.
    pub terms: String,
    /// The term that it lacks, in the ladder of removals.
    pub removed: Option<Suspect>,
    /// What took part.
    pub suspects: Vec<Suspect>,
    /// Pass: a sound solver shows this. Fail: it does not. Unresolved: it says nothing.
    #[serde(rename = "verdict")]
    pub decision: Decision,
    /// What it had to show; its note says why it does or does not.
    pub claim: Claim,
}

/// The terms of (5.1)-(5.5) that a variant has; none is linear elasticity.
type Terms = BTreeSet<Suspect>;

fn terms_of(body: &ContactScene) -> Terms {
    let projection = body.material.projection.as_ref().filter(|p| p.mu > 0.0);
    let present = [
        (Suspect::Projection, projection.is_some()),
        (Suspect::Accumulation, projection.is_some_and(|p| p.lipschitz > 0.0)),
        (Suspect::Memory, !body.material.memory.is_empty()),
        (Suspect::Compliance, body.laws().next().is_some()),
        (Suspect::Gap, body.has_gap()),
    ];
    present.into_iter().filter_map(|(term, present)| present.then_some(term)).collect()
}

/// These terms but for one; ζ goes with the projection that it acts on.
fn without(terms: &Terms, gone: Suspect) -> Terms {
    let zeta = (gone == Suspect::Projection).then_some(Suspect::Accumulation);
    terms.iter().copied().filter(|&term| term != gone && Some(term) != zeta).collect()
}

fn has_history(terms: &Terms) -> bool {
    terms.contains(&Suspect::Memory) || terms.contains(&Suspect::Accumulation)
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
    pub(super) const ALL: [(Self, &'static str, &'static str); 10] = [
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

    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    pub(super) fn words(self) -> &'static str {
        Self::ALL[self as usize].2
    }

    /// Whether a variant of a scene can do without it.
    pub(super) fn is_term(self) -> bool {
        self <= Self::Gap
    }
}

/// The scene with the terms `kept`, varied, on a grid of n and N.
fn trial(
    scene: &Scene,
    name: impl Into<String>,
    kept: &Terms,
    order: Option<Prediction>,
    [n, steps]: [Vec<u32>; 2],
    vary: impl FnOnce(&mut ContactScene, &mut Graph),
) -> Trial {
    let norms = match &order {
        Some(_) => vec![Norm::VMax],
        None => vec![Norm::VMax, Norm::StressL2Max, Norm::PressureL2Max],
    };
    let mut variant = Scene {
        name: name.into(),
        judge: order.is_some(),
        expect: Expectation::Pass,
        window_n: None,
        window_steps: None,
        predicts: order.into_iter().collect(),
        sweep: Some(Sweep { n, steps, norms: Some(norms), ..Sweep::default() }),
        ..scene.clone()
    };
    // Claims about regularity speak of terms that may be gone.
    let regular = [Hypothesis::RegularInTime, Hypothesis::RegularInSpace];
    variant.violates.retain(|claim| !regular.contains(claim));
    let Scene { body, formulas, .. } = &mut variant;
    if let Body::Contact(body) = body {
        // No terms but these; u stays what it is.
        let lacks = |term| !kept.contains(&term);
        if lacks(Suspect::Memory) {
            body.material.memory.clear();
        }
        if lacks(Suspect::Projection) {
            body.material.projection = None;
        }
        let projection = body.material.projection.as_mut();
        if let Some(projection) = projection.filter(|_| lacks(Suspect::Accumulation)) {
            // κ at ζ = 0 for all ζ.
            let at_start = formulas.evaluate(projection.kappa, &EvaluationPoint::default());
            (projection.kappa, projection.lipschitz) = (formulas.constant(at_start), 0.0);
        }
        for contact in &mut body.contact {
            contact.law = contact.law.take().filter(|_| !lacks(Suspect::Compliance));
            contact.gap = contact.gap.filter(|_| !lacks(Suspect::Gap));
        }
        if let Data::Exact { multiplier, selection, .. } = &mut body.data {
            multiplier.retain(|_| !lacks(Suspect::Gap));
            selection.retain(|_| !lacks(Suspect::Compliance));
        }
        vary(body, formulas);
    }
    let shared = [
        (Suspect::TimeRule, has_history(kept)),
        (Suspect::Solver, kept.iter().any(|term| *term != Suspect::Memory)),
        (Suspect::Elasticity, true),
        (Suspect::Loads, true),
    ];
    let shared = shared.into_iter().filter_map(|(suspect, used)| used.then_some(suspect));
    let word = |term: &Suspect| if *term == Suspect::Projection { "mu" } else { term.name() };
    let words: Vec<&str> = ["elasticity"].into_iter().chain(kept.iter().map(word)).collect();
    let outcome = Outcome {
        name: variant.name.clone(),
        terms: words.join(", "),
        suspects: kept.iter().copied().chain(shared).collect(),
        ..Outcome::default()
    };
    (variant, outcome)
}

/// Numbers of steps of an order in k: from the coarsest at which contact events are told apart to one
/// at which an error of 1e-5 of the solution that does not fall outweighs one that falls like k².
const STEPS: [u32; 5] = [16, 32, 64, 128, 256];
/// The finest mesh of an order in h: one more costs as much as all others together.
const FINEST: u32 = 64;
/// Steps of a trial in h: the time error of the shipped scenes is then below 5 % of that in space.
const STEPS_IN_SPACE: u32 = 8;

/// The trials in V^h: all terms, each term removed, each term alone. Without contact scene: none.
pub(super) fn trials_in_time(scene: &Scene) -> Vec<Trial> {
    let Some(body) = scene.as_contact() else { return Vec::new() };
    let (terms, bare, horizon) = (terms_of(body), Terms::new(), scene.time.horizon);
    // Exactness needs no fine grid; four levels see every kind of weight, and the scene's coarsest step is known to be
    // solvable.
    let listed = scene.sweep.as_ref().map(|sweep| [&sweep.n, &sweep.steps]);
    let least = |i: usize| listed.and_then(|lists| lists[i].iter().min().copied());
    // The scene's coarsest mesh, or 8 cells per unit length where that divides the sides and is coarser.
    let n = least(0).filter(|&n| n <= 8 || scene.check_cells(8).is_err()).unwrap_or(8);
    let coarsest = [vec![n], vec![least(1).unwrap_or(4).max(4)]];
    // What Theorem 7 gives of u(t) ∈ V^h, or the order that the scene predicts where it violates a hypothesis of it.
    let promised = predicted(scene, Direction::K).map(|prediction| prediction.order.min(2.0));
    let smooth = !scene.violates.contains(&Hypothesis::RegularInTime);
    // A scene without a prediction that is not smooth in time promises no more than order 1.
    // Nor does a rule promise more than its own order.
    let order = promised.unwrap_or(if smooth { 2.0 } else { 1.0 }).min(scene.time.rule.order());
    let in_k = at_least(Direction::K, order, "Theorem 7, (3.17), u(t) in V^h");
    // A trial with u(t) of the scene, in V^h: exact unless there is a history.
    let of_scene = |name: &str, kept: &Terms| {
        let order = has_history(kept).then(|| in_k.clone());
        let fine = [coarsest[0].clone(), STEPS.to_vec()];
        let grid = if order.is_some() { fine } else { coarsest.clone() };
        trial(scene, name, kept, order, grid, |body, _| in_space(body))
    };
    // On a course on which the history is integrated exactly; `control` adds a term that the scene lacks.
    type Control = fn(&mut ContactScene, &mut Graph, f64);
    let exact = |name: &str, kept: &Terms, course: Option<f64>, control: Option<Control>| {
        let name = format!("{name}{}", control.map_or("", |_| ", a control"));
        trial(scene, name, kept, None, coarsest.clone(), |body, graph| {
            on_course(body, graph, horizon, course);
            control.inspect(|control| control(body, graph, horizon));
        })
    };
    let mut trials = vec![of_scene("all terms", &terms)];
    for &term in &terms {
        let rest = without(&terms, term);
        if rest != bare {
            let (variant, outcome) = of_scene(&format!("without {}", term.name()), &rest);
            trials.push((variant, Outcome { removed: Some(term), ..outcome }));
        }
    }
    trials.push(of_scene("elasticity alone", &bare));
    for term in [Suspect::Projection, Suspect::Compliance, Suspect::Gap] {
        let kept = Terms::from([term]);
        if terms.contains(&term) && kept != terms {
            trials.push(of_scene(&format!("{} alone", term.name()), &kept));
        }
    }
    let still = without(&terms, Suspect::Memory);
    if has_history(&terms) && still != bare {
        trials.push(exact("u constant in time", &still, None, None));
    }
    // κ(ζ) of the scene, or of a control: the time rule must serve it as well as memory. The rule integrates a line exactly, or
    // only a constant.
    let zeta = Terms::from([Suspect::Projection, Suspect::Accumulation]);
    let course = (scene.time.rule.order() >= 2.0).then_some(0.0);
    let control: Control = with_projection;
    let lacks_zeta = !terms.contains(&Suspect::Accumulation);
    trials.push(exact("zeta alone", &zeta, course, lacks_zeta.then_some(control)));
    let memory = Terms::from([Suspect::Memory]);
    // The rate c of a kernel a exp(-c t) or t^{-a} b exp(-c t), where it is one. Of several terms none is taken alone: their
    // course is that of the scene.
    let rate = |term: &RelaxationTerm| match term.singular {
        Some(parts) => single(scene.formulas.exponential_sum(parts.factor)),
        None => single(term.exponentials.clone()),
    };
    let written = &body.material.memory;
    let course = match (scene.time.rule, &written[..]) {
        (TimeRule::Trapezoid, []) => Some(1.0 / horizon),
        (TimeRule::Trapezoid, [term]) => rate(term).filter(|_| term.singular.is_none()),
        // v, or the product of it with what a singular kernel has beside its power, is interpolated linearly.
        (TimeRule::ProductIntegration, [term]) if term.singular.is_some() => rate(term),
        (TimeRule::ProductIntegration, several) => {
            several.iter().all(|term| term.singular.is_none()).then_some(0.0)
        }
        _ => None,
    };
    let control: Control = with_memory;
    if course.is_some() {
        let control = written.is_empty().then_some(control);
        trials.push(exact("memory alone", &memory, course, control));
    } else if !written.is_empty() && memory != terms {
        trials.push(of_scene("memory alone", &memory));
    }
    trials
}

fn single(exponentials: Option<Vec<(f64, f64)>>) -> Option<f64> {
    match exponentials?[..] {
        [(_, rate)] => Some(rate),
        _ => None,
    }
}

/// The trials outside V^h, for an order in h: all terms, each term removed, elasticity alone.
pub(super) fn trials_in_space(scene: &Scene) -> Vec<Trial> {
    let Some(body) = scene.as_contact() else { return Vec::new() };
    let (terms, bare) = (terms_of(body), Terms::new());
    let listed = scene.sweep.as_ref().map_or(Vec::new(), |sweep| sweep.n.clone());
    let mut n: Vec<u32> = listed.into_iter().filter(|&n| n <= FINEST).collect();
    n.sort_unstable();
    let promised = predicted(scene, Direction::H);
    let order = promised.map_or(1.0, |prediction| prediction.order);
    // The variants keep u and drop the claim on its regularity: where u is not in H² the interpolation error is not what
    // C_h must be.
    let singular = scene.violates.contains(&Hypothesis::RegularInSpace);
    let constant = !singular && promised.is_none_or(|prediction| prediction.constant);
    let trial = |name: String, kept: &Terms, removed| {
        let order = Prediction { constant, ..at_least(Direction::H, order, "(5.26)") };
        let grid = [n.clone(), vec![STEPS_IN_SPACE]];
        let (variant, mut outcome) = trial(scene, name, kept, Some(order), grid, |_, _| ());
        outcome.suspects.push(Suspect::Space);
        (variant, Outcome { removed, ..outcome })
    };
    let mut trials = vec![trial("all terms, in h".into(), &terms, None)];
    trials.extend(terms.iter().map(|&term| {
        let name = format!("without {}, in h", term.name());
        trial(name, &without(&terms, term), Some(term))
    }));
    if terms != bare {
        trials.push(trial("elasticity alone, in h".into(), &bare, None));
    }
    trials
}

fn predicted(scene: &Scene, variable: Direction) -> Option<&Prediction> {
    scene.predicts.iter().find(|prediction| prediction.variable == variable)
}

/// Share by which the constant of a variant may be off. A variant without its gap or its memory may stand at a kink of its
/// law, where the linearised step has two slopes: `affine-locked` without its gap is 0.6 % off. A wrong factor in a term is
/// beyond it.
const CONSTANT_WITHIN: f64 = 0.02;

/// A lower bound of an order in V_max: too high an order is no sign of a wrong term.
fn at_least(variable: Direction, order: f64, why: &str) -> Prediction {
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

/// u(t) replaced by its nodal interpolant on each mesh.
fn in_space(body: &mut ContactScene) {
    if let Data::Exact { interpolated, form, .. } = &mut body.data {
        (*interpolated, *form) = (true, LoadForm::Weak);
    }
}

/// u(t) replaced by an interpolated U, the largest of a few states of u, times exp(-c t) (1 + t/T)/2 with the given c, with which
/// the trapezoidal rule integrates exp(-c (t - s)) u(s) exactly (of c = 0 also ‖ε(u)‖); or, without a c, times one, for every
/// rule whose weights sum to t_n and where a multiplier may act.
///
/// Histories inside formulas of u are left out of U: they are the solution's, not the model's.
fn on_course(body: &mut ContactScene, graph: &mut Graph, horizon: f64, course: Option<f64>) {
    in_space(body);
    let points = interior(body);
    let Data::Exact { u, multiplier, selection, .. } = &mut body.data else { return };
    let sizes = [0.25, 0.5, 0.75, 1.0]
        .map(|part| (part * horizon, size(graph, u, part * horizon, &points)));
    let largest = sizes.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let at = largest.map_or(horizon, |(t, _)| t);
    let factor = course.map(|rate| {
        let numbers = [("rate", rate), ("slope", 0.5 / horizon)];
        graph.written("exp(-rate*t)*(0.5 + slope*t)", &[], &numbers)
    });
    for component in u.iter_mut() {
        let profile = graph.instant(*component, at);
        *component = factor.map_or(profile, |factor| graph.mul(factor, profile));
    }
    for stated in [multiplier, selection] {
        stated.retain(|_| course.is_none());
        stated.iter_mut().for_each(|(_, node)| *node = graph.instant(*node, at));
    }
}

/// Interior points per side at which a profile is sampled.
const SAMPLES: u32 = 6;

fn interior(body: &ContactScene) -> Vec<EvaluationPoint> {
    let at = |[x, y, z]: [f64; 3]| EvaluationPoint { x, y, z, ..EvaluationPoint::default() };
    body.domain.inner_points(SAMPLES).into_iter().map(at).collect()
}

/// Mean length at time t of the vector of these nodes over the points.
fn size(graph: &mut Graph, nodes: &[Node], t: f64, points: &[EvaluationPoint]) -> f64 {
    let now: Vec<Node> = nodes.iter().map(|&node| graph.instant(node, t)).collect();
    let length = |point: &EvaluationPoint| -> f64 {
        now.iter().map(|&node| graph.evaluate(node, point).powi(2)).sum::<f64>().sqrt()
    };
    points.iter().map(length).sum::<f64>() / points.len() as f64
}

/// Half of the smallest eigenvalue of 𝒜: μ_L where it is isotropic.
fn shear(body: &ContactScene) -> f64 {
    0.5 * body.material.elastic.eigenvalues(body.domain.dimension()).0
}

/// Memory b(t) = -exp(-t/T), ℬ₀ an identity: a control where the scene has none. It fades on the unit time scale, so its
/// integral over [0, T] stays below 𝒜/4.
fn with_memory(body: &mut ContactScene, graph: &mut Graph, horizon: f64) {
    let rate = 1.0 / horizon;
    let kernel = graph.written("-exp(-rate*t)", &[], &[("rate", rate)]);
    let exponentials = graph.exponential_sum(kernel);
    let mu = 0.25 * rate.min(1.0) * shear(body);
    let (singular, inner, regions) = (None, None, vec![[0.0, mu]; body.material.regions.len()]);
    body.material.memory =
        vec![RelaxationTerm { kernel, singular, exponentials, inner, lambda: 0.0, mu, regions }];
}

/// A projection that yields in a part of the body, beyond half of the mean |Du| at T and a fifth more over [0, T]: a control
/// where the scene has none.
fn with_projection(body: &mut ContactScene, graph: &mut Graph, horizon: f64) {
    let Data::Exact { u, .. } = &body.data else { return };
    let axes = [Variable::X, Variable::Y, Variable::Z];
    let pairs = u.iter().flat_map(|&component| axes.map(|axis| (component, axis)));
    let gradient: Vec<Node> = pairs.map(|(node, axis)| graph.derivative(node, axis)).collect();
    let strain = size(graph, &gradient, horizon, &interior(body));
    let slope = 0.2 / horizon;
    let numbers = [("start", 0.5 * strain), ("slope", slope)];
    let kappa = graph.written("start + slope*zeta", &[], &numbers);
    let mu = shear(body);
    body.material.projection = Some(Projection { mu, kappa, lipschitz: slope });
}
