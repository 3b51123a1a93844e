//! Bounds on the step size of the scheme (3.3) from the constants of Problem 5.
//!
//! Λ: η ↦ u_η freezes the last slot of the history at η and solves. Its contraction factor is bounded by k β_φ‖R‖‖q‖/m0
//! (3.15). But the weight of that slot is w_nn (k/2 for the trapezoidal rule), not k, and a history of several parts
//! enters by the sum of their factors instead of a product of maxima, so the factor is also at most
//! w_nn·`last_slot`/m0. With w_nn = 0, Λ is constant.

/// Constants of Problem 5 that bound its step size. Units: m0 a stress, the others a stress per time.
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
    /// The part of the last slot, for weight 1, that can act against the monotonicity of the step.
    pub destabilizing: f64,
    /// The largest w_nn/k of the time rule: ½ for the trapezoidal one.
    pub last_share: f64,
    /// The same constants of kernels (t - s)^{-a} b(t, s), in terms of b.
    pub singular: SingularSlot,
}

/// Additional constants of kernels (t - s)^{-a} b(t, s): their last weight w = `share` k^{1-a} takes the place of k in
/// (3.4). Units: b is a stress over a time to the power 1 - a.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SingularSlot {
    /// a; 0 without such a kernel.
    pub power: f64,
    /// 1/((1-a)(2-a)).
    pub share: f64,
    /// ‖R‖ max ‖b‖, with operator norms.
    pub lipschitz: f64,
    /// ‖R‖ max ‖b‖, in the paper's norms.
    pub paper_lipschitz: f64,
    /// As [`StepBounds::last_slot`], for b(t, t).
    pub last_slot: f64,
    /// As [`StepBounds::destabilizing`], for b(t, t).
    pub destabilizing: f64,
}

impl SingularSlot {
    fn weight(&self, k: f64) -> f64 {
        if self.share == 0.0 { 0.0 } else { self.share * k.powf(1.0 - self.power) }
    }
}

/// The eigenvalue, the slopes and the trace constant of (2.9) are each known to a few units of rounding.
const ROUNDING: f64 = 1e-14;

/// m0 = m_A - `taken` of (2.9), with `taken` = α_φ + α_j c_j². Zero if the difference is within rounding, since bounds
/// divide by it.
pub fn monotonicity(m_a: f64, taken: f64) -> f64 {
    let m0 = m_a - taken;
    if m0.abs() <= ROUNDING * m_a.abs().max(taken.abs()) { 0.0 } else { m0 }
}

impl StepBounds {
    /// The bound (3.15) of the contraction factor of Λ, with the norms of the paper. Like the next two it is infinite
    /// for m0 ≤ 0.
    pub fn paper_factor(&self, k: f64) -> f64 {
        self.over_m0(self.size(k, self.paper()))
    }

    /// The bound (3.15) of the contraction factor of Λ, with operator norms.
    pub fn factor(&self, k: f64) -> f64 {
        self.over_m0(self.size(k, self.operator()))
    }

    /// The sharpened bound of the contraction factor of Λ.
    pub fn sharpened_factor(&self, k: f64) -> f64 {
        self.over_m0(self.size(k, self.sharpened()))
    }

    /// The part of the monotonicity that the last slot of a step k can take.
    pub fn taken(&self, k: f64) -> f64 {
        self.size(k, self.taking())
    }

    /// Constants that multiply k, and the last weight of singular kernels.
    fn paper(&self) -> [f64; 2] {
        [self.paper_lipschitz, self.singular.paper_lipschitz]
            .map(|lipschitz| self.beta_phi * self.counted(lipschitz))
    }

    fn operator(&self) -> [f64; 2] {
        [self.lipschitz, self.singular.lipschitz]
            .map(|lipschitz| self.beta_phi * self.counted(lipschitz))
    }

    fn sharpened(&self) -> [f64; 2] {
        [self.last_share * self.last_slot, self.singular.last_slot]
    }

    fn taking(&self) -> [f64; 2] {
        [self.last_share * self.destabilizing, self.singular.destabilizing]
    }

    /// A constant of the history, which (3.4) counts with all of k; 0 if the last slot has no weight.
    fn counted(&self, lipschitz: f64) -> f64 {
        if self.last_share == 0.0 { 0.0 } else { lipschitz }
    }

    fn size(&self, k: f64, [plain, singular]: [f64; 2]) -> f64 {
        k * plain + self.singular.weight(k) * singular
    }

    fn over_m0(&self, size: f64) -> f64 {
        if self.m0 <= 0.0 { f64::INFINITY } else { size / self.m0 }
    }

    /// (3.4) with the norms of the paper: k below this.
    pub fn paper_limit(&self) -> f64 {
        self.limit_of(self.paper())
    }

