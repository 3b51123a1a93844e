//! The error of one run from coarser companions: the same scene with 2h, 4h and with 2k, 4k.
//!
//! Space and time each have two differences of nested runs, d₁ of the two finest and d₂ of the two coarser, hence an
//! order p = log₂(d₂/d₁) and estimates d₁ F(p). In time, and wherever errors are aligned, F = 1/(2^p - 1)
//! (Richardson). In space u - u_h is nearly orthogonal to u_h - u_2h in the energy norm (Céa), which gives
//! F = 1/(4^p - 1)^½; in norms without orthogonality both are admissible. No estimate says which order the next
//! refinement would show: the interval is the hull over the observed order, half an order around it as far as it is
//! positive (with three levels there is no drift to measure), and the order of the theorem where the observed one is
//! within that half. Outside of these no number is given, but the reason.

mod answer;

pub use answer::{Advice, Advised, Estimated, Goal, advise, estimate};

use std::collections::BTreeMap;

use super::SPAN;
use super::bench::Meshed;
use crate::solution::FinalState;
use crate::study::StudyError;
use fem::contact::{CaseError, Discretization, Floors, LevelFields, LoadError, Observer, StepView};
use fem::norms::{ReferenceError, ReferenceRun, step_errors};
use guarantee::{Bounding, Guarantee, GuaranteeError};
use judge::fit::{FLOORS_ABOVE, Interval, Triple, ValueSample};
use run::sweep::{NORMS, Runs, as_floors, floor_in};
use scene::setup::{Setup, SetupError};
use scene::{Direction, Norm};
use serde_json::Value;

/// Half of the width of the orders that are admitted around an observed one. On h ≤ 1/8 the shipped scenes with P1 and P2
/// have local orders within 0.3 of their limit; a half leaves room for singular corners.
const HALF: f64 = 0.5;

/// How the errors of two refinements lie to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alignment {
    /// One direction: e_2h = e_h + d.
    Aligned,
    /// At right angles, e_2h² = e_h² + d².
    Orthogonal,
    /// Not known: both.
    Either,
}

/// One admissible reading of the differences: the error of the run, and how it changes with the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Error of the run.
    pub value: f64,
    /// p towards coarser steps, where the companions are.
    pub order: f64,
    /// The order towards finer steps, where nothing was run: at most the order of elements and rule.
    pub finer: f64,
}

impl Reading {
    /// e (s/s₀)^p, with `ratio` = s/s₀ of a step to that of the run.
    pub(crate) fn at(self, ratio: f64) -> f64 {
        let order = if ratio < 1.0 { self.finer } else { self.order };
        self.value * ratio.powf(order)
    }
}

/// The error of a run in one step.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Observed order; none where the run depends on the step by rounding alone, which bounds the error.
    pub order: Option<f64>,
    /// All that is admissible, the best first.
    pub readings: Vec<Reading>,
    /// The most that elements, rule or theorem allow towards finer steps.
    pub most: f64,
}

impl Part {
    /// No error but rounding.
    fn below(bound: f64) -> Self {
        let readings = [0.0, bound].map(|value| Reading { value, order: 0.0, finer: 0.0 });
        Self { order: None, readings: readings.into(), most: f64::INFINITY }
    }

