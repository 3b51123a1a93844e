//! Bounds on the step size of the scheme (3.3) from the constants of Problem 5.
//!
//! Λ: η ↦ u_η freezes the last slot of the history at η and solves. Its contraction factor is bounded
//! by k β_φ‖R‖‖q‖/m0 (3.15). A rule gives that slot the weight w_nn, k/2 by the trapezoidal one, not k, and
//! a history of several parts enters with the sum of their own factors instead of a product of maxima, so
//! the factor is also at most w_nn·`last_slot`/m0. Without a weight there, Λ is constant.

/// Constants of Problem 5 that bound its step size. Units: m0 a stress, the others a stress a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepBounds {
    /// m0 = m_A - α_φ - α_j c_j² of (2.9).
    pub m0: f64,
    /// β_φ of (2.7b).
    pub beta_phi: f64,
    /// ‖R‖‖q‖, or the Lipschitz constant of S, with operator norms.
    pub lipschitz: f64,
    /// ‖R‖‖q‖, or the Lipschitz constant of S, in the paper's norms.
    pub paper_lipschitz: f64,
    /// Lipschitz constant of y ↦ φ(y,·,·) composed with the last slot of S, for weight 1.
    pub last_slot: f64,
    /// How much of the last slot, for weight 1, can act against the monotonicity of the step.
    pub destabilizing: f64,
    /// The largest w_nn/k of the time rule: ½ of the trapezoidal one.
    pub last_share: f64,
}

/// The eigenvalue, the slopes and the trace constant of (2.9) are each known to a few units of rounding.
const ROUNDING: f64 = 1e-14;

/// m0 = m_A - `taken` of (2.9), with `taken` = α_φ + α_j c_j². Zero where the difference is no more than rounding of its
/// terms: 1e-16 is no stress that a bound could be divided by.
pub fn monotonicity(m_a: f64, taken: f64) -> f64 {
    let m0 = m_a - taken;
    if m0.abs() <= ROUNDING * m_a.abs().max(taken.abs()) { 0.0 } else { m0 }
}

impl StepBounds {
    /// The bound (3.15) of the contraction factor of Λ, with the norms of the paper. Like the other two it is infinite
    /// where m0 ≤ 0: then nothing bounds the factor.
    pub fn paper_factor(&self, k: f64) -> f64 {
        self.over_m0(k * self.beta_phi * self.counted(self.paper_lipschitz))
    }

    /// The bound (3.15) of the contraction factor of Λ, with operator norms.
    pub fn factor(&self, k: f64) -> f64 {
        self.over_m0(k * self.beta_phi * self.counted(self.lipschitz))
    }

    /// The sharpened bound of the contraction factor of Λ.
    pub fn sharpened_factor(&self, k: f64) -> f64 {
        self.over_m0(self.last_share * k * self.last_slot)
    }

    /// A constant of the history, which (3.4) counts with all of k; 0 where the last slot has no weight.
    fn counted(&self, lipschitz: f64) -> f64 {
        if self.last_share == 0.0 { 0.0 } else { lipschitz }
    }

    fn over_m0(&self, size: f64) -> f64 {
        if self.m0 <= 0.0 { f64::INFINITY } else { size / self.m0 }
    }

    /// (3.4) with the norms of the paper: k below this.
    pub fn paper_limit(&self) -> f64 {
        limit(self.m0, self.beta_phi * self.counted(self.paper_lipschitz))
    }

    /// (3.4) with operator norms.
    pub fn limit(&self) -> f64 {
        limit(self.m0, self.beta_phi * self.counted(self.lipschitz))
    }

    /// The k below which Λ is a contraction by the sharpened bound.
    pub fn sharpened_limit(&self) -> f64 {
        limit(self.m0, self.last_share * self.last_slot)
    }

    /// The k below which the step is a strongly monotone problem, hence has exactly one solution.
    pub fn solvable_limit(&self) -> f64 {
        limit(self.m0, self.last_share * self.destabilizing)
    }

