//! Wrong materials at the solver's model: each is refused by an order or by a predicted constant of the scene.

use judge::verdict::{Decision, Foreseen};
use scene::setup::Setup;
use vhi::law::{ExponentialSum, FourthOrder, Isotropic, TensorField};

use crate::judged::verdict;
use crate::shipped::setup;

/// The verdict of a scene on the grid of its file.
fn judged(setup: Setup) -> (Decision, String) {
    let verdict = verdict(setup);
    if let Some(Foreseen::Nothing { not_predicted }) = &verdict.foreseen {
        panic!("no constant is predicted: {not_predicted}");
    }
    (verdict.decision, verdict.reason)
}

fn exchanged(law: Isotropic) -> Isotropic {
    Isotropic { lambda: law.mu, mu: law.lambda }
}

fn shear_of(field: &TensorField, region: usize) -> f64 {
    match field.on(region) {
        FourthOrder::Isotropic(law) => law.mu,
        FourthOrder::Full(_) => f64::NAN,
    }
}

fn swapped(field: &TensorField) -> TensorField {
    TensorField::new(*field.on(1), [*field.on(0)])
}

#[test]
fn sound_materials_pass() {
    for name in super::SCENES {
        let (decision, reason) = judged(setup(name));
        assert_eq!(decision, Decision::Pass, "{name}: {reason}");
    }
}

/// A defect, seeded at the model of a scene.
type Defect = fn(&mut Setup);

#[test]
fn wrong_materials_fail() {
    let defects: [(&str, &str, Defect); 16] = [
        ("layered", "regions swapped", |s| {
            s.model.elasticity = swapped(&s.model.elasticity);
            s.model.memory[0].tensor = swapped(&s.model.memory[0].tensor);
        }),
        ("layered", "memory of the regions swapped", |s| {
            s.model.memory[0].tensor = swapped(&s.model.memory[0].tensor);
        }),
        ("layered", "shear modulus of the wrong region", |s| {
            let mu = shear_of(&s.model.elasticity, 0);
            s.model.elasticity = s.model.elasticity.map(|law| Isotropic { mu, ..law });
        }),
        ("layered", "no regions", |s| {
            s.model.elasticity = (*s.model.elasticity.on(0)).into();
        }),
        ("layered", "Lamé numbers exchanged", |s| {
            s.model.elasticity = s.model.elasticity.map(exchanged);
        }),
        ("layered-in-space", "elasticity of the regions swapped", |s| {
            s.model.elasticity = swapped(&s.model.elasticity);
        }),
        ("layered-in-space", "kernels of the regions exchanged", |s| {
            let [lower, upper] = &mut s.model.memory[..] else { panic!("two terms") };
            std::mem::swap(&mut lower.kernel, &mut upper.kernel);
        }),
        ("orthotropic", "one coupling of shear dropped", |s| {
            let FourthOrder::Full(mut matrix) = *s.model.elasticity.on(0) else { return };
            (matrix[0][2], matrix[2][0]) = (0.0, 0.0);
            s.model.elasticity = FourthOrder::Full(matrix).into();
        }),
        ("orthotropic", "shear entry without the 2 of Mandel's notation", |s| {
            let FourthOrder::Full(mut matrix) = *s.model.elasticity.on(0) else { return };
            matrix[2][2] *= 0.5;
            s.model.elasticity = FourthOrder::Full(matrix).into();
        }),
        ("bulk-shear", "kernels of bulk and shear exchanged", |s| {
            let [bulk, shear] = &mut s.model.memory[..] else { panic!("two terms") };
            std::mem::swap(&mut bulk.kernel, &mut shear.kernel);
        }),
        ("bulk-shear", "shear on the whole strain", |s| {
            s.model.memory[1].tensor = Isotropic { lambda: 0.0, mu: 1.0 }.into();
        }),
        ("bulk-shear", "bulk lost", |s| drop(s.model.memory.remove(0))),
        ("bulk-shear", "shear lost", |s| drop(s.model.memory.remove(1))),
        ("prony", "times exchanged", |s| {
            let terms = vec![(-1.0, 0.5), (-0.3, 5.0)];
            s.model.memory[0].kernel = Box::new(ExponentialSum { terms });
        }),
        ("prony", "Lamé numbers of the memory exchanged", |s| {
            s.model.memory[0].tensor = s.model.memory[0].tensor.map(exchanged);
        }),
        ("power-law", "Lamé numbers exchanged", |s| {
            s.model.elasticity = s.model.elasticity.map(exchanged);
        }),
    ];
    for (name, defect, seed) in defects {
        let mut setup = setup(name);
        seed(&mut setup);
        let (decision, reason) = judged(setup);
        assert_eq!(decision, Decision::Fail, "{name}, {defect}: {reason}");
    }
}
