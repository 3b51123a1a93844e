//! A factor that all grids in time have in common is made once a mesh.

use fem::contact::Plan;
use run::sweep::{CasePlan, run_contact_case};
use scene::Norm;
use scene::setup::{MeshData, Setup};

use super::shipped::{on_mesh, run, setup};

const STEPS: [u32; 3] = [4, 8, 6];

/// Displacements of all levels of a run, and the factorizations that it counts.
fn levels(setup: &Setup, data: &MeshData, steps: u32) -> (Vec<f64>, u32) {
    let mut all = Vec::new();
    let info = run(setup, &setup.model, data, steps, |view| all.extend_from_slice(view.u));
    (all, info.unwrap_or_else(|error| panic!("{error}")).work.linear.factorizations)
}

#[test]
fn runs_on_a_mesh_share_the_factor_and_have_the_solution_of_a_run_alone() {
    for (name, plan) in [("linear-punch", Plan::Linear), ("elastic-punch", Plan::Condensed)] {
        let setup = setup(name);
        let data = on_mesh(&setup, 8);
        assert_eq!(Plan::of(&data.space, &setup.model), plan, "{name}");
        for steps in STEPS {
            let shared = levels(&setup, &data, steps);
            // What a run counts does not depend on what ran before it.
            assert_eq!(shared, levels(&setup, &on_mesh(&setup, 8), steps), "{name}");
            assert_eq!((shared.1, data.space.stiffness_factors_made()), (1, 1), "{name}");
        }
    }
}

/// Where the matrix depends on the step there is nothing to share.
#[test]
fn a_matrix_that_depends_on_the_step_is_factorized_by_each_run() {
    for name in ["punch", "bulk-shear"] {
        let setup = setup(name);
        assert!(Plan::changes_factor(&setup.model) || setup.model.projection.is_some(), "{name}");
        let data = on_mesh(&setup, 8);
        for steps in STEPS {
            assert_eq!(levels(&setup, &data, steps), levels(&setup, &on_mesh(&setup, 8), steps));
        }
        assert_eq!(data.space.stiffness_factors_made(), 0, "{name}");
    }
}

/// Another body on the same mesh has another factor, whichever came first.
#[test]
fn another_tensor_has_another_factor() {
    for name in ["linear-punch", "elastic-punch"] {
        let mut body = setup(name);
        let data = on_mesh(&body, 8);
        let (soft, _) = levels(&body, &data, 4);
        body.model.elasticity = body.model.elasticity.scaled(2.0);
        let (stiff, _) = levels(&body, &data, 4);
        assert_eq!(data.space.stiffness_factors_made(), 2, "{name}");
        assert_eq!(stiff, levels(&body, &on_mesh(&body, 8), 4).0, "{name}");
        assert_ne!(stiff, soft, "{name}");
        // Let go, it is made anew.
        data.space.forget_factors();
        assert_eq!(levels(&body, &data, 4).0, stiff, "{name}");
        assert_eq!(data.space.stiffness_factors_made(), 3, "{name}");
    }
}

/// Whole cases with their errors, finer runs for the time error, rule checks and projections: one factor of 𝒜 in each
/// order that is asked for, whatever the number of steps.
#[test]
fn whole_cases_share_what_the_mesh_holds() {
    // `orthotropic` has 𝒜 alone; the levels of `compliance` are condensed, its loads are checked by 𝒜 in the other order.
    for (name, factors) in [("orthotropic", 1), ("compliance", 2)] {
        let setup = setup(name);
        let data = on_mesh(&setup, 8);
        for steps in STEPS {
            let norms = vec![Norm::VMax, Norm::VTimeMax, Norm::VProjectionMax];
            let record = run_contact_case(&setup, &data, &CasePlan { n: Some(8), steps, norms });
            assert!(record.converged(), "{name}: {:?}", record.status);
            assert_eq!(record.factorizations, 1, "{name}");
        }
        assert_eq!(data.space.stiffness_factors_made(), factors, "{name}");
    }
}
