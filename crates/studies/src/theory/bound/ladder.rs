//! The step-size study of any run: factors at all its levels, and at the worst of them Λ and Newton's method over a
//! ladder of step sizes. It knows no mesh: it asks for a [`vhi::FrozenDerivative`] and for [`StepBounds`].
//!
//! With J the tangent of the step and J_0 that of the frozen level, J = J_0 (I - DΛ): the tangent is
//! singular exactly where DΛ has the eigenvalue one. So the step loses its solution where Λ does not
//! contract any more because of a positive eigenvalue; where the eigenvalues are negative, as for
//! ℬ(0) ≥ 0, Λ stops converging and the step stays solvable.

use crate::study::{Result, StudyError};
use algebra::linalg::{
    EigenError, FactorError, LinearMap, Spectrum, largest_eigenvalue, signed_unit, spectrum,
};
use files::digits;
use serde::{Serialize, Serializer};
use vhi::history::TimeGrid;
use vhi::{
    FailedStep, FixedPoint, FrozenDerivative, Newton, Scratch, StepBounds, StepError, StepInfo,
    StepSolver, StepState,
};

/// The factor of Λ at a level of the run, with the step size of the run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct FactorAtLevel {
    /// n.
    pub level: usize,
    /// t_n.
    pub t: f64,
    /// The step size there.
    pub k: f64,
    /// ‖DΛ‖.
    pub norm: f64,
    /// Spectral radius of DΛ.
    pub radius: f64,
    /// The sharpened bound.
    pub sharpened: f64,
}

/// The iterations in which a solver found a solution, or why it found none; as JSON the number, or the reason.
pub type StepOutcome = Result<u32, StepError>;

fn outcome<S: Serializer>(outcome: &StepOutcome, serializer: S) -> Result<S::Ok, S::Error> {
    match outcome {
        Ok(iterations) => serializer.serialize_u32(*iterations),
        Err(error) => serializer.collect_str(error),
    }
}

/// What was measured at one step size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepRung {
    /// k.
    pub k: f64,
    /// ‖DΛ‖ at η, the worst direction.
    pub norm: f64,
    /// Spectral radius of DΛ at η.
    pub radius: f64,
    /// Largest real eigenvalue of DΛ at η.
    pub rightmost: f64,
    /// ‖Λ(η + δd) - Λη‖/‖δd‖ in the worst direction of the derivative.
    pub finite_worst: f64,
    /// True if η is the solution of the step; false where Newton's method found none, and η is the
    /// solution of the largest step that had one.
    pub at_solution: bool,
    /// Newton's method from the solution of the step size before.
    #[serde(serialize_with = "outcome")]
    pub newton: StepOutcome,
    /// The iteration η ← Λη from u_n of the run.
    #[serde(serialize_with = "outcome")]
    pub fixed_point: StepOutcome,
    /// Other solutions that Newton's method finds from random starts.
    pub distinct: u32,
    /// Bounds of `norm`: sharpened, (3.15), and (3.15) with the norms of the paper.
    pub sharpened: f64,
    /// (3.15) with operator norms.
    pub theorem: f64,
    /// (3.15) with the norms of the paper.
    #[serde(rename = "paper_norm")]
    pub paper: f64,
}

/// Where the step loses its solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Loss {
    /// The last k with a solution whose tangent is regular, and the first without one.
    pub bracket: Crossing,
    /// The largest real eigenvalue of DΛ at the last k: one where the tangent is singular.
    pub rightmost: f64,
    /// What is seen beyond it.
    pub reason: String,
}

/// Where factors reach one and solvability ends.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Thresholds {
    /// The k at which ‖DΛ‖ reaches one; none if Λ does not depend on η.
    pub norm: Option<Crossing>,
    /// The k at which the spectral radius of DΛ reaches one; none if Λ does not depend on η.
    pub radius: Option<Crossing>,
    /// Where the solution ends, if it does.
    pub loss: Option<Loss>,
}

/// What the study found.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ContractionStudy {
    /// Every level of the run.
    pub levels: Vec<FactorAtLevel>,
    /// The level of the ladder: the one with the largest factor.
    pub worst: FactorAtLevel,
    /// Uniqueness at the step size of the run, by many starts.
    pub starts: Starts,
    /// The ladder.
    pub rungs: Vec<StepRung>,
    #[serde(skip)]
    pub thresholds: Thresholds,
    /// Why there are neither rungs nor thresholds, where there are none.
    #[serde(skip)]
    pub not_followed: Option<String>,
}