    /// Reads d₁ and d₂; `theory` is the order of a theorem, where there is one.
    ///
    /// # Errors
    /// Why there is no estimate.
    pub fn of(
        [fine, coarse]: [f64; 2],
        floor: f64,
        theory: Option<f64>,
        how: Alignment,
    ) -> Result<Self, String> {
        if !(fine.is_finite() && coarse.is_finite()) {
            return Err("a difference of runs is NaN".into());
        }
        if fine.max(coarse) <= FLOORS_ABOVE * floor {
            return Ok(Self::below(FLOORS_ABOVE * floor));
        }
        if fine <= FLOORS_ABOVE * floor {
            return Err(format!(
                "the last difference {fine:.1e} is not above {FLOORS_ABOVE} floors of {floor:.1e}"
            ));
        }
        let order = (coarse / fine).log2();
        if order < LEAST_ORDER {
            return Err(format!(
                "pre-asymptotic: differences of {coarse:.2e} and {fine:.2e} have order {order:.2}"
            ));
        }
        if let Some(theory) = theory.filter(|theory| order > theory + 2.0 * HALF) {
            return Err(format!(
                "pre-asymptotic: order {order:.2} observed, {theory} predicted; a coarse companion does not resolve the solution"
            ));
        }
        let near = theory.filter(|theory| (theory - order).abs() <= HALF);
        let orders = [order, order - HALF, order + HALF].into_iter();
        // A theorem's order that is near the observed one is the likelier of both.
        let orders = std::iter::once(near.unwrap_or(order)).chain(orders).chain(near);
        let read = |order: f64| {
            let values = factors(order, how).into_iter().map(move |factor| factor * fine);
            values.map(move |value| Reading { value, order, finer: order })
        };
        let readings = orders.filter(|order| *order >= LEAST_ORDER).flat_map(read).collect();
        Ok(Self { order: Some(order), readings, most: f64::INFINITY })
    }

    /// Best value and hull of the admissible ones, at `ratio` times the step of the run.
    pub fn at(&self, ratio: f64) -> Option<(f64, Interval)> {
        let values = || self.readings.iter().map(|reading| reading.at(ratio));
        Some((values().next()?, Interval::of(values())?))
    }

    /// Keeps the orders of the readings towards finer steps within `limits`.
    fn limited(mut self, limits: Interval) -> Self {
        for reading in &mut self.readings {
            reading.finer = reading.finer.max(limits.lo).min(limits.hi);
        }
        Self { most: limits.hi, ..self }
    }
}

/// e_h over d₁ for an order, the likelier first.
fn factors(order: f64, how: Alignment) -> Vec<f64> {
    let aligned = 1.0 / (2f64.powf(order) - 1.0);
    let orthogonal = 1.0 / (4f64.powf(order) - 1.0).sqrt();
    match how {
        Alignment::Aligned => vec![aligned],
        Alignment::Orthogonal => vec![orthogonal],
        Alignment::Either => vec![orthogonal, aligned],
    }
}

/// The error of a run in both steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The error in h, or why there is no estimate.
    pub space: Result<Part, String>,
    /// The error in k, likewise.
    pub time: Result<Part, String>,
}

impl Estimate {
    /// Both together: best by the root of the sum of squares, the hull from the larger lower end (errors may cancel no
    /// further than that in either model of `fit`) to the sum of the upper ones. None where a part is unknown.
    pub fn total(&self) -> Option<(f64, Interval)> {
        self.at([1.0; 2])
    }

    /// The error at other steps, `ratios` = \[h/h₀, k/k₀\] to those of the run: E² = (e_h (h/h₀)^p)² + (e_k (k/k₀)^q)².
    pub(crate) fn at(&self, ratios: [f64; 2]) -> Option<(f64, Interval)> {
        let (h, space) = self.space.as_ref().ok()?.at(ratios[0])?;
        let (k, time) = self.time.as_ref().ok()?.at(ratios[1])?;
        Some((h.hypot(k), Interval { lo: space.lo.max(time.lo), hi: space.hi + time.hi }))
    }

    /// Why there is no total.
    pub fn reasons(&self) -> Vec<String> {
        let parts = [("h", &self.space), ("k", &self.time)].into_iter();
        let reason = |(step, part): (_, &Result<Part, String>)| {
            part.as_ref().err().map(|reason| format!("{step}: {reason}"))
        };
        parts.filter_map(reason).collect()
    }
}

