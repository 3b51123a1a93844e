//! Error and cost of a scene as functions of both steps, from the runs of a trade.

use judge::fit::{
    Direction, ErrorCombination, Interval, JointFits, Point, Sample, joint_fits, linear_fit,
    local_slopes, order as infer_order, power_law, same_level, samples,
};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// C s^p of one step s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Term {
    /// C.
    pub constant: f64,
    /// p.
    pub order: f64,
    /// Interval of p.
    pub interval: Interval,
}

/// E^m = (C_h h^p)^m + (C_k k^q)^m.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ErrorModel {
    /// m = 1 or 2.
    pub model: ErrorCombination,
    /// The term of h; none where the error does not depend on it.
    pub space: Option<Term>,
    /// The term of k, likewise.
    pub time: Option<Term>,
    /// How it was found.
    pub source: String,
    /// Largest |log e - log E| of the runs.
    pub residual: f64,
}

impl Term {
    /// C s^p.
    pub(super) fn at(&self, step: f64) -> f64 {
        self.constant * step.powf(self.order)
    }
}

impl ErrorModel {
    /// The error at (h, k).
    pub(super) fn error(&self, h: f64, k: f64) -> f64 {
        let parts = [self.space.map(|term| term.at(h)), self.time.map(|term| term.at(k))];
        let m = self.model.exponent();
        parts.into_iter().flatten().map(|part| part.powf(m)).sum::<f64>().powf(1.0 / m)
    }

    /// Fits the errors of a grid. Where both terms show, by the joint fit of `fit`; where one hides below the other,
    /// the visible one from a line (in h on the finest k; in k on the coarsest h, which is the mesh to take then), and a
    /// hidden term of k from `differences`: C k^q without space error, of runs on one mesh. `on_mesh` says that the data
    /// depend on the mesh, so that h has no error.
    ///
    /// # Errors
    /// What is missing, in words.
    pub(super) fn fit(
        points: &[Point],
        differences: &[Sample],
        on_mesh: bool,
    ) -> Result<Self, String> {
        let hidden = if on_mesh {
            Some(Direction::Space)
        } else {
            match joint_fits(points, false) {
                // Maxima over more times grow a little: no term falls that way.
                Ok(fits) if fits.best.order_h.value <= 0.0 => Some(Direction::Space),
                Ok(fits) if fits.best.order_k.value <= 0.0 => Some(Direction::Time),
                Ok(JointFits { best, .. }) => {
                    let terms = [(best.constant_h, best.order_h), (best.constant_k, best.order_k)];
                    let terms = terms.map(|(constant, order)| {
                        Some(Term { constant, order: order.value, interval: order.interval })
                    });
                    let source = format!("joint fit, {}", best.model.name());
                    return Ok(Self::new(points, best.model, terms, source));
                }
                Err(refused) => refused.hidden,
            }
        };
        let line = |direction: Direction| -> Result<Term, String> {
            // The runs on the finest k, or on the coarsest h.
            let (other, level): (fn(&Point) -> f64, f64) = match direction {
                Direction::Space => {
                    (|p| p.k, points.iter().map(|p| p.k).fold(f64::INFINITY, f64::min))
                }
                Direction::Time => (|p| p.h, points.iter().map(|p| p.h).fold(0.0, f64::max)),
            };
            let of_line = points.iter().filter(|p| same_level(other(p), level));
            let points: Vec<Point> = of_line.copied().collect();
            let samples = samples(&points, direction).map_err(|error| error.to_string())?;
            term(&samples)
        };
        let (space, time) = match hidden {
            Some(Direction::Space) => (None, Some(line(Direction::Time)?)),
            _ => (Some(line(Direction::Space)?), term(differences).ok()),
        };
        let source = match (space, time) {
            (None, _) => "line in k; the error does not show h".to_owned(),
            (_, Some(_)) => "line in h on the finest k; k from runs on one mesh".to_owned(),
            (_, None) => "line in h; k does not show".to_owned(),
        };
        let with = |model| Self::new(points, model, [space, time], source.clone());
        let [sum, root] = [ErrorCombination::Sum, ErrorCombination::RootSumSquare].map(with);
        Ok(if sum.residual < root.residual { sum } else { root })
    }

