//! Which n and N have an error at least cost.
//!
//! With S = C_h h^p and T = C_k k^q a cost c h^-a k^-b is a multiple of S^(-a/p) T^(-b/q), least under a given error
//! where p S^m / a = q T^m / b, m = 1 for E = S + T and m = 2 for E² = S² + T² (Lagrange: the slopes of log cost and
//! of E^m in log h and log k are parallel). Hence S^m = E^m (a/p)/(a/p + b/q), T^m is the rest, k is a multiple of
//! h^(p/q), and the cost of an error grows like E^-(a/p + b/q). Runs have whole n and N, among which [`Choices`] searches.

use std::cell::RefCell;
use std::collections::HashMap;

use super::models::ErrorModel;
use files::megabytes;
use judge::fit::FLOORS_ABOVE;
use run::sweep::{MemoryLimit, NORMS, TooLarge, admit_run, run_cost, scene_reference};
use scene::Norm;
use scene::setup::{Setup, SetupError, Subject, check_step_sizes};

/// The path k = c h^s of the optima of all errors.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(super) struct Coupling {
    /// s = p/q.
    pub exponent: f64,
    /// c.
    pub factor: f64,
    /// Part of E^m that is left to space, (a/p)/(a/p + b/q).
    pub space_share: f64,
    /// The cost of an error grows like E to minus this: a/p + b/q.
    pub cost_exponent: f64,
}

/// The coupling, where both terms are there and the cost grows with either refinement.
pub(super) fn coupling(error: &ErrorModel, [a, b]: [f64; 2]) -> Option<Coupling> {
    let (space, time) = (error.space?, error.time?);
    let (alpha, beta) = (a / space.order, b / time.order);
    if !(alpha > 0.0 && beta > 0.0) {
        return None;
    }
    // T^m = S^m β/α.
    let ratio = (beta / alpha).powf(1.0 / error.model.exponent());
    Some(Coupling {
        exponent: space.order / time.order,
        factor: (ratio * space.constant / time.constant).powf(1.0 / time.order),
        space_share: alpha / (alpha + beta),
        cost_exponent: alpha + beta,
    })
}

/// No larger n or N is proposed: `sweep solve` takes no larger n, and N beyond it is a separate campaign.
pub(super) const MOST: [u32; 2] = [4096, 100_000];

/// A number at (h, k).
pub(super) type AtSteps<'a> = dyn Fn(f64, f64) -> f64 + 'a;

/// What errors and costs are, the one growing and the other falling with either step, and where that may be believed.
pub(super) struct Law<'a> {
    pub error: Box<AtSteps<'a>>,
    /// CPU seconds.
    pub seconds: Box<AtSteps<'a>>,
    /// The least and the largest n and N.
    pub range: [[u32; 2]; 2],
    /// Meshes up to this n are made to know their memory; that of finer ones follows from them.
    pub made: u32,
}

/// A run that is proposed.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Choice {
    /// The error that is wanted.
    pub target: f64,
    /// Cells per unit length.
    pub n: u32,
    /// Number of steps.
    pub steps: u32,
    /// Mesh size.
    pub h: f64,
    /// Largest time step.
    pub k: f64,
    /// Predicted error.
    pub error: f64,
    /// Predicted CPU seconds.
    #[serde(rename = "cpu_seconds")]
    pub seconds: f64,
    /// Predicted peak memory of a process that does this run alone.
    pub bytes: f64,
}

impl Choice {
    /// The choice in words; `with` is its setting, `interval` that of its error.
    pub(super) fn words(&self, with: &str, interval: &str) -> String {
        let Self { n, steps, h, k, error, seconds, bytes, .. } = *self;
        format!(
            "n = {n}, N = {steps}{with} (h = {h:.5}, k = {k:.5}), predicted: error {error:.3e}{interval}, {seconds:.3} CPU s, {}",
            megabytes(bytes)
        )
    }
}

/// A wanted error and its norm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    pub norm: Norm,
    error: Option<f64>,
    /// Whether the error is one relative to the largest ‖ε(u)‖.
    relative: bool,
}

