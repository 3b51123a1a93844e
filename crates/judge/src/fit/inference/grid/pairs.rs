//! The evidence of every pair of orders of a grid, in closed form.
//!
//! Columns h^p, k^q and their next terms, divided by the observed errors, are fitted to one. The leading terms are
//! eliminated once per pair; a 2 × 2 matrix of the next terms remains for each noise.

use crate::fit::Point;

pub(super) const STEP: f64 = 0.05;
pub(super) const ORDERS: usize = 79;
/// Powers of next terms in multiples of `STEP`, with weights.
const NEXT: [(usize, f64); 3] = [(10, 0.15), (20, 0.55), (40, 0.30)];
/// Standard deviation of D.
const BEND: f64 = 0.3;
pub(super) fn order(index: usize) -> f64 {
    STEP * (index + 1) as f64
}

pub(super) struct PairSums {
    /// 1 if errors add, 2 if squares do.
    exponent: usize,
    points: f64,
    /// Column i of h with itself and with its next terms; likewise for k.
    with_next_terms: [Vec<[f64; 4]>; 2],
    next: [Vec<f64>; 2],
    ones: [Vec<f64>; 2],
    mixed: Vec<f64>,
}

const COLUMNS: usize = ORDERS + NEXT[2].0;

impl PairSums {
    pub(super) fn new(points: &[Point], exponent: i32) -> Self {
        let largest = |f: fn(&Point) -> f64| points.iter().map(f).fold(0.0, f64::max);
        let scale = [largest(|p| p.h), largest(|p| p.k)];
        let rows: Vec<[f64; 3]> = points
            .iter()
            .map(|p| [p.h / scale[0], p.k / scale[1], p.error].map(|value| value.powi(exponent)))
            .collect();
        let columns = |which: usize| -> Vec<Vec<f64>> {
            let factors: Vec<f64> = rows.iter().map(|row| row[which].powf(STEP)).collect();
            let first = rows.iter().zip(&factors).map(|(row, factor)| factor / row[2]).collect();
            // By repeated products: 119 of them are off by 1e-14.
            let times = |column: &Vec<f64>| {
                Some(column.iter().zip(&factors).map(|(value, factor)| value * factor).collect())
            };
            std::iter::successors(Some(first), times).take(COLUMNS).collect()
        };
        let of = [columns(0), columns(1)];
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let shifts = NEXT.map(|(shift, _)| shift / exponent as usize);
        let with_next_terms = |columns: &[Vec<f64>]| -> Vec<[f64; 4]> {
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
            with_next_terms: [with_next_terms(&of[0]), with_next_terms(&of[1])],
            next: [next(&of[0]), next(&of[1])],
            ones: [ones(&of[0]), ones(&of[1])],
            mixed,
        }
    }

    /// Adds exp(log prior) times the evidence of every pair, in logarithms.
    pub(super) fn add(&self, log_prior: f64, noises: &[(f64, f64)], evidence: &mut [f64]) {
        let noises: Vec<Noise> = noises.iter().map(|noise| self.noise(*noise, log_prior)).collect();
        for i in 0..ORDERS {
            for j in 0..ORDERS {
                let Some(pair) = self.pair(i, j) else { continue };
                let entry = &mut evidence[i * ORDERS + j];
                *entry = log_sum(*entry, self.evidence(&pair, &noises));
            }
        }
    }

    fn noise(&self, (noise, share): (f64, f64), log_prior: f64) -> Noise {
        let noise = noise * self.exponent as f64;
        let variance = noise * noise;
        let log = log_prior + share.ln() - (self.points - 4.0) * noise.ln();
        Noise { variance, precision: 1.0 / variance, log }
    }

