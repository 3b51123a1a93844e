//! Source: what each rule misses of ∫_0^t F ds, F(s) = q(t, s) u(s): (k/2)[F]_0^t by the left-endpoint rule,
//!   (k³/24)(F''(t) + F''(0)) by Gregory's of order 3, (19/720)k⁴[F''']_0^t by that of order 4.
//! Goal: the scenes of each rule have its order and the predicted error. Wrong weights: docs/SABOTAGE.md.
//! Mesh, data: left-rule, gregory-three, gregory-four at n = 2, affine in space: nothing but time is discretised.

use crate::judged::foreseen;
use crate::shipped::{on_mesh, setup, v_max};
use scene::setup::Subject;
use scene::{Direction, Norm};

/// Steps of a scene, and the order of its rule.
const SCENES: [(&str, u32, f64); 3] =
    [("left-rule", 64, 1.0), ("gregory-three", 32, 3.0), ("gregory-four", 16, 4.0)];

/// The share by which the main job lets an error in time differ from the predicted one.
const GATE: f64 = 1e-4;

/// The order between N and 2N steps, and the error at 2N over the predicted one.
#[test]
fn each_rule_has_its_order_and_its_constant() {
    for (name, steps, order) in SCENES {
        let sound = setup(name);
        let data = on_mesh(&sound, 2);
        let [coarse, fine] = [steps, 2 * steps].map(|n| v_max(&sound, &sound.model, &data, n));
        let subject = Subject::Contact(Box::new(sound));
        let told = foreseen(&subject, (Norm::VMax, Direction::K, order), Some(2), &[2 * steps]);
        let (observed, ratio) = ((coarse / fine).log2(), fine / told.points[0].error);
        // The next term is a share k of the leading one.
        assert!((observed - order).abs() < 0.1, "{name}: {observed}");
        assert!((ratio - 1.0).abs() < GATE, "{name}: {ratio}");
    }
}
