//! Source: what each rule misses of ∫_0^t F ds, F(s) = q(t, s) u(s): (k/2)[F]_0^t by the left-endpoint rule,
//!   (k³/24)(F''(t) + F''(0)) by Gregory's of order 3, (19/720)k⁴[F''']_0^t by that of order 4.
//! Goal: the scenes of each rule have its order and the predicted error; wrong end weights and midpoint weights in the
//!   same place leave one of them.
//! Mesh, data: left-rule, gregory-three, gregory-four at n = 2, affine in space: nothing but time is discretised.

use crate::judged::foreseen;
use crate::shipped::{on_mesh, setup, v_max};
use crate::wrong::Weights;
use fem::contact::Model;
use scene::setup::Subject;
use scene::{Direction, Norm};
use vhi::history::{Gregory, GregoryOrder, Left, TimeGrid, TimeRule, Trapezoid};

/// Steps of a scene, and the order of its rule.
const SCENES: [(&str, u32, f64); 3] =
    [("left-rule", 64, 1.0), ("gregory-three", 32, 3.0), ("gregory-four", 16, 4.0)];

/// The share by which the main job lets an error in time differ from the predicted one.
const GATE: f64 = 1e-4;

/// Observed order between N and 2N steps, and the error at 2N over the predicted one.
fn measured(name: &str, steps: u32, order: f64, rule: Option<Box<dyn TimeRule>>) -> (f64, f64) {
    let sound = setup(name);
    let data = on_mesh(&sound, 2);
    let written = setup(name).model;
    let time_rule = rule.unwrap_or(written.time_rule);
    let model = Model { time_rule, ..setup(name).model };
    let [coarse, fine] = [steps, 2 * steps].map(|steps| v_max(&sound, &model, &data, steps));
    let subject = Subject::Contact(Box::new(sound));
    let told = foreseen(&subject, (Norm::VMax, Direction::K, order), Some(2), &[2 * steps]);
    ((coarse / fine).log2(), fine / told.points[0].error)
}

#[test]
fn each_rule_has_its_order_and_its_constant() {
    for (name, steps, order) in SCENES {
        let (observed, ratio) = measured(name, steps, order, None);
        // The next term is a share k of the leading one.
        assert!((observed - order).abs() < 0.1, "{name}: {observed}");
        assert!((ratio - 1.0).abs() < GATE, "{name}: {ratio}");
    }
}

/// Two steps at once by the value between them, the last of an odd number by the trapezoidal rule.
fn midpoint(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    let even = n - n % 2;
    let inside = if j % 2 == 1 && j < even { grid.step(j) + grid.step(j + 1) } else { 0.0 };
    let rest = if n > even && j >= even { 0.5 * grid.step(n) } else { 0.0 };
    inside + rest
}

fn three(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    Gregory { order: GregoryOrder::Three }.weight(grid, n, j)
}

fn four(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    Gregory { order: GregoryOrder::Four }.weight(grid, n, j)
}

/// Of each rule, weights that are wrong at an end or everywhere.
#[test]
fn wrong_weights_leave_the_order_or_the_constant() {
    type Wrong = (&'static str, &'static str, fn(&TimeGrid, usize, usize) -> f64);
    let defects: [Wrong; 9] = [
        ("left-rule", "midpoint weights", midpoint),
        ("left-rule", "trapezoidal weights", |g, n, j| Trapezoid.weight(g, n, j)),
        ("left-rule", "last weight k, first 0", |g, _, j| if j == 0 { 0.0 } else { g.step(j) }),
        ("gregory-three", "midpoint weights", midpoint),
        ("gregory-three", "last weight k/2", |g, n, j| {
            if j == n && n > 0 { 0.5 * g.step(n) } else { three(g, n, j) }
        }),
        ("gregory-three", "corrections of the last end with the other sign", |g, n, j| {
            let near = n - j <= 1;
            let sound = three(g, n, j);
            if near { 2.0 * Trapezoid.weight(g, n, j) - sound } else { sound }
        }),
        ("gregory-four", "midpoint weights", midpoint),
        ("gregory-four", "second differences left out", three),
        ("gregory-four", "last weight of Simpson's rule at every level", |g, n, j| {
            if j == n && n > 0 { g.step(n) / 3.0 } else { four(g, n, j) }
        }),
    ];
    for (name, defect, weight) in defects {
        let (_, steps, order) = SCENES.into_iter().find(|scene| scene.0 == name).expect("a scene");
        let (observed, ratio) = measured(name, steps, order, Some(Box::new(Weights(weight))));
        println!("{name}, {defect}: order {observed:.3}, {ratio:.3} times the prediction");
        // The gate on orders is 0.15. The right-hand rule has the order and, from u(0) = 0, the constant of the left one
        // but for a share k: the gate on constants sees that.
        // No number is no pass.
        let beyond = |off: f64, gate: f64| off.is_nan() || off.abs() >= gate;
        let caught = beyond(observed - order, 0.15) || beyond(ratio - 1.0, GATE);
        assert!(caught, "{name}, {defect}: {observed}, {ratio}");
    }
    // The sound weights, given in the same way, pass.
    for (name, weight) in [("gregory-three", three as fn(&_, _, _) -> _), ("gregory-four", four)] {
        let (_, steps, order) = SCENES.into_iter().find(|scene| scene.0 == name).expect("a scene");
        let (observed, ratio) = measured(name, steps, order, Some(Box::new(Weights(weight))));
        assert!((observed - order).abs() < 0.1 && (ratio - 1.0).abs() < GATE, "{name}: {ratio}");
    }
    let left = Weights(|g, n, j| Left.weight(g, n, j));
    let (_, ratio) = measured("left-rule", 64, 1.0, Some(Box::new(left)));
    assert!((ratio - 1.0).abs() < GATE, "{ratio}");
}