impl Wanted {
    /// Reads both words; only norms with a value at every time level, and norms on Γ3 only with Γ3.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn read(setup: &Setup, norm: &str, error: Option<&str>) -> Result<Self, NoAnswer> {
        let refused = |text: String| Err(NoAnswer::Refused(text));
        let Some(norm) = NORMS.into_iter().find(|known| known.name() == norm) else {
            let known: Vec<&str> = NORMS.iter().map(|norm| norm.name()).collect();
            return refused(format!("no norm `{norm}` here: choose one of {}", known.join(", ")));
        };
        let name = norm.name();
        if norm.needs_contact() && setup.model.boundary.is_empty() {
            return refused(format!("`{name}` is a norm on Γ3, and the scene has none"));
        }
        let Some(text) = error else { return Ok(Self { norm, error: None, relative: false }) };
        let percent = text.trim().strip_suffix('%');
        let Ok(target) = percent.unwrap_or(text).trim().parse::<f64>() else {
            return refused(format!(
                "--target {text}: not a number; `0.01` is an error in the norm, `1%` a hundredth of the solution"
            ));
        };
        if !(target.is_finite() && target > 0.0) {
            return refused(format!("the target {target} must be positive"));
        }
        let relative = percent.is_some();
        if relative && norm != Norm::VMax {
            return refused(format!(
                "--target {text}: a part of the solution is known in V_max alone; give an error in {name}"
            ));
        }
        let error = if relative { target / 100.0 } else { target };
        Ok(Self { norm, error: Some(error), relative })
    }

    /// The absolute error, for a solution of this size in V_max.
    ///
    /// # Errors
    /// An error that zero has as well.
    pub fn error(&self, size: f64) -> Option<Result<f64, NoAnswer>> {
        let target = self.error.map(|error| if self.relative { error * size } else { error })?;
        let as_zero = self.norm == Norm::VMax && size > 0.0 && target >= size;
        Some(if as_zero { Err(NoAnswer::AsZero { target, size }) } else { Ok(target) })
    }
}

/// Why no run is the answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoAnswer {
    /// Nothing is known of the errors or of the costs, or a mesh cannot be made.
    #[error("{0}")]
    Refused(String),
    #[error(
        "the target {target:.3e} is no less than the solution, {size:.3e}: `5%` is a twentieth of it"
    )]
    AsZero { target: f64, size: f64 },
    /// Below what solver and rounding leave.
    #[error(
        "an error of {target:.3e} cannot be reached: solver and rounding leave up to {floor:.1e}, and only errors above {FLOORS_ABOVE} times that can be measured"
    )]
    BelowFloor { target: f64, floor: f64 },
    /// Finer than the finest choice, where the error is `least`.
    #[error(
        "an error of {target:.3e} is out of reach: the least on n <= {n}, N <= {steps} is {least:.3e}{way_out}"
    )]
    OutOfReach { target: f64, n: u32, steps: u32, least: f64, way_out: &'static str },
    /// The cheapest choice does not fit into memory.
    #[error("an error of {target:.3e} asks for n = {n}, N = {steps}: {source}")]
    Memory { target: f64, n: u32, steps: u32, source: TooLarge },
}

impl From<SetupError> for NoAnswer {
    fn from(error: SetupError) -> Self {
        Self::Refused(error.to_string())
    }
}

impl NoAnswer {
    /// Refuses a target that solver and rounding hide.
    pub(super) fn admit(target: f64, floor: f64) -> Result<(), Self> {
        let seen = target > FLOORS_ABOVE * floor;
        if seen { Ok(()) } else { Err(Self::BelowFloor { target, floor }) }
    }
}

/// The whole numbers n and N that suit a scene.
pub(super) struct Choices<'a> {
    setup: &'a Setup,
    subject: Subject,
    /// Errors are to be measured against the scene's reference run, whose n and N these must divide.
    measured: bool,
    /// What was found by N: the largest step, and whether it suits.
    steps: RefCell<HashMap<u32, f64>>,
    suits: RefCell<HashMap<u32, bool>>,
}

impl<'a> Choices<'a> {
    /// # Errors
    /// The scene cannot be set up.
    pub(super) fn new(setup: &'a Setup, measured: bool) -> Result<Self, SetupError> {
        let subject = Subject::new(setup.scene.clone())?;
        let (steps, suits) = Default::default();
        Ok(Self { setup, subject, measured, steps, suits })
    }

    /// The finest n and N whose errors show: half of those of the reference run, which has no error against itself.
    pub(super) fn most(&self) -> [u32; 2] {
        let reference = scene_reference(self.setup).filter(|_| self.measured);
        reference.map_or(MOST, |run| [run.n / 2, run.steps / 2])
    }

    pub(super) fn h(&self, n: u32) -> f64 {
        self.setup.body.domain.h(n)
    }

    /// The largest time step; 0 for numbers of steps without a grid, which do not suit.
    pub(super) fn k(&self, steps: u32) -> f64 {
        let made = || self.setup.scene.time.grid(steps).map_or(0.0, |grid| grid.largest_step());
        *self.steps.borrow_mut().entry(steps).or_insert_with(made)
    }

