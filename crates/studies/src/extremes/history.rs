//! Ladders of the history alone: relaxation times against steps, and the number of steps.
//!
//! The recursion I_n = e^{-ck}(I_{n-1} + (k/2) u_{n-1}) + (k/2) u_n is compared with Σ' e^{-c(n-j)k} u_j k, summed
//! with compensation.  A step of the recursion rounds six times (two products and two sums of each half, the
//! exponential, its argument), each by ε/2 of what I_n holds, and the factor e^{-ck} forgets: for u ≥ 0 the
//! relative error is below 3ε/(1 - e^{-ck}), and below 3εN for any c, to which the exponential adds ε from its
//! argument at most.

use super::rung::{Ladder, Measured, Relation, Rung, power_of_ten};
use super::under_test::{UnderTest, value};
use vhi::history::{Accumulated, TimeGrid, Trapezoid};

/// Roundings of a step in units of ε, and of the last exponential.
const ROUNDINGS: f64 = 3.0;

/// The sum in full, with Neumaier's compensation.
fn in_full(rate: f64, k: f64, steps: usize) -> f64 {
    let weight = |j: usize| if j == 0 || j == steps { 0.5 * k } else { k };
    let term = |j: usize| weight(j) * (-rate * ((steps - j) as f64 * k)).exp() * value(j);
    compensated((0..=steps).map(term))
}

/// Neumaier's sum: exact to ε of the result but for terms of order ε².
fn compensated(terms: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut lost) = (0.0f64, 0.0f64);
    for term in terms {
        let next = sum + term;
        lost += if sum.abs() >= term.abs() { (sum - next) + term } else { (term - next) + sum };
        sum = next;
    }
    sum + lost
}

/// 3ε min(N, 1/(1 - e^{-ck})) and 2ε for the sum in full.
fn allowed(rate: f64, k: f64, steps: usize) -> f64 {
    let remembered = (1.0 / -(-rate * k).exp_m1()).min(steps as f64);
    f64::EPSILON * (ROUNDINGS * remembered + 2.0 + ROUNDINGS)
}

fn against_the_sum(at: String, rate: f64, k: f64, steps: usize) -> Rung {
    Rung::new(at, Relation::AtMost(allowed(rate, k, steps)), move |under_test| {
        let full = in_full(rate, k, steps);
        let value = ((under_test.history)(rate, k, steps) - full).abs() / full;
        Ok(Measured::number(value))
    })
}

/// The kernel e^{-t} - w e^{-2t}: two recursions, and the difference of what they give.
pub(super) fn opposed(weight: f64, k: f64, steps: usize) -> Rung {
    let bound = allowed(1.0, k, steps).max(allowed(2.0, k, steps)) + f64::EPSILON;
    Rung::new(format!("{weight:e}"), Relation::AtMost(bound), move |under_test: &UnderTest<'_>| {
        let parts = [1.0, 2.0].map(|rate| in_full(rate, k, steps));
        let found = [1.0, 2.0].map(|rate| (under_test.history)(rate, k, steps));
        let difference = |[first, second]: [f64; 2]| first - weight * second;
        let magnitude = parts[0] + weight * parts[1];
        Ok(Measured::number((difference(found) - difference(parts)).abs() / magnitude))
    })
}

/// ck from 1e-12 (nothing is forgotten) to 1e12 (everything is, within a step).
pub(crate) fn relaxation() -> Ladder {
    const STEPS: usize = 1000;
    let exponents = [-12, -6, -3, -1, 0, 1, 2, 3, 6, 12];
    let rung = |e: i32| {
        let rate = power_of_ten(e) * STEPS as f64;
        against_the_sum(format!("1e{e}"), rate, 1.0 / STEPS as f64, STEPS)
    };
    Ladder {
        name: "relaxation",
        parameter: "step over relaxation time, N = 1000",
        quantity: "recursion − sum in full, relative",
        why: "rounding of a step times the steps that are remembered",
        rungs: exponents.into_iter().map(rung).collect(),
    }
}

/// N from 1e2 to 1e6 at cT = 1.
pub(crate) fn steps() -> Ladder {
    let rung = |e: i32| {
        let steps = 10usize.pow(e as u32);
        against_the_sum(format!("1e{e}"), 1.0, 1.0 / steps as f64, steps)
    };
    Ladder {
        name: "steps",
        parameter: "number of steps, T = τ",
        quantity: "recursion − sum in full, relative",
        why: "3ε a step that is remembered",
        rungs: (2..=6).map(rung).collect(),
    }
}

/// ζ_N of N from 1e2 to 1e6 against the sum with compensation: ε/2 each of product and sum per step.
pub(crate) fn accumulated() -> Ladder {
    let rung = |e: i32| {
        let steps = 10usize.pow(e as u32);
        let bound = f64::EPSILON * (steps as f64 + 4.0);
        Rung::new(format!("1e{e}"), Relation::AtMost(bound), move |_| {
            let grid = TimeGrid::uniform(1.0, steps as u32);
            let mut zeta = Accumulated::default();
            (0..=steps).for_each(|j| zeta.commit(&grid, value(j)));
            let weight = |j: usize| if j == 0 || j == steps { 0.5 } else { 1.0 };
            let full = compensated((0..=steps).map(|j| weight(j) * value(j))) / steps as f64;
            Ok(Measured::number((zeta.value(&Trapezoid, &grid) - full).abs() / full))
        })
    };
    Ladder {
        name: "zeta",
        parameter: "number of steps",
        quantity: "running ζ − sum in full, relative",
        why: "ε/2 a step for the sum, ε/2 for step sizes and values",
        rungs: (2..=6).map(rung).collect(),
    }
}
