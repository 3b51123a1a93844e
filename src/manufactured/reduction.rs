//! Sampled fields reduced to what the distance to P1 functions needs.

use crate::norms::linear_projection;
use crate::space::quadrature::Rule;

/// The mean of a tensor field on one cell; `values` holds the tensors point by point, one for each of `weights`, and
/// becomes what they differ from it.
pub fn deviations(values: &mut [f64], weights: &[f64]) -> [f64; 6] {
    let numbers = values.len() / weights.len();
    let mut mean = [0.0; 6];
    for (value, weight) in values.chunks_exact(numbers).zip(weights) {
        mean.iter_mut().zip(value).for_each(|(mean, value)| *mean += weight * value);
    }
    for value in values.chunks_exact_mut(numbers) {
        value.iter_mut().zip(&mean).for_each(|(value, mean)| *value -= mean);
    }
    mean
}

/// Linear projection of sampled values on one simplex, by its values at the corners; `at` becomes what is left.
pub fn remainders(at: &mut [f64], rule: &Rule) -> [f64; 4] {
    let corners = rule.points[0].len();
    let mut moment = [0.0; 4];
    for ((value, weight), b) in at.iter().zip(&rule.weights).zip(&rule.points) {
        for a in 0..corners {
            moment[a] += weight * *value * b[a];
        }
    }
    let mut corner = [0.0; 4];
    linear_projection(&moment[..corners], &mut corner[..corners]);
    for (value, b) in at.iter_mut().zip(&rule.points) {
        *value -= (0..corners).map(|a| corner[a] * b[a]).sum::<f64>();
    }
    corner
}