/// Rungs of a ladder, and how far it goes beyond the largest finite threshold that is known.
const RUNGS: u32 = 17;
const REACH: f64 = 4.0;
/// Random starts at the step size of the run, and at each of the ladder.
const MANY_STARTS: u64 = 24;
const STARTS: u64 = 3;
/// Iterations of Λ after which a step size is not followed further: 400 reach 1e-13 for factors up
/// to 0.93.
const ITERATIONS: u32 = 400;
/// The loss is bisected to this width, relative to k, in at most so many step sizes: nearer to a singular tangent Newton's
/// method does not come.
const WIDTH: f64 = 1e-7;
const EVALUATIONS: u32 = 100;
/// Solutions that a ladder holds at most.
pub(super) const SOLUTIONS: usize = (RUNGS + EVALUATIONS) as usize;
/// The tolerance of Newton's method shrinks with the tangent where that becomes singular, rounding does
/// not: a residual that stalls at this multiple of it is a solution.
const STALLED: f64 = 64.0;
/// A largest eigenvalue above this at the end of the solution says that the tangent is singular there.
const NEARLY_ONE: f64 = 0.99;
/// Factors are solved for to 1e-10 of themselves or better: of levels that agree to ten times that the last one is taken,
/// so that rounding does not choose.
const EQUAL: f64 = 1e-9;

impl ContractionStudy {
    /// The factors at every level n ≥ 1 of a run, and starts, thresholds and ladder at the level with the largest one; neither
    /// thresholds nor rungs where m0 ≤ 0, with the reason. `run` makes it anew from each of two equal loads.
    ///
    /// # Errors
    /// The run's, or a factor that is not found.
    pub(super) fn new<D, L: FrozenDerivative<Error: Into<StudyError>>, E: Into<StudyError>>(
        [first, again]: [D; 2],
        run: impl Fn(D) -> Result<L, E>,
        bounds: &StepBounds,
    ) -> Result<Self> {
        let mut level = run(first).map_err(Into::into)?;
        let (grid, mut levels): (TimeGrid, Vec<FactorAtLevel>) = (level.grid().clone(), Vec::new());
        run_to(&mut level, grid.steps(), |level, number, state| {
            if number == 0 {
                return Ok(());
            }
            let (k, t) = (grid.step(number), grid.time(number));
            let Contraction { norm, radius, .. } = factors(level, k, &state.u, state)?;
            let sharpened = bounds.sharpened_factor(k);
            levels.push(FactorAtLevel { level: number, t, k, norm, radius, sharpened });
            // Once more with the last slot implicit, which commit records.
            implicit(level, state, number)
        })?;
        drop(level);
        let worse = |best: FactorAtLevel, next: &FactorAtLevel| {
            if next.norm >= best.norm * (1.0 - EQUAL) { *next } else { best }
        };
        let worst = levels.iter().fold(levels.last().copied().unwrap_or_default(), worse);
        let mut level = run(again).map_err(Into::into)?;
        let state = run_to(&mut level, worst.level, |_, _, _| Ok(()))?;
        let starts = random_starts(&mut level, &state, MANY_STARTS);
        let mut found = Self { worst, levels, starts, ..Self::default() };
        if bounds.m0.is_nan() || bounds.m0 <= 0.0 {
            found.not_followed = Some(format!(
                "the least m0 = {} is not positive, (2.9) is violated or unknown: no k is known to have one solution, from which a ladder could begin",
                digits(bounds.m0, 7)
            ));
            return Ok(found);
        }
        // A geometric ladder from a quarter of (3.4) to beyond all thresholds that are known.
        let known = [bounds.limit(), bounds.sharpened_limit(), bounds.solvable_limit()];
        let largest = known.into_iter().filter(|k| k.is_finite()).fold(0.0, f64::max);
        let (low, high) = (0.25 * bounds.paper_limit(), REACH * largest);
        let mut ladder = StepLadder::new(&mut level, *bounds, state);
        for i in 0..RUNGS {
            let k = low * (high / low).powf(f64::from(i) / f64::from(RUNGS - 1));
            found.rungs.push(ladder.rung(k)?);
        }
        found.thresholds = ladder.thresholds(&found.rungs)?;
        Ok(found)
    }
}

