//! Wrong weights of the history, in time and in the kernel's argument.

use vhi::history::{TimeGrid, TimeRule, Trapezoid};
use vhi::law::HistoryKernel;

use scene::setup::Setup;

use super::{Defect, Term};

/// Weights by a function, for ζ and for the memory.
struct Weights(fn(&TimeGrid, usize, usize) -> f64);

impl TimeRule for Weights {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        (self.0)(grid, n, j)
    }
}

/// Weights of ζ by a function, the memory by the trapezoidal rule.
struct ZetaWeights(fn(&TimeGrid, usize, usize) -> f64);

impl TimeRule for ZetaWeights {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        (self.0)(grid, n, j)
    }

    fn kernel_weight(&self, q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.kernel_weight(q, grid, n, j)
    }
}

/// Weights of the memory by a function, ζ by the trapezoidal rule.
struct KernelWeights(fn(&dyn HistoryKernel, &TimeGrid, usize, usize) -> f64);

impl TimeRule for KernelWeights {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.weight(grid, n, j)
    }

    fn kernel_weight(&self, q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        (self.0)(q, grid, n, j)
    }
}

fn sound(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    Trapezoid.weight(grid, n, j)
}

fn lagged(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    match n - j {
        0 => 0.0,
        1 => sound(grid, n, j) + sound(grid, n, n),
        _ => sound(grid, n, j),
    }
}

/// q at t_j moved by a share of the step that ends at t_n.
fn moved(q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize, share: f64) -> f64 {
    if n == 0 {
        return 0.0;
    }
    sound(grid, n, j) * q.at(grid.time(n), grid.time(j) - share * grid.step(n))
}

/// A defect of the time rule, in contact and in abstract scenes.
macro_rules! ruled {
    ($term:expr, $name:literal, $rule:expr) => {
        Defect {
            program: |mut setup| {
                setup.model.time_rule = Box::new($rule);
                setup
            },
            abstract_program: |mut setup| {
                setup.model.time_rule = Box::new($rule);
                setup
            },
            ..Defect::none($term, $name)
        }
    };
}

/// The rule of a Gregory scene with each weight changed by a function of it, n and j; other scenes keep their rules.
fn corrected(mut setup: Setup, change: fn(f64, &TimeGrid, usize, usize) -> f64) -> Setup {
    if matches!(setup.scene.time.rule, scene::TimeRule::Gregory { .. }) {
        let sound = std::mem::replace(&mut setup.model.time_rule, Box::new(Trapezoid));
        setup.model.time_rule = Box::new(Corrected { sound, change });
    }
    setup
}

struct Corrected {
    sound: Box<dyn TimeRule>,
    change: fn(f64, &TimeGrid, usize, usize) -> f64,
}

impl TimeRule for Corrected {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        (self.change)(self.sound.weight(grid, n, j), grid, n, j)
    }
}

/// Levels that a shortened history keeps.
const KEPT: usize = 8;

