//! Mixtures of normal distributions of an order.

use std::collections::BTreeMap;

use statrs::function::erf::erf;

/// One reading of a table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    /// Posterior weight, relative to others.
    pub(super) weight: f64,
    /// Mean and standard deviation of the order.
    pub(super) mean: f64,
    pub(super) deviation: f64,
    /// It has a floor, or leaves out fine levels.
    pub(super) floored: bool,
    /// Coarse levels that it leaves out.
    pub(super) coarse: usize,
}

/// Weighted normal distributions.
#[derive(Debug, Clone)]
pub(super) struct Mixture {
    /// Sum of all weights, 0 for none.
    pub(super) weight: f64,
    /// Share, mean, standard deviation.
    parts: Vec<[f64; 3]>,
}

/// Deviations within this ratio, and means within this share of a deviation, are one: no probability moves by 2e-3.
const RATIO: f64 = 1.3;
const SHARE: f64 = 0.2;

impl Mixture {
    /// Of the parts that `serve`; close ones are merged, so that a probability costs little.
    pub(super) fn of(parts: &[Part], serves: impl Fn(&Part) -> bool) -> Self {
        let cell = |part: &Part| {
            let size = (part.deviation.ln() / RATIO.ln()).floor();
            [size as i32, (part.mean / (SHARE * RATIO.powf(size))).floor() as i32]
        };
        let mut weight = 0.0;
        // Ordered, so that sums have one order.
        let mut cells: BTreeMap<[i32; 2], [f64; 3]> = BTreeMap::new();
        for part in parts.iter().filter(|part| serves(part)) {
            weight += part.weight;
            let sums = cells.entry(cell(part)).or_default();
            sums[0] += part.weight;
            sums[1] += part.weight * part.mean;
            sums[2] += part.weight * part.deviation;
        }
        let parts = cells.into_values();
        Self { weight, parts: parts.map(|[w, m, d]| [w / weight, m / w, d / w]).collect() }
    }

    /// All of two.
    pub(super) fn union(&self, other: &Self) -> Self {
        let weight = self.weight + other.weight;
        let share = |of: &Self| {
            let share = of.weight / weight;
            of.parts.iter().map(|[w, m, d]| [w * share, *m, *d]).collect::<Vec<_>>()
        };
        Self { weight, parts: [share(self), share(other)].concat() }
    }

    /// Probability of at most p; 0 without parts.
    pub(super) fn below(&self, p: f64) -> f64 {
        self.parts
            .iter()
            .map(|[share, mean, deviation]| share * normal((p - mean) / deviation))
            .sum()
    }

    /// The p with `probability` below it.
    pub(super) fn quantile(&self, probability: f64) -> f64 {
        let reach = |sign: f64| self.parts.iter().map(move |[_, m, d]| m + sign * 8.0 * d);
        let mut lo = reach(-1.0).fold(f64::INFINITY, f64::min);
        let mut hi = reach(1.0).fold(f64::NEG_INFINITY, f64::max);
        // To a tenth of what is printed.
        while hi - lo > 1e-5 {
            let middle = 0.5 * (lo + hi);
            if middle <= lo || middle >= hi {
                break;
            }
            match self.below(middle) < probability {
                true => lo = middle,
                false => hi = middle,
            }
        }
        0.5 * (lo + hi)
    }
}

/// Φ(t), 0 and 1 beyond six standard deviations.
fn normal(t: f64) -> f64 {
    if t.abs() > 6.0 {
        return if t > 0.0 { 1.0 } else { 0.0 };
    }
    0.5 * (1.0 + erf(t / std::f64::consts::SQRT_2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(weight: f64, mean: f64, deviation: f64) -> Part {
        Part { weight, mean, deviation, floored: mean > 1.5, coarse: 0 }
    }

    #[test]
    fn probabilities_and_quantiles_of_a_mixture() {
        let parts = [part(3.0, 1.0, 0.1), part(1.0, 2.0, 0.1)];
        let all = Mixture::of(&parts, |_| true);
        // Three quarters lie about 1, one quarter about 2; 1e-5 is the width of a quantile.
        assert!((all.below(1.5) - 0.75).abs() < 1e-6 && (all.below(1.0) - 0.375).abs() < 1e-6);
        assert!((all.quantile(0.375) - 1.0).abs() < 1e-5);
        let some = Mixture::of(&parts, |part| part.floored);
        assert!((some.weight - 1.0).abs() < 1e-15 && (some.quantile(0.5) - 2.0).abs() < 1e-5);
        // 1.959964 is the 97.5 % quantile of the normal distribution.
        assert!((some.quantile(0.975) - 2.1959964).abs() < 2e-5);
        let rest = Mixture::of(&parts, |part| !part.floored);
        for p in [0.9, 1.5, 2.05] {
            assert!((rest.union(&some).below(p) - all.below(p)).abs() < 1e-15);
        }
        assert_eq!(Mixture::of(&[], |_| true).below(1.0), 0.0);
    }
}
