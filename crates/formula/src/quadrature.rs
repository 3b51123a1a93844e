//! Gauss-Legendre quadrature on the unit interval.

use std::sync::LazyLock;

/// Points of the rule; exact for polynomials of degree 23.
pub(super) const ORDER: usize = 12;

/// Abscissae in (0, 1), ascending; weights sum to one.
pub(super) struct Rule {
    pub(super) abscissae: [f64; ORDER],
    pub(super) weights: [f64; ORDER],
    /// Weights of the last two Legendre coefficients.
    pub(super) last: [[f64; ORDER]; 2],
}

pub(super) static GAUSS: LazyLock<Rule> = LazyLock::new(Rule::legendre);

impl Rule {
    /// Roots of P_n by Newton's method, weights 2 / ((1 - r^2) P_n'(r)^2), mapped from (-1, 1) to (0, 1).
    fn legendre() -> Self {
        let n = ORDER as f64;
        let none = [0.0; ORDER];
        let mut rule = Self { abscissae: none, weights: none, last: [none; 2] };
        for k in 0..ORDER {
            let angle = std::f64::consts::PI * (ORDER as f64 - k as f64 - 0.25) / (n + 0.5);
            let mut r = angle.cos();
            // Quadratic convergence from a start good to three digits.
            for _ in 0..8 {
                r -= legendre(ORDER, r) / slope(r);
            }
            rule.abscissae[k] = 0.5 * (1.0 + r);
            rule.weights[k] = 1.0 / ((1.0 - r * r) * slope(r) * slope(r));
            for (weights, degree) in rule.last.iter_mut().zip(ORDER - 2..) {
                weights[k] = (2 * degree + 1) as f64 * rule.weights[k] * legendre(degree, r);
            }
        }
        rule
    }
}

/// P_n by the three-term recurrence, n > 0.
fn legendre(degree: usize, r: f64) -> f64 {
    let (mut last, mut value) = (1.0, r);
    for k in 2..=degree {
        let k = k as f64;
        (last, value) = (value, ((2.0 * k - 1.0) * r * value - (k - 1.0) * last) / k);
    }
    value
}

fn slope(r: f64) -> f64 {
    ORDER as f64 * (r * legendre(ORDER, r) - legendre(ORDER - 1, r)) / (r * r - 1.0)
}

#[cfg(test)]
mod tests {
    use super::{GAUSS, ORDER, legendre};

    /// P_10 has coefficients (1, 0), P_11 (0, 1), lower degrees (0, 0).
    #[test]
    fn last_coefficients_are_those_of_the_series() {
        for degree in 1..ORDER {
            for (k, weights) in GAUSS.last.iter().enumerate() {
                let pairs = weights.iter().zip(&GAUSS.abscissae);
                let found: f64 = pairs.map(|(w, u)| w * legendre(degree, 2.0 * u - 1.0)).sum();
                let expected = if degree == ORDER - 2 + k { 1.0 } else { 0.0 };
                // Twelve terms of up to 2.
                assert!((found - expected).abs() < 1e-14, "{degree} {k}: {found}");
            }
        }
    }

    #[test]
    fn rule_is_exact_to_degree_23() {
        for degree in 0..24 {
            let sum: f64 =
                GAUSS.abscissae.iter().zip(&GAUSS.weights).map(|(u, w)| w * u.powi(degree)).sum();
            assert!((sum * f64::from(degree + 1) - 1.0).abs() < 1e-14, "{degree}: {sum}");
        }
        let mut sum = 0.0;
        for (u, w) in GAUSS.abscissae.iter().zip(&GAUSS.weights) {
            sum += w * u.powi(24);
        }
        assert!((sum * 25.0 - 1.0).abs() > 1e-14);
    }
}
