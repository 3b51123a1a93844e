//! Both orders of a grid of meshes and time steps by the same inference.
//!
//! E = C_h h^p (1 + D_h h^r) + C_k k^q (1 + D_k k^s), or this form for E² if space and time errors are orthogonal.
//! Divided by the observed E the model is linear in C_h, C_h D_h, C_k and C_k D_k, so the evidence of each pair (p, q)
//! is closed. Pairs lie on a grid of spacing 0.05; one order is the marginal over the other.

mod pairs;

use super::mixture::Mixture;
use super::told::up_to;
use super::{Doubts, Interval, NOISES, Posterior, Trend};
use crate::identifiable::{LEVELS, check_levels};
use crate::level::{deviation, foreign, is_step};
use crate::{NotIdentifiable, Point, joint_fits, screen};
use pairs::{ORDERS, PairSums, STEP, order};

/// Relative noise of E, with weights.
const NOISE: [(f64, f64); 5] =
    [(0.001, 0.34), (0.003, 0.3), (0.01, 0.24), (0.03, 0.09), (0.1, 0.03)];
/// Priors of errors that add, and of squares that add.
const MODELS: [(i32, f64); 2] = [(1, 0.7), (2, 0.3)];
/// So many orders are the end of the list.
const LAST: usize = 4;
const BEYOND: &str = "the order is at the end of those that are looked for on grids, 8";
const PARAMETERS: usize = 4;
/// Standard deviation of a uniform distribution over one step, in steps.
const UNIFORM: f64 = 0.289;

/// What a grid says of its two orders.
#[derive(Debug, Clone)]
pub struct GridPosterior {
    pub order_h: Posterior,
    pub order_k: Posterior,
}

/// Posterior over all pairs of orders. `noise`: what the relative standard deviation of the errors is at most, if known.
///
/// # Errors
/// [`NotIdentifiable`] where the points do not determine two orders.
pub fn infer_grid(points: &[Point], noise: Option<f64>) -> Result<GridPosterior, NotIdentifiable> {
    let noise = noise.map(deviation).transpose().map_err(NotIdentifiable::refused)?;
    let [order_h, order_k] = match noise {
        Some(noise) => up_to(noise, NOISES, |noise| infer_at(points, &[(noise, 1.0)])),
        None => infer_at(points, &NOISE),
    }?;
    Ok(GridPosterior { order_h, order_k })
}

/// The orders in h and k by noises with weights.
fn infer_at(points: &[Point], noises: &[(f64, f64)]) -> Result<[Posterior; 2], NotIdentifiable> {
    let there = points.iter().filter(|p| is_step(p.h) && is_step(p.k));
    let (usable, left_out): (Vec<Point>, Vec<Point>) =
        there.copied().partition(|p| screen(p).is_ok());
    if let Some(broken) = left_out.iter().find_map(|p| screen(p).err().filter(|e| e.is_broken())) {
        return Err(NotIdentifiable::refused(broken));
    }
    check_levels(&usable, PARAMETERS, LEVELS)?;
    let mut evidence = vec![f64::NEG_INFINITY; ORDERS * ORDERS];
    for (model, prior) in MODELS {
        PairSums::new(&usable, model).add(prior.ln(), noises, &mut evidence);
    }
    let largest = evidence.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return Err(NotIdentifiable::no_minimum());
    }
    let weights: Vec<f64> = evidence.iter().map(|log| (log - largest).exp()).collect();
    let unexplained = unexplained(&left_out, points);
    let evidence = largest + weights.iter().sum::<f64>().ln();
    let of = |sum: &dyn Fn(usize) -> f64| {
        let unexplained = unexplained.clone();
        Posterior { evidence, unexplained, ..marginal((0..ORDERS).map(sum).collect()) }
    };
    let order_h = of(&|i| weights[i * ORDERS..(i + 1) * ORDERS].iter().sum());
    let order_k = of(&|j| (0..ORDERS).map(|i| weights[i * ORDERS + j]).sum());
    Ok([order_h, order_k])
}

/// The first point left out that the better of the two models by least squares does not explain.
fn unexplained(left_out: &[Point], points: &[Point]) -> Option<String> {
    // The fit costs more than the look.
    if left_out.is_empty() {
        return None;
    }
    let model = joint_fits(points, false).ok().map(|fits| fits.best);
    left_out.iter().find_map(|&Point { h, k, error, floor }| {
        let least = model.as_ref().map_or(0.0, |model| model.error(h, k));
        let why = foreign(error, floor, least)?;
        Some(format!("the error at h = {h:.3e}, k = {k:.3e} {why}"))
    })
}

