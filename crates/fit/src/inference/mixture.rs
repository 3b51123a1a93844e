//! Mixtures of normal distributions of an order.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};
use std::sync::LazyLock;

use statrs::function::erf::{erfc, erfc_inv};

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Part {
    /// Posterior weight, unnormalised.
    pub(super) weight: f64,
    pub(super) mean: f64,
    pub(super) deviation: f64,
    /// It has a floor or an unstated reference, or drops fine levels.
    pub(super) floored: bool,
    /// It stands at an end of a list of the prior.
    pub(super) outside: bool,
    pub(super) coarse: usize,
    /// The next term changes the sign.
    pub(super) crossing: bool,
    /// The floor scatters.
    pub(super) scattered: bool,
}

#[derive(Debug, Clone)]
pub(super) struct Mixture {
    /// Sum of all weights, 0 without parts.
    pub(super) weight: f64,
    /// Share, mean, standard deviation.
    parts: Vec<[f64; 3]>,
}

/// Parts with deviations within this ratio and means within this share of a deviation become one of the same mean and
/// variance: no probability changes by 1e-3.
const RATIO: f64 = 1.5;
const SHARE: f64 = 0.4;
/// What rounding leaves of a variance.
const LEAST_VARIANCE: f64 = 1e-14;
/// Means closer than a fifth of what is printed are one.
const LEAST_WIDTH: f64 = 0.002;

/// The least parts are dropped, as long as they hold no more together.
const NEGLIGIBLE: f64 = 3e-4;

/// Accuracy of quantiles: a tenth of what is printed.
const QUANTILE: f64 = 1e-5;

/// Upper ends of the cells of deviations, and the widths of their cells of means.
static CELLS: LazyLock<[[f64; 2]; 64]> = LazyLock::new(|| {
    let first = (LEAST_WIDTH.ln() / RATIO.ln()).floor();
    let from = |i: usize| RATIO.powf(first + i as f64);
    std::array::from_fn(|i| [from(i + 1), (SHARE * from(i)).max(LEAST_WIDTH)])
});

/// Cell of a part by its deviation, and by its mean in units of the cell width.
fn cell(part: &Part) -> (u8, i32) {
    let size = CELLS.partition_point(|[end, _]| *end <= part.deviation).min(CELLS.len() - 1);
    (size as u8, (part.mean / CELLS[size][1]).floor() as i32)
}

impl Mixture {
    /// Mixture of the parts that `serve`, close ones merged.
    pub(super) fn of(parts: &[Part], serves: impl Fn(&Part) -> bool) -> Self {
        let mut serving: Vec<_> =
            parts.iter().filter(|part| serves(part)).map(|part| (cell(part), part)).collect();
        serving.sort_by_key(|(cell, _)| *cell);
        let weight = serving.iter().map(|(_, part)| part.weight).sum();
        let merged = |cell: &[((u8, i32), &Part)]| {
            let sum = |of: fn(&Part) -> f64| cell.iter().map(|(_, part)| of(part)).sum::<f64>();
            let weight = sum(|part| part.weight);
            let mean = sum(|part| part.weight * part.mean) / weight;
            let second = sum(|part| part.weight * (part.mean.powi(2) + part.deviation.powi(2)));
            [weight, mean, (second / weight - mean * mean).max(LEAST_VARIANCE).sqrt()]
        };
        let mut parts: Vec<[f64; 3]> =
            serving.chunk_by(|(a, _), (b, _)| a == b).map(merged).collect();
        parts.sort_by(|a, b| b[0].total_cmp(&a[0]));
        let mut left = weight;
        while let Some([least, ..]) =
            parts.last().filter(|[w, ..]| left - w > (1.0 - NEGLIGIBLE) * weight)
        {
            left -= least;
            parts.pop();
        }
        parts.iter_mut().for_each(|part| part[0] /= left);
        Self { weight, parts }
    }

    /// From (share, mean, deviation); shares sum to one.
    pub(super) fn from_parts(parts: Vec<[f64; 3]>) -> Self {
        Self { weight: parts.iter().map(|[share, ..]| share).sum(), parts }
    }

    pub(super) fn union(&self, other: &Self) -> Self {
        let weight = self.weight + other.weight;
        let share = |of: &Self| {
            let share = of.weight / weight;
            of.parts.iter().map(|[w, m, d]| [w * share, *m, *d]).collect::<Vec<_>>()
        };
        Self { weight, parts: [share(self), share(other)].concat() }
    }

    /// The same, so many times as likely beside others.
    pub(super) fn times(self, by: f64) -> Self {
        Self { weight: by * self.weight, ..self }
    }

    /// Probability of at most p; 0 without parts.
    pub(super) fn below(&self, p: f64) -> f64 {
        self.at(p)[0]
    }

    /// Probability of at most p, and the density there.
    fn at(&self, p: f64) -> [f64; 2] {
        self.parts.iter().fold([0.0; 2], |[below, density], [share, mean, deviation]| {
            let t = (p - mean) / deviation;
            // Beyond, less than 1e-9 is left.
            if t.abs() > 6.0 {
                return [below + if t > 0.0 { *share } else { 0.0 }, density];
            }
            let here = (-0.5 * t * t).exp() / (std::f64::consts::TAU.sqrt() * deviation);
            [below + share * 0.5 * erfc(-t * FRAC_1_SQRT_2), density + share * here]
        })
    }

    pub(super) fn quantile(&self, probability: f64) -> f64 {
        let reach = |sign: f64| self.parts.iter().map(move |[_, m, d]| m + sign * 8.0 * d);
        let mut lo = reach(-1.0).fold(f64::INFINITY, f64::min);
        let mut hi = reach(1.0).fold(f64::NEG_INFINITY, f64::max);
        // From the same quantile of a normal distribution of this mean and variance.
        let mean: f64 = self.parts.iter().map(|[w, m, _]| w * m).sum();
        let variance: f64 =
            self.parts.iter().map(|[w, m, d]| w * ((m - mean).powi(2) + d * d)).sum();
        let normal = -SQRT_2 * erfc_inv(2.0 * probability);
        let mut p = (mean + normal * variance.sqrt()).clamp(lo, hi);
        // Newton's steps if they stay in the bracket and halve it, else bisection.
        let mut last = hi - lo;
        while hi - lo > QUANTILE {
            let [below, density] = self.at(p);
            let away = below - probability;
            match away < 0.0 {
                true => lo = p,
                false => hi = p,
            }
            let step = away / density;
            if step.abs() < 0.1 * QUANTILE {
                return p - step;
            }
            let newton = p - step;
            let serves = newton > lo && newton < hi && step.abs() < 0.5 * last;
            last = if serves { step.abs() } else { hi - lo };
            p = if serves { newton } else { 0.5 * (lo + hi) };
        }
        0.5 * (lo + hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(weight: f64, mean: f64, deviation: f64) -> Part {
        Part { weight, mean, deviation, floored: mean > 1.5, ..Part::default() }
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
