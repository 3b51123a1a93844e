//! A measured difference with what the proof of Theorem 7 puts over it: any scene, with or without a
//! mesh, fills an [`Estimate`] and has its [`Envelopes`].

use super::GronwallError;
use super::bounds::Bounds;
use super::recurrence::{HistoryPart, StepTooLarge, unprimed, unprimed_closed, weighted};
use super::rule::Weights;
use algebra::linalg::largest;
use serde::Serialize;
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

impl Estimate {
    /// One with these constants, before anything is measured.
    pub(super) fn blank(
        grid: &TimeGrid,
        weights: Weights,
        m0: f64,
        beta: f64,
        parts: Vec<HistoryPart>,
    ) -> Self {
        Self {
            grid: grid.clone(),
            weights,
            m0,
            beta,
            parts,
            error: Vec::new(),
            weighted_source: Vec::new(),
            source: Vec::new(),
            floor: 0.0,
            truncation: [Vec::new(), Vec::new()],
        }
    }

    /// C2 = β_φ ‖S‖/m0, ‖S‖ being ‖R‖‖q‖ or the Lipschitz constant of S: Σ_p sup κ_p.
    pub(crate) fn c2(&self) -> f64 {
        self.beta / self.m0 * self.parts.iter().map(|part| part.supremum).sum::<f64>()
    }

    /// The estimate up to t_last, with the largest κ_p(n, j) of that part of the grid as suprema: a shorter
    /// horizon.
    pub(crate) fn up_to(&self, last: usize) -> Self {
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
        let (grid, c2, weights) = (&self.grid, self.c2(), self.weights);
        // (3.24) has its printed sum where its weights bound those of the trapezoidal rule.
        let as_printed = weights.are_the_papers();
        Ok(Envelopes {
            primed: weights.envelope(grid, &scaled, c2)?,
            closed: weights.closed(grid, &scaled, c2)?,
            limit: weights.limit(grid, &scaled, c2),
            weighted: weighted(
                &*weights.rule(),
                grid,
                &self.weighted_source,
                self.m0,
                &self.parts,
            )?,
            printed: unprimed(grid, &scaled, c2).ok().filter(|_| as_printed),
            printed_closed: unprimed_closed(grid, &scaled, c2).ok().filter(|_| as_printed),
        })
    }
}

/// The bounds of e_n at every n.
pub type Envelopes = Bounds<Vec<f64>>;

/// A link of the chain that does not hold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LinkViolation {
    /// Which inequality, such as "e <= weighted envelope".
    pub link: &'static str,
    /// The first n at which it fails.
    pub n: usize,
    /// t_n.
    pub t: f64,
    /// Left side.
    pub left: f64,
    /// Right side.
    pub right: f64,
}

/// Rounding of sums of up to some thousands of positive terms, relative: N·2^-53 for N = 4096 is
/// 5e-13. The envelopes that are compared are equal where the constants are.
const ROUNDING: f64 = 1e-12;

impl Envelopes {
    /// Every link e ≤ weighted ≤ primed ≤ closed, primed ≤ printed ≤ printed closed that fails, by
    /// its first n. A number that is not finite fails.
    pub fn violations(&self, estimate: &Estimate) -> Vec<LinkViolation> {
        let measured = "e <= weighted envelope";
        // What the floor of one step can grow to in e_n: its primed envelope.
        let floor = vec![estimate.floor; estimate.error.len()];
        let allowance = estimate.weights.envelope(&estimate.grid, &floor, estimate.c2());
        let allowance = allowance.unwrap_or_else(|_| vec![0.0; floor.len()]);
        let mut links: Vec<(&'static str, &[f64], &[f64])> = vec![
            (measured, &estimate.error, &self.weighted),
            ("weighted <= primed envelope", &self.weighted, &self.primed),
            ("primed envelope <= closed form", &self.primed, &self.closed),
        ];
        if let (Some(printed), Some(closed)) = (&self.printed, &self.printed_closed) {
            links.push(("primed <= printed envelope", &self.primed, printed));
            links.push(("printed envelope <= its closed form", printed, closed));
            links.push(("closed form <= closed form of the printed sum", &self.closed, closed));
        }
        let steps = estimate.grid.times();
        let failing = |(link, left, right): (&'static str, &[f64], &[f64])| {
            if left.len() != steps.len() || right.len() != steps.len() {
                let (left, right) = (left.len() as f64, right.len() as f64);
                return Some(LinkViolation {
                    link: "one value per step",
                    n: 0,
                    t: 0.0,
                    left,
                    right,
                });
            }
            let n = (0..steps.len()).find(|&n| {
                let allowed = if link == measured { allowance[n] } else { 0.0 };
                let bound = right[n] * (1.0 + ROUNDING) + allowed;
                // NaN and infinity fail.
                !(left[n] <= bound && bound.is_finite() && left[n] >= 0.0)
            })?;
            Some(LinkViolation { link, n, t: steps[n], left: left[n], right: right[n] })
        };
        links.into_iter().filter_map(failing).collect()
    }
}

/// A run with its envelopes and the links of the chain that do not hold; the table of all levels holds its curves.
pub struct Judged {
    pub estimate: Estimate,
    pub envelopes: Envelopes,
    pub violations: Vec<LinkViolation>,
}

impl Judged {
    /// # Errors
    /// [`GronwallError::Step`].
    pub(super) fn new(estimate: Estimate) -> Result<Self, GronwallError> {
        let steps = estimate.grid.steps() as u32;
        let envelopes =
            estimate.envelopes().map_err(|source| GronwallError::Step { steps, source })?;
        let violations = envelopes.violations(&estimate);
        Ok(Self { estimate, envelopes, violations })
    }
}

/// bound/e of one grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Effectivity {
    /// At t_N = T; absent if e_N is at its floor.
    pub at_end: Option<f64>,
    /// max_n bound/max_n e.
    pub of_maxima: f64,
    /// The least over n ≥ 1: how close the bound comes to being attained.
    pub least: Option<f64>,
}

impl Effectivity {
    pub(crate) fn new(bound: &[f64], estimate: &Estimate) -> Self {
        // Where e_n is not above 20 floors there is none.
        let serves = |n: usize| n > 0 && estimate.error[n] > 20.0 * estimate.floor;
        let ratio = |n: usize| serves(n).then(|| bound[n] / estimate.error[n]);
        Self {
            at_end: bound.len().checked_sub(1).and_then(ratio),
            of_maxima: largest(bound) / largest(&estimate.error),
            least: (0..bound.len()).filter_map(ratio).reduce(f64::min),
        }
    }
}
