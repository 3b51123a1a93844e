use super::*;
use crate::Direction;

fn grid(levels: i32, error: impl Fn(f64, f64) -> f64) -> Vec<Point> {
    let step = |level: i32| 0.125 * 0.5f64.powi(level);
    let pairs = (0..levels).flat_map(|i| (0..levels).map(move |j| (step(i), step(j))));
    pairs.map(|(h, k)| Point { h, k, error: error(h, k), floor: 0.0 }).collect()
}

#[test]
fn both_models_are_recognised_with_their_orders() {
    let sum = joint_fits(&grid(4, |h, k| 0.3 * h + 4.0 * k * k), false).unwrap();
    assert_eq!(sum.best.model, ErrorCombination::Sum);
    let square = joint_fits(&grid(4, |h, k| (0.3 * h).hypot(4.0 * k * k)), false).unwrap();
    assert_eq!(square.best.model, ErrorCombination::RootSumSquare);
    for fits in [sum, square] {
        // The minimisation stops at steps of 1e-10.
        assert!((fits.best.order_h.value - 1.0).abs() < 1e-8);
        assert!((fits.best.order_k.value - 2.0).abs() < 1e-8);
        assert!((fits.best.constant_h - 0.3).abs() < 1e-8);
        assert!((fits.best.constant_k - 4.0).abs() < 1e-7);
        assert!(fits.other.unwrap().residual_norm > 1e-2);
    }
}

#[test]
fn bias_of_the_space_error_is_covered() {
    for bend in [-2.0, -1.0, 1.0, 2.0] {
        let points = grid(5, |h, k| 0.3 * h * (1.0 + bend * h) + 4.0 * k * k);
        let best = joint_fits(&points, false).unwrap().best;
        assert!(best.order_h.interval.contains(1.0), "{bend} {best:?}");
        assert!(best.order_k.interval.contains(2.0), "{bend} {best:?}");
    }
}

/// A misfitting model has no influence on the interval; one that fits as well has.
#[test]
fn the_other_model_counts_where_it_fits_as_well() {
    // Noise of 1e-4 decides for the sum.
    let noise = |h: f64, k: f64| 1.0 + 1e-4 * (1e3 * h + 7e3 * k).sin();
    let sum = grid(5, |h, k| (0.3 * h + 4.0 * k * k) * noise(h, k));
    for estimate in fit_constants(&sum, ErrorCombination::Sum, (1.0, 2.0)).unwrap() {
        let FittedValue { value, interval } = estimate;
        assert!(interval.half_width() < 0.01 * value, "{estimate:?}");
    }
    let asked = fit_constants(&sum, ErrorCombination::RootSumSquare, (1.0, 2.0)).unwrap();
    for (estimate, truth) in asked.iter().zip([0.3, 4.0]) {
        assert!(estimate.interval.contains(truth), "{truth}: {estimate:?}");
    }
    let few = fit_constants(&sum[..2], ErrorCombination::Sum, (1.0, 2.0));
    assert_eq!(few, Err(FitError::TooFew { found: 2, needed: 3 }));
}

#[test]
fn what_cannot_be_identified_says_why() {
    let path: Vec<Point> =
        grid(6, |h, k| h + k * k).into_iter().filter(|point| point.h == point.k).collect();
    let refused = joint_fits(&path, false).unwrap_err();
    assert!(refused.reason.contains("together"), "{refused}");
    let flat = joint_fits(&grid(4, |h, k| h + 1e-4 * k * k), false).unwrap_err();
    assert!(flat.reason.contains("time term"), "{flat}");
    let few = joint_fits(&grid(2, |h, k| h + k * k), false).unwrap_err();
    assert!(few.reason.contains("2 levels of h"), "{few}");
    assert!(joint_fits(&[], false).is_err());
    assert!(joint_fits(&grid(4, |_, _| f64::NAN), false).is_err());
    assert!(joint_fits(&grid(4, |_, _| 0.0), false).is_err());
}

