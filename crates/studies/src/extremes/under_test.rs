//! The parts that the ladders test; a test passes in wrong ones.

use super::Prepare;
use vhi::Newton;
use vhi::history::{Memory, TimeGrid, Trapezoid};
use vhi::law::ExponentialSum;

/// The parts under test.
pub struct UnderTest<'a> {
    /// Puts the solver into a setup of a body.
    pub prepare: &'a Prepare<'a>,
    /// Solves the levels of abstract scenes, and of the iteration Λ.
    pub newton: Newton,
    /// The history sum of step N by the rate of its kernel, the step and N, see [`by_recursion`].
    pub history: &'a (dyn Fn(f64, f64, usize) -> f64 + Sync),
}

impl Default for UnderTest<'_> {
    fn default() -> Self {
        Self { prepare: &|setup| setup, newton: Newton::default(), history: &by_recursion }
    }
}

/// u_j of the past: positive, so that sums do not cancel and relative errors mean something.
pub(super) fn value(j: usize) -> f64 {
    1.0 + (0.7 * j as f64).sin().powi(2)
}

/// Σ'_j e^{-c(t_N - t_j)} u_j k of the past and the last slot, as the recursion gives it.
pub fn by_recursion(rate: f64, k: f64, steps: usize) -> f64 {
    let kernel = ExponentialSum { terms: vec![(1.0, rate)] };
    let grid = TimeGrid::uniform(k * steps as f64, steps as u32);
    let mut memory = Memory::new(&kernel, &Trapezoid, &grid, 1);
    for j in 0..steps {
        memory.commit(&grid, &[value(j)]);
    }
    let mut past = [0.0];
    memory.past(&kernel, &Trapezoid, &grid, &mut past);
    past[0] + 0.5 * k * value(steps)
}
