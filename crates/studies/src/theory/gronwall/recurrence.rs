//! The discrete Gronwall inequality, solved with equality: envelopes on any grid, without a mesh.
//!
//! For e_n ≤ C1 g_n + C2 Σ_j w_nj e_j with w_nj ≥ 0 and C2 w_nn < 1 the solution E_n of the equality
//! is an upper bound of e_n (induction over n), and E_n depends on g monotonically. Without
//! C2 w_nn < 1 nothing follows: see [`StepTooLarge`].

use crate::study::{Result, StudyError};
use algebra::linalg::larger;
use files::digits;
use judge::claim::{Claim, Place, Standing, Statement};
use serde_json::{Map, Value};
use statrs::function::gamma::{gamma, ln_gamma};
use vhi::history::{ClosedForm, TimeGrid, TimeRule};
use vhi::law::HistoryKernel;

/// The lemma's hypothesis fails: e_n stands on both sides with a factor of at least 1, so that the
/// inequality holds for arbitrarily large e_n whatever g is. "For any C2" the lemma is false.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the discrete Gronwall lemma needs C2 w_nn < 1: at n = {n} it is {} * {} = {}; take smaller steps",
    digits(*.factor, 7), digits(*.weight, 7), digits(.factor * .weight, 7)
)]
pub struct StepTooLarge {
    /// The first n at which it fails.
    pub n: usize,
    /// C2, or 1/m0 of the weighted form.
    pub factor: f64,
    /// w_nn, or w_nn Σ ω_p κ_p(n, n).
    pub weight: f64,
}

/// E_n, or a bound of it, at every n; none where the lemma's hypothesis fails.
pub type Solved = Result<Vec<f64>, StepTooLarge>;

fn solvable(n: usize, factor: f64, weight: f64) -> Result<f64, StepTooLarge> {
    let remaining = 1.0 - factor * weight;
    // NaN is refused as well.
    if remaining > 0.0 { Ok(remaining) } else { Err(StepTooLarge { n, factor, weight }) }
}

/// E_n = s_n + C2 Σ_{j ≤ n} a_nj E_j, where `row` gives a_n0, …, a_nn. O(N²): meant for N up to some thousands.
///
/// # Errors
/// C2 a_nn ≥ 1.
fn solved(source: &[f64], c2: f64, row: impl Fn(usize) -> Vec<f64>) -> Solved {
    let mut envelope: Vec<f64> = Vec::with_capacity(source.len());
    for (n, s) in source.iter().enumerate() {
        let row = row(n);
        let remaining = solvable(n, c2, row[n])?;
        let sum: f64 = row.iter().zip(&envelope).map(|(weight, e)| weight * e).sum();
        envelope.push((s + c2 * sum) / remaining);
    }
    Ok(envelope)
}

/// max_{j ≤ n} s_j times the factor of n.
fn amplified(source: &[f64], factors: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut largest = 0.0f64;
    let bound = |(s, factor): (&f64, f64)| {
        largest = larger(largest, *s);
        largest * factor
    };
    source.iter().zip(factors).map(bound).collect()
}

/// The printed form (3.24), E_n = s_n + C2 k Σ_{j=0..n} E_j, k the largest step.
///
/// # Errors
/// C2 k ≥ 1.
pub(crate) fn unprimed(grid: &TimeGrid, source: &[f64], c2: f64) -> Solved {
    let k = grid.largest_step();
    solved(source, c2, |n| vec![k; n + 1])
}

/// max_{j ≤ n} s_j/(1 - c) · exp(C2 n k/(1 - c)), c = C2 k, k the largest step: above E_n of
/// [`unprimed`], since (1 - c)^{-n} ≤ exp(n c/(1 - c)).
///
/// # Errors
/// C2 k ≥ 1.
pub(crate) fn unprimed_closed(grid: &TimeGrid, source: &[f64], c2: f64) -> Solved {
    let k = grid.largest_step();
    let remaining = solvable(0, c2, k)?;
    let factor = |n: usize| (c2 * k * n as f64 / remaining).exp() / remaining;
    Ok(amplified(source, (0..).map(factor)))
}

