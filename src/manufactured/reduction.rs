//! Sampled fields reduced to what the distance to P1 functions needs.

use super::lanes::Number;
use crate::norms::linear_projection;
use crate::space::quadrature::Rule;

/// The mean of a tensor field on one cell; `values` holds the tensors point by point, one for each of `weights`, and
/// becomes what they differ from it.
#[inline(always)]
pub fn deviations<T: Number>(values: &mut [T], weights: &[f64]) -> [T; 6] {
    let numbers = values.len() / weights.len();
    let mut mean = [T::from(0.0); 6];
    for (value, weight) in values.chunks_exact(numbers).zip(weights) {
        mean.iter_mut().zip(value).for_each(|(mean, value)| *mean += T::from(*weight) * *value);
    }
    for value in values.chunks_exact_mut(numbers) {
        value.iter_mut().zip(&mean).for_each(|(value, mean)| *value -= *mean);
    }
    mean
}

/// Linear projection of sampled values on one simplex, by its values at the corners; `at` becomes what is left.
#[inline(always)]
pub fn remainders<T: Number>(at: &mut [T], rule: &Rule) -> [T; 4] {
    let corners = rule.points[0].len();
    let mut moment = [T::from(0.0); 4];
    for ((value, weight), b) in at.iter().zip(&rule.weights).zip(&rule.points) {
        for a in 0..corners {
            moment[a] += T::from(*weight) * *value * T::from(b[a]);
        }
    }
    let mut corner = [T::from(0.0); 4];
    linear_projection(&moment[..corners], &mut corner[..corners]);
    for (value, b) in at.iter_mut().zip(&rule.points) {
        let linear = |a: usize| corner[a] * T::from(b[a]);
        *value -= (1..corners).fold(linear(0), |sum, a| sum + linear(a));
    }
    corner
}