fn marginal(weights: Vec<f64>) -> Posterior {
    let total: f64 = weights.iter().sum();
    let parts = weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
    let parts = parts.map(|(i, weight)| [weight / total, order(i), UNIFORM * STEP]).collect();
    let all = Mixture::from_parts(parts);
    let last = weights[ORDERS - LAST..].iter().sum::<f64>() > 0.5 * total;
    Posterior {
        order: all.quantile(0.5),
        interval: Interval { lo: all.quantile(0.025), hi: all.quantile(0.975) },
        coarse_left_out: 0,
        floor_from: None,
        slopes: Vec::new(),
        sound: all.clone(),
        wary: None,
        wide: None,
        floored: Mixture::from_parts(Vec::new()),
        all,
        floor: 0.0,
        evidence: f64::NEG_INFINITY,
        less: Vec::new(),
        unexplained: None,
        doubts: Doubts { always: last.then(|| BEYOND.to_owned()), ..Doubts::default() },
        trend: Trend::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Claim;
    use crate::Decision;

    fn grid(levels: u32, mut error: impl FnMut(f64, f64) -> f64) -> Vec<Point> {
        let step = |i: u32| 0.125 / f64::from(1 << i);
        let pairs = (0..levels).flat_map(|i| (0..levels).map(move |j| (step(i), 4.0 * step(j))));
        pairs.map(|(h, k)| Point { h, k, error: error(h, k), floor: 0.0 }).collect()
    }

    fn decide(points: &[Point], p: f64, q: f64) -> [Decision; 2] {
        let found = infer_grid(points, None).expect("a grid");
        let on = |posterior: &Posterior, order| {
            posterior.decide(&Claim::new(order).expect("an order")).decision
        };
        [on(&found.order_h, p), on(&found.order_k, q)]
    }

    /// E = 0.6 h (1 − h) + 16 k² / 16 on 3 × 3 levels: what the table cannot tell stays open.
    #[test]
    fn the_smallest_grids_have_no_false_fail() {
        for (bend, share) in [(-1.0, 1.0), (1.0, 1.0), (0.0, 0.3), (-1.0, 4.0), (1.0, 0.1)] {
            let points = grid(3, |h, k| 0.6 * h * (1.0 + bend * h) + share * k * k);
            let found = decide(&points, 1.0, 2.0);
            assert!(!found.contains(&Decision::Fail), "{bend} {share}: {found:?}");
            assert_eq!(decide(&points, 2.0, 2.0)[0], Decision::Fail, "{bend} {share}");
            assert_eq!(decide(&points, 1.0, 3.0)[1], Decision::Fail, "{bend} {share}");
        }
    }

    #[test]
    fn four_levels_of_each_tell_both_orders() {
        for bend in [-0.5, 0.0, 0.5] {
            let sum = grid(4, |h, k| 0.6 * h * (1.0 + bend * h) + k * k);
            assert_eq!(decide(&sum, 1.0, 2.0), [Decision::Pass; 2], "{bend}");
            assert_eq!(decide(&sum, 1.5, 1.5), [Decision::Fail, Decision::Unresolved]);
            let root = grid(4, |h, k| (0.36 * h * h + k.powi(4)).sqrt());
            assert_eq!(decide(&root, 1.0, 2.0), [Decision::Pass; 2]);
        }
    }

    /// Orders above four, opposite signs, and noise, on five levels of each.
    #[test]
    fn grids_of_high_orders_opposite_signs_and_noise_do_not_fail() {
        let high = grid(4, |h, k| h.powi(5) + 0.77 * (k / 4.0).powi(4));
        assert_eq!(decide(&high, 5.0, 4.0), [Decision::Pass; 2]);
        assert_eq!(decide(&high, 6.0, 4.0)[0], Decision::Fail);
        let opposite = grid(4, |h, k| h - 0.28 * (k / 4.0).powi(2));
        assert_eq!(decide(&opposite, 1.0, 2.0), [Decision::Pass; 2]);
        for seed in 0..10 {
            // Quasi-random, of zero mean and a tenth.
            let mut at = f64::from(seed);
            let noisy = grid(4, |h, k| {
                at += 0.618_034;
                (h + k * k) * (0.17 * (2.0 * at.fract() - 1.0)).exp()
            });
            assert!(!decide(&noisy, 1.0, 2.0).contains(&Decision::Fail), "{seed}");
        }
    }
}
