//! Wrong elasticity: numbers, and a shear counted twice as an extra stress.

use algebra::tensor::Symmetric;
use fem::contact::{CaseError, CaseInfo, Model, Observer, march};
use scene::setup::{MeshData, Setup, TruthLoad, YieldFormula};
use vhi::Newton;
use vhi::law::{AnyProjection, Isotropic, Projection, Response, VonMises, YieldLimit};

use super::{Defect, Term, marched};

fn numbers(mut setup: Setup, change: fn(Isotropic) -> Isotropic) -> Setup {
    setup.model.elasticity = setup.model.elasticity.map(change);
    setup
}

/// No limit: the projection itself never acts.
struct Unlimited;

impl YieldLimit for Unlimited {
    fn value(&self, _: f64) -> f64 {
        f64::INFINITY
    }
    fn slope(&self, _: f64) -> f64 {
        0.0
    }
}

/// 2 μ_L ε_ij for i ≠ j once more.
struct ShearTwice {
    sound: Option<VonMises<YieldFormula>>,
    mu: f64,
}

/// Normal components in a Mandel vector of S.
fn normals(components: usize) -> usize {
    if components == 3 { 2 } else { 3 }
}

impl Projection for ShearTwice {
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
        Some(self.sound.limit().unwrap_or(&Unlimited))
    }
}

fn shear_twice(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let sound = setup.scene_model();
    // 2 μ_L ε_xy of a strain ε_xy = 1/√2.
    let mu = 0.5 * sound.elasticity.on(0).apply(&[0.0, 0.0, 1.0])[2];
    let twice = ShearTwice { sound: setup.scene_projection(), mu };
    let model = Model { projection: Some(AnyProjection::new(twice)), ..sound };
    let mut load = TruthLoad(&*data.truth);
    march(&data.space, &model, &setup.grid(steps), &mut load, &Newton::default(), observe)
}

pub fn defects() -> Vec<Defect> {
    let of = |name, program| Defect::of(Term::Elasticity, name, program);
    vec![
        of("Lamé numbers exchanged", |setup| {
            numbers(setup, |a| Isotropic { lambda: a.mu, mu: a.lambda })
        }),
        of("μ_L ε in place of 2 μ_L ε", |setup| {
            numbers(setup, |a| Isotropic { mu: 0.5 * a.mu, ..a })
        }),
        of("shear stress counted twice", |setup| marched(setup, shear_twice)),
        of("λ of plane stress", |setup| {
            numbers(setup, |a| {
                let lambda = 2.0 * a.lambda * a.mu / (a.lambda + 2.0 * a.mu);
                Isotropic { lambda, ..a }
            })
        }),
        of("trace without λ", |setup| numbers(setup, |a| Isotropic { lambda: 0.0, ..a })),
        of("μ_L off by 1e-4", |setup| {
            numbers(setup, |a| Isotropic { mu: a.mu * (1.0 + 1e-4), ..a })
        }),
        of("λ off by 1e-8", |setup| {
            numbers(setup, |a| Isotropic { lambda: a.lambda * (1.0 + 1e-8), ..a })
        }),
    ]
}