/// m0 E_n = s_n + Σ_p ω_p Σ_{j ≤ n} w_nj κ_p(n, j) E_j, with ω_p and w_nj κ_p of `parts`.
///
/// # Errors
/// Σ_p ω_p w_nn κ_p(n, n) ≥ m0.
pub(crate) fn weighted(source: &[f64], m0: f64, parts: &[HistoryPart]) -> Solved {
    let scaled: Vec<f64> = source.iter().map(|s| s / m0).collect();
    let entry = |n: usize, j: usize| -> f64 {
        parts.iter().map(|part| part.coefficient * part.rows[n][j]).sum()
    };
    solved(&scaled, m0.recip(), |n| (0..=n).map(|j| entry(n, j)).collect())
}

/// One component of the history S u = (…, S_p u, …), which enters φ with the factor ω_p and whose
/// discrete sum satisfies ‖S_p^k u - S_p^k v‖ ≤ Σ'_j w_nj κ_p(n, j) ‖u_j - v_j‖.
#[derive(Debug, Clone, PartialEq)]
pub struct HistoryPart {
    /// ω_p: μ L_κ √|Ω| for ζ, 1 for the memory stress, β_φ for an abstract history.
    pub coefficient: f64,
    /// w_nj κ_p(n, j), κ_p = 1 for ζ; else ‖Σ_l W^l_nj Q_l‖, W^l_nj the weights of the rule for the kernel q_l.
    pub rows: Vec<Vec<f64>>,
    /// sup κ_p on [0, T]²; of kernels with (t - s)^{-a}, a the largest power of the history, sup of what stands beside it.
    pub supremum: f64,
}

impl HistoryPart {
    /// Of Σ_l q_l Q_l, with the rows W^l of each kernel and the norm of a sum of the Q_l with these factors.
    pub(super) fn of(
        coefficient: f64,
        supremum: f64,
        each: &[Vec<Vec<f64>>],
        norm: impl Fn(&[f64]) -> f64,
    ) -> Self {
        let at = |n: usize, j: usize| norm(&each.iter().map(|rows| rows[n][j]).collect::<Vec<_>>());
        let levels = each.first().map_or(0, Vec::len);
        let rows = (0..levels).map(|n| (0..=n).map(|j| at(n, j)).collect()).collect();
        Self { coefficient, rows, supremum }
    }
}

/// Weights in Gronwall's inequality that are not negative, the same for every kernel: those of a rule, or bounds of them.
/// By product integration they are those of (t - s)^{-power} alone, which bound those of kernels by what these have
/// beside it; of kernels that are finite, power = 0, those of the trapezoidal rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    rule: scene::TimeRule,
    form: ClosedForm,
    /// 0 ≤ power < 1, 0 by other rules than product integration.
    power: f64,
}

/// (t - s)^{-a}.
struct Power(f64);

impl HistoryKernel for Power {
    fn at(&self, t: f64, s: f64) -> f64 {
        (t - s).powf(-self.0)
    }

    fn power(&self) -> f64 {
        self.0
    }

    fn factor(&self, _: f64, _: f64) -> f64 {
        1.0
    }
}

impl Weights {
    /// The weights of a rule on kernels with this largest power; none where they depend on the kernel in another way.
    pub fn of(rule: scene::TimeRule, power: f64) -> Option<Self> {
        let form = rule.weights().closed_form()?;
        let power = if form == ClosedForm::MittagLeffler { power } else { 0.0 };
        Some(Self { rule, form, power })
    }

    /// The rule.
    pub fn rule(self) -> Box<dyn TimeRule> {
        self.rule.weights()
    }

    /// w_n0, …, w_nn.
    pub fn row(self, grid: &TimeGrid, n: usize) -> Vec<f64> {
        self.rule().kernel_row(&Power(self.power), grid, n)
    }

