//! Source: tests/fixtures/nested.json by tests/independent/nested.py, which knows nothing of this program: double sums
//!   written out, loads by Gauss's rule within Gauss's rule, levels by bisection.
//! Goal: histories of histories, by the repeated left rule and as the displacement of backward Euler, are what another
//!   program finds. The repeated weights are the double sums. Wrong kernels and beginnings: docs/SABOTAGE.md.
//! Data: the scenes nested-left and short-memory.

use scene::setup::{AbstractLoad, AbstractSetup};
use vhi::Newton;
use vhi::finite::march;
use vhi::history::{Left, Memory, Right, TimeGrid, TimeRule, Trapezoid, last_weight};
use vhi::law::{ExponentialSum, MemoryKernel, Nested};

use crate::shipped::{abstract_of, fixture, number, text};

/// The largest difference of a component of u_0, …, u_N over the largest component.
fn off(setup: &AbstractSetup, name: &str) -> f64 {
    let known = fixture("nested");
    let steps = number(&known, "steps") as u32;
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    let mut see = |view: &vhi::finite::FiniteView<'_>| {
        for (i, found) in view.u.iter().enumerate() {
            let value = known[name][view.n][i].as_f64().expect("a number");
            largest = largest.max(value.abs());
            let off = (found - value).abs();
            worst = if off.is_nan() || off > worst { off } else { worst };
        }
    };
    let grid = setup.grid(steps);
    let info = march(&setup.model, &grid, &mut AbstractLoad(setup), &Newton::default(), &mut see);
    if info.is_err() { f64::INFINITY } else { worst / largest }
}

/// To 1e-9 of the largest: both solve the same discrete problem, the other program to the last digits.
#[test]
fn another_program_finds_the_same() {
    for name in ["nested-left", "short-memory"] {
        let off = off(&abstract_of(text(name)), name);
        println!("{name}: {off:.1e}");
        assert!(off <= 1e-9, "{name}: {off:e}");
    }
}

/// W_ni = Σ_{i ≤ j ≤ n} w_nj q(t_n - t_j) w_ji r(t_j - t_i), and the vectors of a march.
#[test]
fn repeated_sums_are_double_sums() {
    let kernel = |a: f64, c: f64| ExponentialSum { terms: vec![(a, c)] };
    let (q, r) = (kernel(-1.0, 1.0), kernel(2.0, 3.0));
    let nested = Nested { outer: Box::new(q.clone()), inner: Box::new(r.clone()) };
    let grids = [TimeGrid::uniform(1.0, 9), TimeGrid::random(1.0, 9, 4)];
    let rules: [&dyn TimeRule; 3] = [&Trapezoid, &Left, &Right];
    for (grid, rule) in grids.iter().flat_map(|grid| rules.map(|rule| (grid, rule))) {
        let mut memory = Memory::new(&nested, rule, grid, 1);
        let u = |j: usize| (3.0 * grid.time(j)).sin() + 0.2;
        for n in 0..=grid.steps() {
            let lag = |n: usize, j: usize| grid.time(n) - grid.time(j);
            let v = |j: usize| -> f64 {
                (0..=j).map(|i| rule.weight(grid, j, i) * r.value(lag(j, i)) * u(i)).sum()
            };
            let sum: f64 =
                (0..=n).map(|j| rule.weight(grid, n, j) * q.value(lag(n, j)) * v(j)).sum();
            let mut past = [7.0];
            memory.past(&nested, rule, grid, &mut past);
            let found = past[0] + last_weight(&nested, rule, grid, n) * u(n);
            memory.commit(grid, &[u(n)]);
            // Some fifty terms of size one.
            assert!((found - sum).abs() < 1e-14, "{n}: {found} {sum}");
        }
    }
    // ∫_0^t e^{-(t-s)} 2 e^{-3 s} ds = e^{-t} - e^{-3 t}, with the sign of q.
    let value = nested.value(0.7);
    assert!((value - ((-2.1f64).exp() - (-0.7f64).exp())).abs() < 1e-14, "{value}");
}