/// Λ at the open level over step sizes.
pub struct StepLadder<'a, L> {
    level: &'a mut L,
    bounds: StepBounds,
    /// The solution of the level in the run.
    of_run: StepState,
    /// The rungs, with the last solution found where there is none.
    climbed: Vec<At>,
}

/// A solution with the factors there.
struct At {
    k: f64,
    state: StepState,
    found: Contraction,
}

impl<'a, L: FrozenDerivative> StepLadder<'a, L> {
    /// The open `level` whose solution in the run is `of_run`.
    pub fn new(level: &'a mut L, bounds: StepBounds, of_run: StepState) -> Self {
        Self { level, bounds, of_run, climbed: Vec::new() }
    }

    /// A solution at step size k by Newton's method from `near`.
    fn solve(&mut self, k: f64, near: &StepState) -> Result<(StepState, u32), StepError> {
        self.level.set_step(k);
        let mut state = near.clone();
        match solve(self.level, None, &mut state) {
            Ok(info) => Ok((state, info.iterations)),
            Err(StepError::NotConverged { iterations, residual, tolerance })
                if residual <= STALLED * tolerance =>
            {
                Ok((state, iterations))
            }
            Err(error) => Err(error),
        }
    }

    /// Measures at one step size.
    ///
    /// # Errors
    /// A frozen level that cannot be solved, an eigenvalue that does not settle.
    pub fn rung(&mut self, k: f64) -> Result<StepRung> {
        let near = self.climbed.last().map_or(&self.of_run, |at| &at.state).clone();
        let (followed, newton) = match self.solve(k, &near) {
            Ok((state, iterations)) => (state, Ok(iterations)),
            Err(error) => (near, Err(error)),
        };
        let frozen = || format!("k = {k}: the level with frozen last slot was not solved");
        let at = |source: StepError| StudyError::at(frozen(), source);
        // η: the solution at k where there is one; and Λη.
        let (eta, mut state) = (&followed.u, followed.clone());
        solve(self.level, Some(eta), &mut state).map_err(at)?;
        let found = factors(self.level, k, eta, &state)?;
        let finite_worst = match found.norm {
            0.0 => 0.0,
            _ => finite_factor(self.level, eta, &state, &found.direction).map_err(at)?,
        };
        let solver = FixedPoint { max_iterations: ITERATIONS, ..FixedPoint::default() };
        let mut of_run = self.of_run.clone();
        let fixed = solver.solve_level(self.level, &mut of_run, &mut Scratch::default());
        let distinct = random_starts(self.level, &followed, STARTS).distinct;
        let Contraction { norm, radius, rightmost, .. } = found;
        self.climbed.push(At { k, state: followed, found });
        Ok(StepRung {
            k,
            norm,
            radius,
            rightmost,
            finite_worst,
            at_solution: newton.is_ok(),
            newton,
            fixed_point: fixed.map(|info| info.fixed_point_iterations),
            distinct,
            sharpened: self.bounds.sharpened_factor(k),
            theorem: self.bounds.factor(k),
            paper: self.bounds.paper_factor(k),
        })
    }

    /// A solution at k with a regular tangent by Newton's method from the last of the known solutions, then from a line
    /// through the last two, from earlier ones, that of the run and a random state; else what the first of them says.
    fn regular(&mut self, k: f64, known: &[At]) -> Result<Result<At, String>> {
        let back = |places: usize| known.len().checked_sub(places).map(|i| &known[i]);
        let Some(last) = back(1) else { return Ok(Err(String::new())) };
        let mut starts = vec![last.state.clone()];
        starts.extend(back(2).map(|before| {
            let share = (k - last.k) / (last.k - before.k);
            let pairs = last.state.u.iter().zip(&before.state.u);
            let u = pairs.map(|(u, v)| u + share * (u - v)).collect();
            StepState { u, pressure: last.state.pressure.clone() }
        }));
        starts.extend([2, 4, 8, 16].into_iter().filter_map(back).map(|at| at.state.clone()));
        starts.extend([self.of_run.clone(), random_state(self.level, &last.state, 0)]);
        let mut reason = None;
        for from in starts {
            let said = match self.solve(k, &from) {
                Ok((state, _)) => {
                    self.level.set_step(k);
                    let found = factors(self.level, k, &state.u, &state)?;
                    if found.rightmost < 1.0 {
                        return Ok(Ok(At { k, state, found }));
                    }
                    "the tangent is singular"
                }
                Err(StepError::Factor { .. }) => "the tangent is not positive definite beyond it",
                Err(StepError::NotConverged { .. }) => {
                    "Newton's method finds no solution beyond it"
                }
                Err(error) => &error.to_string(),
            };
            reason.get_or_insert_with(|| said.to_owned());
        }
        Ok(Err(reason.unwrap_or_default()))
    }

