//! Intervals on laws whose order is known; tests/numbers/coverage.rs simulates them.

use super::*;

fn refined(ratio: f64, levels: i32, error: impl Fn(f64) -> f64) -> Vec<Sample> {
    (0..levels)
        .map(|level| 0.125 * ratio.powi(-level))
        .map(|step| Sample { step, error: error(step) })
        .collect()
}

#[test]
fn exact_laws_give_a_point_that_holds_the_truth() {
    for ratio in [1.3, 1.5, 2.0] {
        for order in [0.5, 1.0, 2.0, -2.0] {
            for levels in 3..8 {
                let samples = refined(ratio, levels, |h| 1e-9 * h.powf(order));
                let found = order_interval(&samples, Correction::Linear).unwrap();
                assert!(found.interval.contains(order), "{ratio} {order} {found:?}");
                // Student's factor 12.7 on rounding; nothing else is there.
                assert!(found.interval.half_width() < 1e-10, "{ratio} {order} {found:?}");
            }
        }
    }
}

/// e = h + 4h² on h = 1/8 … 1/256: every window lies in [1.03, 1.21], on one side of 1.
#[test]
fn bias_is_covered_though_every_window_misses() {
    let samples = refined(2.0, 6, |h| h + 4.0 * h * h);
    let found = order_interval(&samples, Correction::Linear).unwrap();
    assert!(found.windows.lo > 1.03 && found.windows.hi < 1.21);
    assert!(found.interval.contains(1.0) && found.interval.half_width() <= 0.15);
}

#[test]
fn divergence_is_negative() {
    let samples = refined(2.0, 5, |h| h.powi(-2));
    let found = order_interval(&samples, Correction::Quadratic).unwrap();
    assert!(found.interval.contains(-2.0) && found.interval.hi < -1.9);
}

#[test]
fn fewer_than_three_points_have_no_interval() {
    let samples = refined(2.0, 2, |h| h);
    let refused = order_interval(&samples, Correction::Linear).unwrap_err();
    assert_eq!(refused, FitError::TooFew { found: 2, needed: 3 });
    assert!(order_interval(&[], Correction::Linear).is_err());
}

/// Slopes of 3, 2, 1.5 drift on: the last change, times 2, is half of the way that is left.
#[test]
fn the_drift_reaches_further_on_small_ratios() {
    let samples: Vec<Sample> =
        [0.3, 0.2, 0.15].map(|step: f64| Sample { step, error: step * (1.0 + 0.1 * step) }).into();
    let found = order_interval(&samples, Correction::Linear).unwrap();
    let slopes = local_slopes(&samples);
    let change = slopes[1] - slopes[0];
    let factor = found.drift.half_width() / change.abs();
    let mean = |a: f64, b: f64| (a - b) / (a / b).ln();
    let expected = 2.0 * mean(0.2, 0.15) / (mean(0.3, 0.2) - mean(0.2, 0.15));
    // Roundings of a change of 1 in 100.
    assert!((factor - expected).abs() < 1e-10 && factor > 4.0, "{factor} {expected}");
    assert!(found.interval.contains(1.0));
    // Halvings have the factor 2, also in even powers, where less is left.
    for correction in [Correction::Linear, Correction::Quadratic] {
        let samples = refined(2.0, 3, |h| h * (1.0 + 0.1 * h));
        let found = order_interval(&samples, correction).unwrap();
        let slopes = local_slopes(&samples);
        let factor = found.drift.half_width() / (slopes[1] - slopes[0]).abs();
        assert!((factor - 2.0).abs() < 1e-10, "{correction:?} {factor}");
    }
}

/// Windows by hand: errors 1, 2, 16, 4 on halved steps, slopes over three points are half of the
/// sum of two neighbours; over four (3 a + 4 b + 3 c)/10.
#[test]
fn windows_are_all_contiguous_runs_of_three_and_more() {
    let errors = [1.0, 2.0, 16.0, 4.0];
    let samples: Vec<Sample> =
        (0..4).map(|i| Sample { step: 0.5f64.powi(i), error: errors[i as usize] }).collect();
    let found = order_interval(&samples, Correction::Linear).unwrap();
    // Local slopes −1, −3, 2: windows −2, −1/2 and −0.9.
    assert!((found.windows.lo + 2.0).abs() < 1e-14 && (found.windows.hi + 0.5).abs() < 1e-14);
    assert!((found.law.order + 0.9).abs() < 1e-14);
    assert!((found.drift.lo + 8.0).abs() < 1e-12 && (found.drift.hi - 12.0).abs() < 1e-12);
    assert_eq!(found.widest_part(), "curvature");
    let three = order_interval(&samples[..3], Correction::Linear).unwrap();
    assert!(three.curvature.is_none());
}

/// Logarithms of larger orders carry more rounding.
#[test]
fn rounding_grows_with_the_order() {
    for (order, wanted) in [(0.5, 1.0), (1.0, 1.0), (5.0, 5.0)] {
        let found =
            order_interval(&refined(2.0, 4, |h| h.powf(order)), Correction::Linear).unwrap();
        let parts = found.student.hull(found.windows).hull(found.drift);
        let parts = parts.hull(found.curvature.unwrap());
        let added = (found.interval.hi - parts.hi) / ROUNDING;
        // Rounding of the difference of two numbers up to 5: 1e-15 over 1e-12.
        assert!((added - wanted).abs() < 2e-3, "{order}: {added}");
    }
}

#[test]
fn the_widest_part_is_named() {
    let [narrow, wide] = [0.1, 1.0].map(|radius| Interval::around(1.0, radius));
    let samples = refined(2.0, 4, |h| h);
    let base = order_interval(&samples, Correction::Linear).unwrap();
    let parts = |student, windows, drift, curvature| {
        OrderInterval { student, windows, drift, curvature: Some(curvature), ..base.clone() }
            .widest_part()
    };
    assert_eq!(parts(wide, narrow, narrow, narrow), "scatter");
    assert_eq!(parts(narrow, wide, narrow, narrow), "windows");
    assert_eq!(parts(narrow, narrow, wide, narrow), "drift");
    assert_eq!(parts(narrow, narrow, narrow, wide), "curvature");
    // One-sided parts count by their far end, to either side.
    let below = Interval { lo: -1.0, hi: 1.0 };
    assert_eq!(parts(narrow, below, narrow, narrow), "windows");
    // By distances: 0.6 above the order is further than 0.5 below it.
    let [low, high] = [Interval { lo: 0.5, hi: 1.1 }, Interval { lo: 0.9, hi: 1.6 }];
    assert_eq!(parts(low, narrow, high, narrow), "drift");
    let [low, high] = [Interval { lo: 0.5, hi: 1.0 }, Interval { lo: 0.9, hi: 1.2 }];
    assert_eq!(parts(low, narrow, high, narrow), "scatter");
}
