//! The function of Mittag-Leffler where it increases.

use statrs::function::gamma::ln_gamma;

/// E_α(x) = Σ_i x^i/Γ(αi + 1), x ≥ 0, 0 < α ≤ 1: the solution of y(t) = 1 + (1/Γ(α)) ∫_0^t (t - s)^{α-1} y(s) ds is E_α(t^α), and
/// E_1 = exp. All terms are positive; ∞ where it is beyond the doubles.
pub(super) fn mittag_leffler(alpha: f64, x: f64) -> f64 {
    if x == 0.0 {
        return 1.0;
    }
    let log = x.ln();
    // Terms rise up to αi ≈ x^{1/α}, and E is about e to that power over α.
    let peak = (log / alpha).exp();
    if peak.is_nan() || peak > f64::MAX.ln() {
        return f64::INFINITY;
    }
    let mut sum = 0.0;
    for i in 0u32.. {
        let place = alpha * f64::from(i);
        let term = (f64::from(i) * log - ln_gamma(place + 1.0)).exp();
        sum += term;
        if place > peak && term <= f64::EPSILON * f64::EPSILON * sum {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::mittag_leffler;

    /// E_1(x) = e^x; E_{1/2}(x) = e^{x²} erfc(-x), by tables of erfc.
    #[test]
    fn known_values_are_met() {
        for x in [0.0, 0.1, 1.0, 10.0, 300.0] {
            let off = mittag_leffler(1.0, x) / f64::exp(x) - 1.0;
            // Logarithms of terms as large as 300 · 6 lose three digits.
            assert!(off.abs() < 1e-11, "{x}: {off:e}");
        }
        // erfc(-1/2) = 1.520499877813046537…, erfc(-1) = 1.842700792949714869…, erfc(-2) = 1.995322265018952734….
        for (x, erfc) in [
            (0.5, 1.520_499_877_813_046_5),
            (1.0, 1.842_700_792_949_715),
            (2.0, 1.995_322_265_018_952_7),
        ] {
            let off = mittag_leffler(0.5, x) / (f64::exp(x * x) * erfc) - 1.0;
            assert!(off.abs() < 1e-12, "{x}: {off:e}");
        }
        assert!(mittag_leffler(0.3, 10.0).is_infinite());
    }
}