    /// What C2 stands beside on a step k: k, or k^{1-a}.
    pub(crate) fn of_step(self, k: f64) -> f64 {
        if self.power > 0.0 { k.powf(1.0 - self.power) } else { k }
    }

    /// By how much a bound of κ(n, j) beside the weights of the trapezoidal rule is to be multiplied beside these, up to the
    /// horizon: (t - s)^{-a} ≥ T^{-a}.
    pub(crate) fn beside_plain(self, horizon: f64) -> f64 {
        horizon.powf(self.power)
    }

    /// E_n = s_n + C2 Σ_{j ≤ n} w_nj E_j.
    ///
    /// # Errors
    /// C2 w_nn ≥ 1.
    pub fn envelope(self, grid: &TimeGrid, source: &[f64], c2: f64) -> Solved {
        solved(source, c2, |n| self.row(grid, n))
    }

    /// Above E_n of [`Self::envelope`]: max_{j ≤ n} s_j · A_n with what [`ClosedForm`] says. By the trapezoidal rule
    /// A_1 = 1/(1 - c_1/2), A_n = A_{n-1} (1 + c_n/2)/(1 - c_n/2), c_n = C2 k_n, which is E_n for constant g with g_0 = 0; where
    /// s_0 > 0, E_0 = s_0 enters too and A_n is larger by 1 + c_1/2. By the others the power of 1 + c/(1 - θ) is n then. The
    /// limit for k → 0 is e^{C2 t}.
    ///
    /// By product integration, on any grid with largest step k, it is max s/(1 - θ) · E_α(C2 Γ(α) t^α/(1 - θ)), α = 1 - a,
    /// θ = C2 k^α/α, with the function of Mittag-Leffler. Let y be that, which solves
    /// y(t) = y(0) + C2/(1 - θ) ∫_0^t (t - s)^{-a} y(s) ds and increases. Its interpolant is below y(s + k), and below y(t_n) in
    /// the last k, so the sum of w_nj y(t_j) is below ∫_0^{t_n} (t_n - s)^{-a} y ds + y(t_n) k^α/α; with max s added and C2 before
    /// it that is y(t_n) at most, and induction over n puts E_n below y(t_n).
    ///
    /// # Errors
    /// c_n/2 ≥ 1, θ ≥ 1, or c > 1 by Gregory's rules.
    pub fn closed(self, grid: &TimeGrid, source: &[f64], c2: f64) -> Solved {
        let (share, beyond, most) = match self.form {
            ClosedForm::Paper => (0.5, 0.0, f64::INFINITY),
            ClosedForm::Corrected { share, beyond, most } => (share, beyond, most),
            ClosedForm::MittagLeffler => {
                let exponent = 1.0 - self.power;
                let whole = grid.largest_step().powf(exponent) / exponent;
                let remaining = solvable(1, c2, whole)?;
                return Ok(fractional(grid, source, exponent, c2, remaining));
            }
        };
        let from_rest = source.first().is_none_or(|s| *s == 0.0);
        let mut amplification = 1.0;
        let factor = |n: usize| {
            if n > 0 {
                let (k, c) = (grid.step(n), c2 * grid.step(n));
                // Beyond this c the form is not shown to be a bound.
                let remaining = solvable(n, c2, if c <= most { share * k } else { f64::INFINITY })?;
                let (grown, end) = (1.0 + c / remaining, 1.0 + beyond * c / remaining);
                amplification *= match self.form {
                    _ if n == 1 && from_rest => end / remaining,
                    ClosedForm::Corrected { .. } if n == 1 => grown * end / remaining,
                    _ => grown,
                };
            }
            Ok(amplification)
        };
        let factors: Vec<f64> = (0..source.len()).map(factor).collect::<Result<_, _>>()?;
        Ok(amplified(source, factors))
    }
}

/// max_{j ≤ n} s_j/r · E_α(C2 Γ(α) t_n^α/r).
pub(super) fn fractional(
    grid: &TimeGrid,
    source: &[f64],
    exponent: f64,
    c2: f64,
    r: f64,
) -> Vec<f64> {
    let growth = c2 * gamma(exponent) / r;
    let factor = |t: &f64| mittag_leffler(exponent, growth * t.powf(exponent)) / r;
    amplified(source, grid.times().iter().map(factor))
}

