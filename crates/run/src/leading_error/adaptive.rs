//! Reference integrals for discrete sums, by Gauss rules of two orders on bisected pieces: as accurate as the
//! comparison requires, and independent of the quadratures of the exact solution.

use fem::space::quadrature::gauss_legendre;

/// Points of the rule, and of the weaker one for its error.
const POINTS: [usize; 2] = [10, 6];
/// Allowed error as a share of the difference from the discrete sum: predictions are compared at 1e-2 and 1e-3.
const SHARE: f64 = 1e-5;
/// Rounding of a hundred terms.
const ROUNDING: f64 = 1e-14;
/// Rounds of halving, and the limit of pieces halved.
const ROUNDS: usize = 60;
const MOST: usize = 256;
/// Approximate limit of numbers held at once.
const HELD: usize = 1 << 17;

/// Initial pieces of [0, t].
const PIECES: usize = 8;

/// Cuts of [0, t]: uniform ones, and the `places` where f has a kink, since a kink near the end of a piece is beyond
/// the last points of both rules.
pub(super) fn cuts(t: f64, places: &[f64]) -> Vec<f64> {
    let mut cuts: Vec<f64> = (0..=PIECES).map(|i| t * i as f64 / PIECES as f64).collect();
    cuts.extend(places.iter().copied().filter(|&place| place > 0.0 && place < t));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}

/// ∫_0^t (t-s)^{-a} f(s) ds, 0 ≤ a < 1, of vectors, with cuts of [0, t]: in r = (t-s)^{1-a}, where the kernel is
/// constant.
pub(super) fn integral_against(
    a: f64,
    cuts: &[f64],
    discrete: &[f64],
    mut f: impl FnMut(&[f64]) -> Vec<Vec<f64>>,
) -> Vec<f64> {
    let t = cuts.last().copied().unwrap_or(0.0);
    if a == 0.0 {
        return integral(cuts, discrete, f);
    }
    let in_r: Vec<f64> = cuts.iter().rev().map(|s| (t - s).powf(1.0 - a)).collect();
    integral(&in_r, discrete, |places| {
        let stretch = 1.0 / (1.0 - a);
        let times: Vec<f64> = places.iter().map(|r| (t - r.powf(stretch)).max(0.0)).collect();
        let mut values = f(&times);
        values.iter_mut().flatten().for_each(|value| *value *= stretch);
        values
    })
}

