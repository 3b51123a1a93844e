//! Wrong weights of kernels (t-s)^{-a} b that are infinite at s = t.

use scene::setup::Setup;
use vhi::history::{ProductIntegration, TimeGrid, TimeRule, Trapezoid};
use vhi::law::{HistoryKernel, MemoryKernel, Singular};

use super::{Defect, Term};

/// Weights over b(t_n, t_j), from a, the grid, n and j.
struct Weights(fn(f64, &TimeGrid, usize, usize) -> f64);

impl TimeRule for Weights {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.weight(grid, n, j)
    }

    fn kernel_weight(&self, q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        (self.0)(q.power(), grid, n, j) * q.factor(grid.time(n), grid.time(j))
    }
}

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

/// 1.01 b of a kernel.
struct Stronger(Box<dyn MemoryKernel>);

impl MemoryKernel for Stronger {
    fn value(&self, lag: f64) -> f64 {
        1.01 * self.0.factor(lag)
    }
}

fn has_power(setup: &Setup) -> bool {
    setup.model.memory.iter().any(|term| term.kernel.power() > 0.0)
}

macro_rules! weighed {
    ($name:literal, $weights:expr) => {
        Defect::of(Term::Memory, $name, |mut setup| {
            if has_power(&setup) {
                setup.model.time_rule = Box::new(Weights($weights));
            }
            setup
        })
    };
}

pub fn defects() -> Vec<Defect> {
    vec![
        weighed!("singular kernel: last weight of the other end", |a, grid, n, j| match j == n {
            true => (1.0 - a) * sound(a, grid, n, j),
            false => sound(a, grid, n, j),
        }),
        weighed!("singular kernel: trapezoidal, its power at midpoints", |a, grid, n, j| {
            let before = if j > 0 { at_middle(a, grid, n, j) } else { 0.0 };
            before + if j < n { at_middle(a, grid, n, j + 1) } else { 0.0 }
        }),
        weighed!("singular kernel: exponent 1 % too small", |a, grid, n, j| {
            sound(0.99 * a, grid, n, j)
        }),
        Defect::of(Term::Memory, "singular kernel: factor 1 % too strong", |mut setup| {
            for term in &mut setup.model.memory {
                let power = term.kernel.power();
                if power > 0.0 {
                    let sound = std::mem::replace(&mut term.kernel, Box::new(Nothing));
                    let factor = Box::new(Stronger(sound));
                    term.kernel = Box::new(Singular { power, factor });
                }
            }
            setup
        }),
    ]
}

struct Nothing;

impl MemoryKernel for Nothing {
    fn value(&self, _: f64) -> f64 {
        0.0
    }
}
