//! Wrong weights of kernels (t-s)^{-a} b that are infinite at s = t.

use vhi::history::{ProductIntegration, TimeGrid, TimeRule};
use vhi::law::{HistoryKernel, Singular};

use super::memory::kernels;
use super::{Defect, Term};
use crate::wrong::{Kernel, Rule};

/// (t-s)^{-a} alone.
struct Power(f64);

impl HistoryKernel for Power {
    fn at(&self, t: f64, s: f64) -> f64 {
        (t - s).powf(-self.0)
    }
    fn power(&self) -> f64 {
        self.0
    }
    fn factor(&self, _: f64, _: f64) -> f64 {
        1.0
    }
}

fn sound(a: f64, grid: &TimeGrid, n: usize, j: usize) -> f64 {
    ProductIntegration.kernel_weight(&Power(a), grid, n, j)
}

/// The half of step i with the power at its middle.
fn at_middle(a: f64, grid: &TimeGrid, n: usize, i: usize) -> f64 {
    let k = grid.step(i);
    0.5 * k * (grid.lag(n, i) + 0.5 * k).powf(-a)
}

/// Weights over b(t_n, t_j), from a, the grid, n and j.
fn weighed(name: &'static str, weights: fn(f64, &TimeGrid, usize, usize) -> f64) -> Defect {
    Term::Memory.of(name, move |setup| {
        if setup.model.memory.iter().any(|term| term.kernel.power() > 0.0) {
            setup.model.time_rule = Box::new(Rule::memory(move |q, grid, n, j| {
                weights(q.power(), grid, n, j) * q.factor(grid.time(n), grid.time(j))
            }));
        }
    })
}

pub fn defects() -> Vec<Defect> {
    vec![
        weighed("singular kernel: last weight of the other end", |a, grid, n, j| {
            sound(a, grid, n, j) * if j == n { 1.0 - a } else { 1.0 }
        }),
        weighed("singular kernel: trapezoidal, its power at midpoints", |a, grid, n, j| {
            let before = if j > 0 { at_middle(a, grid, n, j) } else { 0.0 };
            before + if j < n { at_middle(a, grid, n, j + 1) } else { 0.0 }
        }),
        weighed("singular kernel: exponent 1 % too small", |a, grid, n, j| {
            sound(0.99 * a, grid, n, j)
        }),
        kernels("singular kernel: factor 1 % too strong", |sound| match sound.power() {
            0.0 => sound,
            power => {
                let factor = Box::new(Kernel::of(move |lag| 1.01 * sound.factor(lag)));
                Box::new(Singular { power, factor })
            }
        }),
    ]
}