    /// Eliminates a pair of orders without next terms; none unless both terms are positive.
    fn pair(&self, i: usize, j: usize) -> Option<Pair> {
        let (a, b, d) = (
            self.with_next_terms[0][i][0],
            self.mixed[i * COLUMNS + j],
            self.with_next_terms[1][j][0],
        );
        let determinant = a * d - b * b;
        let inverse = [d, -b, a].map(|entry| entry / determinant);
        let (f, g) = (self.ones[0][i], self.ones[1][j]);
        let sizes = [inverse[0] * f + inverse[1] * g, inverse[1] * f + inverse[2] * g];
        if !sizes.iter().all(|size| *size > 0.0 && size.is_finite()) {
            return None;
        }
        let bends = sizes.map(|size| BEND * self.exponent as f64 * size);
        Some(Pair {
            at: [i, j],
            inverse,
            determinant,
            sizes,
            explained: f * sizes[0] + g * sizes[1],
            ridges: bends.map(|bend| 1.0 / (bend * bend)),
            // C has a flat prior in log C, C D is normal with standard deviation 0.3 C.
            log: -bends.iter().chain(&sizes).map(|size| size.ln()).sum::<f64>(),
        })
    }

    /// The column of a next term, orthogonal to the two leading terms.
    fn next(&self, pair: &Pair, which: usize, reading: usize) -> Next {
        let place = pair.at[which] + NEXT[reading].0 / self.exponent;
        let with_itself = self.with_next_terms[which][pair.at[which]][reading + 1];
        let other = match which {
            0 => self.mixed[place * COLUMNS + pair.at[1]],
            _ => self.mixed[pair.at[0] * COLUMNS + place],
        };
        let along = if which == 0 { [with_itself, other] } else { [other, with_itself] };
        let by = [
            pair.inverse[0] * along[0] + pair.inverse[1] * along[1],
            pair.inverse[1] * along[0] + pair.inverse[2] * along[1],
        ];
        Next {
            place,
            by,
            along,
            norm: self.next[which][place] - along[0] * by[0] - along[1] * by[1],
            one: self.ones[which][place] - along[0] * pair.sizes[0] - along[1] * pair.sizes[1],
        }
    }

    /// Log evidence of all readings of a pair.
    fn evidence(&self, pair: &Pair, noises: &[Noise]) -> f64 {
        let [of_h, of_k] = [0, 1].map(|which| [0, 1, 2].map(|r| self.next(pair, which, r)));
        let mut evidence = f64::NEG_INFINITY;
        for (h, (_, r_weight)) in of_h.iter().zip(&NEXT) {
            for (k, (_, s_weight)) in of_k.iter().zip(&NEXT) {
                let cross = self.mixed[h.place * COLUMNS + k.place]
                    - h.along[0] * k.by[0]
                    - h.along[1] * k.by[1];
                let two = Two { h: h.norm, cross, k: k.norm, ones: [h.one, k.one] };
                for noise in noises {
                    let log = self.reading(pair, &two, noise) + (r_weight * s_weight).ln();
                    evidence = log_sum(evidence, log);
                }
            }
        }
        evidence
    }

    fn reading(&self, pair: &Pair, two: &Two, noise: &Noise) -> f64 {
        let (explained, determinant) = two.solve(pair.ridges.map(|ridge| ridge * noise.variance));
        let left = self.points - pair.explained - explained;
        let determinants = pair.determinant * determinant;
        if determinants > 0.0 {
            // Four parameters are integrated: |M| of M = gram / s² + prior is s⁻⁸ times the determinants.
            noise.log + pair.log - 0.5 * (left * noise.precision + determinants.ln())
        } else {
            f64::NEG_INFINITY
        }
    }
}

struct Noise {
    variance: f64,
    precision: f64,
    /// Evidence before any error is seen.
    log: f64,
}

struct Pair {
    at: [usize; 2],
    inverse: [f64; 3],
    determinant: f64,
    /// C_h and C_k by least squares, and the share of the observations (all one) that they explain.
    sizes: [f64; 2],
    explained: f64,
    ridges: [f64; 2],
    log: f64,
}

/// Products of a next term's column with those of the pair (raw and by the inverse), itself and one.
struct Next {
    place: usize,
    along: [f64; 2],
    by: [f64; 2],
    norm: f64,
    one: f64,
}