    /// (3.4) with operator norms.
    pub fn limit(&self) -> f64 {
        self.limit_of(self.operator())
    }

    /// The k below which Λ is a contraction by the sharpened bound.
    pub fn sharpened_limit(&self) -> f64 {
        self.limit_of(self.sharpened())
    }

    /// The k below which the step is strongly monotone, hence has exactly one solution.
    pub fn solvable_limit(&self) -> f64 {
        self.limit_of(self.taking())
    }

    /// The k at which the size of the last slot reaches m0.
    fn limit_of(&self, constants: [f64; 2]) -> f64 {
        let plain = limit(self.m0, constants[0]);
        let size = self.singular.share * constants[1];
        let powers = limit(self.m0, size).powf(1.0 / (1.0 - self.singular.power));
        if size == 0.0 || !(plain.is_finite() && powers > 0.0) {
            return if size == 0.0 { plain } else { powers };
        }
        // The size increases with k, and has reached m0 at the smaller of both limits.
        let (mut below, mut above) = (0.0, plain.min(powers));
        loop {
            let middle = 0.5 * (below + above);
            if middle <= below || middle >= above {
                return below;
            }
            *if self.size(middle, constants) < self.m0 { &mut below } else { &mut above } = middle;
        }
    }

    /// Where a step size stands.
    pub fn place(&self, k: f64) -> StepPlace {
        if k < self.limit() {
            StepPlace::WithinTheorem
        } else if k < self.solvable_limit() {
            StepPlace::Solvable
        } else {
            // Includes NaN limits.
            StepPlace::Unguaranteed
        }
    }
}

/// m0/size; ∞ if nothing depends on the last slot, 0 if m0 ≤ 0, NaN if m0 is.
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
    /// k is beyond (3.4), but the step is still strongly monotone.
    Solvable,
    /// Nothing guarantees a unique solution.
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
        singular: SingularSlot {
            power: 0.0,
            share: 0.0,
            lipschitz: 0.0,
            paper_lipschitz: 0.0,
            last_slot: 0.0,
            destabilizing: 0.0,
        },
    };

    /// a = ½: w = (4/3)√k. Alone √k < m0 (3/4)/b; beside a plain kernel the limit is the root of both.
    #[test]
    fn singular_kernels_are_counted_with_their_last_weight() {
        let singular = SingularSlot {
            power: 0.5,
            share: 4.0 / 3.0,
            lipschitz: 3.0,
            paper_lipschitz: 6.0,
            last_slot: 2.0,
            destabilizing: 1.5,
        };
        let alone = StepBounds {
            lipschitz: 0.0,
            paper_lipschitz: 0.0,
            last_slot: 0.0,
            destabilizing: 0.0,
            singular,
            ..BOUNDS
        };
        let both = StepBounds { singular, ..BOUNDS };
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-14;
        let limits =
            [alone.paper_limit(), alone.limit(), alone.sharpened_limit(), alone.solvable_limit()];
        for (found, expected) in limits.into_iter().zip([0.0625, 0.25, 0.5625, 1.0]) {
            assert!(near(found, expected), "{found} {expected}");
        }
        // 2 k + 4 √k = 2.
        assert!(near(both.limit().sqrt(), 2f64.sqrt() - 1.0), "{}", both.limit());
        let at_limits = [
            both.paper_factor(both.paper_limit()),
            both.factor(both.limit()),
            both.sharpened_factor(both.sharpened_limit()),
            both.taken(both.solvable_limit()) / both.m0,
        ];
        assert!(at_limits.into_iter().all(|one| near(one, 1.0)), "{at_limits:?}");
        for (limit, place) in [(0.999, StepPlace::WithinTheorem), (1.001, StepPlace::Solvable)] {
            assert_eq!(both.place(limit * both.limit()), place);
        }
        assert_eq!(StepBounds { m0: -0.1, ..both }.place(1e-9), StepPlace::Unguaranteed);
        assert_eq!(StepBounds { m0: f64::NAN, ..both }.place(0.1), StepPlace::Unguaranteed);
    }

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

    /// Without a weight in the last slot each step is one solve with a known past.
    #[test]
    fn no_step_is_too_large_without_a_last_weight() {
        let explicit = StepBounds { last_share: 0.0, ..BOUNDS };
        assert_eq!(explicit.place(1e9), StepPlace::WithinTheorem);
        assert_eq!([explicit.paper_factor(9.0), explicit.sharpened_factor(9.0)], [0.0, 0.0]);
        // A quarter of the step: limits that know the weight are twice those of one half.
        let quarter = StepBounds { last_share: 0.25, ..BOUNDS };
        assert_eq!([quarter.sharpened_limit(), quarter.solvable_limit()], [8.0, 16.0]);
        assert_eq!(StepBounds { m0: -0.1, ..explicit }.place(1e-9), StepPlace::Unguaranteed);
    }
}
