//! Quotients of two tensors.

use nalgebra::DMatrix;
use vhi::law::{FourthOrder, TensorField};

/// The eigenvalues of 𝒜⁻¹𝒞 on S^d in all regions.
pub(crate) fn quotients(tensor: &TensorField, elastic: &TensorField, d: usize) -> Vec<f64> {
    let count = tensor.regions().len().max(elastic.regions().len());
    (0..count).flat_map(|region| on_region(tensor.on(region), elastic.on(region), d)).collect()
}

/// Those of L⁻¹𝒞L⁻ᵀ with 𝒜 = LLᵀ; none if 𝒜 is not positive definite.
fn on_region(tensor: &FourthOrder, elastic: &FourthOrder, d: usize) -> Vec<f64> {
    if let (FourthOrder::Isotropic(b), FourthOrder::Isotropic(a)) = (tensor, elastic) {
        // 2μ on deviators, 2μ + dλ on spheres.
        let spheres = |lambda: f64, mu: f64| 2.0 * mu + d as f64 * lambda;
        return vec![b.mu / a.mu, spheres(b.lambda, b.mu) / spheres(a.lambda, a.mu)];
    }
    let dense = |tensor: &FourthOrder| match d {
        2 => DMatrix::from_fn(3, 3, |i, j| tensor.matrix::<3>()[i][j]),
        _ => DMatrix::from_fn(6, 6, |i, j| tensor.matrix::<6>()[i][j]),
    };
    let Some(factor) = dense(elastic).cholesky() else { return Vec::new() };
    let lower = factor.l();
    let half = lower.solve_lower_triangular(&dense(tensor));
    let both = half.and_then(|half| lower.solve_lower_triangular(&half.transpose()));
    both.map_or_else(Vec::new, |both| both.symmetric_eigenvalues().iter().copied().collect())
}
