//! A law times a positive number: a law with a factor c(x), at one place.

use std::sync::Arc;

use super::Potential;

/// c ∂j_ν. (2.8b) and (2.8c) are linear in ∂j_ν, so c0, c1 and α_ν scale with c; over Γ3 the constants of the problem
/// take the largest c.
pub struct Scaled {
    pub potential: Arc<dyn Potential>,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Curve, Curved, NoPotential, PiecewiseLinear};

    /// 2.5 times a law with the slope 2, a jump at 0.1, the slope -2 and a power: values and constants scale, places
    /// and lengths do not.
    #[test]
    fn values_are_multiplied_and_places_are_not() {
        let points = vec![(0.0, 0.0), (0.1, 0.2), (0.1, 0.5)];
        let graph = PiecewiseLinear::new(points, 2.0, -2.0).unwrap();
        let curve = Curve::Power { coefficient: 4.0, exponent: 2.5, until: 0.6 };
        let unscaled = Arc::new(Curved::new(graph, curve));
        let law = Scaled { potential: unscaled.clone(), factor: 2.5 };
        let times = |(a, b): (f64, f64)| (2.5 * a, 2.5 * b);
        for r in [-0.3, 0.05, 0.1, 0.3, 0.9] {
            assert_eq!(law.subdifferential(r), times(unscaled.subdifferential(r)), "{r}");
            assert_eq!(law.value_and_slope(r), times(unscaled.value_and_slope(r)), "{r}");
        }
        let (lo, hi) = law.subdifferential(0.1);
        assert!((hi - lo - 2.5 * 0.3).abs() < 1e-15, "the jump is 0.5 - 0.2");
        assert_eq!((law.jumps(), law.kinks()), (&[0.1][..], &[0.0, 0.1, 0.6][..]));
        assert_eq!((law.alpha(), law.growth()), (2.5 * unscaled.alpha(), times(unscaled.growth())));
        assert!(law.alpha() > 0.0 && law.growth().0 > 0.0 && law.growth().1 > 0.0);
        assert_eq!(law.resolution(), 0.6);
        assert!(!law.is_absent());
        assert!(Scaled { potential: Arc::new(NoPotential), factor: 2.5 }.is_absent());
    }
}
