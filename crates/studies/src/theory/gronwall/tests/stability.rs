//! Perturbed loads: the dual norm, the chain, and a constant that is too good.

use super::super::scenes::FiniteInTime;
use super::super::study::{Bounded, perturbations, stability};
use super::super::*;
use super::{setup, subject};
use crate::theory::norms::DualNorm;
use algebra::linalg::largest;
use fem::contact::{strain_norm, stress_force};
use fem::space::strain_of;
use judge::claim::Standing;
use scene::setup::{MeshData, Subject};

/// F(v) = (ε(w), ε(v)) has the dual norm ‖ε(w)‖.
#[test]
fn the_dual_norm_of_a_riesz_image_is_the_norm() {
    let data = MeshData::new(&setup("punch"), 8, None).unwrap();
    let space = &data.space;
    let mut w: Vec<f64> = (0..space.dofs()).map(|i| (0.3 * i as f64).sin()).collect();
    w.resize(space.nodes.len(), 0.0);
    let mut force = vec![0.0; space.nodes.len()];
    for c in 0..space.mesh.cell_count() {
        let (gradients, nodes) = (space.geometry.gradients(c), space.cell_nodes(c));
        let stress = strain_of::<3>(gradients, nodes, &w).map(|e| e * space.geometry.measure[c]);
        stress_force::<2, 3>(gradients, nodes, &stress, &mut force);
    }
    let dual = DualNorm::new(space).unwrap().of(&force[..space.dofs()]);
    assert!((dual / strain_norm(space, &w) - 1.0).abs() < 1e-12);
}

fn is_caught(found: &[Bounded]) -> bool {
    found.iter().any(|run| stability(run, None).standing() == Standing::Fails)
}

fn all_hold(found: &[Bounded], name: &str) {
    assert_eq!(found.len(), 3);
    for run in found {
        let claim = stability(run, None);
        assert_eq!(claim.standing(), Standing::Passes, "{name} {:?}", claim.reason());
        // Something happened: the difference is far above the floor.
        let [load, difference] = [&run.estimate.source, &run.estimate.error].map(|v| largest(v));
        assert!(run.estimate.m0 * difference > 0.1 * load && load > 0.0, "{name} {difference}");
    }
}

/// Random perturbations come within a factor 1.002, 1.55 and 1.65 of the bound: twice m0 is too much.
#[test]
fn differences_stay_below_the_bounds_and_a_wrong_constant_is_caught() {
    for (name, n) in [("affine-locked", 4), ("punch", 8), ("long-growing", 4)] {
        let setup = setup(name);
        let mut scene = ContactInTime::new(&setup, n, &[32]).unwrap();
        all_hold(&perturbations(&scene, 32).unwrap(), name);
        scene.constants.m0 *= 2.0;
        assert!(is_caught(&perturbations(&scene, 32).unwrap()), "{name}");
    }
}

#[test]
fn the_same_in_r_m() {
    let Subject::Abstract(setup) = subject("abstract-contact") else { panic!("no body") };
    let mut scene = FiniteInTime::new(&setup).unwrap();
    all_hold(&perturbations(&scene, 64).unwrap(), "abstract-contact");
    scene.constants[0] *= 2.0;
    assert!(is_caught(&perturbations(&scene, 64).unwrap()));
}