/// The error of the run in one norm.
///
/// Orders towards finer steps are at most those of elements and rule (strains and stresses have the degree of the element,
/// displacements one more; the trapezoidal rule k²), and no more than a theorem says, unless it says "at least". The least is
/// zero, unless the observed order is within `HALF` of that of a theorem: then it is below the theorem's by twice their
/// distance, the rule of `fit` for a drift, ± 2 |last - limit|.
pub fn norm_estimate(setup: &Setup, found: &Companions, differences: &NormDifferences) -> Estimate {
    let NormDifferences { norm, space, time, floor } = *differences;
    // Galerkin's orthogonality is one of strains.
    let degree = setup.body.element.degree() as f64;
    let (how, in_h) = match norm {
        Norm::VMax | Norm::StressL2Max => (Alignment::Orthogonal, degree),
        _ => (Alignment::Either, degree + 1.0),
    };
    let read = |i: usize, variable, apart, how, scheme: f64| {
        if let Some(missing) = &found.missing[i] {
            return Err(missing.clone());
        }
        let theory = setup.scene.predicts.iter().find(|p| p.norm == norm && p.variable == variable);
        // A theorem that says "at least" does not contradict a higher order that is observed.
        let exact = theory.filter(|p| !p.at_least).map(|p| p.order);
        let part = match found.free[i] {
            true => Part::below(0.0),
            false => Part::of(apart, floor, exact, how)?,
        };
        let away = theory.zip(part.order).map(|(p, order)| (p.order, (p.order - order).abs()));
        let near = away.filter(|(_, away)| *away <= HALF);
        let lo = near.map_or(0.0, |(order, away)| order - 2.0 * away);
        Ok(part.limited(Interval { lo, hi: exact.map_or(scheme, |order| order.min(scheme)) }))
    };
    let space = read(0, Direction::H, space, how, in_h);
    let in_k = setup.scene.time.rule.order();
    Estimate { space, time: read(1, Direction::K, time, Alignment::Aligned, in_k) }
}

// A run with its coarser companions, and the differences of each pair in every norm.

/// What the companions of a run show.
#[derive(Clone)]
pub struct Companions {
    /// The run itself at t = T.
    pub state: FinalState,
    /// Differences in each norm.
    pub norms: Vec<NormDifferences>,
    /// Scalars of the state with what their companions say of them.
    pub quantities: Vec<QuantityEstimate>,
    /// Why there are no companions in h, and in k.
    pub missing: [Option<String>; 2],
    /// Whether h has no error, because the data depend on the mesh and another one is another problem; and k, because no level
    /// depends on another.
    pub free: [bool; 2],
    /// Largest ‖ε(u_n)‖ of the run.
    pub size: f64,
    /// What each run took, the run itself first.
    pub times: Vec<RunTime>,
    /// The guaranteed bound of the error in space of the run itself, or why there is none.
    pub bound: Result<Guarantee, String>,
}

/// CPU seconds of one run as if it were alone: mesh, analysis, loads and march, without what companions are kept and
/// compared for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunTime {
    /// Cells per unit length.
    pub n: u32,
    /// Number of steps.
    pub steps: u32,
    /// CPU seconds of the thread.
    pub seconds: f64,
}

/// The differences [d₁, d₂] of one norm, of the two finest runs and of the two coarser ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormDifferences {
    /// The norm.
    pub norm: Norm,
    /// The changes in h; NaN where there are no companions.
    pub space: [f64; 2],
    /// The changes of the quantity in k, likewise.
    pub time: [f64; 2],
    /// What solver and rounding leave in any of the runs.
    pub floor: f64,
}

/// Levels of the coarsest companion in time that are compared at most, beside the last.
const COMPARED: u32 = 64;
/// Times that differ by less than this part of T are the same, but for rounding.
const SAME_TIME: f64 = 1e-9;

/// One run: levels at the compared times, the state at T, floors.
struct Run {
    time: RunTime,
    size: f64,
    state: FinalState,
    floors: Floors,
    levels: Vec<LevelFields>,
    kept: ReferenceRun,
    /// Largest distance to the finer run that it was compared with.
    apart: Floors,
}

/// What sees the levels of the run itself, on its space.
pub type Watch<'a> = dyn FnMut(&Discretization, &StepView<'_>) + 'a;