/// E_α(x) = Σ_i x^i/Γ(αi + 1), x ≥ 0, 0 < α ≤ 1: the solution of y(t) = 1 + (1/Γ(α)) ∫_0^t (t - s)^{α-1} y(s) ds is E_α(t^α), and
/// E_1 = exp. All terms are positive; ∞ where it is beyond the doubles.
fn mittag_leffler(alpha: f64, x: f64) -> f64 {
    if x == 0.0 {
        return 1.0;
    }
    let log = x.ln();
    // Terms rise up to αi ≈ x^{1/α}, and E is about e to that power over α.
    let peak = (log / alpha).exp();
    if peak.is_nan() || peak > f64::MAX.ln() {
        return f64::INFINITY;
    }
    let mut sum = 0.0;
    for i in 0u32.. {
        let place = alpha * f64::from(i);
        let term = (f64::from(i) * log - ln_gamma(place + 1.0)).exp();
        sum += term;
        if place > peak && term <= f64::EPSILON * f64::EPSILON * sum {
            break;
        }
    }
    sum
}

// A measured difference with what the proof of Theorem 7 puts over it: any scene, with or without a
// mesh, fills an [`Estimate`] and has its [`Envelopes`] and claims.

/// A difference e_n on a time grid and the data of its bounds,
///
/// ```text
/// m0 e_n ≤ s_n + Σ_p ω_p Σ'_j w_nj κ_p(n, j) e_j        (weighted)
/// m0 e_n ≤ S_n + β_φ ‖S‖ Σ'_j w_nj e_j,  ‖S‖ = Σ_p sup κ_p   (3.21)-(3.24), with Σ' as in (3.2)
/// ```
///
/// s_n ≤ S_n and ω_p ≤ β_φ, so the second follows from the first. For the error of a run in time,
/// s_n = Σ_p ω_p g_n^p and S_n = β_φ Σ_p g_n^p; for two loads both are ‖f_n - f̃_n‖_*.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// t_0, …, t_N.
    pub grid: TimeGrid,
    /// w_nj.
    pub weights: Weights,
    /// e_n = ‖u_n - u_n^k‖.
    pub error: Vec<f64>,
    /// s_n (a dual norm: a stress times √|Ω| in the contact problem).
    pub weighted_source: Vec<f64>,
    /// S_n = β_φ g_n, in the same unit.
    pub source: Vec<f64>,
    /// m0 > 0, no larger than the problem's.
    pub m0: f64,
    /// β_φ.
    pub beta: f64,
    /// The components of the history.
    pub parts: Vec<HistoryPart>,
    /// What solver and rounding leave in one u_n, in the norm of e_n.
    pub floor: f64,
    /// g_n in its parts, none of the difference of two loads: |∫_0^{t_n} ‖ε(u)‖ - Σ' ‖ε(u_j)‖|, zero where ζ is no part of
    /// the history, and ‖∫_0^{t_n} ℬ(t_n - s) ε(u) - Σ' ℬ(t_n - t_j) ε(u_j)‖_ℋ (a stress times √|Ω|), zero without memory;
    /// of an abstract scene zero and ‖S_n u - S_n^k u‖_{X*}.
    pub truncation: [Vec<f64>; 2],
}

/// Constants of a scene on a grid: m0, β_φ, w_nj and the components of the history.
pub type Terms = (f64, f64, Weights, Vec<HistoryPart>);

