//! Sampled fields reduced to what the distance to P1 functions needs.

use crate::norms::{CellConstants, linear_projection};
use crate::space::quadrature::Rule;

/// Adds the mean of a tensor field on one cell, and the squared distance to it; `values` holds the tensors
/// point by point, one for each of `weights`.
pub fn add_cell(values: &[f64], weights: &[f64], measure: f64, out: &mut CellConstants) {
    let numbers = values.len() / weights.len();
    let mut mean = [0.0; 6];
    let mean = &mut mean[..numbers];
    for (value, weight) in values.chunks_exact(numbers).zip(weights) {
        mean.iter_mut().zip(value).for_each(|(mean, value)| *mean += weight * value);
    }
    for (value, weight) in values.chunks_exact(numbers).zip(weights) {
        let square: f64 = value.iter().zip(&*mean).map(|(v, m)| (v - m).powi(2)).sum();
        out.rest += measure * weight * square;
    }
    out.mean.extend_from_slice(mean);
}

/// Linear projection of sampled values on one simplex; returns the mean squared remainder.
pub fn project(at: &[f64], rule: &Rule, mut set: impl FnMut(usize, f64)) -> f64 {
    let corners = rule.points[0].len();
    let mut moment = [0.0; 4];
    for ((value, weight), b) in at.iter().zip(&rule.weights).zip(&rule.points) {
        for a in 0..corners {
            moment[a] += weight * value * b[a];
        }
    }
    let mut corner = [0.0; 4];
    linear_projection(&moment[..corners], &mut corner[..corners]);
    let mut rest = 0.0;
    for ((value, weight), b) in at.iter().zip(&rule.weights).zip(&rule.points) {
        let linear: f64 = (0..corners).map(|a| corner[a] * b[a]).sum();
        rest += weight * (value - linear).powi(2);
    }
    for (a, value) in corner[..corners].iter().enumerate() {
        set(a, *value);
    }
    rest
}
