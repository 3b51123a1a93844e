//! Mixtures of normal distributions of an order.

use std::sync::LazyLock;

use rustc_hash::FxHashMap;
use statrs::function::erf::erf;

#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    /// Posterior weight, unnormalised.
    pub(super) weight: f64,
    pub(super) mean: f64,
    pub(super) deviation: f64,
    /// It has a floor, or drops fine levels.
    pub(super) floored: bool,
    pub(super) coarse: usize,
}

#[derive(Debug, Clone)]
pub(super) struct Mixture {
    /// Sum of all weights, 0 without parts.
    pub(super) weight: f64,
    /// Share, mean, standard deviation.
    parts: Vec<[f64; 3]>,
}

/// Parts with deviations within this ratio and means within this share of a deviation merge: no probability changes by
/// 2e-3.
const RATIO: f64 = 1.3;
const SHARE: f64 = 0.2;

/// Tail cut-off in standard deviations.
const FAR: f64 = 6.0;
/// Accuracy of quantiles: a tenth of what is printed.
const QUANTILE: f64 = 1e-5;

static WIDTHS: LazyLock<Vec<f64>> =
    LazyLock::new(|| (NARROWEST..NARROWEST + 96).map(|size| SHARE * RATIO.powi(size)).collect());
const NARROWEST: i32 = -76;

/// Cell of a part by its deviation and its mean in units of the cell width.
fn cell(part: &Part) -> u64 {
    let size = ((part.deviation.ln() / RATIO.ln()).floor() as i32 - NARROWEST).max(0);
    let at = (size as usize).min(WIDTHS.len() - 1);
    let place = (part.mean / WIDTHS[at]).floor() as i32;
    (at as u64) << 32 | u64::from(place.cast_unsigned() ^ 1 << 31)
}

impl Mixture {
    /// Mixture of the parts that `serve`, close ones merged.
    pub(super) fn of(parts: &[Part], serves: impl Fn(&Part) -> bool) -> Self {
        let mut weight = 0.0;
        let mut cells: FxHashMap<u64, [f64; 3]> = FxHashMap::default();
        for part in parts.iter().filter(|part| serves(part)) {
            weight += part.weight;
            let sums = cells.entry(cell(part)).or_default();
            sums[0] += part.weight;
            sums[1] += part.weight * part.mean;
            sums[2] += part.weight * part.deviation;
        }
        // Sorted for a fixed order of summation.
        let mut cells: Vec<_> = cells.into_iter().collect();
        cells.sort_unstable_by_key(|(cell, _)| *cell);
        let parts = cells.into_iter();
        Self { weight, parts: parts.map(|(_, [w, m, d])| [w / weight, m / w, d / w]).collect() }
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

    /// Probability of at most p; 0 without parts.
    pub(super) fn below(&self, p: f64) -> f64 {
        self.at(p)[0]
    }

    /// Probability of at most p, and the density there to four digits.
    fn at(&self, p: f64) -> [f64; 2] {
        let table = &*NORMAL;
        self.parts.iter().fold([0.0; 2], |[below, density], [share, mean, deviation]| {
            let scale = 1.0 / deviation;
            let [all, here] = normal(table, (p - mean) * scale);
            [below + share * all, density + share * here * scale]
        })
    }

    pub(super) fn quantile(&self, probability: f64) -> f64 {
        let reach = |sign: f64| self.parts.iter().map(move |[_, m, d]| m + sign * 8.0 * d);
        let mut lo = reach(-1.0).fold(f64::INFINITY, f64::min);
        let mut hi = reach(1.0).fold(f64::NEG_INFINITY, f64::max);
        let mut p = 0.5 * (lo + hi);
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

/// Φ and its density φ at multiples of 1/64.
static NORMAL: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let last = (2.0 * FAR * PER_UNIT) as usize;
    let at = |i: usize| {
        let t = i as f64 / PER_UNIT - FAR;
        let density = (-0.5 * t * t).exp() / std::f64::consts::TAU.sqrt();
        [0.5 * (1.0 + erf(t / std::f64::consts::SQRT_2)), density]
    };
    (0..=last + 1).map(at).collect()
});
const PER_UNIT: f64 = 64.0;

/// Φ(t), cut off at six standard deviations, by Hermite's cubic in the table: error at most 64^−4 / 384 of the fourth
/// derivative, 2e-10. φ is linear in it: error 3e-5.
fn normal(table: &[[f64; 2]], t: f64) -> [f64; 2] {
    if t.is_nan() || t.abs() >= FAR {
        return [if t > 0.0 { 1.0 } else { 0.0 }, 0.0];
    }
    let place = (t + FAR) * PER_UNIT;
    let at = place as usize;
    let s = place - at as f64;
    let ([a, slope_a], [b, slope_b]) = (table[at], table[at + 1]);
    let (width, rest) = (1.0 / PER_UNIT, 1.0 - s);
    let chord = a + s * s * (3.0 - 2.0 * s) * (b - a);
    let bend = s * rest * width * (rest * slope_a - s * slope_b);
    [chord + bend, slope_a + s * (slope_b - slope_a)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(weight: f64, mean: f64, deviation: f64) -> Part {
        Part { weight, mean, deviation, floored: mean > 1.5, coarse: 0 }
    }

    #[test]
    fn the_table_is_the_normal_distribution_between_its_nodes() {
        for i in -700..700 {
            let t = 0.009 * f64::from(i);
            let exact = 0.5 * (1.0 + erf(t / std::f64::consts::SQRT_2));
            let [all, density] = normal(&NORMAL, t);
            // Error of the cubic, and 1e-9 beyond six deviations.
            assert!((all - exact).abs() < 1.2e-9, "{t}: {all} {exact}");
            let slope = (-0.5 * t * t).exp() / std::f64::consts::TAU.sqrt();
            assert!((density - slope).abs() < 4e-5, "{t}: {density} {slope}");
        }
        assert_eq!(normal(&NORMAL, f64::NAN)[1], 0.0);
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