/// ∫ f between the first and the last cut, as vectors; `f` gives one for each time of a list. `discrete` is the sum
/// that the integral is compared with.
pub(super) fn integral(
    cuts: &[f64],
    discrete: &[f64],
    mut f: impl FnMut(&[f64]) -> Vec<Vec<f64>>,
) -> Vec<f64> {
    let rules = POINTS.map(gauss_legendre);
    let count = POINTS[0] + POINTS[1];
    let mut pending: Vec<[f64; 2]> = cuts.windows(2).map(|ends| [ends[0], ends[1]]).collect();
    let mut done = vec![0.0; discrete.len()];
    for round in 0.. {
        let (mut total, mut size) = (done.clone(), 0.0_f64);
        let mut found = Vec::with_capacity(pending.len());
        for pieces in pending.chunks((HELD / (count * discrete.len().max(1))).max(1)) {
            let all = || rules.iter().copied().flatten();
            let place = |[from, to]: &[f64; 2], x: f64| 0.5 * (from + to) + 0.5 * (to - from) * x;
            let times: Vec<f64> =
                pieces.iter().flat_map(|ends| all().map(move |(x, _)| place(ends, *x))).collect();
            for (ends, values) in pieces.iter().zip(f(&times).chunks(count)) {
                let (strong, weak) = values.split_at(POINTS[0]);
                let half = 0.5 * (ends[1] - ends[0]);
                let [strong_sum, weak_sum] =
                    [(strong, &rules[0]), (weak, &rules[1])].map(|(values, rule)| {
                        let mut sum = vec![0.0; discrete.len()];
                        for (value, (_, weight)) in values.iter().zip(*rule) {
                            algebra::linalg::axpy(half * weight, value, &mut sum);
                        }
                        sum
                    });
                let largest = strong.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
                size += half * largest;
                algebra::linalg::axpy(1.0, &strong_sum, &mut total);
                let error = apart(&strong_sum, &weak_sum);
                found.push((*ends, strong_sum, error));
            }
        }
        let allowed = SHARE * apart(&total, discrete) + ROUNDING * size;
        let mut next = Vec::new();
        for (ends, strong_sum, error) in found {
            let middle = 0.5 * (ends[0] + ends[1]);
            // Bisection does not help where values are not finite.
            if error > allowed && middle > ends[0] && middle < ends[1] {
                next.extend([[ends[0], middle], [middle, ends[1]]]);
            } else {
                algebra::linalg::axpy(1.0, &strong_sum, &mut done);
            }
        }
        if next.is_empty() {
            break;
        }
        if round == ROUNDS || next.len() > MOST {
            return total;
        }
        pending = next;
    }
    done
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

#[cfg(test)]
mod tests {
    use super::{cuts, integral, integral_against};

    /// Powers and kinks to the allowed share; smooth functions to rounding at once.
    #[test]
    fn integrals_are_as_good_as_the_comparison_asks_for() {
        let one = |f: &dyn Fn(f64) -> f64, discrete: f64| {
            integral(&[0.0, 1.0], &[discrete], |times| times.iter().map(|&s| vec![f(s)]).collect())
                [0]
        };
        for power in [0.1, 0.3, 0.6, 0.9] {
            let (exact, found) = (1.0 / (1.0 + power), one(&|s| s.powf(power), 0.5));
            assert!((found - exact).abs() < 1e-4 * (exact - 0.5), "{power}: {found}");
        }
        let kink = one(&|s| (s - 0.3_f64).abs(), 0.5);
        assert!((kink - 0.29).abs() < 1e-4 * 0.21, "{kink}");
        assert!((one(&f64::exp, 1.859) - 1f64.exp_m1()).abs() < 1e-14);
        assert!(one(&|_| f64::NAN, 1.0).is_nan());
    }

    /// ∫_0^t (t-s)^{-a} s^a ds = t πa/sin πa: infinite at one end, a root at the other.
    #[test]
    fn powers_at_both_ends_are_integrated() {
        let t = 0.7;
        for a in [0.3f64, 0.5, 0.9] {
            let exact = t * std::f64::consts::PI * a / (std::f64::consts::PI * a).sin();
            let f = |times: &[f64]| times.iter().map(|s| vec![s.powf(a)]).collect();
            let found = integral_against(a, &cuts(t, &[]), &[exact + 1e-3], f)[0];
            assert!((found - exact).abs() < 1e-7, "{a}: {found} {exact}");
        }
    }

    /// A kink just inside the end of a piece, where neither rule has a point, must be a cut. Kernels with a root at the
    /// other end need none.
    #[test]
    fn kinks_near_the_end_of_a_piece_are_cut_off() {
        let (steps, place) = (256, 0.361_803);
        let [mut plain, mut cut] = [0.0_f64; 2];
        for n in 8..=steps {
            let t = f64::from(n) / f64::from(steps);
            let f = |s: f64| (t - s).max(0.0).sqrt() + (s - place).abs();
            let k = 1.0 / f64::from(steps);
            let inner: f64 = (1..n).map(|j| f(f64::from(j) * k)).sum();
            let discrete = k * (inner + 0.5 * (f(0.0) + f(t)));
            let rest = (t - place) * (t - place).abs();
            let exact = t.powf(1.5) / 1.5 + 0.5 * (place * place + rest);
            let off = |places: &[f64]| {
                let values = |times: &[f64]| times.iter().map(|&s| vec![f(s)]).collect();
                let found = integral(&cuts(t, places), &[discrete], values)[0];
                (found - exact).abs() / (discrete - exact).abs()
            };
            plain = plain.max(off(&[]));
            cut = cut.max(off(&[place]));
        }
        assert!(cut < 1e-3 && plain > 1e-2, "{cut:e} {plain:e}");
    }
}