    fn new(
        points: &[Point],
        model: ErrorCombination,
        [space, time]: [Option<Term>; 2],
        source: String,
    ) -> Self {
        let mut found = Self { model, space, time, source, residual: 0.0 };
        let off = points.iter().map(|p| (found.error(p.h, p.k) / p.error).ln().abs());
        found.residual = off.fold(0.0, f64::max);
        found
    }
}

/// The term by least squares, which predicts steps near those of the runs best; its interval is the range of orders by
/// which it may go on.
fn term(samples: &[Sample]) -> Result<Term, String> {
    let (order, interval) = match samples.len() {
        // Two runs have an order and nothing that bounds it.
        2 => (local_slopes(samples)[0], Interval::around(0.0, f64::INFINITY)),
        _ => {
            let table: Vec<(f64, f64)> = samples.iter().map(|s| (s.step, s.error)).collect();
            let found = infer_order(&table).map_err(|error| error.to_string())?;
            let law = power_law(samples).map_err(|error| error.to_string())?;
            (law.order, found.interval.hull(Interval::around(law.order, 0.0)))
        }
    };
    // Predictions are for finer steps: the constant is that of the finest run, not of the middle of the line.
    let constant = samples.last().map_or(f64::NAN, |s| s.error / s.step.powf(order));
    if !(order > 0.0 && constant > 0.0) {
        return Err(format!("order {order:.2}: the error does not fall"));
    }
    Ok(Term { constant, order, interval })
}

// What a run costs as a function of both steps, as a sum of parts that are there for a reason.
//
// With d dimensions a mesh has h^-d cells, and a factorization by nested dissection takes h^-3(d-1) operations (George
// 1973). A part comes once a run (mesh, analysis, a factor kept) or once a level (loads, assembly, solves, new factors).

/// Parts: a constant, cells and factorization, each once and each a level.
const PARTS: usize = 5;

/// t = Σ c_i f_i(h, k) with c_i ≥ 0.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(super) struct CostModel {
    /// Seconds a unit of each part: constant, a cell, a cell and level, an operation, an operation and level.
    pub parts: [f64; PARTS],
    /// Largest |log t - log t(h, k)| of the runs.
    pub residual: f64,
    #[serde(skip)]
    dimension: usize,
    #[serde(skip)]
    horizon: f64,
}

