//! Reduction of sampled fields to their distance to P1 functions. Index loops, since the inlined calls then vectorise.

use super::lanes::Number;
use fem::norms::linear_projection;
use fem::space::quadrature::Rule;

/// The mean of a tensor field on one cell; `values` holds the tensors point by point, one for each of `weights`, and
/// becomes the deviations.
#[inline(always)]
pub(crate) fn deviations<T: Number, const N: usize>(
    values: &mut [[T; N]],
    weights: &[f64],
) -> [T; N] {
    let mean = mean(values, weights);
    for value in values {
        for i in 0..N {
            value[i] -= mean[i];
        }
    }
    mean
}

/// As [`deviations`], leaving the values unchanged.
#[inline(always)]
pub(crate) fn mean<T: Number, const N: usize>(values: &[[T; N]], weights: &[f64]) -> [T; N] {
    let mut mean = [T::from(0.0); N];
    for (value, weight) in values.iter().zip(weights) {
        let weight = T::from(*weight);
        for i in 0..N {
            mean[i] += weight * value[i];
        }
    }
    mean
}

/// Linear projections of N sampled fields on one simplex of C corners, by their values there; `at` becomes the
/// remainder.
#[inline(always)]
pub(crate) fn remainders<T: Number, const N: usize, const C: usize>(
    at: &mut [[T; N]],
    rule: &Rule,
) -> [[T; C]; N] {
    let mut moment = [[T::from(0.0); C]; N];
    for ((value, weight), b) in at.iter().zip(&rule.weights).zip(&rule.points) {
        let weight = T::from(*weight);
        for a in 0..C {
            let shape = T::from(b[a]);
            for i in 0..N {
                moment[i][a] += weight * value[i] * shape;
            }
        }
    }
    let mut corner = [[T::from(0.0); C]; N];
    for i in 0..N {
        linear_projection(&moment[i], &mut corner[i]);
    }
    for (value, b) in at.iter_mut().zip(&rule.points) {
        for i in 0..N {
            let mut linear = corner[i][0] * T::from(b[0]);
            for a in 1..C {
                linear += corner[i][a] * T::from(b[a]);
            }
            value[i] -= linear;
        }
    }
    corner
}
