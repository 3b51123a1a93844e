//! β_nj = |W_nj| ‖𝒜^{-1/2} ℬ 𝒜^{-1/2}‖: what the errors of earlier levels are to that of level n.

use algebra::linalg::larger;
use fem::contact::Model;
use nalgebra::{Matrix3, SymmetricEigen};
use vhi::history::TimeGrid;
use vhi::law::{Convolution, TensorField};

/// β_nj, j = 0, …, n; empty without memory.
pub(super) fn weights(model: &Model, grid: &TimeGrid, n: usize) -> Vec<f64> {
    let rule = model.time_rule.as_ref();
    let Some((first, others)) = model.memory.split_first() else { return Vec::new() };
    let weight = |j: usize| {
        let of_term = |term: &fem::contact::MemoryTerm| {
            rule.kernel_weight(&Convolution(&*term.kernel), grid, n, j)
        };
        let add = |sum: TensorField, term: &fem::contact::MemoryTerm| {
            sum.plus(of_term(term), &term.tensor, 2)
        };
        let sum = others.iter().fold(first.tensor.scaled(of_term(first)), add);
        relative_norm(&sum, &model.elasticity)
    };
    (0..=n).map(weight).collect()
}

/// ‖𝒜^{-1/2} ℬ 𝒜^{-1/2}‖, the largest of all regions.
fn relative_norm(tensor: &TensorField, elasticity: &TensorField) -> f64 {
    let regions = tensor.regions().len().max(elasticity.regions().len());
    let matrix = |field: &TensorField, region: usize| {
        let rows = field.on(region).matrix::<3>();
        Matrix3::from_fn(|i, j| rows[i][j])
    };
    let largest = |region: usize| {
        let Some(root) = matrix(elasticity, region).cholesky() else { return f64::NAN };
        let Some(inverse) = root.l().try_inverse() else { return f64::NAN };
        let scaled = inverse * matrix(tensor, region) * inverse.transpose();
        SymmetricEigen::new(scaled).eigenvalues.amax()
    };
    (0..regions).map(largest).fold(0.0, larger)
}
