//! Limit, order and grid convergence index from three values of a functional.

/// A step and the value that was computed with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValueSample {
    pub step: f64,
    /// The functional, of any sign.
    pub value: f64,
}

/// Safety factor of the index for three or more grids (Roache 1998, §5.7).
const SAFETY: f64 = 1.25;

/// Differences below so many units in the last place are rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Orders are sought up to ± this: beyond, r^p has no digits to compare even for r = 1.3.
const LARGEST_ORDER: f64 = 50.0;

/// Smaller orders are zero up to rounding, as for a logarithm, which has no limit.
const SMALLEST_ORDER: f64 = 1e-6;

/// Three values φ₃, φ₂, φ₁ on steps h₃ > h₂ > h₁ under φᵢ = φ₀ + α hᵢ^p.
///
/// p solves (φ₂ − φ₁)/(φ₃ − φ₂) = (h₂^p − h₁^p)/(h₃^p − h₂^p), the equation behind the fixed-point iteration of Celik
/// et al. (J. Fluids Eng. 130, 2008, 078001). The right side falls in p, so bisection converges for any ratios. The
/// sign of p is kept: with the absolute value of the printed iteration, divergence reads as convergence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Triple {
    Converging {
        order: f64,
        limit: f64,
        /// Grid convergence index on the finest grid, in units of the value: 1.25 |φ₁ − φ₂| / (r^p − 1) with r = h₂/h₁
        /// (Roache, J. Fluids Eng. 116, 1994, 405).
        gci: f64,
    },
    /// Differences of alternating sign: no order, no limit.
    Oscillating {
        /// Half of the range of the three values (Stern et al., J. Fluids Eng. 123, 2001, 793).
        half_range: f64,
    },
    /// Differences of one sign that do not fall: p ≤ 0 up to rounding.
    Diverging {
        /// −∞ if the first difference is zero.
        order: f64,
    },
    /// The last difference is rounding.
    Stationary,
}

impl Triple {
    /// Reads three values in direction of refinement, steps strictly falling.
    pub fn of([coarse, middle, fine]: [ValueSample; 3]) -> Self {
        let values = [coarse.value, middle.value, fine.value];
        let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let (first, last) = (coarse.value - middle.value, middle.value - fine.value);
        if last.abs() <= ROUNDING * largest {
            return Self::Stationary;
        }
        if first.abs() <= ROUNDING * largest {
            return Self::Diverging { order: f64::NEG_INFINITY };
        }
        let ratio = last / first;
        if ratio < 0.0 {
            let hi = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let lo = values.into_iter().fold(f64::INFINITY, f64::min);
            return Self::Oscillating { half_range: 0.5 * (hi - lo) };
        }
        let refinements = [(coarse.step / middle.step).ln(), (middle.step / fine.step).ln()];
        let order = order(ratio, refinements);
        if order <= SMALLEST_ORDER {
            return Self::Diverging { order };
        }
        let correction = -last / (order * refinements[1]).exp_m1();
        let limit = fine.value + correction;
        Self::Converging { order, limit, gci: SAFETY * correction.abs() }
    }

    /// The order, where there is one.
    pub fn order(self) -> Option<f64> {
        match self {
            Self::Converging { order, .. } | Self::Diverging { order } => Some(order),
            Self::Oscillating { .. } | Self::Stationary => None,
        }
        .filter(|order| order.is_finite())
    }
}

