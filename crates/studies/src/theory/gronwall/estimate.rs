//! A measured difference with what the proof of Theorem 7 puts over it: any scene, with or without a
//! mesh, fills an [`Estimate`] and has its [`Envelopes`] and claims.

use super::recurrence::{HistoryPart, StepTooLarge, Weights, unprimed, unprimed_closed, weighted};
use judge::claim::{Claim, Place, Standing, Statement};
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