struct Two {
    h: f64,
    cross: f64,
    k: f64,
    ones: [f64; 2],
}

impl Two {
    /// What they explain with `ridges` added, and the determinant.
    fn solve(&self, ridges: [f64; 2]) -> (f64, f64) {
        let (a, b, d) = (self.h + ridges[0], self.cross, self.k + ridges[1]);
        let [f, g] = self.ones;
        let determinant = a * d - b * b;
        ((d * f * f - 2.0 * b * f * g + a * g * g) / determinant, determinant)
    }
}

fn log_sum(a: f64, b: f64) -> f64 {
    let (large, small) = (a.max(b), a.min(b));
    if small == f64::NEG_INFINITY { large } else { large + (small - large).exp().ln_1p() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::inference::grid::NOISE;

    fn grid(error: impl Fn(f64, f64) -> f64) -> Vec<Point> {
        let step = |i: i32| 0.125 * 0.5f64.powi(i);
        let pairs = (0..3).flat_map(|i| (0..3).map(move |j| (step(i), 4.0 * step(j))));
        pairs.map(|(h, k)| Point { h, k, error: error(h, k), floor: 0.0 }).collect()
    }

    /// Reference: four explicit columns and a dense factor.
    #[test]
    fn closed_forms_agree_with_dense_matrices() {
        let points = grid(|h, k| h + k * k);
        for exponent in [1, 2] {
            let model = PairSums::new(&points, exponent);
            let (i, j, r, s) = (19, 38, 0, 2);
            let power = |base: f64, at: usize, shift: usize| {
                base.powi(exponent).powf(order(at) + STEP * (shift / exponent as usize) as f64)
            };
            let gram = nalgebra::DMatrix::from_fn(points.len(), 4, |row, column| {
                let point = points[row];
                let (h, k) = (point.h / 0.125, point.k / 0.5);
                let top = match column {
                    0 => power(h, i, 0),
                    1 => power(k, j, 0),
                    2 => power(h, i, NEXT[r].0),
                    _ => power(k, j, NEXT[s].0),
                };
                top / point.error.powi(exponent)
            });
            let pair = model.pair(i, j).expect("both terms are positive");
            let ones = nalgebra::DVector::from_element(points.len(), 1.0);
            let sizes = gram.columns(0, 2).into_owned().svd(true, true);
            let sizes = sizes.solve(&ones, 0.0).expect("two sizes");
            let bends = [0, 1].map(|at| BEND * f64::from(exponent) * sizes[at]);
            let [h, k] = [(0, r), (1, s)].map(|(which, reading)| model.next(&pair, which, reading));
            let cross = model.mixed[h.place * COLUMNS + k.place]
                - h.along[0] * k.by[0]
                - h.along[1] * k.by[1];
            let two = Two { h: h.norm, cross, k: k.norm, ones: [h.one, k.one] };
            for (s, share) in NOISE {
                let noise = s * f64::from(exponent);
                let mut precision = gram.transpose() * &gram / (noise * noise);
                precision[(2, 2)] += 1.0 / (bends[0] * bends[0]);
                precision[(3, 3)] += 1.0 / (bends[1] * bends[1]);
                let along = gram.transpose() * &ones / (noise * noise);
                let factor = precision.cholesky().expect("a precision");
                let log_determinant = 2.0 * factor.l().diagonal().map(f64::ln).sum();
                let left = points.len() as f64 / (noise * noise) - along.dot(&factor.solve(&along));
                let expected = share.ln()
                    - points.len() as f64 * noise.ln()
                    - 0.5 * (left + log_determinant)
                    - (bends[0] * bends[1] * sizes[0] * sizes[1]).ln();
                let found = model.reading(&pair, &two, &model.noise((s, share), 0.0));
                // Rounding of nine over the square of the noise.
                assert!((found - expected).abs() < 1e-6, "{exponent} {s}: {found} {expected}");
            }
        }
    }
}
