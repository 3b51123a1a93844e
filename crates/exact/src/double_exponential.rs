//! Double exponential quadrature: ∫_a^b f by the trapezoidal rule after s = ½(a+b) + ½(b-a) tanh(π/2 sinh x).
//! Source: H. Takahasi, M. Mori, Publ. RIMS 9 (1974) 721-741.
//!
//! Powers (s-a)^p, (b-s)^p with p > -1 at the ends cost no accuracy, so that weakly singular kernels
//! and displacements t^a are integrated to rounding.

/// Nodes x = ±i·STEP.
const STEP: f64 = 1.0 / 16.0;
/// Beyond i = 52, x = 3.25, the weights are below the rounding of their sum.
const REACH: i32 = 52;

/// Places and weights of ∫_a^b, in increasing order of place.
pub(crate) fn double_exponential(a: f64, b: f64) -> Vec<(f64, f64)> {
    (-REACH..=REACH)
        .map(|i| {
            let x = f64::from(i) * STEP;
            let stretched = std::f64::consts::PI * x.sinh();
            // The share of b-a between the place and the nearer end, without cancellation.
            let share = 1.0 / (1.0 + stretched.abs().exp());
            let place = if i <= 0 { a + (b - a) * share } else { b - (b - a) * share };
            let density = std::f64::consts::PI * x.cosh() * share * (1.0 - share);
            (place, (b - a) * STEP * density)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::double_exponential;

    /// Rounding of 105 terms, and of places near an end at distance 1e-16.
    const EXACT: f64 = 1e-14;

    #[test]
    fn smooth_and_weakly_singular_integrands() {
        let integral = |a: f64, b: f64, f: &dyn Fn(f64) -> f64| -> f64 {
            double_exponential(a, b).iter().map(|&(s, weight)| weight * f(s)).sum()
        };
        let exponential = integral(0.0, 2.0, &f64::exp);
        assert!((exponential - 2f64.exp_m1()).abs() < 10.0 * EXACT, "{exponential}");
        for power in [0.3, 0.5, 0.9] {
            let left = integral(0.0, 1.5, &|s| s.powf(power));
            let right = integral(0.0, 1.5, &|s| (1.5 - s).powf(power));
            let exact = 1.5f64.powf(power + 1.0) / (power + 1.0);
            assert!((left - exact).abs() < EXACT && (right - exact).abs() < EXACT, "{power}");
        }
    }

    /// The rule with half the nodes is not exact: the test above can fail.
    #[test]
    fn fewer_nodes_are_seen() {
        let rule = double_exponential(0.0, 2.0);
        let coarse: f64 = rule.iter().step_by(8).map(|&(s, w)| 8.0 * w * s.exp()).sum();
        assert!((coarse - 2f64.exp_m1()).abs() > 1e-6, "{coarse}");
    }
}
