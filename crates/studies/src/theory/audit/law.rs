//! j_ν⁰ of ∂j_ν, evaluated apart from the solver's law.

use exact::LawNumbers;
use scene::setup::Setup;

/// ∂j_ν without the factor c(x).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ClarkeLaw {
    law: LawNumbers,
}

impl ClarkeLaw {
    /// The law of a scene; j_ν ≡ 0 without one.
    pub(crate) fn of(setup: &Setup) -> Self {
        let contact = setup.body.contact.as_ref();
        let law = contact.and_then(|contact| contact.law.as_ref());
        let none = || LawNumbers {
            points: vec![[0.0; 2]],
            slope_before: 0.0,
            slope_after: 0.0,
            curve: None,
        };
        Self { law: law.map_or_else(none, scene::Law::numbers) }
    }

    /// ∂j_ν(r) as an interval.
    pub(crate) fn interval(&self, r: f64) -> [f64; 2] {
        let on = |p: [f64; 2], slope: f64| p[1] + slope * (r - p[0]);
        let points = &self.law.points;
        let (first, last) = (points[0], points[points.len() - 1]);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut include = |value: f64| (low, high) = (low.min(value), high.max(value));
        if r <= first[0] {
            include(on(first, self.law.slope_before));
        }
        if r >= last[0] {
            include(on(last, self.law.slope_after));
        }
        for pair in points.windows(2).filter(|pair| pair[0][0] <= r && r <= pair[1][0]) {
            if pair[0][0] == pair[1][0] {
                include(pair[0][1]);
                include(pair[1][1]);
            } else {
                include(on(pair[0], (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])));
            }
        }
        let curve = self.law.curve.map_or(0.0, |curve| curve.value(r));
        [low + curve, high + curve]
    }

    /// j_ν⁰(r; d) = max {ξ d : ξ ∈ ∂j_ν(r)} (a pressure times a length).
    pub(crate) fn directional(&self, r: f64, d: f64) -> f64 {
        let [low, high] = self.interval(r);
        if r.is_nan() { f64::NAN } else { (low * d).max(high * d) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jump() -> ClarkeLaw {
        let points = vec![[0.0, 0.0], [0.1, 0.2], [0.1, 0.5], [0.3, 0.4]];
        let law = LawNumbers { points, slope_before: 0.0, slope_after: -0.3, curve: None };
        ClarkeLaw { law }
    }

    #[test]
    fn the_directional_derivative_takes_the_larger_end_of_a_jump() {
        let law = jump();
        let [low, high] = law.interval(0.1);
        assert!((low - 0.2).abs() < 1e-15 && (high - 0.5).abs() < 1e-15);
        assert!((law.directional(0.1, 2.0) - 1.0).abs() < 1e-15);
        assert!((law.directional(0.1, -2.0) + 0.4).abs() < 1e-15);
        assert!((law.directional(0.2, 1.0) - 0.45).abs() < 1e-15);
        assert!((law.directional(0.5, 1.0) - 0.34).abs() < 1e-15);
        assert!(law.directional(f64::NAN, 1.0).is_nan());
    }
}
