//! Gauss-Legendre quadrature on the unit interval.

use std::sync::LazyLock;

/// Points of the rule; exact for polynomials of degree 23.
pub(super) const ORDER: usize = 12;

/// Abscissae in (0, 1), ascending, and weights that sum to one.
pub(super) struct Rule {
    pub(super) abscissae: [f64; ORDER],
    pub(super) weights: [f64; ORDER],
}

/// The rule, computed once.
pub(super) static GAUSS: LazyLock<Rule> = LazyLock::new(Rule::legendre);

impl Rule {
    /// The roots of the Legendre polynomial P_n by Newton's method, with the
    /// weights 2 / ((1 - r^2) P_n'(r)^2), moved from (-1, 1) to (0, 1).
    fn legendre() -> Self {
        let n = ORDER as f64;
        let mut rule = Self { abscissae: [0.0; ORDER], weights: [0.0; ORDER] };
        for k in 0..ORDER {
            let angle = std::f64::consts::PI * (ORDER as f64 - k as f64 - 0.25) / (n + 0.5);
            let mut r = angle.cos();
            // Quadratic convergence from a start good to three digits.
            for _ in 0..8 {
                let (value, slope) = legendre(r);
                r -= value / slope;
            }
            let (_, slope) = legendre(r);
            rule.abscissae[k] = 0.5 * (1.0 + r);
            rule.weights[k] = 1.0 / ((1.0 - r * r) * slope * slope);
        }
        rule
    }
}

/// P_n and its derivative by the three-term recurrence.
fn legendre(r: f64) -> (f64, f64) {
    let (mut last, mut value) = (1.0, r);
    for k in 2..=ORDER {
        let k = k as f64;
        (last, value) = (value, ((2.0 * k - 1.0) * r * value - (k - 1.0) * last) / k);
    }
    let slope = ORDER as f64 * (r * value - last) / (r * r - 1.0);
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::GAUSS;

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