/// Runs a scene on (n, N), which is bounded and watched, and on the coarser companions that it has.
///
/// # Errors
/// Of the run itself, and of a bound that the theorem covers; a companion that fails is `missing`.
pub fn companions(
    setup: &Setup,
    n: u32,
    steps: u32,
    watch: &mut Watch<'_>,
) -> Result<Companions, StudyError> {
    let mesh = Meshed::new(setup, n)?;
    let mut bounding = Bounding::new(setup, &mesh.data, steps);
    let finest = run(setup, &mesh, [steps, steps], None, &mut |view| {
        bounding.iter_mut().for_each(|bounding| bounding.see(view));
        watch(&mesh.data.space, view);
        Ok(())
    })?;
    let bound = match bounding.and_then(Bounding::finish) {
        Err(GuaranteeError::NoBound(reason)) => Err(reason),
        found => Ok(found?),
    };
    drop(mesh);
    let no_history = setup.model.memory.is_empty() && setup.kappa.lipschitz == 0.0;
    let free = [setup.body.data.is_interpolated(), no_history];
    let [in_time, in_space] = [1, 0].map(|i| match free[i] {
        true => Ok(Vec::new()),
        false => coarser(setup, &finest, i),
    });
    let runs: [Companion; 2] = [in_space, in_time];
    let all = || std::iter::once(&finest).chain(runs.iter().rev().flatten().flatten());
    let floors = all().fold(Floors::default(), |floors, run| floors.max(run.floors));
    let differences = |runs: &Companion, norm| match runs.as_deref() {
        Ok([half, quarter]) => [half, quarter].map(|run| floor_in(&run.apart, norm)),
        _ => [f64::NAN; 2],
    };
    let on_contact = !setup.model.boundary.is_empty();
    let norms = NORMS.into_iter().filter(|norm| on_contact || !norm.needs_contact());
    let norms = norms.map(|norm| NormDifferences {
        norm,
        space: differences(&runs[0], norm),
        time: differences(&runs[1], norm),
        floor: floor_in(&floors, norm),
    });
    let triple = |runs: &Companion, name: &str, value: f64| {
        let Ok([half, quarter]) = runs.as_deref() else { return None };
        let [half, quarter] = [half, quarter].map(|run| scalars(&run.state).get(name).copied());
        Some([quarter?, half?, value])
    };
    // Displacements have one degree more than strains; no functional is trusted to do better.
    let formal = [setup.body.element.degree() as f64 + 1.0, setup.scene.time.rule.order()];
    let formal = [0, 1].map(|i| (!free[i]).then_some(formal[i]));
    let quantities = scalars(&finest.state).into_iter().map(|(name, value)| {
        let values = [0, 1].map(|i| triple(&runs[i], &name, value));
        quantity(&name, values, value, formal)
    });
    Ok(Companions {
        norms: norms.collect(),
        quantities: quantities.collect(),
        times: all().map(|run| run.time).collect(),
        missing: runs.each_ref().map(|runs| runs.as_ref().err().cloned()),
        free,
        size: finest.size,
        state: finest.state,
        bound,
    })
}

/// The run of [`companions`] with the memory that it takes: beside the run, the compared levels of it and of two
/// companions, with u and σ held twice.
pub fn companion_runs(setup: &Setup, n: u32, steps: u32) -> Runs<'_> {
    let beside = move |space: &Discretization, _| {
        let d = space.mesh.dimension;
        let stresses = d * (d + 1) / 2 * space.geometry.points();
        let compared = steps / stride(steps, steps) + 2;
        let held = 3.0 * 2.0 * 8.0 * f64::from(compared) * (space.nodes.len() + stresses) as f64;
        held + guarantee::bytes(setup, space)
    };
    Runs { setup, grid: vec![(n, steps)], beside: Box::new(beside) }
}

/// The two companions in one step, none where it makes no difference; or why there are none.
type Companion = Result<Vec<Run>, String>;

