//! The sums over the past of a kernel that is no sum of exponentials.

use vhi::history::{Memory, TimeGrid, Trapezoid};
use vhi::law::MemoryKernel;

struct Power;

impl MemoryKernel for Power {
    fn value(&self, lag: f64) -> f64 {
        -(1.0 + 4.0 * lag).powf(-1.5)
    }
}

/// The last of the sums over all levels, by interpolation.
pub fn sums(grid: &TimeGrid, u: &[f64]) -> Vec<f64> {
    let mut memory = Memory::new(&Power, &Trapezoid, grid, u.len());
    let mut past = vec![0.0; u.len()];
    for _ in 0..=grid.steps() {
        memory.past(&Power, &Trapezoid, grid, &mut past);
        memory.commit(grid, u);
    }
    past
}