    /// Whether n suits the domain, and the reference run.
    pub(super) fn has_cells(&self, n: u32) -> bool {
        match self.measured {
            true => self.setup.scene.check_cases(&[n], &[]).is_ok(),
            false => self.setup.scene.check_cells(n).is_ok(),
        }
    }

    /// Whether N suits (3.4), and the reference run.
    pub(super) fn has_steps(&self, steps: u32) -> bool {
        let suits = || {
            let divides = !self.measured || self.setup.scene.check_cases(&[], &[steps]).is_ok();
            divides && check_step_sizes(&self.subject, &[steps]).is_ok()
        };
        *self.suits.borrow_mut().entry(steps).or_insert_with(suits)
    }

    /// The cheapest run of a law with at most `target` of error.
    fn by(&self, law: &Law<'_>, target: f64) -> Option<Choice> {
        let [least, [most, most_steps]] = law.range;
        let mut best: Option<Choice> = None;
        for n in (least[0]..=most).filter(|&n| self.has_cells(n)) {
            let h = self.h(n);
            // Where N is the smallest, cost still grows with n: no later n can do better.
            if best.is_some_and(|best| (law.seconds)(h, self.k(least[1])) > best.seconds) {
                break;
            }
            // The fewest steps that have the error, where more have it as well.
            let (mut lo, mut hi) = (least[1], most_steps);
            while lo < hi {
                let middle = lo + (hi - lo) / 2;
                match (law.error)(h, self.k(middle)) <= target {
                    true => hi = middle,
                    false => lo = middle + 1,
                }
            }
            let Some(steps) = (lo..=most_steps).find(|&steps| self.has_steps(steps)) else {
                continue;
            };
            let k = self.k(steps);
            let (error, seconds) = ((law.error)(h, k), (law.seconds)(h, k));
            if error <= target && best.is_none_or(|best| seconds < best.seconds) {
                best = Some(Choice { target, n, steps, h, k, error, seconds, bytes: f64::NAN });
            }
        }
        best
    }

    /// The cheapest run of a law with at most `target` of error, if it fits into memory.
    ///
    /// # Errors
    /// [`NoAnswer`].
    pub(super) fn cheapest(
        &self,
        law: &Law<'_>,
        target: f64,
        limit: &MemoryLimit,
    ) -> Result<Choice, NoAnswer> {
        let Some(choice) = self.by(law, target) else {
            let [_, [n, steps]] = law.range;
            let least = (law.error)(self.h(n), self.k(steps));
            let way_out = if self.measured { "" } else { "; start from a finer run" };
            return Err(NoAnswer::OutOfReach { target, n, steps, least, way_out });
        };
        let Choice { n, steps, .. } = choice;
        let refused = |source| NoAnswer::Memory { target, n, steps, source };
        // A mesh up to `made` is made for its memory, unless a coarse one shows that it does not fit; a finer one may be more than
        // any machine holds. It has the bytes b(m) of the finest that is made, with the exponent of n that they have on the way
        // there: b(n) = b(m) (n/m)^e, e = log₂ b(m)/b(m/2), of mesh and march; the program itself does not grow.
        let made = law.made;
        admit_run(self.setup, None, (n.min(made), steps), limit).map_err(refused)?;
        let cost = |n: u32| self.setup.space(n).map(|space| run_cost(self.setup, &space, steps));
        let whole = cost(n.min(made))?;
        let mut bytes = whole.memory_bytes;
        if n > made {
            let half = cost(made / 2)?;
            let [half, whole] = [half, whole].map(|cost| cost.march_bytes + cost.load_bytes);
            let finer = f64::from(n) / f64::from(made);
            bytes += whole * (finer.powf((whole / half).log2()) - 1.0);
        }
        limit.admit(bytes, false).map_err(refused)?;
        Ok(Choice { bytes, ..choice })
    }
}

#[cfg(test)]
mod tests {
    use super::super::models::Term;
    use super::*;
    use judge::fit::{ErrorCombination, Interval};
    use scene::Scene;

    fn model(model: ErrorCombination, [ch, p]: [f64; 2], [ck, q]: [f64; 2]) -> ErrorModel {
        let term = |constant, order| {
            Some(Term { constant, order, interval: Interval::around(order, 0.0) })
        };
        let source = String::new();
        ErrorModel { model, space: term(ch, p), time: term(ck, q), source, residual: 0.0 }
    }

    fn cost([a, b]: [f64; 2], h: f64, k: f64) -> f64 {
        1e-6 * h.powf(-a) * k.powf(-b)
    }

