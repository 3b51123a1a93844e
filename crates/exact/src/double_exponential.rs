//! Double exponential quadrature: ∫_a^b f by the trapezoidal rule after s = ½(a+b) + ½(b-a) tanh(π/2 sinh x). H.
//! Takahasi, M. Mori, Publ. RIMS 9 (1974) 721-741.
//!
//! Powers (s-a)^p, (b-s)^p with p > -1 at the ends cost no accuracy, so that weakly singular kernels and displacements
//! t^a are integrated to rounding.

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
            // Distance to the nearer end as a share of b-a, without cancellation.
            let share = 1.0 / (1.0 + stretched.abs().exp());
            let place = if i <= 0 { a + (b - a) * share } else { b - (b - a) * share };
            let density = std::f64::consts::PI * x.cosh() * share * (1.0 - share);
            (place, (b - a) * STEP * density)
        })
        .collect()
}

/// Places and weights of ∫_a^b (t-s)^{-p} f(s) ds, 0 ≤ p < 1, b ≤ t.
///
/// For b = t the substitution s = t - r^{1/(1-p)} is used: near s = t, where t - s is rounding, the rule is then spaced
/// in that power, and only f remains to be integrated.
pub(crate) fn against_power(p: f64, t: f64, a: f64, b: f64) -> Vec<(f64, f64)> {
    if p == 0.0 {
        return double_exponential(a, b);
    }
    if b < t {
        let weighed = |(s, weight): (f64, f64)| (s, weight * (t - s).powf(-p));
        return double_exponential(a, b).into_iter().map(weighed).collect();
    }
    let stretch = 1.0 / (1.0 - p);
    let whole = double_exponential(0.0, (t - a).powf(1.0 - p));
    whole.into_iter().map(|(r, weight)| ((t - r.powf(stretch)).max(a), stretch * weight)).collect()
}

#[cfg(test)]
mod tests {
    use super::{against_power, double_exponential};

    /// ∫_0^t (t-s)^{-p} s^{q} ds = B(1-p, 1+q) t^{1-p+q}, in one panel and in four.
    #[test]
    fn powers_at_both_ends_are_integrated_to_rounding() {
        let t = 0.8f64;
        for p in [0.1, 0.5, 0.7, 0.9] {
            // B(1-p, 1) = 1/(1-p), B(1-p, 2) = 1/((1-p)(2-p)), B(1-p, 1+p) = πp/sin πp.
            let pi = std::f64::consts::PI;
            let one = 1.0 - p;
            let exact =
                [(0.0, 1.0 / one), (1.0, 1.0 / (one * (2.0 - p))), (p, pi * p / (pi * p).sin())];
            for (q, beta) in exact {
                for panels in [1, 4] {
                    let cut = |i: usize| t * i as f64 / panels as f64;
                    let rule = (0..panels).flat_map(|i| against_power(p, t, cut(i), cut(i + 1)));
                    let found: f64 = rule.map(|(s, weight)| weight * s.powf(q)).sum();
                    let off = found / (beta * t.powf(one + q)) - 1.0;
                    assert!(off.abs() < 10.0 * EXACT, "{p} {q} {panels}: {off:e}");
                }
            }
        }
        // Without the substitution the ends of the plain rule are rounding of t - s.
        let plain: f64 =
            double_exponential(0.0, t).iter().map(|(s, w)| w * (t - s).powf(-0.5)).sum();
        let off = plain / (2.0 * t.sqrt()) - 1.0;
        assert!(off.is_nan() || off.abs() > 1e-10, "{off:e}");
    }

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
