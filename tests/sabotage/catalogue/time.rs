//! Wrong weights of the history, in time and in the kernel's argument.

use vhi::history::{TimeGrid, TimeRule, Trapezoid};
use vhi::law::HistoryKernel;

use super::{Defect, Term};
use crate::wrong::Rule;

/// A defect of the time rule, in contact and in abstract scenes.
fn seeded(rule: Rule, term: Term, name: &'static str) -> Defect {
    let of_body = rule.clone();
    let in_contact = term.of(name, move |setup| setup.model.time_rule = Box::new(of_body.clone()));
    let program = term.finite(name, move |setup| setup.model.time_rule = Box::new(rule.clone()));
    Defect { abstract_program: program.abstract_program, ..in_contact }
}

pub(super) fn sound(grid: &TimeGrid, n: usize, j: usize) -> f64 {
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

/// The rule of a Gregory scene with each weight changed by a function of it, n and j. Other scenes keep their rules.
fn corrected(name: &'static str, change: fn(f64, &TimeGrid, usize, usize) -> f64) -> Defect {
    Term::TimeRule.of(name, move |setup| {
        if matches!(setup.scene.time.rule, scene::TimeRule::Gregory { .. }) {
            let sound = std::mem::replace(&mut setup.model.time_rule, Box::new(Trapezoid));
            let changed = move |grid: &TimeGrid, n, j| change(sound.weight(grid, n, j), grid, n, j);
            setup.model.time_rule = Box::new(Rule::of(changed));
        }
    })
}

/// Levels that a shortened history keeps.
const KEPT: usize = 8;

pub fn defects() -> Vec<Defect> {
    let all = |name, weight: fn(&TimeGrid, usize, usize) -> f64| {
        seeded(Rule::of(weight), Term::TimeRule, name)
    };
    let zeta = |name, weight| seeded(Rule::zeta(weight), Term::Zeta, name);
    let memory = |name, weight: fn(&dyn HistoryKernel, &TimeGrid, usize, usize) -> f64| {
        seeded(Rule::memory(weight), Term::Memory, name)
    };
    vec![
        all("last weight k, not k/2", |grid, n, j| {
            sound(grid, n, j) * if j == n { 2.0 } else { 1.0 }
        }),
        all("first weight k, not k/2", |grid, n, j| {
            sound(grid, n, j) * if j == 0 { 2.0 } else { 1.0 }
        }),
        all("first weight 0, not k/2", |grid, n, j| if j == 0 { 0.0 } else { sound(grid, n, j) }),
        all("last weight alone, no sum over the past", |grid, n, j| {
            if j == n { sound(grid, n, j) } else { 0.0 }
        }),
        all("both end weights k", |grid, n, j| {
            sound(grid, n, j) * if j == 0 || j == n { 2.0 } else { 1.0 }
        }),
        all("all weights 1 % too large", |grid, n, j| 1.01 * sound(grid, n, j)),
        all(
            "right-hand rectangle rule",
            |grid, n, j| {
                if n == 0 || j == 0 { 0.0 } else { grid.step(j) }
            },
        ),
        all("left-hand rectangle rule", |grid, n, j| if j == n { 0.0 } else { grid.step(j + 1) }),
        all("last weight on the level before", lagged),
        all("weight of t_1 lost from n = 3 on", |grid, n, j| {
            if j == 1 && n > 2 { 0.0 } else { sound(grid, n, j) }
        }),
        all("weights of a uniform grid on any grid", |grid, n, j| {
            let step = grid.time(grid.steps()) / grid.steps() as f64;
            let ends = usize::from(j > 0) + usize::from(j < n);
            0.5 * step * ends as f64
        }),
        corrected("Gregory's correction at the end of t_n left out", |weight, grid, n, j| {
            if n - j < 3 && n > 5 { sound(grid, n, j) } else { weight }
        }),
        corrected("Gregory's correction at t = 0 left out", |weight, grid, n, j| {
            if j < 3 && n > 5 { sound(grid, n, j) } else { weight }
        }),
        corrected("Gregory's corrections with the wrong sign", |weight, grid, n, j| {
            2.0 * sound(grid, n, j) - weight
        }),
        corrected("Gregory's weights halfway to the trapezoidal rule's", |weight, grid, n, j| {
            0.5 * (sound(grid, n, j) + weight)
        }),
        all("midpoint weights: the even levels skipped", |grid, n, j| match (j % 2, n % 2) {
            (1, 0) => 2.0 * grid.step(j),
            (_, 0) => 0.0,
            // An odd number of steps: the last one by the trapezoidal rule.
            (1, _) if j < n => 2.0 * grid.step(j),
            _ if j + 1 >= n => 0.5 * grid.step(n),
            _ => 0.0,
        }),
        zeta("ζ explicit: its last weight on the level before", lagged),
        zeta(
            "ζ by the left-hand rectangle rule",
            |grid, n, j| {
                if j == n { 0.0 } else { grid.step(j + 1) }
            },
        ),
        memory("kernel at t_n - t_j + k", |q, grid, n, j| moved(q, grid, n, j, 1.0)),
        memory("kernel at t_n - t_j + k/2", |q, grid, n, j| moved(q, grid, n, j, 0.5)),
        memory("memory reset at T/2", |q, grid, n, j| {
            let half = 0.5 * grid.time(grid.steps());
            let forgotten = grid.time(n) > half && grid.time(j) < half;
            if forgotten { 0.0 } else { Trapezoid.kernel_weight(q, grid, n, j) }
        }),
        memory("memory of the last 8 levels only", |q, grid, n, j| {
            if n > j + KEPT { 0.0 } else { Trapezoid.kernel_weight(q, grid, n, j) }
        }),
        memory("memory of u_{j-1} in place of u_j", |q, grid, n, j| {
            if j == n { 0.0 } else { Trapezoid.kernel_weight(q, grid, n, j + 1) }
        }),
    ]
}