impl CostModel {
    /// Least squares of the relative error over all non-negative c: the best of all choices of parts whose least
    /// squares have no negative coefficient (the minimum has such a support). `samples` have h, k and CPU seconds.
    ///
    /// # Errors
    /// What is missing, in words.
    pub(super) fn fit(
        samples: &[[f64; 3]],
        dimension: usize,
        horizon: f64,
    ) -> Result<Self, &'static str> {
        if [0, 1].iter().any(|&i| samples.windows(2).all(|pair| pair[0][i] == pair[1][i])) {
            return Err(
                "the runs use a single mesh or a single number of steps, so their costs cannot be separated",
            );
        }
        let ones = DVector::from_element(samples.len(), 1.0);
        let mut best: Option<(f64, [f64; PARTS])> = None;
        for chosen in 1u32..1 << PARTS {
            let columns: Vec<usize> = (0..PARTS).filter(|i| chosen & (1 << i) != 0).collect();
            let mut design = DMatrix::from_fn(samples.len(), columns.len(), |row, column| {
                let [h, k, seconds] = samples[row];
                features(dimension, horizon, h, k)[columns[column]] / seconds
            });
            // Columns of size one: a cell of the finest mesh is some 1e-6 of a run.
            let sizes: Vec<f64> = design.column_iter().map(|column| column.norm()).collect();
            design.column_iter_mut().zip(&sizes).for_each(|(mut column, size)| column /= *size);
            let Some(fit) = linear_fit(design, &ones) else { continue };
            let norm = fit.residuals.norm();
            let sound = fit.coefficients.iter().all(|c| c.is_finite() && *c >= 0.0);
            if !sound || best.is_some_and(|(least, _)| least <= norm) {
                continue;
            }
            let mut parts = [0.0; PARTS];
            for (i, &column) in columns.iter().enumerate() {
                parts[column] = fit.coefficients[i] / sizes[i];
            }
            best = Some((norm, parts));
        }
        let (_, parts) = best.ok_or("no parts fit the times")?;
        let mut found = Self { parts, residual: 0.0, dimension, horizon };
        let off = |[h, k, seconds]: &[f64; 3]| (found.seconds(*h, *k) / seconds).ln().abs();
        found.residual = samples.iter().map(off).fold(0.0, f64::max);
        Ok(found)
    }

    /// Seconds at (h, k).
    pub(super) fn seconds(&self, h: f64, k: f64) -> f64 {
        let parts = features(self.dimension, self.horizon, h, k);
        parts.iter().zip(&self.parts).map(|(f, c)| f * c).sum()
    }

    /// The exponents a and b of t ~ h^-a k^-b around (h, k).
    pub(super) fn exponents(&self, h: f64, k: f64) -> [f64; 2] {
        let shares = features(self.dimension, self.horizon, h, k);
        let all = self.seconds(h, k);
        let share = |i: usize| shares[i] * self.parts[i] / all;
        let d = self.dimension as f64;
        // Of T/k + 1 levels T/k come and go with k.
        let falls = self.horizon / (self.horizon + k);
        let in_space = d * (share(1) + share(2)) + 3.0 * (d - 1.0) * (share(3) + share(4));
        [in_space, falls * (share(2) + share(4))]
    }
}

/// The f_i at (h, k).
fn features(dimension: usize, horizon: f64, h: f64, k: f64) -> [f64; PARTS] {
    let (cells, levels) = (h.powi(-(dimension as i32)), horizon / k + 1.0);
    let operations = h.powi(-3 * (dimension as i32 - 1));
    [1.0, cells, cells * levels, operations, operations * levels]
}

#[cfg(test)]
mod tests {
    mod error_model {
        use super::super::*;

        fn grid(error: impl Fn(f64, f64) -> f64) -> Vec<Point> {
            let steps = |list: [u32; 4]| list.map(|n| 1.0 / f64::from(n));
            let pairs = steps([8, 16, 32, 64])
                .into_iter()
                .flat_map(|h| steps([4, 8, 16, 32]).map(|k| (h, k)));
            pairs.map(|(h, k)| Point { h, k, error: error(h, k), floor: 0.0 }).collect()
        }

        fn differences(constant: f64) -> Vec<Sample> {
            let k = [4, 8, 16].map(|steps| 1.0 / f64::from(steps));
            k.map(|step| Sample { step, error: constant * step * step }).to_vec()
        }

        #[test]
        fn both_terms_are_found_where_both_show() {
            for (model, m) in
                [(ErrorCombination::Sum, 1.0f64), (ErrorCombination::RootSumSquare, 2.0)]
            {
                let law =
                    |h: f64, k: f64| ((0.5 * h).powf(m) + (2.0 * k * k).powf(m)).powf(1.0 / m);
                // The differences are not asked.
                let found =
                    ErrorModel::fit(&grid(law), &differences(77.0), false).expect("a model");
                assert_eq!(found.model, model);
                let (space, time) = (found.space.expect("h"), found.time.expect("k"));
                // The minimum of a smooth residual, to the root of rounding.
                assert!((space.order - 1.0).abs() < 1e-6 && (time.order - 2.0).abs() < 1e-6);
                assert!((found.error(0.01, 0.01) / law(0.01, 0.01) - 1.0).abs() < 1e-5);
                assert!(found.residual < 1e-6);
            }
        }