    /// Where factors reach one, and where the step loses its solution, by bisection between the last rung that has one and
    /// the first that has not: what Newton's method does not reach from afar it may reach from nearer, so a solution that
    /// is found doubles the next step.
    fn thresholds(&mut self, rungs: &[StepRung]) -> Result<Thresholds> {
        let (mut path, mut loss): (Vec<At>, Option<Loss>) = (Vec::new(), None);
        for (rung, at) in rungs.iter().zip(std::mem::take(&mut self.climbed)) {
            if rung.at_solution && rung.rightmost < 1.0 {
                path.push(at);
                continue;
            }
            let mut low = path.last().map_or(rung.k, |at| at.k);
            let (mut step, mut high, mut reason) = (rung.k - low, rung.k, String::new());
            for _ in 0..EVALUATIONS {
                if low >= rung.k || step <= WIDTH * low {
                    break;
                }
                let k = (low + step).min(rung.k);
                match self.regular(k, &path)? {
                    Ok(at) => {
                        path.push(at);
                        (low, step) = (k, 2.0 * step);
                    }
                    Err(said) => (high, step, reason) = (k, 0.5 * (k - low), said),
                }
            }
            if low < rung.k {
                let rightmost = path.last().map_or(f64::NAN, |at| at.found.rightmost);
                loss = Some(Loss { bracket: [low, high], rightmost, reason });
                break;
            }
        }
        let mut reaches = |factor: fn(&Contraction) -> f64| -> Result<_> {
            if path.iter().all(|at| factor(&at.found) == 0.0) {
                return Ok(None);
            }
            let ladder: Vec<_> = path.iter().map(|at| (at.k, factor(&at.found))).collect();
            crossing(&ladder, |k| {
                let below = path.partition_point(|at| at.k <= k).max(1) - 1;
                // Where no solution is found the factor counts as one.
                let at = self.regular(k, &path[..=below])?;
                Ok(at.map_or(f64::NAN, |at| factor(&at.found)))
            })
        };
        let found = [reaches(|of| of.norm)?, reaches(|of| of.radius)?];
        // At a singular tangent DΛ has the eigenvalue one, so norm and radius reach it there at the latest.
        let singular = loss.as_ref().filter(|loss| loss.rightmost > NEARLY_ONE);
        let [norm, radius] = found.map(|crossing| match (crossing, singular) {
            (Some([_, f64::INFINITY]), Some(loss)) => Some(loss.bracket),
            _ => crossing,
        });
        Ok(Thresholds { norm, radius, loss })
    }
}

fn factors<L: FrozenDerivative>(
    level: &mut L,
    k: f64,
    eta: &[f64],
    state: &StepState,
) -> Result<Contraction> {
    contraction(level, eta, state).map_err(|source| {
        StudyError::at(format!("k = {k}: the contraction factor was not found"), source)
    })
}

/// Runs to level `last`, which stays open, and returns its solution; `see` gets each level with its number and solution.
///
/// # Errors
/// The run's.
pub fn run_to<L: FrozenDerivative<Error: Into<StudyError>>>(
    level: &mut L,
    last: usize,
    mut see: impl FnMut(&mut L, usize, &mut StepState) -> Result<()>,
) -> Result<StepState> {
    let graphs = level.graph().coordinates.len();
    let mut state = StepState { u: vec![0.0; level.dofs()], pressure: vec![0.0; graphs] };
    for number in 0..=last {
        if number > 0 {
            level.commit(&state);
        }
        level.open().map_err(Into::into)?;
        implicit(level, &mut state, number)?;
        see(level, number, &mut state)?;
    }
    Ok(state)
}

fn implicit<L: FrozenDerivative>(level: &mut L, state: &mut StepState, n: usize) -> Result<()> {
    let t = level.grid().time(n);
    solve(level, None, state).map_err(|source| FailedStep { n, t, source })?;
    Ok(())
}

// The contraction factor of Λ at a state, by its derivative and by finite perturbations, and where it reaches one.

