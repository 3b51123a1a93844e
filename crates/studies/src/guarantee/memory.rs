//! β_nj = |W_nj| ‖𝒜^{-1/2} ℬ 𝒜^{-1/2}‖: what the errors of earlier levels are to that of level n.

use crate::quotients::quotients;
use algebra::linalg::largest;
use fem::contact::{Model, weighted_memory};
use vhi::history::TimeGrid;
use vhi::law::{Convolution, MemoryKernel};

/// β_nj, j = 0, …, n; zeros without memory.
pub(super) fn weights(model: &Model, grid: &TimeGrid, n: usize) -> Vec<f64> {
    let weight = |j: usize| {
        let of = |kernel: &dyn MemoryKernel| {
            model.time_rule.kernel_weight(&Convolution(kernel), grid, n, j)
        };
        let sum = weighted_memory(&model.memory, of, 2);
        sum.map_or(0.0, |sum| largest(&quotients(&sum, &model.elasticity, 2)))
    };
    (0..=n).map(weight).collect()
}