/// The bounds of e_n at every n, in the order weighted ≤ primed ≤ closed ≤ …; primed ≤ printed.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelopes {
    /// m0 E_n = s_n + Σ_p ω_p Σ' w κ_p E_j: the parts of the history apart.
    pub weighted: Vec<f64>,
    /// E_n = C1 g_n + C2 Σ' w_nj E_j.
    pub primed: Vec<f64>,
    /// C1 max g/(1 - c/2) ((1 + c/2)/(1 - c/2))^{n-1}, c = C2 k, or what [`super::Weights::closed`] says of another rule.
    pub closed: Vec<f64>,
    /// E_n = C1 g_n + C2 k Σ_{j ≤ n} E_j, as printed in (3.24); absent where C2 k ≥ 1.
    pub printed: Option<Vec<f64>>,
    /// C1 max g/(1 - c) exp(C2 t_n/(1 - c)).
    pub printed_closed: Option<Vec<f64>>,
}

impl Estimate {
    /// Without truncation errors.
    pub(super) fn new(
        grid: &TimeGrid,
        (m0, beta, weights, parts): Terms,
        error: Vec<f64>,
        [weighted_source, source]: [Vec<f64>; 2],
        floor: f64,
    ) -> Self {
        let (grid, truncation) = (grid.clone(), [Vec::new(), Vec::new()]);
        Self { grid, weights, error, weighted_source, source, m0, beta, parts, floor, truncation }
    }

    /// C2 = β_φ ‖S‖/m0, ‖S‖ being ‖R‖‖q‖ or the Lipschitz constant of S: Σ_p sup κ_p.
    pub(super) fn c2(&self) -> f64 {
        self.beta / self.m0 * self.parts.iter().map(|part| part.supremum).sum::<f64>()
    }

    /// The bounds, each above the one before.
    ///
    /// # Errors
    /// C2 w_nn ≥ 1. The printed sum, which needs C2 k < 1, is `None` where it fails, and by rules with other weights.
    pub fn envelopes(&self) -> Result<Envelopes, StepTooLarge> {
        let scaled: Vec<f64> = self.source.iter().map(|s| s / self.m0).collect();
        let (grid, c2, weights) = (&self.grid, self.c2(), self.weights);
        // (3.24) has its printed sum where its weights bound those of the trapezoidal rule.
        let as_printed = weights.form == ClosedForm::Paper;
        Ok(Envelopes {
            primed: weights.envelope(grid, &scaled, c2)?,
            closed: weights.closed(grid, &scaled, c2)?,
            weighted: weighted(&self.weighted_source, self.m0, &self.parts)?,
            printed: unprimed(grid, &scaled, c2).ok().filter(|_| as_printed),
            printed_closed: unprimed_closed(grid, &scaled, c2).ok().filter(|_| as_printed),
        })
    }
}

/// Rounding of sums of up to some thousands of positive terms, relative: N·2^-53 for N = 4096 is
/// 5e-13. The envelopes that are compared are equal where the constants are.
const ROUNDING: f64 = 1e-12;

impl Envelopes {
    /// What is made of each, by its name; null where it is absent.
    pub(super) fn each(&self, of: impl Fn(&[f64]) -> Value) -> Map<String, Value> {
        let Self { weighted, primed, closed, printed, printed_closed } = self;
        let all =
            [("weighted", Some(weighted)), ("primed", Some(primed)), ("closed", Some(closed))];
        let printed = [("printed", printed), ("printed_closed", printed_closed)];
        let all = all.into_iter().chain(printed.map(|(name, bound)| (name, bound.as_ref())));
        all.map(|(name, bound)| (name.into(), bound.map_or(Value::Null, |b| of(b)))).collect()
    }