/// What DΛ does at one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Contraction {
    /// ‖DΛ‖ in X: the factor in the worst direction, the local Lipschitz constant of Λ.
    pub norm: f64,
    /// The worst direction, of length 1.
    pub direction: Vec<f64>,
    /// Spectral radius of DΛ: the factor that the iteration shows after many steps.
    pub radius: f64,
    /// Its largest real eigenvalue: the tangent of the step is singular where it is one.
    pub rightmost: f64,
}

/// DΛ or (DΛ)*DΛ as a map.
struct Map<'a, L> {
    level: &'a mut L,
    normal: bool,
    between: Vec<f64>,
}

impl<L: FrozenDerivative> LinearMap for Map<'_, L> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        if self.normal {
            self.level.derivative(x, &mut self.between)?;
            self.level.adjoint(&self.between, out)
        } else {
            self.level.derivative(x, out)
        }
    }

    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        self.level.gram(x, out);
    }
}

/// Solves the open level by Newton's method from `state`, with its last slot frozen at η where one is given.
///
/// # Errors
/// Newton's.
pub(super) fn solve<L: FrozenDerivative>(
    level: &mut L,
    eta: Option<&[f64]>,
    state: &mut StepState,
) -> Result<StepInfo, StepError> {
    level.freeze(eta);
    Newton::default().solve(level, state, &mut Scratch::default())
}

/// A vector with a part of everything.
fn mixed(length: usize, mut seed: u64) -> Vec<f64> {
    (0..length).map(|_| signed_unit(&mut seed)).collect()
}

/// Norm and eigenvalues of DΛ(η), where `state` is Λη.
///
/// # Errors
/// A linear solve fails, or the iteration does not settle.
pub fn contraction<L: FrozenDerivative>(
    level: &mut L,
    eta: &[f64],
    state: &StepState,
) -> Result<Contraction, EigenError> {
    level.differentiate(eta, state)?;
    let (length, between) = (eta.len(), vec![0.0; eta.len()]);
    let worst = largest_eigenvalue(&mut Map { level, normal: true, between }, &mixed(length, 11))?;
    let mut map = Map { level, normal: false, between: Vec::new() };
    let Spectrum { radius, rightmost, .. } = spectrum(&mut map, &mixed(length, 12))?;
    Ok(Contraction {
        norm: worst.value.max(0.0).sqrt(),
        direction: worst.vector,
        radius,
        rightmost,
    })
}

/// Size of a perturbation, relative to ‖η‖. Rounding of Λη is some 1e-13 of it, so the ratio has
/// seven digits; kinks of Λ within 1e-6 of η are few.
const PERTURBATION: f64 = 1e-6;

/// ‖Λ(η + δd) - Λη‖/δ‖d‖ for a small δ, where `state` is Λη.
///
/// # Errors
/// The solver's.
pub fn finite_factor<L: FrozenDerivative>(
    level: &mut L,
    eta: &[f64],
    state: &StepState,
    direction: &[f64],
) -> Result<f64, StepError> {
    let size = PERTURBATION * level.norm(eta).max(f64::MIN_POSITIVE) / level.norm(direction);
    let moved: Vec<f64> = eta.iter().zip(direction).map(|(e, d)| e + size * d).collect();
    let solved = |level: &mut L, eta: &[f64]| {
        let mut out = state.clone();
        solve(level, Some(eta), &mut out)?;
        Ok::<_, StepError>(out.u)
    };
    let (here, there) = (solved(level, eta)?, solved(level, &moved)?);
    let difference: Vec<f64> = there.iter().zip(&here).map(|(a, b)| a - b).collect();
    Ok(level.norm(&difference) / (size * level.norm(direction)))
}

/// A random state of up to three times the size of `known`.
pub(super) fn random_state<L: FrozenDerivative>(
    level: &L,
    known: &StepState,
    number: u64,
) -> StepState {
    let mut u = mixed(known.u.len(), 1000 + number);
    let size = level.norm(&known.u).max(f64::MIN_POSITIVE);
    let scale = size * (1.0 + (number % 3) as f64) / level.norm(&u);
    u.iter_mut().for_each(|value| *value *= scale);
    StepState { u, pressure: vec![0.0; known.pressure.len()] }
}

/// Where random starts ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Starts {
    /// Starts that end at the known solution.
    pub same: u32,
    /// Starts that end at another solution.
    pub distinct: u32,
    /// Nowhere: Newton's method is local, so this says nothing.
    pub failed: u32,
}

/// Two solutions are the same if they differ by less than this share: each is found to rounding times
/// the condition of the step.
const SAME: f64 = 1e-7;

