//! Joint fits on grids whose orders are known.

use super::*;

fn grid(levels: i32, error: impl Fn(f64, f64) -> f64) -> Vec<Point> {
    let step = |level: i32| 0.125 * 0.5f64.powi(level);
    let pairs = (0..levels).flat_map(|i| (0..levels).map(move |j| (step(i), step(j))));
    pairs.map(|(h, k)| Point { h, k, error: error(h, k), floor: 0.0 }).collect()
}

#[test]
fn both_models_are_recognised_with_their_orders() {
    let sum = joint_fits(&grid(4, |h, k| 0.3 * h + 4.0 * k * k), false).unwrap();
    assert_eq!(sum.best.model, Model::Sum);
    let square = joint_fits(&grid(4, |h, k| (0.3 * h).hypot(4.0 * k * k)), false).unwrap();
    assert_eq!(square.best.model, Model::RootSumSquare);
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

#[test]
fn a_floor_is_fitted_on_request() {
    let fits = joint_fits(&grid(5, |h, k| 1e-3 + 0.3 * h + 4.0 * k * k), true).unwrap();
    // The floor is a tenth of the smallest error, its digits suffer accordingly.
    assert!((fits.best.floor.unwrap() - 1e-3).abs() < 1e-7);
}

#[test]
fn constants_under_given_orders() {
    let points = grid(3, |h, k| 0.3 * h + 4.0 * k * k);
    let [space, time] = fit_constants(&points, Model::Sum, (1.0, 2.0)).unwrap();
    assert!((space.value - 0.3).abs() < 1e-8 && (time.value - 4.0).abs() < 1e-7);
    assert!(fit_constants(&points[..2], Model::Sum, (1.0, 2.0)).is_err());
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

/// E = C_h h (1 + D h) and C_k k² (1 + D' k²) in both forms, |D|, |D'| ≤ 4, noise of 1 %.
#[test]
fn simulated_coverage_of_the_grid() {
    let mut state = 2024u64;
    // Knuth's MMIX generator, uniform on [0, 1).
    let mut uniform = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for m in [1.0, 2.0] {
        let mut covered = [0, 0];
        for _ in 0..100 {
            let [c, d, c_k, d_k] = [1.0, 8.0, 8.0, 8.0].map(|scale| scale * uniform());
            let mut points = grid(4, |h, k| {
                let space = (0.2 + c) * h * (1.0 + (d - 4.0) * h);
                let time = (2.0 + c_k) * k * k * (1.0 + (d_k - 4.0) * k * k);
                (space.powf(m) + time.powf(m)).powf(1.0 / m)
            });
            // Uniform noise of standard deviation 1 %.
            points.iter_mut().for_each(|p| p.error *= 1.0 + 0.0346 * (uniform() - 0.5));
            let best = joint_fits(&points, false).unwrap().best;
            covered[0] += usize::from(best.order_h.interval.contains(1.0));
            covered[1] += usize::from(best.order_k.interval.contains(2.0));
        }
        println!("m = {m}: {covered:?} of 100");
        // 95 % less two standard deviations of 100 draws.
        assert!(covered.iter().all(|count| *count >= 90), "{m} {covered:?}");
    }
}
