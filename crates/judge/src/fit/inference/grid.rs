//! Both orders of a grid of meshes and time steps by the same inference.
//!
//! E = C_h h^p (1 + D_h h^r) + C_k k^q (1 + D_k k^s), or the same of E² where space and time errors are orthogonal.
//! Divided by the observed E the model is linear in C_h, C_h D_h, C_k and C_k D_k: the evidence of every pair (p, q) is
//! closed. The pairs are a grid of distance 0.05; what is said of one order is the sum over the other.

use super::mixture::Mixture;
use super::{Interval, LEAST_NOISE, Posterior};
use crate::fit::identifiable::check_grid;
use crate::fit::{NotIdentifiable, Point, screen};

/// Orders are multiples of this, up to the largest.
const STEP: f64 = 0.05;
const ORDERS: usize = 79;
/// Powers of next terms in multiples of `STEP`, with their weights.
const NEXT: [(usize, f64); 3] = [(10, 0.15), (20, 0.55), (40, 0.30)];
/// Relative noise of E with its weights.
const NOISE: [(f64, f64); 4] = [(0.001, 0.35), (0.003, 0.3), (0.01, 0.25), (0.03, 0.1)];
/// Standard deviation of D.
const BEND: f64 = 0.3;
/// Prior of errors that add as numbers, and as squares.
const MODELS: [(i32, f64); 2] = [(1, 0.7), (2, 0.3)];
/// C_h, C_k and both orders.
const PARAMETERS: usize = 4;
/// A uniform distribution over one step has this standard deviation times the step.
const UNIFORM: f64 = 0.289;

/// What a grid says of its two orders.
#[derive(Debug, Clone)]
pub struct GridPosterior {
    /// The order p in h.
    pub order_h: Posterior,
    /// The order q in k.
    pub order_k: Posterior,
}

/// Weighs all pairs of orders. `noise` is the relative standard deviation of the errors where it is known.
///
/// # Errors
/// [`NotIdentifiable`] where the points do not determine two orders.
pub fn infer_grid(points: &[Point], noise: Option<f64>) -> Result<GridPosterior, NotIdentifiable> {
    let noises = noise.map_or(NOISE.to_vec(), |noise| vec![(noise.max(LEAST_NOISE), 1.0)]);
    let usable: Vec<Point> = points.iter().copied().filter(|p| screen(p).is_ok()).collect();
    check_grid(&usable, PARAMETERS)?;
    let mut evidence = vec![f64::NEG_INFINITY; ORDERS * ORDERS];
    for (model, prior) in MODELS {
        Model::new(&usable, model).add(prior.ln(), &noises, &mut evidence);
    }
    let largest = evidence.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return Err(NotIdentifiable::no_minimum());
    }
    let weights: Vec<f64> = evidence.iter().map(|log| (log - largest).exp()).collect();
    let of = |sum: &dyn Fn(usize) -> f64| marginal((0..ORDERS).map(sum).collect());
    let order_h = of(&|i| weights[i * ORDERS..(i + 1) * ORDERS].iter().sum());
    let order_k = of(&|j| (0..ORDERS).map(|i| weights[i * ORDERS + j]).sum());
    Ok(GridPosterior { order_h, order_k })
}

fn order(index: usize) -> f64 {
    STEP * (index + 1) as f64
}

fn marginal(weights: Vec<f64>) -> Posterior {
    let total: f64 = weights.iter().sum();
    let parts = weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
    let parts = parts.map(|(i, weight)| [weight / total, order(i), UNIFORM * STEP]).collect();
    let all = Mixture::from_parts(parts);
    Posterior {
        order: all.quantile(0.5),
        interval: Interval { lo: all.quantile(0.025), hi: all.quantile(0.975) },
        coarse_left_out: 0,
        floor_from: None,
        slopes: Vec::new(),
        sound: all.clone(),
        floored: Mixture::from_parts(Vec::new()),
        all,
        floor: 0.0,
    }
}

/// Sums over the points for all powers of h and k that occur.
struct Model {
    /// 1 for errors that add, 2 for squares.
    exponent: usize,
    points: f64,
    /// Column i of h against itself and against the columns of its next terms; the same of k.
    own: [Vec<[f64; 4]>; 2],
    next: [Vec<f64>; 2],
    /// Columns against one.
    ones: [Vec<f64>; 2],
    /// Columns of h against those of k.
    mixed: Vec<f64>,
}

