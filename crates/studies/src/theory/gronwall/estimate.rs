//! A measured difference with what the proof of Theorem 7 puts over it: any scene, with or without a
//! mesh, fills an [`Estimate`] and has its [`Envelopes`] and claims.

use super::recurrence::{HistoryPart, StepTooLarge, Weights, unprimed, unprimed_closed, weighted};
use algebra::linalg::FactorError;
use fem::contact::{CaseError, LoadError};
use judge::claim::{Claim, Place, Standing, Statement};
use scene::setup::SetupError;
use serde::Serialize;
use vhi::finite::FiniteError;
use vhi::history::TimeGrid;

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

/// One thing for each bound of e_n, in the order weighted ≤ primed ≤ closed ≤ …; primed ≤ printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bounds<T> {
    /// m0 E_n = s_n + Σ_p ω_p Σ' w κ_p E_j: the parts of the history apart.
    pub weighted: T,
    /// E_n = C1 g_n + C2 Σ' w_nj E_j.
    pub primed: T,
    /// C1 max g/(1 - c/2) ((1 + c/2)/(1 - c/2))^{n-1}, c = C2 k, or what [`super::Weights::closed`] says of another rule.
    pub closed: T,
    /// C1 max g e^{C2 t_n}, or what [`super::Weights::limit`] says of product integration.
    pub limit: T,
    /// E_n = C1 g_n + C2 k Σ_{j ≤ n} E_j, as printed in (3.24); absent where C2 k ≥ 1.
    pub printed: Option<T>,
    /// C1 max g/(1 - c) exp(C2 t_n/(1 - c)).
    pub printed_closed: Option<T>,
}

/// The bounds of e_n at every n.
pub type Envelopes = Bounds<Vec<f64>>;

impl<T> Bounds<T> {
    pub(super) fn map<U>(&self, of: impl Fn(&T) -> U) -> Bounds<U> {
        Bounds {
            weighted: of(&self.weighted),
            primed: of(&self.primed),
            closed: of(&self.closed),
            limit: of(&self.limit),
            printed: self.printed.as_ref().map(&of),
            printed_closed: self.printed_closed.as_ref().map(&of),
        }
    }
}

impl Estimate {
    /// C2 = β_φ ‖S‖/m0, ‖S‖ being ‖R‖‖q‖ or the Lipschitz constant of S: Σ_p sup κ_p.
    pub(super) fn c2(&self) -> f64 {
        self.beta / self.m0 * self.parts.iter().map(|part| part.supremum).sum::<f64>()
    }

    /// The estimate up to t_last, with the largest κ_p(n, j) of that part of the grid as suprema: a shorter
    /// horizon.
    pub(super) fn up_to(&self, last: usize) -> Self {
        let kept = |values: &[f64]| values[..=last].to_vec();
        let part = |part: &HistoryPart| {
            let supremum = part.norms.maximum(last).unwrap_or(part.supremum);
            HistoryPart { supremum, ..part.clone() }
        };
        Self {
            grid: self.grid.up_to(last),
            error: kept(&self.error),
            weighted_source: kept(&self.weighted_source),
            source: kept(&self.source),
            parts: self.parts.iter().map(part).collect(),
            truncation: self.truncation.each_ref().map(|part| kept(part)),
            ..*self
        }
    }

    /// The bounds, each above the one before.
    ///
    /// # Errors
    /// C2 w_nn ≥ 1. The printed sum, which needs C2 k < 1, is `None` where it fails, and by rules with other weights.
    pub fn envelopes(&self) -> Result<Envelopes, StepTooLarge> {
        let scaled: Vec<f64> = self.source.iter().map(|s| s / self.m0).collect();
        let (grid, c2, weights, rule) = (&self.grid, self.c2(), self.weights, self.weights.rule());
        // (3.24) has its printed sum where its weights bound those of the trapezoidal rule.
        let as_printed = weights.are_the_papers();
        Ok(Envelopes {
            primed: weights.envelope(grid, &scaled, c2)?,
            closed: weights.closed(grid, &scaled, c2)?,
            limit: weights.limit(grid, &scaled, c2),
            weighted: weighted(&*rule, grid, &self.weighted_source, self.m0, &self.parts)?,
            printed: unprimed(grid, &scaled, c2).ok().filter(|_| as_printed),
            printed_closed: unprimed_closed(grid, &scaled, c2).ok().filter(|_| as_printed),
        })
    }
}

/// Rounding of sums of up to some thousands of positive terms, relative: N·2^-53 for N = 4096 is
/// 5e-13. The envelopes that are compared are equal where the constants are.
const ROUNDING: f64 = 1e-12;

