//! Perturbed loads: the dual norm, the chain, and a constant that is too good.

use super::super::*;
use super::setup;
use crate::contact::{strain_norm, stress_force};
use crate::setup::MeshData;
use crate::space::strain_of;

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

#[test]
fn differences_stay_below_the_bounds_and_a_wrong_constant_is_caught() {
    for (name, n) in [("affine-locked", 4), ("punch", 8), ("long-growing", 4)] {
        let setup = setup(name);
        let data = MeshData::new(&setup, n, None).unwrap();
        let right = GronwallConstants::new(&setup).unwrap();
        let found = perturbations(&setup, &data, &right, 32).unwrap();
        assert_eq!(found.len(), 6);
        for own in &found {
            assert_eq!(own.violations, [], "{name} {:?} {}", own.shape, own.size);
            // Attained in long-growing: rounding decides.
            assert!(own.least_effectivity().unwrap() > 1.0 - 1e-12);
            // Something happened: the difference is far above the floor.
            assert!(own.growth() > 0.1 && own.load > 0.0);
        }
        // The least effectivities of random perturbations are 1.002, 1.55 and 1.65.
        let wrong = GronwallConstants { m0: 2.0 * right.m0, ..right };
        let found = perturbations(&setup, &data, &wrong, 32).unwrap();
        let caught = |own: &&Perturbation| {
            own.violations.iter().any(|v| v.link == "e <= weighted envelope" && v.left > v.right)
        };
        assert!(found.iter().filter(caught).any(|own| own.shape == Shape::Random), "{name}");
    }
}
