//! Wrong elasticity: numbers, and a shear counted twice as an extra stress.

use algebra::tensor::Symmetric;
use fem::contact::Model;
use scene::setup::YieldFormula;
use vhi::law::{AnyProjection, Isotropic, Projection, Response, VonMises, YieldLimit};

use super::Term::Elasticity;
use super::{Defect, Marched, Run};
use crate::wrong::Limit;

fn numbers(name: &'static str, change: fn(Isotropic) -> Isotropic) -> Defect {
    Elasticity.of(name, move |setup| {
        setup.model.elasticity = setup.model.elasticity.map(change);
    })
}

/// 2 μ_L ε_ij for i ≠ j once more.
struct ShearTwice<L> {
    sound: Option<VonMises<YieldFormula>>,
    mu: f64,
    unlimited: L,
}

/// Normal components in a Mandel vector of S.
fn normals(components: usize) -> usize {
    if components == 3 { 2 } else { 3 }
}

impl<L: YieldLimit> Projection for ShearTwice<L> {
    fn stress<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Symmetric<S>> {
        let mut stress = self.sound.stress(strain, kappa).unwrap_or([0.0; S]);
        for i in normals(S)..S {
            stress[i] += 2.0 * self.mu * strain[i];
        }
        Some(stress)
    }

    fn response<const S: usize>(&self, strain: &Symmetric<S>, kappa: f64) -> Option<Response<S>> {
        let absent = Response { stress: [0.0; S], tangent: [[0.0; S]; S], by_limit: [0.0; S] };
        let mut response = self.sound.response(strain, kappa).unwrap_or(absent);
        for i in normals(S)..S {
            response.stress[i] += 2.0 * self.mu * strain[i];
            response.tangent[i][i] += 2.0 * self.mu;
        }
        Some(response)
    }

    fn limit(&self) -> Option<&dyn YieldLimit> {
        Some(self.sound.limit().unwrap_or(&self.unlimited))
    }
}

fn shear_twice(run: Run<'_>) -> Marched {
    let (setup, data) = (run.setup, run.data);
    let sound = setup.scene_model();
    // 2 μ_L ε_xy of a strain ε_xy = 1/√2.
    let mu = 0.5 * sound.elasticity.on(0).apply(&[0.0, 0.0, 1.0])[2];
    // No limit: the projection itself never acts.
    let unlimited = Limit { value: |_| f64::INFINITY, slope: |_| 0.0 };
    let twice = ShearTwice { sound: setup.scene_projection(), mu, unlimited };
    run.on(&data.space, &Model { projection: Some(AnyProjection::new(twice)), ..sound })
}

pub fn defects() -> Vec<Defect> {
    vec![
        numbers("Lamé numbers exchanged", |a| Isotropic { lambda: a.mu, mu: a.lambda }),
        numbers("μ_L ε in place of 2 μ_L ε", |a| Isotropic { mu: 0.5 * a.mu, ..a }),
        Elasticity.run("shear stress counted twice", shear_twice),
        numbers("λ of plane stress", |a| Isotropic {
            lambda: 2.0 * a.lambda * a.mu / (a.lambda + 2.0 * a.mu),
            ..a
        }),
        numbers("trace without λ", |a| Isotropic { lambda: 0.0, ..a }),
        numbers("μ_L off by 1e-4", |a| Isotropic { mu: a.mu * (1.0 + 1e-4), ..a }),
        numbers("λ off by 1e-8", |a| Isotropic { lambda: a.lambda * (1.0 + 1e-8), ..a }),
    ]
}