    /// Every link e ≤ weighted ≤ primed ≤ closed, primed ≤ printed ≤ printed closed, at the first n at which it fails, or where
    /// it is tightest; the first of them, with which all stands or falls, is "e <= weighted envelope".
    pub fn claims(&self, estimate: &Estimate, place: &Place) -> Vec<Claim> {
        // What the floor of one step can grow to in e_n: its primed envelope.
        let none = vec![0.0; estimate.grid.times().len()];
        let floor = vec![estimate.floor; none.len()];
        let allowed = estimate.weights.envelope(&estimate.grid, &floor, estimate.c2());
        let (allowed, error) = (allowed.unwrap_or_else(|_| none.clone()), &estimate.error);
        let mut links = vec![
            ("error", "e <= weighted envelope", error, &self.weighted, &allowed),
            ("weighted", "weighted <= primed envelope", &self.weighted, &self.primed, &none),
            ("primed", "primed envelope <= closed form", &self.primed, &self.closed, &none),
        ];
        if let (Some(printed), Some(closed)) = (&self.printed, &self.printed_closed) {
            let says = "closed form <= closed form of the printed sum";
            links.extend([
                ("(3.24)", "primed <= printed envelope", &self.primed, printed, &none),
                ("(3.24)", "printed envelope <= its closed form", printed, closed, &none),
                ("(3.24)", says, &self.closed, closed, &none),
            ]);
        }
        let levels = estimate.grid.times().len();
        let link =
            |(source, says, left, right, allowed): (_, _, &Vec<f64>, &Vec<f64>, &Vec<f64>)| {
                if left.len() != levels || right.len() != levels {
                    let statement = Statement { source, says: "one value per step" };
                    return Claim { statement, place: place.clone(), ..Claim::default() };
                }
                let at = |n: usize| {
                    let place = Place { level: Some(n), ..place.clone() };
                    let accuracy = ROUNDING * right[n] + allowed[n];
                    Claim::at_most(Statement { source, says }, place, [left[n], right[n]], accuracy)
                };
                let mut worst = at(0);
                for claim in (1..levels).map(at) {
                    if worst.standing() != Standing::Passes {
                        break;
                    }
                    if claim.is_worse_than(&worst) {
                        worst = claim;
                    }
                }
                worst
            };
        links.into_iter().map(link).collect()
    }
}

// What a scene of either kind gives to the study of its error in time.

/// Vectors at t_0, …, t_N: loads or displacements in the layout of the scene.
pub type Levels = Vec<Vec<f64>>;

/// The truth on a grid.
pub struct Known {
    /// u(t_0), …, u(t_N).
    pub u: Levels,
    /// As in [`Estimate`], and the factors ω_p with which its parts enter.
    pub truncation: [Vec<f64>; 2],
    pub factors: [f64; 2],
    /// What is not known of u, in its norm.
    pub unknown: f64,
}

