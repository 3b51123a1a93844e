//! The recurrences against their definitions, the closed forms, and the counter-example to the lemma
//! without its hypothesis.

use super::super::recurrence::{unprimed, unprimed_closed, weighted};
use super::super::*;
use algebra::linalg::signed_unit;
use vhi::history::{TimeGrid, TimeRule, Trapezoid};

/// E_n = s_n + C2 Σ'_{j ≤ n} w_nj E_j.
fn primed(grid: &TimeGrid, source: &[f64], c2: f64) -> Result<Vec<f64>, StepTooLarge> {
    papers().envelope(grid, source, c2)
}

fn papers() -> Weights {
    Weights::of(scene::TimeRule::Trapezoid, 0.0).unwrap()
}

fn grids() -> [TimeGrid; 3] {
    [TimeGrid::uniform(2.0, 40), TimeGrid::graded(2.0, 40, 2.0), TimeGrid::random(2.0, 40, 7)]
}

/// Random sources with g_0 = 0 or not.
fn source(from_rest: bool) -> Vec<f64> {
    let mut state = 3;
    let mut values: Vec<f64> = (0..=40).map(|_| 1.0 + signed_unit(&mut state)).collect();
    if from_rest {
        values[0] = 0.0;
    }
    values
}

/// Largest |left - right|, relative to the right sides.
fn distance(left: &[f64], right: &[f64]) -> f64 {
    assert_eq!(left.len(), right.len());
    let size = right.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    left.iter().zip(right).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
}

#[test]
fn each_envelope_satisfies_its_equation() {
    let c2 = 1.3;
    for grid in grids() {
        for s in [source(true), source(false)] {
            let e = primed(&grid, &s, c2).unwrap();
            let right: Vec<f64> = (0..=40)
                .map(|n| {
                    let sum: f64 = (0..=n).map(|j| Trapezoid.weight(&grid, n, j) * e[j]).sum();
                    s[n] + c2 * sum
                })
                .collect();
            // 40 steps of rounding: 40·2^-53, with a factor 20 in hand; so below.
            assert!(distance(&e, &right) < 1e-13);
            let k = grid.largest_step();
            let p = unprimed(&grid, &s, c2).unwrap();
            let right: Vec<f64> =
                (0..=40).map(|n| s[n] + c2 * k * p[..=n].iter().sum::<f64>()).collect();
            assert!(distance(&p, &right) < 1e-13);
        }
    }
}

#[test]
fn closed_forms_are_attained_by_constant_truncation_and_bound_the_rest() {
    for grid in grids() {
        let mut constant = vec![0.7; 41];
        for first in [0.0, 0.7] {
            constant[0] = first;
            let e = primed(&grid, &constant, 1.3).unwrap();
            assert!(distance(&e, &papers().closed(&grid, &constant, 1.3).unwrap()) < 1e-13);
        }
        for s in [source(true), source(false)] {
            let pairs = [
                (primed(&grid, &s, 1.3), papers().closed(&grid, &s, 1.3)),
                (unprimed(&grid, &s, 1.3), unprimed_closed(&grid, &s, 1.3)),
                (primed(&grid, &s, 1.3), unprimed(&grid, &s, 1.3)),
            ];
            for (lower, upper) in pairs {
                let (lower, upper) = (lower.unwrap(), upper.unwrap());
                // Equal where s has its maximum so far at n = 0 or 1: rounding decides there.
                assert!(lower.iter().zip(&upper).all(|(a, b)| *a <= b * (1.0 + 1e-14)));
            }
        }
    }
    // The textbook form on a uniform grid, and its limit e^{C2 T} as k → 0.
    let (c, g) = (1.3 * 2.0 / 40.0, 0.7);
    let mut s = vec![g; 41];
    s[0] = 0.0;
    let closed = papers().closed(&grids()[0], &s, 1.3).unwrap();
    let rho: f64 = (1.0 + 0.5 * c) / (1.0 - 0.5 * c);
    assert!((closed[40] - g / (1.0 - 0.5 * c) * rho.powi(39)).abs() < 1e-13 * closed[40]);
    let fine = TimeGrid::uniform(2.0, 4000);
    let mut s = vec![g; 4001];
    s[0] = 0.0;
    let closed = papers().closed(&fine, &s, 1.3).unwrap();
    // 1/(1 - c/2)·ρ^{n-1}·e^{-cn} = 1 - c/2 + c/2·… + O(c²): below c = 6.5e-4 relatively.
    assert!((closed[4000] / (g * f64::exp(2.6)) - 1.0).abs() < 1.3 * 2.0 / 4000.0);
}

#[test]
fn the_weighted_form_reduces_to_the_primed_one() {
    for grid in grids() {
        let s = source(true);
        let with = |kappa: &dyn Fn(f64) -> f64| {
            let lag = |n: usize, j: usize| grid.time(n) - grid.time(j);
            let at = |n: usize, j: usize| Trapezoid.weight(&grid, n, j) * kappa(lag(n, j));
            let rows = (0..=40).map(|n| (0..=n).map(|j| at(n, j)).collect()).collect();
            let part = HistoryPart { coefficient: 0.5, rows, supremum: 1.0 };
            weighted(&s, 0.25, &[part]).unwrap()
        };
        // ω κ/m0 = 0.5·1/0.25 = C2, source/m0.
        let scaled: Vec<f64> = s.iter().map(|s| s / 0.25).collect();
        let primed = primed(&grid, &scaled, 2.0).unwrap();
        assert!(distance(&with(&|_| 1.0), &primed) < 1e-12);
        let fading = with(&|lag: f64| (-lag).exp());
        assert!(fading.iter().zip(&primed).all(|(a, b)| *a <= b * (1.0 + 1e-14)));
        assert!(fading[40] < 0.5 * primed[40]);
    }
}

/// "For some constants C1, C2" is not enough: with C2 k = 1 the inequality reads e_n ≤ C1 g_n + e_n
/// + …, which any sequence satisfies for g = 0, and no C3 bounds it by max g = 0.
#[test]
fn for_any_c2_the_lemma_is_false() {
    let (grid, c1, c2) = (TimeGrid::uniform(2.0, 2), 1.0, 1.0);
    let (g, e) = ([0.0; 3], [0.0, 5.0, 1e6]);
    let k = grid.largest_step();
    for n in 0..=2 {
        assert!(e[n] <= c1 * g[n] + c2 * k * e[..=n].iter().sum::<f64>());
    }
    let refused = unprimed(&grid, &g, c2).unwrap_err();
    assert_eq!(refused, StepTooLarge { n: 0, factor: 1.0, weight: 1.0 });
    assert!(refused.to_string().contains("1 * 1 = 1;"), "{refused}");
    assert!(unprimed_closed(&grid, &g, c2).is_err());
    // The halved last weight still allows it, and gives e = 0; twice the constant does not.
    assert_eq!(primed(&grid, &g, c2).unwrap(), [0.0; 3]);
    assert_eq!(
        primed(&grid, &g, 2.0).unwrap_err(),
        StepTooLarge { n: 1, factor: 2.0, weight: 0.5 }
    );
    assert!(papers().closed(&grid, &g, 2.0).is_err());
    assert!(primed(&grid, &g, f64::NAN).is_err());
    let row = |n: usize| (0..=n).map(|j| 2.0 * Trapezoid.weight(&grid, n, j)).collect();
    let rows = (0..=2).map(row).collect();
    let part = HistoryPart { coefficient: 1.0, rows, supremum: 2.0 };
    assert!(weighted(&g, 1.0, &[part]).is_err());
}