/// Solves the open level, its last slot implicit, from `count` random states.
pub(super) fn random_starts<L: FrozenDerivative>(
    level: &mut L,
    known: &StepState,
    count: u64,
) -> Starts {
    let mut starts = Starts::default();
    let size = level.norm(&known.u).max(f64::MIN_POSITIVE);
    for number in 0..count {
        let mut state = random_state(level, known, number);
        let solved = solve(level, None, &mut state).is_ok();
        let off: Vec<f64> = state.u.iter().zip(&known.u).map(|(a, b)| a - b).collect();
        // A NaN is not the same.
        let end = match level.norm(&off) <= SAME * size {
            _ if !solved => &mut starts.failed,
            true => &mut starts.same,
            false => &mut starts.distinct,
        };
        *end += 1;
    }
    starts
}

/// Between which k a factor reaches one: the first is 0 where it is one or more already at the smallest k that was
/// tried, the second infinite where it stays below one up to the largest.
pub type Crossing = [f64; 2];

const BRACKET: f64 = 1e-8;
/// Evaluations within one bracket: bisection alone would need 30 from a factor of two.
const SECANTS: u32 = 60;

/// The first crossing of `factor` - 1 along the increasing sequence `ladder` of (k, factor), narrowed
/// by the Illinois method (a bracket is kept, so a jump is found as well).
///
/// # Errors
/// `factor` fails.
pub(super) fn crossing<E>(
    ladder: &[(f64, f64)],
    mut factor: impl FnMut(f64) -> Result<f64, E>,
) -> Result<Option<Crossing>, E> {
    let (Some(first), Some(last)) = (ladder.first(), ladder.last()) else { return Ok(None) };
    let reached = |value: f64| value.is_nan() || value >= 1.0;
    if reached(first.1) {
        return Ok(Some([0.0, first.0]));
    }
    let Some(pair) = ladder.windows(2).find(|pair| reached(pair[1].1)) else {
        return Ok(Some([last.0, f64::INFINITY]));
    };
    let ((mut low, mut below), (mut high, mut above)) =
        ((pair[0].0, pair[0].1 - 1.0), (pair[1].0, pair[1].1 - 1.0));
    let mut side = 0;
    for evaluation in 0..SECANTS {
        if high - low <= BRACKET * high {
            break;
        }
        let secant = low - below * (high - low) / (above - below);
        // Every third point bisects: an end that does not move must not stay far away.
        let inside = secant > low && secant < high && evaluation % 3 != 2;
        let middle = if inside { secant } else { 0.5 * (low + high) };
        let value = factor(middle)? - 1.0;
        if value.is_nan() || value >= 0.0 {
            below *= if side == 1 { 0.5 } else { 1.0 };
            (high, above, side) = (middle, value, 1);
        } else {
            above *= if side == -1 { 0.5 } else { 1.0 };
            (low, below, side) = (middle, value, -1);
        }
    }
    Ok(Some([low, high]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(factor: impl Fn(f64) -> f64) -> Crossing {
        let ladder: Vec<(f64, f64)> =
            (0..12).map(|i| 0.25 * 2f64.powi(i)).map(|k| (k, factor(k))).collect();
        crossing(&ladder, |k| Ok::<_, ()>(factor(k))).unwrap().unwrap()
    }

    #[test]
    fn lines_curves_and_jumps_are_bracketed() {
        for (factor, exact) in [
            (Box::new(|k: f64| k / 3.0) as Box<dyn Fn(f64) -> f64>, 3.0),
            (Box::new(|k: f64| (k / 5.0).powi(4)), 5.0),
            (Box::new(|k: f64| if k < 7.3 { 0.2 } else { 4.0 }), 7.3),
        ] {
            let [low, high] = found(&factor);
            assert!(low <= exact * (1.0 + 1e-15) && exact <= high * (1.0 + 1e-15));
            assert!(high - low <= 1e-8 * exact, "{low} {high}");
        }
    }

    #[test]
    fn ends_are_said_and_a_missing_value_is_no_success() {
        assert_eq!(found(|_| 0.5), [512.0, f64::INFINITY]);
        assert_eq!(found(|_| 2.0), [0.0, 0.25]);
        assert_eq!(found(|_| f64::NAN), [0.0, 0.25]);
        let nan = found(|k| if k < 6.0 { 0.1 * k } else { f64::NAN });
        assert!((nan[0] - 6.0).abs() < 1e-6, "{nan:?}");
    }
}