/// Columns: the orders, and next terms beyond the last of them.
const COLUMNS: usize = ORDERS + NEXT[2].0;

impl Model {
    fn new(points: &[Point], exponent: i32) -> Self {
        let largest = |f: fn(&Point) -> f64| points.iter().map(f).fold(0.0, f64::max);
        let scale = [largest(|p| p.h), largest(|p| p.k)];
        let rows: Vec<[f64; 3]> = points
            .iter()
            .map(|p| [p.h / scale[0], p.k / scale[1], p.error].map(|value| value.powi(exponent)))
            .collect();
        let columns = |which: usize| -> Vec<Vec<f64>> {
            let column = |i| rows.iter().map(|row| row[which].powf(order(i)) / row[2]).collect();
            (0..COLUMNS).map(column).collect()
        };
        let of = [columns(0), columns(1)];
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let shifts = NEXT.map(|(shift, _)| shift / exponent as usize);
        let own = |columns: &[Vec<f64>]| -> Vec<[f64; 4]> {
            let at = |i: usize, shift: usize| dot(&columns[i], &columns[i + shift]);
            (0..ORDERS)
                .map(|i| [at(i, 0), at(i, shifts[0]), at(i, shifts[1]), at(i, shifts[2])])
                .collect()
        };
        let next = |columns: &[Vec<f64>]| columns.iter().map(|c| dot(c, c)).collect();
        let ones = |columns: &[Vec<f64>]| columns.iter().map(|c| c.iter().sum()).collect();
        let mixed = of[0].iter().flat_map(|a| of[1].iter().map(move |b| dot(a, b))).collect();
        Self {
            exponent: exponent as usize,
            points: rows.len() as f64,
            own: [own(&of[0]), own(&of[1])],
            next: [next(&of[0]), next(&of[1])],
            ones: [ones(&of[0]), ones(&of[1])],
            mixed,
        }
    }

    /// Adds exp(log prior) times the evidence of every pair, on logarithms.
    fn add(&self, log_prior: f64, noises: &[(f64, f64)], evidence: &mut [f64]) {
        for i in 0..ORDERS {
            for j in 0..ORDERS {
                // Without next terms: the sizes of both terms, which have to be positive.
                let (a, b, d) = (self.own[0][i][0], self.mixed[i * COLUMNS + j], self.own[1][j][0]);
                let determinant = a * d - b * b;
                let (f, g) = (self.ones[0][i], self.ones[1][j]);
                let sizes = [(d * f - b * g) / determinant, (a * g - b * f) / determinant];
                if !sizes.iter().all(|size| *size > 0.0 && size.is_finite()) {
                    continue;
                }
                let entry = &mut evidence[i * ORDERS + j];
                for (r, (_, r_weight)) in NEXT.iter().enumerate() {
                    for (s, (_, s_weight)) in NEXT.iter().enumerate() {
                        let gram = self.gram([i, j], [r, s]);
                        for (noise, share) in noises {
                            let noise = noise * self.exponent as f64;
                            let log = self.log_evidence(&gram, sizes, noise);
                            let log = log + (r_weight * s_weight * share).ln() + log_prior;
                            *entry = log_sum(*entry, log);
                        }
                    }
                }
            }
        }
    }

    /// Products of the four columns, and of each with one.
    fn gram(&self, [i, j]: [usize; 2], [r, s]: [usize; 2]) -> ([[f64; 4]; 4], [f64; 4]) {
        let after = |at: usize, which: usize| at + NEXT[which].0 / self.exponent;
        let (i2, j2) = (after(i, r), after(j, s));
        let mixed = |a: usize, b: usize| self.mixed[a * COLUMNS + b];
        let gram = [
            [self.own[0][i][0], self.own[0][i][r + 1], mixed(i, j), mixed(i, j2)],
            [self.own[0][i][r + 1], self.next[0][i2], mixed(i2, j), mixed(i2, j2)],
            [mixed(i, j), mixed(i2, j), self.own[1][j][0], self.own[1][j][s + 1]],
            [mixed(i, j2), mixed(i2, j2), self.own[1][j][s + 1], self.next[1][j2]],
        ];
        (gram, [self.ones[0][i], self.ones[0][i2], self.ones[1][j], self.ones[1][j2]])
    }

