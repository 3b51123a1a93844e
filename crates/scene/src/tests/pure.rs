//! The manufactured contact states at points of the bottom, checked with an independent quadrature: -σ_ν = p(u_ν) + λ
//! and σ_τ = 0 on Γ3 (pure scenes), u = 0 on Γ1, u_ν ≤ g, λ ≥ 0, λ (u_ν - g) = 0.

use super::shipped::shipped;
use crate::{Data, Scene};
use formula::{EvaluationPoint, Node, Variable};

/// Data of a pure scene; λ_L = μ_L = 1 and ℬ = -exp(-t)(0.5 ε + 0.25 tr ε I).
struct Pure {
    scene: Scene,
    u: Vec<Node>,
    /// ε_xx, ε_yy, ε_xy.
    strain: [Node; 3],
    multiplier: Option<Node>,
}

impl Pure {
    fn of(name: &str) -> Pure {
        let mut scene = shipped(name);
        let Data::Exact { u, multiplier, .. } = scene.as_contact().unwrap().data.clone() else {
            panic!("{name} has no exact solution")
        };
        let graph = &mut scene.formulas;
        let [xx, xy] = [Variable::X, Variable::Y].map(|v| graph.derivative(u[0], v));
        let [yx, yy] = [Variable::X, Variable::Y].map(|v| graph.derivative(u[1], v));
        let (sum, half) = (graph.add(xy, yx), graph.constant(0.5));
        let shear = graph.mul(half, sum);
        Pure {
            scene,
            u,
            strain: [xx, yy, shear],
            multiplier: multiplier.first().map(|(_, node)| *node),
        }
    }

    fn at(&self, node: Node, x: f64, y: f64, t: f64) -> f64 {
        self.scene
            .formulas
            .evaluate(node, &EvaluationPoint { x, y, t, ..EvaluationPoint::default() })
    }

    /// Elastic and remembered part of σ_yy and σ_xy; the projection adds nothing where ‖ε^D‖ ≤ κ.
    fn stress(&self, x: f64, y: f64, t: f64) -> [f64; 2] {
        let [xx, yy, xy] = self.strain.map(|node| self.at(node, x, y, t));
        let mut stress = [3.0 * yy + xx, 2.0 * xy];
        if !self.scene.as_contact().unwrap().material.memory.is_empty() {
            let intervals = 40;
            let step = t / f64::from(intervals);
            for j in 0..=intervals {
                let simpson =
                    if j == 0 || j == intervals { 1.0 } else { f64::from(2 + 2 * (j % 2)) };
                let time = step * f64::from(j);
                let weight = -(time - t).exp() * step * simpson / 3.0;
                let [xx, yy, xy] = self.strain.map(|node| self.at(node, x, y, time));
                stress[0] += weight * (0.75 * yy + 0.25 * xx);
                stress[1] += weight * 0.5 * xy;
            }
        }
        stress
    }

    fn compliance(&self, u_normal: f64) -> f64 {
        match self
            .scene
            .as_contact()
            .unwrap()
            .contact
            .first()
            .and_then(|contact| contact.law.as_ref())
        {
            None => 0.0,
            Some(_) if u_normal <= 0.0 => 0.0,
            Some(_) if u_normal <= 0.04 => 2.0 * u_normal,
            Some(_) => 0.08 - 0.5 * (u_normal - 0.04),
        }
    }

    fn check(&self, is_pure: bool) -> [bool; 3] {
        let mut seen = [false; 3];
        for (x, t) in
            [0.05, 0.3, 0.47, 0.95].into_iter().flat_map(|x| [0.0, 0.4, 1.0].map(|t| (x, t)))
        {
            let u_normal = -self.at(self.u[1], x, 0.0, t);
            let multiplier = self.multiplier.map_or(0.0, |node| self.at(node, x, 0.0, t));
            assert!(u_normal <= 0.08 + 1e-14 && multiplier >= 0.0);
            assert!((multiplier * (u_normal - 0.08)).abs() < 1e-14);
            assert!(
                self.u.iter().all(|&node| self.at(node, x, 1.0, t).abs() < 1e-15),
                "u on the clamped side"
            );
            if is_pure {
                let [normal, shear] = self.stress(x, 0.0, t);
                let pressure = self.compliance(u_normal) + multiplier;
                assert!(
                    (normal + pressure).abs() < 1e-5,
                    "x = {x}, t = {t}: {normal} and {pressure}"
                );
                assert!(shear.abs() < 1e-12);
                let yields = self.at(self.strain[1], x, 0.0, t).abs() / 2.0_f64.sqrt() > 0.10;
                assert!(!yields, "the projection acts on the bottom");
            }
            seen[0] |= u_normal < 0.0;
            seen[1] |= u_normal > 0.0 && u_normal < 0.08;
            seen[2] |= multiplier > 0.0;
        }
        seen
    }
}

/// The occurring states are those stated in the headers of the files.
#[test]
fn contact_states_are_the_ones_promised() {
    assert_eq!(Pure::of("steady").check(true), [false, true, true]);
    assert_eq!(Pure::of("compliance").check(true), [true, true, false]);
    assert_eq!(Pure::of("signorini").check(true), [true, true, true]);
    assert_eq!(Pure::of("pure-mild").check(true), [false, true, true]);
    assert_eq!(Pure::of("pure-strong").check(true), [true, true, true]);
    assert_eq!(Pure::of("sourced").check(false), [false, true, true]);
}