    /// Where a step size stands.
    pub fn place(&self, k: f64) -> StepPlace {
        if k < self.limit() {
            StepPlace::WithinTheorem
        } else if k < self.solvable_limit() {
            StepPlace::Solvable
        } else {
            // NaN limits end here as well.
            StepPlace::Unguaranteed
        }
    }
}

/// m0/size; no restriction where nothing depends on the last slot, none admissible if m0 ≤ 0, NaN if m0 is.
fn limit(m0: f64, size: f64) -> f64 {
    if m0.is_nan() {
        f64::NAN
    } else if m0 <= 0.0 {
        0.0
    } else if size == 0.0 {
        f64::INFINITY
    } else {
        m0 / size
    }
}

/// What is known of a step size beforehand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepPlace {
    /// k satisfies (3.4).
    WithinTheorem,
    /// k is beyond (3.4), and the step is still strongly monotone.
    Solvable,
    /// Nothing guarantees that the step has one solution.
    Unguaranteed,
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: StepBounds = StepBounds {
        m0: 2.0,
        beta_phi: 1.0,
        lipschitz: 2.0,
        paper_lipschitz: 5.0,
        last_slot: 1.0,
        destabilizing: 0.5,
        last_share: 0.5,
    };

    #[test]
    fn factors_reach_one_at_the_limits() {
        assert_eq!(BOUNDS.paper_factor(BOUNDS.paper_limit()), 1.0);
        assert_eq!(BOUNDS.factor(BOUNDS.limit()), 1.0);
        assert_eq!(BOUNDS.sharpened_factor(BOUNDS.sharpened_limit()), 1.0);
        let limits = [
            BOUNDS.paper_limit(),
            BOUNDS.limit(),
            BOUNDS.sharpened_limit(),
            BOUNDS.solvable_limit(),
        ];
        assert_eq!(limits, [0.4, 1.0, 4.0, 8.0]);
    }

    #[test]
    fn every_step_has_its_place() {
        assert_eq!(BOUNDS.place(0.9), StepPlace::WithinTheorem);
        assert_eq!(BOUNDS.place(1.0), StepPlace::Solvable);
        assert_eq!(BOUNDS.place(8.0), StepPlace::Unguaranteed);
        let free = StepBounds { destabilizing: 0.0, ..BOUNDS };
        assert_eq!(free.place(1e9), StepPlace::Solvable);
        // (2.9) violated: no step is covered, however small.
        assert_eq!(StepBounds { m0: -0.1, ..BOUNDS }.place(1e-9), StepPlace::Unguaranteed);
        assert_eq!(StepBounds { m0: f64::NAN, ..BOUNDS }.place(0.1), StepPlace::Unguaranteed);
        assert_eq!(StepBounds { m0: f64::NAN, ..free }.place(0.1), StepPlace::Unguaranteed);
        assert_eq!(
            StepBounds { last_slot: 0.0, destabilizing: 0.0, ..BOUNDS }.sharpened_limit(),
            f64::INFINITY
        );
    }

    /// By a rule without a weight in the last slot each step is one solve with a known past.
    #[test]
    fn no_step_is_too_large_without_a_last_weight() {
        let explicit = StepBounds { last_share: 0.0, ..BOUNDS };
        assert_eq!(explicit.place(1e9), StepPlace::WithinTheorem);
        assert_eq!([explicit.paper_factor(9.0), explicit.sharpened_factor(9.0)], [0.0, 0.0]);
        // A quarter of the step: the limits that know the weight are twice those of one half.
        let quarter = StepBounds { last_share: 0.25, ..BOUNDS };
        assert_eq!([quarter.sharpened_limit(), quarter.solvable_limit()], [8.0, 16.0]);
        assert_eq!(StepBounds { m0: -0.1, ..explicit }.place(1e-9), StepPlace::Unguaranteed);
    }
}