    /// The least cost under E(h, k) = target, by search over h alone: k is what the target leaves.
    fn searched(error: &ErrorModel, exponents: [f64; 2], target: f64) -> (f64, [f64; 2]) {
        let (space, time) = (error.space.expect("h"), error.time.expect("k"));
        let m = error.model.exponent();
        let at = |i: u32| {
            let h = (-12.0 + 14.0 * f64::from(i) / 2e5).exp();
            let left = (target.powf(m) - space.at(h).powf(m)).max(0.0).powf(1.0 / m);
            let k = (left / time.constant).powf(1.0 / time.order);
            (if k > 0.0 { cost(exponents, h, k) } else { f64::INFINITY }, [h, k])
        };
        (0..200_000).map(at).min_by(|a, b| a.0.total_cmp(&b.0)).expect("a least")
    }

    #[test]
    fn the_coupling_is_the_least_cost_of_a_search() {
        for kind in [ErrorCombination::Sum, ErrorCombination::RootSumSquare] {
            for (space, time, exponents) in [
                ([0.5, 1.0], [2.0, 2.0], [2.4, 0.9]),
                ([3.0, 0.6], [0.1, 2.0], [3.0, 1.0]),
                ([1.0, 2.0], [5.0, 1.0], [2.0, 1.7]),
            ] {
                let error = model(kind, space, time);
                let path = coupling(&error, exponents).expect("a path");
                let found = [0.1, 0.003].map(|target| searched(&error, exponents, target));
                for ((_, [h, k]), target) in found.iter().zip([0.1f64, 0.003]) {
                    // The search looks at every 7e-5 of log h, and the cost is flat over the root of its rounding.
                    assert!((path.factor * h.powf(path.exponent) / k - 1.0).abs() < 1e-2);
                    let m = kind.exponent();
                    let share = (error.space.expect("h").at(*h) / target).powf(m);
                    assert!((share - path.space_share).abs() < 1e-2, "{share} {path:?}");
                }
                let grows = (found[1].0 / found[0].0).ln() / (0.1f64 / 0.003).ln();
                assert!((grows - path.cost_exponent).abs() < 1e-6, "{grows} {path:?}");
            }
        }
        let mut error = model(ErrorCombination::Sum, [0.5, 1.0], [2.0, 2.0]);
        assert!(coupling(&error, [2.0, -0.1]).is_none());
        error.space = None;
        assert!(coupling(&error, [2.0, 1.0]).is_none());
    }

    fn setup(name: &str) -> Setup {
        let path = format!("{}/../../manufactured/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        Setup::new(Scene::read(path.as_ref()).expect("a scene")).expect("a setup")
    }

    /// Of a scene with an exact solution, and of one whose n and N divide those of its reference run.
    #[test]
    fn the_answer_is_the_cheapest_of_all_pairs() {
        let error = model(ErrorCombination::RootSumSquare, [0.5, 1.0], [0.3, 2.0]);
        for (name, target) in [("compliance", 0.02), ("compliance", 0.1), ("punch", 0.03)] {
            let setup = setup(name);
            let choices = Choices::new(&setup, true).expect("choices");
            let law = Law {
                error: Box::new(|h, k| error.error(h, k)),
                seconds: Box::new(|h, k| cost([2.2, 0.9], h, k)),
                range: [[4, 2], [128, 64]],
                made: 8,
            };
            let found = choices.by(&law, target).expect("an answer");
            let mut least = f64::INFINITY;
            for n in (4..=128).filter(|&n| setup.scene.check_cases(&[n], &[]).is_ok()) {
                for steps in (2..=64).filter(|&m| setup.scene.check_cases(&[], &[m]).is_ok()) {
                    let (h, k) = (setup.body.domain.h(n), setup.grid(steps).largest_step());
                    if error.error(h, k) <= target {
                        least = least.min(cost([2.2, 0.9], h, k));
                    }
                }
            }
            assert_eq!(found.seconds, least, "{name}: {found:?}");
            assert!(found.error <= target && choices.has_cells(found.n));
            assert!(choices.has_steps(found.steps));
            // h = 1/128 leaves 0.0039, and 1 MB holds no mesh at all.
            let all = MemoryLimit::NONE;
            let refused = choices.cheapest(&law, 0.002, &all).expect_err("out of reach");
            assert!(
                matches!(refused, NoAnswer::OutOfReach { n: 128, least, .. } if least > 0.0039)
            );
            let refused = choices.cheapest(&law, target, &MemoryLimit::of_bytes(1e6));
            assert!(matches!(refused, Err(NoAnswer::Memory { .. })), "{refused:?}");
        }
        for (target, floor) in [(1.9e-11, 1e-12), (0.0, 0.0), (-1.0, 0.0), (f64::NAN, 0.0)] {
            let refused = NoAnswer::admit(target, floor);
            assert!(matches!(refused, Err(NoAnswer::BelowFloor { .. })), "{target}");
        }
    }
}