pub fn defects() -> Vec<Defect> {
    vec![
        ruled!(
            Term::TimeRule,
            "last weight k, not k/2",
            Weights(|grid, n, j| sound(grid, n, j) * if j == n { 2.0 } else { 1.0 })
        ),
        ruled!(
            Term::TimeRule,
            "first weight k, not k/2",
            Weights(|grid, n, j| sound(grid, n, j) * if j == 0 { 2.0 } else { 1.0 })
        ),
        ruled!(
            Term::TimeRule,
            "first weight 0, not k/2",
            Weights(|grid, n, j| if j == 0 { 0.0 } else { sound(grid, n, j) })
        ),
        ruled!(
            Term::TimeRule,
            "last weight alone, no sum over the past",
            Weights(|grid, n, j| if j == n { sound(grid, n, j) } else { 0.0 })
        ),
        ruled!(
            Term::TimeRule,
            "both end weights k",
            Weights(|grid, n, j| sound(grid, n, j) * if j == 0 || j == n { 2.0 } else { 1.0 })
        ),
        ruled!(
            Term::TimeRule,
            "all weights 1 % too large",
            Weights(|grid, n, j| 1.01 * sound(grid, n, j))
        ),
        ruled!(
            Term::TimeRule,
            "right-hand rectangle rule",
            Weights(|grid, n, j| if n == 0 || j == 0 { 0.0 } else { grid.step(j) })
        ),
        ruled!(
            Term::TimeRule,
            "left-hand rectangle rule",
            Weights(|grid, n, j| if j == n { 0.0 } else { grid.step(j + 1) })
        ),
        ruled!(Term::TimeRule, "last weight on the level before", Weights(lagged)),
        ruled!(
            Term::TimeRule,
            "weight of t_1 lost from n = 3 on",
            Weights(|grid, n, j| if j == 1 && n > 2 { 0.0 } else { sound(grid, n, j) })
        ),
        ruled!(
            Term::TimeRule,
            "weights of a uniform grid on any grid",
            Weights(|grid, n, j| {
                let step = grid.time(grid.steps()) / grid.steps() as f64;
                let ends = usize::from(j > 0) + usize::from(j < n);
                0.5 * step * ends as f64
            })
        ),
        Defect::of(Term::TimeRule, "Gregory's correction at the end of t_n left out", |setup| {
            corrected(setup, |weight, grid, n, j| match n - j {
                0..=2 if n > 5 => sound(grid, n, j),
                _ => weight,
            })
        }),
        Defect::of(Term::TimeRule, "Gregory's correction at t = 0 left out", |setup| {
            corrected(setup, |weight, grid, n, j| match j {
                0..=2 if n > 5 => sound(grid, n, j),
                _ => weight,
            })
        }),
        Defect::of(Term::TimeRule, "Gregory's corrections with the wrong sign", |setup| {
            corrected(setup, |weight, grid, n, j| 2.0 * sound(grid, n, j) - weight)
        }),
        Defect::of(
            Term::TimeRule,
            "Gregory's weights halfway to the trapezoidal rule's",
            |setup| corrected(setup, |weight, grid, n, j| 0.5 * (sound(grid, n, j) + weight)),
        ),
        ruled!(
            Term::TimeRule,
            "midpoint weights: the even levels skipped",
            Weights(|grid, n, j| match (j % 2, n % 2) {
                (1, 0) => 2.0 * grid.step(j),
                (_, 0) => 0.0,
                // An odd number of steps: the last one by the trapezoidal rule.
                (1, _) if j < n => 2.0 * grid.step(j),
                _ if j + 1 >= n => 0.5 * grid.step(n),
                _ => 0.0,
            })
        ),
        ruled!(Term::Zeta, "ζ explicit: its last weight on the level before", ZetaWeights(lagged)),
        ruled!(
            Term::Zeta,
            "ζ by the left-hand rectangle rule",
            ZetaWeights(|grid, n, j| if j == n { 0.0 } else { grid.step(j + 1) })
        ),
        ruled!(
            Term::Memory,
            "kernel at t_n - t_j + k",
            KernelWeights(|q, grid, n, j| moved(q, grid, n, j, 1.0))
        ),
        ruled!(
            Term::Memory,
            "kernel at t_n - t_j + k/2",
            KernelWeights(|q, grid, n, j| moved(q, grid, n, j, 0.5))
        ),
        ruled!(
            Term::Memory,
            "memory reset at T/2",
            KernelWeights(|q, grid, n, j| {
                let half = 0.5 * grid.time(grid.steps());
                let forgotten = grid.time(n) > half && grid.time(j) < half;
                if forgotten { 0.0 } else { Trapezoid.kernel_weight(q, grid, n, j) }
            })
        ),
        ruled!(
            Term::Memory,
            "memory of the last 8 levels only",
            KernelWeights(|q, grid, n, j| {
                if n > j + KEPT { 0.0 } else { Trapezoid.kernel_weight(q, grid, n, j) }
            })
        ),
        ruled!(
            Term::Memory,
            "memory of u_{j-1} in place of u_j",
            KernelWeights(|q, grid, n, j| {
                if j == n { 0.0 } else { Trapezoid.kernel_weight(q, grid, n, j + 1) }
            })
        ),
    ]
}