/// Coarser runs, each from nothing and compared with the one before: on the same mesh point by point, on another one by
/// moments.
fn coarser(setup: &Setup, finest: &Run, i: usize) -> Companion {
    let RunTime { n, steps, .. } = finest.time;
    // A fourth of n, or of N, has what companions share with the run.
    let (name, count) = [("n", n), ("N", steps)][i];
    if !count.is_multiple_of(SPAN) {
        return Err(format!("{name} = {count} is no multiple of {SPAN}"));
    }
    let fourth = count / SPAN;
    if i == 0 {
        let none = |_| format!("the domain has no mesh with n = {fourth}");
        setup.scene.check_cells(fourth).map_err(none)?;
    } else {
        let (fine, coarse) = (setup.grid(count), setup.grid(fourth));
        let apart = |j: usize| (fine.time(SPAN as usize * j) - coarse.time(j)).abs();
        if (0..=coarse.steps()).any(|j| apart(j) > SAME_TIME * fine.time(fine.steps())) {
            return Err("the grids of N and N/4 steps share no times".into());
        }
    }
    let mut found: Vec<Run> = Vec::new();
    for part in [2, 4] {
        let [n, steps] = if i == 0 { [n / part, steps] } else { [n, steps / part] };
        let finer = found.last().unwrap_or(finest);
        let other = (n != finer.time.n).then_some(&finer.kept);
        let one = || -> Result<Run, SetupError> {
            let mesh = Meshed::new(setup, n)?;
            let mut one = run(setup, &mesh, [steps, finest.time.steps], other, &mut |_| Ok(()))?;
            if other.is_none() {
                let pairs = finer.levels.iter().zip(&one.levels);
                let apart = pairs.map(|(a, b)| a.distance(b, &mesh.data.space));
                one.apart = apart.fold(Floors::default(), Floors::max);
            }
            Ok(one)
        };
        let failed = |e| format!("the companion run with n = {n}, N = {steps} fails: {e}");
        let one = one().map_err(failed)?;
        found.push(one);
    }
    Ok(found)
}

/// A run whose levels are kept at the times of N/4 steps (thinned), N = `finest`; `finer` is what it is compared with.
fn run(
    setup: &Setup,
    mesh: &Meshed,
    [steps, finest]: [u32; 2],
    finer: Option<&ReferenceRun>,
    watch: &mut Observer<'_>,
) -> Result<Run, CaseError> {
    let refused = |error: ReferenceError| LoadError::Reference { reason: error.to_string() };
    let (n, space) = (mesh.data.space.mesh.n, &mesh.data.space);
    let refinement = finer.map(|finer| finer.refinement(space)).transpose().map_err(refused)?;
    let stride = stride(steps, finest) as usize;
    let mut kept = ReferenceRun::new(space.clone());
    let (mut levels, mut state, mut apart) = (Vec::new(), None, Floors::default());
    let (info, seconds) = mesh.march(setup, steps, &mut |view| {
        watch(view)?;
        let last = view.n == steps as usize;
        if !(last || view.n.is_multiple_of(stride)) {
            return Ok(());
        }
        if let Some((finer, refinement)) = finer.zip(refinement.as_ref()) {
            let truth = finer.moments(refinement, space, view.t).map_err(refused)?;
            apart = apart.max(as_floors(&step_errors(space, &setup.model, view, &truth)));
        }
        kept.keep(&setup.model, view);
        levels.push(LevelFields::of(space, &setup.model, view));
        if last {
            state = Some(FinalState::new(space, &setup.model, view));
        }
        Ok(())
    })?;
    let missing =
        || LoadError::Reference { reason: format!("the run on n = {n} has no last level") };
    let (state, time) = (state.ok_or_else(missing)?, RunTime { n, steps, seconds });
    Ok(Run { time, size: info.strain_norm, state, floors: info.floors, levels, kept, apart })
}

/// Levels of a run with `steps` steps between two compared ones, N = `finest` being the steps of the finest.
fn stride(steps: u32, finest: u32) -> u32 {
    let compared = if finest.is_multiple_of(SPAN) { finest / SPAN } else { finest };
    compared.div_ceil(COMPARED).max(1) * (steps / compared).max(1)
}

/// The scalars of a state; counts of vertices and cells have no order.
fn scalars(state: &FinalState) -> BTreeMap<String, f64> {
    let Ok(Value::Object(fields)) = serde_json::to_value(state) else { return BTreeMap::new() };
    let number = |(name, value): (String, Value)| {
        value.as_f64().filter(|_| value.is_f64()).map(|value| (name, value))
    };
    fields.into_iter().filter_map(number).collect()
}

