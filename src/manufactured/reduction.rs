//! Sampled fields reduced to what the distance to P1 functions needs.

use crate::norms::{CellConstants, linear_projection};
use crate::space::quadrature::Rule;

/// Adds the mean of a tensor field on one cell, and the squared distance to it.
pub fn add_cell(values: &[[f64; 3]], weights: &[f64], measure: f64, out: &mut CellConstants) {
    let mut mean = [0.0; 3];
    for (value, weight) in values.iter().zip(weights) {
        for i in 0..3 {
            mean[i] += weight * value[i];
        }
    }
    for (value, weight) in values.iter().zip(weights) {
        let square: f64 = (0..3).map(|i| (value[i] - mean[i]).powi(2)).sum();
        out.rest += measure * weight * square;
    }
    out.mean.extend(mean);
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
