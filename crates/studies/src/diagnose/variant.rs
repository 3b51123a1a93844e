//! Variants of a scene: terms removed, u(t) put into V^h, or replaced by a profile whose history is integrated exactly.
//!
//! The loads of a variant are derived from its exact solution and its terms, so each of them is
//! a sound manufactured scene, and whatever it shows is the solver's doing.

use super::term::{SceneTerms, Suspect};
use formula::{EvaluationPoint, Graph, Node, Scope, Variable};
use scene::{
    Body, ContactScene, Data, Direction, Domain, Expectation, Hypothesis, LoadForm, Norm,
    Prediction, Projection, RelaxationTerm, Scene, Sweep,
};
use vhi::law::FourthOrder;

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
        if let Some(contact) = &mut body.contact {
            contact.law = contact.law.take().filter(|_| kept.has(Suspect::Compliance));
            contact.gap = contact.gap.filter(|_| kept.has(Suspect::Gap));
        }
        if let Data::Exact { multiplier, selection, .. } = &mut body.data {
            *multiplier = multiplier.filter(|_| kept.has(Suspect::Gap));
            *selection = selection.filter(|_| kept.has(Suspect::Compliance));
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
        *multiplier = multiplier.filter(|_| constant).map(|node| graph.instant(node, at));
        *selection = selection.filter(|_| constant).map(|node| graph.instant(node, at));
    })
}

fn factor(graph: &mut Graph, course: Course, horizon: f64) -> Node {
    let t = graph.variable(Variable::T);
    let (half, slope) = (graph.constant(0.5), graph.constant(0.5 / horizon));
    let rising = graph.mul(slope, t);
    let line = graph.add(half, rising);
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
        body.memory =
            vec![RelaxationTerm { kernel, singular: None, exponentials, lambda, mu, regions }];
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