        #[test]
        fn a_hidden_term_of_time_comes_from_runs_on_one_mesh() {
            let law = |h: f64, k: f64| (0.5 * h).hypot(0.01 * k * k);
            let found = ErrorModel::fit(&grid(law), &differences(0.01), false).expect("a model");
            let (space, time) = (found.space.expect("h"), found.time.expect("k"));
            assert!((space.order - 1.0).abs() < 1e-3 && (time.constant - 0.01).abs() < 1e-12);
            // Where k is coarse and h is not, its error counts.
            assert!((found.error(1e-3, 0.25) / law(1e-3, 0.25) - 1.0).abs() < 0.01);
            // Without them it is left out, and said.
            let without = ErrorModel::fit(&grid(law), &[], false).expect("a model");
            assert!(without.time.is_none() && without.source.contains("k does not show"));
        }

        /// Largest errors over more times are a little larger where k has no error at all.
        #[test]
        fn an_error_that_grows_with_the_number_of_times_has_no_term_of_k() {
            let law = |h: f64, k: f64| 0.4 * h * if k > 0.2 { 0.91 } else { 1.0 };
            let found = ErrorModel::fit(&grid(law), &[], false).expect("a model");
            assert!(found.time.is_none() && (found.space.expect("h").order - 1.0).abs() < 1e-6);
        }

        #[test]
        fn an_error_without_h_has_a_line_in_k_alone() {
            let found = ErrorModel::fit(&grid(|_, k| 3.0 * k * k), &[], true).expect("a model");
            assert!(found.space.is_none());
            assert!((found.error(0.5, 0.1) - 0.03).abs() < 1e-10);
            // One that does not fall is no model.
            assert!(ErrorModel::fit(&grid(|_, k| 1.0 / k), &[], true).is_err());
        }
    }

    mod cost {
        use super::super::*;

        fn runs(cost: impl Fn(f64, f64) -> f64) -> Vec<[f64; 3]> {
            let mut found = Vec::new();
            for n in [8, 16, 32, 64] {
                for steps in [4, 8, 16] {
                    let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
                    found.push([h, k, cost(h, k)]);
                }
            }
            found
        }

        #[test]
        fn parts_are_found_and_carry_beyond_the_runs() {
            let law =
                |h: f64, k: f64| 1e-3 + 2e-6 * h.powi(-2) * (1.0 / k + 1.0) + 3e-8 * h.powi(-3);
            let found = CostModel::fit(&runs(law), 2, 1.0).expect("a cost");
            // Columns of five parts on twelve runs: some digits of 16 are lost.
            for (fitted, part) in found.parts.iter().zip([1e-3, 0.0, 2e-6, 3e-8, 0.0]) {
                assert!((fitted - part).abs() <= 1e-7 * part.max(1e-3), "{:?}", found.parts);
            }
            let (h, k) = (1.0 / 256.0, 1.0 / 40.0);
            assert!((found.seconds(h, k) / law(h, k) - 1.0).abs() < 1e-3 && found.residual < 1e-3);
            // Differences of the law itself: their error is of the square of the step, 1e-4.
            let [a, b] = found.exponents(h, k);
            let slope = |[up, down]: [f64; 2]| (down / up).ln() / (1.001f64 / 0.999).ln();
            assert!((a - slope([1.001, 0.999].map(|s| law(s * h, k)))).abs() < 1e-3, "{a}");
            assert!((b - slope([1.001, 0.999].map(|s| law(h, s * k)))).abs() < 1e-3, "{b}");
        }

        #[test]
        fn noise_makes_no_negative_part() {
            let mut samples = runs(|h, k| 2e-6 * h.powi(-2) / k);
            for (i, [_, _, seconds]) in samples.iter_mut().enumerate() {
                *seconds *= if i % 3 == 0 { 1.15 } else { 0.95 };
            }
            let found = CostModel::fit(&samples, 2, 1.0).expect("a cost");
            assert!(found.parts.iter().all(|part| *part >= 0.0));
            // An eighth of the step, a fourth of the width: 8 and 16 times the cost, within the noise and its growth.
            let ratio = found.seconds(1.0 / 256.0, 1.0 / 32.0) / (2e-6 * 65536.0 * 32.0);
            assert!((0.7..1.5).contains(&ratio), "{ratio}");
            assert!(CostModel::fit(&[], 2, 1.0).is_err());
        }
    }
}