/// A scene with its truth in time, ready to run on any of the grids it was prepared for.
pub trait InTime {
    /// The constants of (3.24), and what they are made of, by name.
    fn constants(&self) -> Vec<(&'static str, f64)>;

    /// Where the truth comes from.
    fn truth(&self) -> String;

    /// The grid with N steps.
    fn grid(&self, steps: u32) -> TimeGrid;

    /// f_0, …, f_N.
    ///
    /// # Errors
    /// A formula that is not finite.
    fn loads(&self, grid: &TimeGrid) -> Result<Levels>;

    /// ‖·‖_* of each vector.
    ///
    /// # Errors
    /// A factorization's.
    fn dual_norms(&self, loads: &[Vec<f64>]) -> Result<Vec<f64>>;

    /// u_0^k, …, u_N^k under these loads, and the floor of the run.
    ///
    /// # Errors
    /// The run fails.
    fn solutions(&self, grid: &TimeGrid, loads: &[Vec<f64>]) -> Result<(Levels, f64)>;

    /// ‖u - v‖_X.
    fn distance(&self, u: &[f64], v: &[f64]) -> f64;

    /// The constants on this grid.
    fn terms(&self, grid: &TimeGrid) -> Terms;

    /// The truth on this grid.
    ///
    /// # Errors
    /// A formula that is not finite, a grid that the truth does not have.
    fn known(&self, grid: &TimeGrid) -> Result<Known>;

    /// A run against the truth.
    ///
    /// # Errors
    /// As [`Self::known`].
    fn compared(&self, grid: TimeGrid, (run, floor): (Levels, f64)) -> Result<Estimate> {
        let Known { u, truncation, factors, unknown } = self.known(&grid)?;
        let terms = self.terms(&grid);
        let both = || truncation[0].iter().zip(&truncation[1]);
        let weighted = both().map(|(zeta, memory)| factors[0] * zeta + factors[1] * memory);
        let source = both().map(|(zeta, memory)| terms.1 * (zeta + memory)).collect();
        let error = run.iter().zip(&u).map(|(run, u)| self.distance(run, u)).collect();
        let sources = [weighted.collect(), source];
        let found = Estimate::new(&grid, terms, error, sources, floor + unknown);
        Ok(Estimate { truncation, ..found })
    }

    /// e_n, g_n and the data of the bounds on the grid with N steps.
    ///
    /// # Errors
    /// The run or the truth fails.
    fn measure(&self, steps: u32) -> Result<Estimate> {
        let grid = self.grid(steps);
        let run = self.solutions(&grid, &self.loads(&grid)?)?;
        self.compared(grid, run)
    }
}

/// m0, β_φ, ‖S‖, C1 = β_φ/m0 and C2 = C1 ‖S‖ by name, and others.
pub(super) fn named<const N: usize>(
    [m0, beta, lipschitz]: [f64; 3],
    others: [(&'static str, f64); N],
) -> Vec<(&'static str, f64)> {
    let c1 = beta / m0;
    let own = [("m0", m0), ("beta_phi", beta), ("lipschitz", lipschitz), ("C1", c1)];
    own.into_iter().chain([("C2", c1 * lipschitz)]).chain(others).collect()
}

/// Loads given at the times of a grid.
pub(super) struct GivenLoads<'a>(pub &'a TimeGrid, pub &'a [Vec<f64>]);

impl GivenLoads<'_> {
    /// The load at t; none between the times of the grid.
    pub(super) fn load(&self, t: f64) -> Option<&[f64]> {
        let n = self.0.times().iter().position(|level| *level == t)?;
        Some(&self.1[n])
    }
}

/// A scene without an estimate, by words that follow its name.
pub(super) fn refused(scene: &scene::Scene, why: &str) -> StudyError {
    StudyError::Unbounded { scene: scene.name.clone(), why: why.into() }
}

/// The rule corrects its weights by the kernel.
pub(super) const OWN_WEIGHTS: &str = ": the rule corrects its last weight by the kernel, and (3.24) has one set of weights for all; take \"trapezoid\", \"left\", \"gregory\" or \"product-integration\"";
/// Nothing is remembered, so there is no error in time to bound.
pub(super) const NO_HISTORY: &str = " has no history (neither memory nor a yield limit that depends on zeta), so its error in time is zero";

/// (2.9), with a bound of c_j².
pub(super) fn smallness(scene: &scene::Scene, m0: f64) -> Result<()> {
    let why = format!(
        ": m0 = {m0:.6} is not positive with an upper bound of c_j^2; flatten the falling branch of the law"
    );
    if m0 > 0.0 { Ok(()) } else { Err(refused(scene, &why)) }
}

#[cfg(test)]
mod tests {
    use super::mittag_leffler;

    /// E_1(x) = e^x; E_{1/2}(x) = e^{x²} erfc(-x), by tables of erfc.
    #[test]
    fn known_values_are_met() {
        for x in [0.0, 0.1, 1.0, 10.0, 300.0] {
            let off = mittag_leffler(1.0, x) / f64::exp(x) - 1.0;
            // Logarithms of terms as large as 300 · 6 lose three digits.
            assert!(off.abs() < 1e-11, "{x}: {off:e}");
        }
        // erfc(-1/2) = 1.520499877813046537…, erfc(-1) = 1.842700792949714869…, erfc(-2) = 1.995322265018952734….
        for (x, erfc) in [
            (0.5, 1.520_499_877_813_046_5),
            (1.0, 1.842_700_792_949_715),
            (2.0, 1.995_322_265_018_952_7),
        ] {
            let off = mittag_leffler(0.5, x) / (f64::exp(x * x) * erfc) - 1.0;
            assert!(off.abs() < 1e-12, "{x}: {off:e}");
        }
        assert!(mittag_leffler(0.3, 10.0).is_infinite());
    }
}
