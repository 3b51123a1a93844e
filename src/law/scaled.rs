//! A law times a positive number: what a law with a factor c(x) is at one place.

use std::sync::Arc;

use super::Potential;

/// c ∂j_ν. The definitions (2.8b) and (2.8c) are linear in ∂j_ν, so c0, c1 and α_ν are c times those of the
/// law; over Γ3 the constants of the problem take the largest c.
pub struct Scaled {
    /// ∂j_ν.
    pub potential: Arc<dyn Potential>,
    /// c > 0.
    pub factor: f64,
}

impl Potential for Scaled {
    fn subdifferential(&self, r: f64) -> (f64, f64) {
        let (lo, hi) = self.potential.subdifferential(r);
        (self.factor * lo, self.factor * hi)
    }

    fn value_and_slope(&self, r: f64) -> (f64, f64) {
        let (value, slope) = self.potential.value_and_slope(r);
        (self.factor * value, self.factor * slope)
    }

    fn jumps(&self) -> &[f64] {
        self.potential.jumps()
    }

    fn kinks(&self) -> &[f64] {
        self.potential.kinks()
    }

    fn alpha(&self) -> f64 {
        self.factor * self.potential.alpha()
    }

    fn growth(&self) -> (f64, f64) {
        let (c0, c1) = self.potential.growth();
        (self.factor * c0, self.factor * c1)
    }

    fn resolution(&self) -> f64 {
        self.potential.resolution()
    }

    fn is_absent(&self) -> bool {
        self.potential.is_absent()
    }
}