// Named quantities at t = T: how far each is from its limit, from the same companions.

/// Below this order differences fall too slowly to say anything about what is left.
pub(super) const LEAST_ORDER: f64 = 0.3;

/// A quantity with what h and k leave open in it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct QuantityEstimate {
    /// Its name, see `solution::FinalState`.
    pub name: String,
    /// Its value in the run.
    pub value: f64,
    /// The value with what either extrapolation adds, where both have a limit.
    pub extrapolated: Option<f64>,
    /// Estimate of the distance to the limit: the sum of the two grid convergence indices. It is no bound.
    pub uncertainty: Option<f64>,
    /// Observed orders in h and k.
    pub orders: [Option<f64>; 2],
    /// Why there is no estimate.
    pub reason: Option<String>,
}

/// Safety factor of the index where the observed order is within a tenth of the formal one, and elsewhere, where it is the
/// smaller of both that counts, and at least ½ (Oberkampf and Roy, Verification and Validation in Scientific Computing, 2010,
/// §8.6.3).
const SAFETY: [f64; 2] = [1.25, 3.0];
const AS_FORMAL: f64 = 0.1;

/// Reads the values of a quantity on [4h, 2h, h] and on [4k, 2k, k], None for a direction that was not run; `formal` are the
/// orders of element and rule, none where the direction has no error.
pub(super) fn quantity(
    name: &str,
    values: [Option<[f64; 3]>; 2],
    value: f64,
    formal: [Option<f64>; 2],
) -> QuantityEstimate {
    let read = |[coarse, middle, fine]: [f64; 3]| {
        let at = |step: f64, value: f64| ValueSample { step, value };
        Triple::of([at(4.0, coarse), at(2.0, middle), at(1.0, fine)])
    };
    let triples = values.map(|values| values.map(read));
    let (mut shift, mut width, mut reason) = (0.0, 0.0, None);
    for (i, step) in ["h", "k"].into_iter().enumerate() {
        let Some(formal) = formal[i] else { continue };
        let refused = match values[i].zip(triples[i]) {
            Some(([_, middle, fine], Triple::Converging { order, .. })) if order >= LEAST_ORDER => {
                let counts = order.max(0.5).min(formal);
                let correction = factors(counts, Alignment::Aligned)[0] * (fine - middle);
                let as_formal = (order - formal).abs() <= AS_FORMAL * formal;
                shift += correction;
                width += SAFETY[usize::from(!as_formal)] * correction.abs();
                continue;
            }
            // No order, but no further away than the values are from each other.
            Some((_, Triple::Oscillating { half_range })) => {
                width += 2.0 * half_range;
                continue;
            }
            // A place on the mesh moves by whole cells.
            Some((_, Triple::Stationary)) if step == "h" && value != 0.0 => {
                "the same on all three meshes: a constraint, or a place that moves by whole cells"
                    .into()
            }
            Some((_, Triple::Stationary)) => continue,
            Some((_, Triple::Converging { order, .. } | Triple::Diverging { order })) => {
                format!("pre-asymptotic in {step}: order {order:.2}")
            }
            None => format!("no companions in {step}"),
        };
        reason.get_or_insert(refused);
    }
    QuantityEstimate {
        name: name.into(),
        value,
        extrapolated: reason.is_none().then_some(value + shift),
        uncertainty: reason.is_none().then_some(width),
        orders: triples.map(|triple| triple.and_then(Triple::order)),
        reason,
    }
}

#[cfg(test)]
mod tests {
    mod estimate {
        use super::super::*;

        fn of(apart: [f64; 2], theory: Option<f64>, how: Alignment) -> Part {
            Part::of(apart, 0.0, theory, how).expect("an estimate")
        }

        fn known(apart: [f64; 2], theory: Option<f64>, how: Alignment) -> (f64, f64, Interval) {
            let part = of(apart, theory, how);
            let (value, interval) = part.at(1.0).expect("readings");
            (part.order.expect("an order"), value, interval)
        }