fn estimate(value: f64, radius: f64) -> FittedValue {
    FittedValue { value, interval: Interval::around(value, radius) }
}

/// Order 1: a clip at 1.25 reaches 1.25 ± 0.5, bends at 1.25 reach 1.25 ± 0.125.
#[test]
fn parts_reach_by_the_change_they_make() {
    let full = estimate(1.0, 0.01);
    assert_eq!(drift(full, estimate(1.25, 0.0)), Interval { lo: 0.75, hi: 1.75 });
    assert_eq!(drift(full, estimate(0.75, 9.0)), Interval { lo: 0.25, hi: 1.25 });
    assert_eq!(corrected(full, estimate(1.25, 0.0)), Interval { lo: 1.125, hi: 1.375 });
    assert_eq!(corrected(full, estimate(1.25, 0.5)), Interval { lo: 0.75, hi: 1.75 });
    let bent = [estimate(1.25, 0.0), estimate(1.0, 0.25)];
    let rival = [estimate(2.0, 0.5), estimate(1.0, 0.0)].map(|rival| rival.interval);
    let [space, time] = hulls(bent, &[bent.map(|bent| corrected(full, bent)), rival]);
    assert_eq!(space, FittedValue { value: 1.25, interval: Interval { lo: 1.125, hi: 2.5 } });
    assert_eq!(time, FittedValue { value: 1.0, interval: Interval { lo: 0.75, hi: 1.25 } });
}

#[test]
fn a_fit_evaluates_its_model() {
    let fits = joint_fits(&grid(5, |h, k| 1e-3 + 0.3 * h + 4.0 * k * k), true).unwrap();
    let (h, k) = (0.05, 0.02);
    let [space, time] = [0.3 * h, 4.0 * k * k];
    let error = 1e-3 + space + time;
    // The floor is a tenth of the smallest error.
    assert!((fits.best.error(h, k) / error - 1.0).abs() < 1e-5);
    let point = Point { h, k, error, floor: 0.0 };
    let shares = Direction::BOTH.map(|direction| fits.best.share(direction, &point));
    assert!((shares[0] - space / error).abs() < 1e-5);
    assert!((shares[1] - time / error).abs() < 1e-5);
}

#[test]
fn broken_points_take_no_part() {
    let mut points = grid(3, |h, k| 0.3 * h + 4.0 * k * k);
    for broken in [(0.0, 0.5), (0.5, f64::NAN), (-1.0, 0.5), (0.5, f64::INFINITY)] {
        points.push(Point { h: broken.0, k: broken.1, error: 1.0, floor: 0.0 });
    }
    points.push(Point { h: 0.3, k: 0.3, error: f64::NAN, floor: 0.0 });
    let best = joint_fits(&points, false).unwrap().best;
    assert!((best.order_h.value - 1.0).abs() < 1e-8 && (best.order_k.value - 2.0).abs() < 1e-8);
}

/// The bias D h is 3 % here at D = 2 without next terms.
#[test]
fn constants_of_a_grid_are_extrapolated() {
    let points = grid(4, |h, k| 0.3 * h * (1.0 + 2.0 * h) + 4.0 * k * k);
    let [space, time] = fit_constants(&points, ErrorCombination::Sum, (1.0, 2.0)).unwrap();
    assert!((space.value / 0.3 - 1.0).abs() < 0.02, "{space:?}");
    assert!((time.value / 4.0 - 1.0).abs() < 0.02, "{time:?}");
    assert!(space.interval.contains(0.3) && time.interval.contains(4.0));
    let three = fit_constants(&grid(3, |h, k| h + k), ErrorCombination::Sum, (1.0, 2.0)).unwrap();
    assert!(three[0].value > 0.0 && three[0].interval.contains(three[0].value));
    assert!(fit_constants(&points[..2], ErrorCombination::Sum, (1.0, 2.0)).is_err());
}
