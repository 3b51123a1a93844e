//! Envelopes with the weights of other rules than the paper's: against their definition, and under their closed forms.

use super::super::recurrence::fractional;
use super::super::*;
use algebra::linalg::signed_unit;
use scene::TimeRule;
use vhi::history::TimeGrid;

const RULES: [TimeRule; 5] = [
    TimeRule::Trapezoid,
    TimeRule::Left,
    TimeRule::Right,
    TimeRule::Gregory { order: 3 },
    TimeRule::Gregory { order: 4 },
];

fn of(rule: TimeRule) -> Weights {
    Weights::of(rule, 0.0).expect("weights that are the same for every kernel")
}

fn product(power: f64) -> Weights {
    Weights::of(TimeRule::ProductIntegration, power).expect("bounds by the power")
}

fn sources() -> [Vec<f64>; 3] {
    let mut seed = 3;
    let random: Vec<f64> = (0..=60).map(|_| 1.0 + signed_unit(&mut seed)).collect();
    let mut from_rest = vec![0.7; 61];
    from_rest[0] = 0.0;
    [random, from_rest, vec![0.7; 61]]
}

#[test]
fn envelopes_solve_their_equations_and_stay_below_their_closed_forms() {
    for weights in RULES.map(of) {
        for (c2, source) in
            [0.2, 2.0, 9.0, 29.0].into_iter().flat_map(|c2| sources().map(|s| (c2, s)))
        {
            let grid = TimeGrid::uniform(2.0, 60);
            let e = weights.envelope(&grid, &source, c2).expect("a step that is small enough");
            let closed = weights.closed(&grid, &source, c2).expect("the same");
            for n in 0..=60 {
                let sum: f64 = (0..=n).map(|j| weights.rule().weight(&grid, n, j) * e[j]).sum();
                // 60 steps of rounding.
                assert!((source[n] + c2 * sum - e[n]).abs() <= 1e-13 * e[n], "{weights:?} {n}");
                assert!(e[n] <= closed[n] * (1.0 + 1e-13), "{weights:?} {c2} {n}");
            }
        }
    }
}

/// c (1 + c)^{n-1} by the left rule, on any grid; a step without end is no step too large there, but is one by the others.
#[test]
fn the_left_rule_attains_its_closed_form_and_needs_no_small_step() {
    let source = &sources()[1];
    for grid in [TimeGrid::uniform(2.0, 60), TimeGrid::graded(2.0, 60, 2.0)] {
        for c2 in [0.5, 100.0] {
            let left = of(TimeRule::Left);
            let both = [left.envelope(&grid, source, c2), left.closed(&grid, source, c2)];
            let [e, closed] = both.map(|bound| bound.expect("no bound of the step"));
            assert!(e.iter().zip(&closed).all(|(a, b)| (a - b).abs() <= 1e-12 * b));
        }
    }
    for weights in [RULES[0], RULES[2], RULES[3], RULES[4]].map(of) {
        let grid = TimeGrid::uniform(2.0, 60);
        let most = 30.0 / weights.rule().last_share();
        assert!(weights.envelope(&grid, source, 1.01 * most).is_err(), "{weights:?}");
        assert!(weights.closed(&grid, source, 1.01 * most).is_err(), "{weights:?}");
        // The closed form of a fine grid is that of the continuous inequality.
        let (fine, s) = (TimeGrid::uniform(2.0, 20_000), vec![1.0; 20_001]);
        let closed = weights.closed(&fine, &s, 1.3).expect("small steps");
        assert!((closed[20_000] / f64::exp(2.6) - 1.0).abs() < 1e-3, "{weights:?}");
    }
}

/// E_{1/2}(√t) = e^t erfc(-√t), by a table of erfc at t = 1, is the limit of the envelope for C2 Γ(½) = 1; on any grid the
/// envelope solves its equation and stays below the closed form.
#[test]
fn envelopes_with_the_weights_of_a_power_tend_to_the_function_of_mittag_leffler() {
    let c2 = std::f64::consts::PI.sqrt().recip();
    let known = std::f64::consts::E * 1.842_700_792_949_715;
    let weights = product(0.5);
    let at_the_end = |steps: u32| {
        let grid = TimeGrid::graded(1.0, steps, 2.0);
        let source = vec![1.0; steps as usize + 1];
        let limit = fractional(&grid, &source, 0.5, c2, 1.0);
        assert!((limit[steps as usize] / known - 1.0).abs() < 1e-12);
        *weights.envelope(&grid, &source, c2).expect("small steps").last().expect("levels")
    };
    // The solution starts like t^{1/2}: order 2 on t_j = (j/N)² by product integration.
    let off = [100, 200].map(|steps| (at_the_end(steps) - known).abs());
    assert!(off[1] < 1e-3 && (off[0] / off[1]).log2() > 1.7, "{off:?}");
    for power in [0.0, 0.3, 0.5, 0.8] {
        let weights = product(power);
        for grid in [
            TimeGrid::uniform(2.0, 60),
            TimeGrid::graded(2.0, 60, 2.0),
            TimeGrid::random(2.0, 60, 5),
        ] {
            // A tenth of the last step, and one near the largest that there may be.
            let whole = grid.largest_step().powf(1.0 - power) / (1.0 - power);
            for (share, source) in
                [0.01, 0.1, 0.9].into_iter().flat_map(|share| sources().map(|s| (share, s)))
            {
                let c2 = share / whole;
                let e = weights.envelope(&grid, &source, c2).expect("a step that is small enough");
                let closed = weights.closed(&grid, &source, c2).expect("the same");
                for n in 0..=60 {
                    let row = weights.row(&grid, n);
                    let sum: f64 = row.iter().zip(&e).map(|(w, e)| w * e).sum();
                    assert!((source[n] + c2 * sum - e[n]).abs() <= 1e-12 * e[n], "{power} {n}");
                    assert!(e[n] <= closed[n] * (1.0 + 1e-10), "{power} {share} {n}");
                }
            }
            assert!(weights.closed(&grid, &[0.0, 1.0], 1.01 / whole).is_err());
        }
    }
    // Of a kernel without a pole: the integrals of the hat functions.
    let grid = TimeGrid::graded(2.0, 9, 1.5);
    let (hats, halves) = (product(0.0).row(&grid, 7), of(TimeRule::Trapezoid).row(&grid, 7));
    assert!(hats.iter().zip(&halves).all(|(a, b)| (a - b).abs() < 1e-15));
}
