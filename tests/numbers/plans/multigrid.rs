//! Factors and conjugate gradients with multigrid, for every scene with a mesh that has levels.

use fem::contact::{LinearSolver, MULTIGRID_RATIO, Plan};
use fem::space::Element;
use scene::setup::{MeshData, Setup};
use vhi::{Newton, StepSolver};

use super::anew::defective;
use super::{AGREE, Run, Where, distance, run};
use crate::shipped::bodies;

const STEPS: u32 = 8;

/// The coarsest mesh of a scene that has levels.
fn with_levels(setup: &Setup) -> Option<MeshData> {
    let tried: &[u32] = if setup.scene.dimension == 2 { &[16, 24, 32] } else { &[6, 8] };
    let has = |&&n: &&u32| setup.space(n).is_ok_and(|space| space.levels().is_some());
    tried.iter().find(has).map(|&n| crate::shipped::on_mesh(setup, n))
}

fn by(setup: &mut Setup, data: &MeshData, solver: LinearSolver, newton: &dyn StepSolver) -> Run {
    setup.linear_solver = Some(solver);
    let data = crate::shipped::on_mesh(setup, data.space.mesh.n);
    assert_eq!(LinearSolver::of(&data.space, &setup.model, STEPS as usize), solver);
    run(setup, &data, STEPS, Where::Shortest, newton)
}

#[test]
#[ignore = "seconds for each scene: make test-long"]
fn long_factors_and_multigrid_have_the_same_solution_on_all_scenes() {
    let (mut taken, mut without) = ([0; 4], Vec::new());
    for mut setup in bodies() {
        let name = setup.scene.name.clone();
        let softer = setup.model.elasticity.ratio(setup.scene.dimension) <= MULTIGRID_RATIO;
        let Some(data) = with_levels(&setup).filter(|_| softer) else {
            without.push(name);
            continue;
        };
        let direct = by(&mut setup, &data, LinearSolver::Direct, &Newton::default());
        let multigrid = by(&mut setup, &data, LinearSolver::Multigrid, &Newton::default());
        taken[Plan::of(&data.space, &setup.model, STEPS as usize, true) as usize] += 1;
        let (of_direct, of_multigrid) = (direct.info.work.linear, multigrid.info.work.linear);
        let off = distance(&direct, &multigrid);
        assert!(of_direct.iterations == 0 && of_direct.factorizations > 0, "{name}");
        assert!(of_multigrid.iterations > 0, "{name}");
        assert!(off <= AGREE, "{name}: {off:e}");
    }
    // Every plan has scenes that multigrid takes over; a mesh from a file refines nothing that is known, other elements
    // than linear ones have no transfers, and eigenvalues 10⁶ apart are too far for single precision.
    assert!(taken.iter().all(|&count| count >= 4), "{taken:?}");
    without.retain(|name| crate::shipped::setup(name).body.element == Element::P1);
    assert_eq!(without, ["frustum", "frustum-affine", "locking-linear"]);
}

#[test]
fn a_seeded_defect_in_multigrid_is_seen() {
    for name in ["punch", "viscoelastic", "elastic-punch"] {
        let mut setup = crate::shipped::setup(name);
        let data = with_levels(&setup).expect("a scene with levels");
        let direct = by(&mut setup, &data, LinearSolver::Direct, &Newton::default());
        let wrong = by(&mut setup, &data, LinearSolver::Multigrid, &defective());
        let off = distance(&direct, &wrong);
        assert!(off > 2.0 * AGREE, "{name}: {off:e}");
    }
}