    /// The logarithm of the evidence: C flat on its logarithm, C D normal with the standard deviation 0.3 C.
    fn log_evidence(
        &self,
        (gram, ones): &([[f64; 4]; 4], [f64; 4]),
        sizes: [f64; 2],
        noise: f64,
    ) -> f64 {
        let variance = noise * noise;
        let bends = sizes.map(|size| BEND * self.exponent as f64 * size);
        let mut factor = *gram;
        for (row, bend) in [(1, bends[0]), (3, bends[1])] {
            factor[row][row] += variance / (bend * bend);
        }
        // Cholesky, and the forward substitution of the right-hand side.
        let (mut solved, mut log_diagonal) = (*ones, 0.0);
        for row in 0..4 {
            for column in 0..=row {
                let sum: f64 = (0..column).map(|l| factor[row][l] * factor[column][l]).sum();
                let left = factor[row][column] - sum;
                if row == column {
                    if left <= 0.0 {
                        return f64::NEG_INFINITY;
                    }
                    factor[row][row] = left.sqrt();
                    log_diagonal += factor[row][row].ln();
                } else {
                    factor[row][column] = left / factor[column][column];
                }
            }
            let sum: f64 = (0..row).map(|l| factor[row][l] * solved[l]).sum();
            solved[row] = (ones[row] - sum) / factor[row][row];
        }
        let explained: f64 = solved.iter().map(|value| value * value).sum();
        // Four parameters are integrated: |M| of the precision M = gram / s² + prior is s⁻⁸ times that of the factor.
        -(self.points - 4.0) * noise.ln()
            - 0.5 * (self.points - explained) / variance
            - log_diagonal
            - bends.iter().chain(&sizes).map(|size| size.ln()).sum::<f64>()
    }
}

/// log(exp a + exp b).
fn log_sum(a: f64, b: f64) -> f64 {
    let (large, small) = (a.max(b), a.min(b));
    if small == f64::NEG_INFINITY { large } else { large + (small - large).exp().ln_1p() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Claim;
    use crate::fit::Decision;

    fn grid(levels: u32, error: impl Fn(f64, f64) -> f64) -> Vec<Point> {
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

    /// E = 0.6 h (1 − h) + 16 k² / 16, on 3 × 3 levels: what a table cannot tell is left open.
    #[test]
    fn the_smallest_grids_have_no_false_fail() {
        for (bend, share) in [(-1.0, 1.0), (1.0, 1.0), (0.0, 0.3), (-1.0, 4.0), (1.0, 0.1)] {
            let points = grid(3, |h, k| 0.6 * h * (1.0 + bend * h) + share * k * k);
            let found = decide(&points, 1.0, 2.0);
            assert!(!found.contains(&Decision::Fail), "{bend} {share}: {found:?}");
            // Orders that are wrong by one fail.
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

    /// The four columns by the definition, at a pair and a reading, against the stored sums.
    #[test]
    fn stored_products_are_those_of_the_columns() {
        let points = grid(3, |h, k| h + k * k);
        for exponent in [1, 2] {
            let model = Model::new(&points, exponent);
            let (i, j, r, s) = (19, 39, 0, 2);
            let power = |base: f64, at: usize, shift: usize| {
                base.powi(exponent).powf(order(at) + STEP * (shift / exponent as usize) as f64)
            };
            let column = |which: usize| -> Vec<f64> {
                let of = |p: &Point| {
                    let (h, k) = (p.h / 0.125, p.k / 0.5);
                    let top = match which {
                        0 => power(h, i, 0),
                        1 => power(h, i, NEXT[r].0),
                        2 => power(k, j, 0),
                        _ => power(k, j, NEXT[s].0),
                    };
                    top / p.error.powi(exponent)
                };
                points.iter().map(of).collect()
            };
            let (gram, ones) = model.gram([i, j], [r, s]);
            for a in 0..4 {
                let sum: f64 = column(a).iter().sum();
                // Sums of nine numbers, each a few roundings off.
                assert!((ones[a] - sum).abs() < 1e-12 * sum.abs());
                for b in 0..4 {
                    let product: f64 = column(a).iter().zip(column(b)).map(|(x, y)| x * y).sum();
                    assert!((gram[a][b] - product).abs() < 1e-12 * product.abs(), "{a} {b}");
                }
            }
        }
    }
}