        #[test]
        fn aligned_errors_are_found_with_their_order() {
            // u_h = u + C h²: e = 1, d₁ = 3, d₂ = 12.
            let (order, value, interval) = known([3.0, 12.0], Some(2.0), Alignment::Aligned);
            assert!((order - 2.0).abs() < 1e-15 && (value - 1.0).abs() < 1e-15);
            assert!(interval.contains(1.0) && interval.lo > 0.5 && interval.hi < 1.7);
            // The estimate of orthogonal errors does not hold them.
            let (_, _, wrong) = known([3.0, 12.0], Some(2.0), Alignment::Orthogonal);
            assert!(wrong.contains(3.0 / 15f64.sqrt()));
        }

        #[test]
        fn orthogonal_errors_are_found_with_their_order() {
            // e² = h²: e = 1, 2, 4 at h, 2h, 4h; d₁² = 3, d₂² = 12.
            let (fine, coarse) = (3f64.sqrt(), 12f64.sqrt());
            let (order, value, interval) = known([fine, coarse], Some(1.0), Alignment::Orthogonal);
            assert!((order - 1.0).abs() < 1e-15 && (value - 1.0).abs() < 1e-15);
            assert!(interval.contains(1.0) && interval.hi < 2.0);
            let (_, _, both) = known([fine, coarse], None, Alignment::Either);
            assert!(both.contains(1.0) && both.contains(fine));
        }

        #[test]
        fn what_is_not_asymptotic_has_no_estimate() {
            // Differences that grow, that stand still, that fall far faster than the theorem says, NaN.
            for (d, theory) in [
                ([2.0, 1.0], None),
                ([1.0, 1.0], Some(1.0)),
                ([1.0, 10.0], Some(1.0)),
                ([f64::NAN, 1.0], None),
            ] {
                assert!(Part::of(d, 0.0, theory, Alignment::Aligned).is_err(), "{d:?}");
            }
            assert!(Part::of([1e-12, 1.0], 1e-12, None, Alignment::Aligned).is_err());
            let below = Part::of([1e-13, 1e-13], 1e-13, None, Alignment::Aligned);
            assert_eq!(below, Ok(Part::below(FLOORS_ABOVE * 1e-13)));
        }

        #[test]
        fn a_total_needs_both_parts() {
            let read = |value| Reading { value, order: 1.0, finer: 1.0 };
            let part = |value: f64| {
                let readings = [1.0, 0.5, 2.0].map(|factor| read(factor * value)).to_vec();
                Ok(Part { order: Some(1.0), readings, most: 1.0 })
            };
            let both = Estimate { space: part(3.0), time: part(4.0) };
            let (value, interval) = both.total().expect("a total");
            assert!((value - 5.0).abs() < 1e-15 && interval == Interval { lo: 2.0, hi: 14.0 });
            let one = Estimate { time: Err("N = 3".into()), ..both };
            assert!(one.total().is_none() && one.reasons() == ["k: N = 3"]);
        }