impl Envelopes {
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
    fn loads(&self, grid: &TimeGrid) -> Result<Levels, GronwallError>;

    /// ‖·‖_* of each vector.
    ///
    /// # Errors
    /// A factorization's.
    fn dual_norms(&self, loads: &[Vec<f64>]) -> Result<Vec<f64>, GronwallError>;

    /// u_0^k, …, u_N^k under these loads, and the floor of the run.
    ///
    /// # Errors
    /// The run fails.
    fn solutions(
        &self,
        grid: &TimeGrid,
        loads: &[Vec<f64>],
    ) -> Result<(Levels, f64), GronwallError>;

    /// ‖u - v‖_X.
    fn distance(&self, u: &[f64], v: &[f64]) -> f64;

    /// The constants on this grid.
    fn terms(&self, grid: &TimeGrid) -> Terms;

    /// The truth on this grid.
    ///
    /// # Errors
    /// A formula that is not finite, a grid that the truth does not have.
    fn known(&self, grid: &TimeGrid) -> Result<Known, GronwallError>;

    /// A run against the truth.
    ///
    /// # Errors
    /// As [`Self::known`].
    fn compared(
        &self,
        grid: TimeGrid,
        (run, floor): (Levels, f64),
    ) -> Result<Estimate, GronwallError> {
        let Known { u, truncation, factors, unknown } = self.known(&grid)?;
        let (m0, beta, weights, parts) = self.terms(&grid);
        let both = || truncation[0].iter().zip(&truncation[1]);
        let weighted = both().map(|(zeta, memory)| factors[0] * zeta + factors[1] * memory);
        Ok(Estimate {
            weights,
            error: run.iter().zip(&u).map(|(run, u)| self.distance(run, u)).collect(),
            weighted_source: weighted.collect(),
            source: both().map(|(zeta, memory)| beta * (zeta + memory)).collect(),
            m0,
            beta,
            parts,
            floor: floor + unknown,
            truncation,
            grid,
        })
    }

    /// e_n, g_n and the data of the bounds on the grid with N steps.
    ///
    /// # Errors
    /// The run or the truth fails.
    fn measure(&self, steps: u32) -> Result<Estimate, GronwallError> {
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

/// What ends a study before it can judge.
#[derive(Debug, thiserror::Error)]
pub enum GronwallError {
    /// The scene has no estimate: no history, or a constant that is not known, not finite or not positive.
    #[error("scene `{scene}`{why}")]
    Refused { scene: String, why: String },
    /// A body without a mesh, or a mesh without a body.
    #[error("{reason}")]
    Mesh { reason: &'static str },
    /// C2 w_nn ≥ 1 on a grid.
    #[error("{steps} steps: {source}")]
    Step { steps: u32, source: StepTooLarge },
    /// A run with more steps has no level at the times of this grid.
    #[error(
        "the grid with {steps} steps is not part of the reference's with {reference}: random grids need an exact solution in V^h"
    )]
    NotNested { steps: u32, reference: u32 },
    /// A horizon that is no multiple of the step.
    #[error("horizon {horizon} is no multiple of the step k = {k}: choose multiples")]
    Horizon { horizon: f64, k: f64 },
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error("{steps} steps: {source}")]
    Case { steps: u32, source: CaseError },
    #[error("{steps} steps: {source}")]
    FiniteCase { steps: u32, source: FiniteError },
    /// The inner product of an abstract scene has no inverse.
    #[error("the inner product is singular")]
    InnerProduct,
    #[error("the dual norm: {0}")]
    Dual(#[from] FactorError),
    #[error(transparent)]
    Setup(#[from] SetupError),
}

/// A scene without an estimate, by words that follow its name.
pub(super) fn refused(scene: &scene::Scene, why: &str) -> GronwallError {
    GronwallError::Refused { scene: scene.name.clone(), why: why.into() }
}

/// The rule corrects its weights by the kernel.
pub(super) const OWN_WEIGHTS: &str = ": the rule corrects its last weight by the kernel, and (3.24) has one set of weights for all; take \"trapezoid\", \"left\", \"gregory\" or \"product-integration\"";
/// Nothing is remembered, so there is no error in time to bound.
pub(super) const NO_HISTORY: &str = " has no history: neither memory nor a yield limit that depends on zeta; the error in time is zero";

/// (2.9), with a bound of c_j².
pub(super) fn smallness(scene: &scene::Scene, m0: f64) -> Result<(), GronwallError> {
    let why = format!(
        ": m0 = {m0:.6} is not positive with an upper bound of c_j^2; flatten the falling branch of the law"
    );
    if m0 > 0.0 { Ok(()) } else { Err(refused(scene, &why)) }
}