/// The p at which (1 − r^{−p})/(s^p − 1) equals the ratio of differences; arguments are log s (coarse) and log r
/// (fine).
fn order(ratio: f64, [coarse, fine]: [f64; 2]) -> f64 {
    let model = |p: f64| {
        if p == 0.0 { fine / coarse } else { -(-p * fine).exp_m1() / (p * coarse).exp_m1() }
    };
    let (mut lo, mut hi) = (-LARGEST_ORDER, LARGEST_ORDER);
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if model(middle) > ratio {
            lo = middle;
        } else {
            hi = middle;
        }
    }
    0.5 * (lo + hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triple(steps: [f64; 3], value: impl Fn(f64) -> f64) -> Triple {
        Triple::of(steps.map(|step| ValueSample { step, value: value(step) }))
    }

    #[test]
    fn rounding_is_relative_to_the_values() {
        let at = |step: f64, value: f64| ValueSample { step, value };
        let triple = Triple::of([at(0.4, 1e6 + 1e-9), at(0.2, 1e6), at(0.1, 1e6 - 1.0)]);
        assert_eq!(triple, Triple::Diverging { order: f64::NEG_INFINITY });
        assert_eq!(triple.order(), None);
        // The same difference counts for small values.
        let triple = Triple::of([at(0.4, 1.5e-9), at(0.2, 5e-10), at(0.1, 0.0)]);
        assert!((triple.order().expect("an order") - 1.0).abs() < 1e-12);
    }

    #[test]
    fn limits_and_orders_are_found_for_any_ratios() {
        for steps in [[0.4, 0.2, 0.1], [0.4, 0.3, 0.1], [0.13, 0.1, 0.05], [3.0, 2.0, 1.9]] {
            for true_order in [0.3, 1.0, 2.0, 3.5] {
                for factor in [2.0, -2.0] {
                    let found = triple(steps, |h| 5.0 + factor * h.powf(true_order));
                    let Triple::Converging { order, limit, gci } = found else {
                        panic!("{steps:?} {found:?}")
                    };
                    // Digits lost in φ₂ − φ₁: values of size 5, differences down to 1e-3.
                    assert!((order - true_order).abs() < 1e-10, "{steps:?} {order}");
                    assert!((limit - 5.0).abs() < 1e-9, "{steps:?} {limit}");
                    let error = factor.abs() * steps[2].powf(true_order);
                    assert!((gci / (1.25 * error) - 1.0).abs() < 1e-7, "{steps:?} {gci}");
                }
            }
        }
    }

    /// φ = 1.9, 1.7, 1.6 on halved steps, by hand: differences 0.2, 0.1, order 1, limit 1.5, index 1.25 · 0.1.
    #[test]
    fn a_triple_by_hand() {
        let values = [(0.4, 1.9), (0.2, 1.7), (0.1, 1.6)];
        let found = Triple::of(values.map(|(step, value)| ValueSample { step, value }));
        let Triple::Converging { order, limit, gci } = found else { panic!("{found:?}") };
        // Differences of numbers of size 2 with 16 digits.
        assert!((order - 1.0).abs() < 1e-14 && (limit - 1.5).abs() < 1e-14);
        assert!((gci - 0.125).abs() < 1e-14);
        assert_eq!(found.order(), Some(order));
    }

    #[test]
    fn divergence_keeps_its_sign() {
        for true_order in [-2.0, -0.5] {
            let found = triple([0.4, 0.3, 0.1], |h: f64| 7.0 - h.powf(true_order));
            let Triple::Diverging { order } = found else { panic!("{found:?}") };
            assert!((order - true_order).abs() < 1e-10);
            assert_eq!(found.order(), Some(order));
        }
        // log h: order zero, no limit.
        let logarithm = triple([0.4, 0.3, 0.1], |h: f64| h.ln());
        assert!(matches!(logarithm, Triple::Diverging { order } if order.abs() < 1e-10));
        let jump = triple([0.4, 0.2, 0.1], |h| if h < 0.15 { 1.0 } else { 0.0 });
        assert_eq!(jump, Triple::Diverging { order: f64::NEG_INFINITY });
        assert_eq!(jump.order(), None);
    }

    /// Steps in the ratio 1.0003, as in a table of ten thousand: the limit is many differences away.
    #[test]
    fn close_steps_converge_as_well() {
        let found = triple([0.1, 0.1 / 1.0003, 0.1 / 1.0006], |h| 2.0 + h);
        // Nine digits are lost in the second differences, seven are left.
        assert!(
            matches!(found, Triple::Converging { order, limit, .. }
            if (order - 1.0).abs() < 1e-4 && (limit - 2.0).abs() < 1e-4),
            "{found:?}"
        );
    }

    #[test]
    fn oscillation_has_a_range_and_no_order() {
        let values = [(0.4, 1.0), (0.2, -0.5), (0.1, 0.25)];
        let found = Triple::of(values.map(|(step, value)| ValueSample { step, value }));
        assert_eq!(found, Triple::Oscillating { half_range: 0.75 });
        assert_eq!(found.order(), None);
    }

    #[test]
    fn a_value_that_stands_still_is_stationary() {
        assert_eq!(triple([0.4, 0.2, 0.1], |_| 3.0), Triple::Stationary);
        assert_eq!(triple([0.4, 0.2, 0.1], |_| 0.0), Triple::Stationary);
        assert_eq!(triple([0.4, 0.2, 0.1], |h| 3.0 + 1e-14 * h), Triple::Stationary);
        let moving = triple([0.4, 0.2, 0.1], |h| 3.0 + 1e-9 * h);
        assert!(matches!(moving, Triple::Converging { .. }), "{moving:?}");
        assert_eq!(Triple::Stationary.order(), None);
    }
}