        #[test]
        fn other_steps_have_the_errors_of_the_law() {
            // 3 h + 4 k² in the sense of u_h - u, at h = k = 1: d₁ = 3, d₂ = 6 in h, 12 and 48 in k.
            let space = Part::of([3.0, 6.0], 0.0, None, Alignment::Aligned);
            let time = Part::of([12.0, 48.0], 0.0, None, Alignment::Aligned);
            let estimate = Estimate { space, time };
            for [h, k] in [[1.0, 1.0], [0.25, 0.5], [2.0, 0.1], [0.1, 4.0]] {
                let (value, interval) = estimate.at([h, k]).expect("both parts");
                let truth = (3.0 * h).hypot(4.0 * k * k);
                // Roundings of powers.
                assert!((value / truth - 1.0).abs() < 1e-14, "{h} {k}: {value} {truth}");
                assert!(interval.contains(truth));
            }
            // Half an order less over a factor 16 is a factor 4 of error, beside that of the value itself.
            let (value, interval) = estimate.at([1.0 / 16.0; 2]).expect("both parts");
            assert!(interval.hi > 4.0 * value && interval.lo < value / 4.0);
            // Nothing falls faster than its elements, and nothing is changed towards coarser steps.
            let fast = of([3.0, 12.0], None, Alignment::Orthogonal);
            let limited = fast.clone().limited(Interval { lo: 0.0, hi: 1.0 });
            let best = |part: &Part, ratio: f64| part.at(ratio).expect("a value").0;
            assert!((best(&limited, 0.25) / best(&limited, 1.0) - 0.25).abs() < 1e-15);
            assert!((best(&fast, 0.25) / best(&fast, 1.0) - 0.0625).abs() < 1e-15);
            assert_eq!(best(&limited, 4.0), best(&fast, 4.0));
            // A theorem bounds the slowest reading as well: without it half an order less goes on.
            let upper = |part: &Part| part.at(1.0 / 64.0).expect("a hull").1.hi;
            let slow = fast.clone().limited(Interval { lo: 0.9, hi: 1.0 });
            let unlimited = of([3.0, 6.0], None, Alignment::Orthogonal);
            let bounded = unlimited.clone().limited(Interval { lo: 0.9, hi: 1.0 });
            assert!((upper(&unlimited) / upper(&bounded) / 64f64.powf(0.4) - 1.0).abs() < 1e-14);
            assert!(upper(&slow) <= upper(&limited));
        }
    }

    mod quantity {
        use super::super::*;

        const FORMAL: [Option<f64>; 2] = [Some(2.0); 2];

        #[test]
        fn the_estimate_holds_the_limit_of_power_laws() {
            // 5 + 2h² + k² at h = k = 0.1.
            let at = |h: f64, k: f64| 5.0 + 2.0 * h * h + k * k;
            let space = [at(0.4, 0.1), at(0.2, 0.1), at(0.1, 0.1)];
            let time = [at(0.1, 0.4), at(0.1, 0.2), at(0.1, 0.1)];
            let found = quantity("q", [Some(space), Some(time)], at(0.1, 0.1), FORMAL);
            // Differences of numbers of size 5 with 16 digits, over 3.
            assert!((found.extrapolated.expect("a limit") - 5.0).abs() < 1e-13);
            // Roache's factor 1.25 on both corrections.
            assert!((found.uncertainty.expect("an estimate") - 1.25 * 0.03).abs() < 1e-13);
            let orders = found.orders.map(|order| order.expect("an order"));
            assert!(orders.iter().all(|order| (order - 2.0).abs() < 1e-10));
        }

        #[test]
        fn what_does_not_converge_has_no_estimate() {
            let in_h = |values: [f64; 3]| {
                quantity("q", [Some(values), None], values[2], [Some(2.0), None])
            };
            let growing = in_h([0.0, 1.0, 3.0]);
            assert!(growing.uncertainty.is_none() && growing.extrapolated.is_none());
            assert!(growing.reason.expect("a reason").contains("in h"));
            let missing = quantity("q", [None, Some([3.0; 3])], 3.0, FORMAL);
            assert!(missing.uncertainty.is_none());
            let oscillating = in_h([3.1, 2.9, 3.0]);
            assert!((oscillating.uncertainty.expect("a range") - 0.2).abs() < 1e-15);
            // The width of a zone on a mesh, which jumps later.
            assert!(
                in_h([0.25; 3]).uncertainty.is_none() && in_h([0.0; 3]).uncertainty == Some(0.0)
            );
        }

        /// An order of four, by chance: that of the element counts, with the larger factor.
        #[test]
        fn an_order_above_that_of_the_element_narrows_nothing() {
            let found = quantity("q", [Some([9.0, 1.0, 0.5]), None], 0.5, [Some(2.0), None]);
            assert!((found.uncertainty.expect("an estimate") - 3.0 * 0.5 / 3.0).abs() < 1e-15);
            assert!((found.extrapolated.expect("a limit") - (0.5 - 0.5 / 3.0)).abs() < 1e-15);
        }
    }
}
