//! A term that a scene does not have costs nothing, by the counters of a run.

use gronwall::contact::{CaseInfo, MemoryTerm, Plan, march};
use gronwall::law::ExponentialSum;
use gronwall::setup::{MeshData, Setup, TruthLoad};
use gronwall::vhi::Newton;

use super::shipped::{bodies, on_a_mesh};

const STEPS: u32 = 6;

fn run(setup: &Setup, data: &MeshData) -> CaseInfo {
    let (mut load, grid) = (TruthLoad(&*data.truth), setup.grid(STEPS));
    let newton = Newton::default();
    march(&data.space, &setup.model, &grid, &mut load, &newton, &mut |_| Ok(()))
        .unwrap_or_else(|error| panic!("{}: {error}", setup.scene.name))
}

/// What `info` counts for terms that `setup` is said not to have, one line each.
fn paid_for_nothing(setup: &Setup, data: &MeshData, info: &CaseInfo) -> Vec<String> {
    let model = &setup.model;
    let plan = Plan::of(&data.space, model, STEPS as usize, true);
    let linear = info.work.linear;
    let levels = STEPS + 1;
    let mut found = Vec::new();
    let mut zero = |absent: bool, what: &str, count: usize| {
        if absent && count != 0 {
            found.push(format!("{}: {count} {what}", setup.scene.name));
        }
    };
    let volume = plan == Plan::Newton;
    zero(setup.body.material.memory.is_empty(), "bytes of history", info.peak_history_bytes);
    zero(model.boundary.is_none(), "changes of the active set", info.active_set_changes as usize);
    zero(model.projection.is_none(), "assembled tangents", info.work.tangents as usize);
    zero(!volume, "residuals in the volume", info.work.residuals as usize);
    zero(true, "applications of Λ", info.fixed_point_iterations as usize);
    zero(true, "convex problems", info.convex_problems as usize);
    zero(true, "iterations without a factor", linear.iterations as usize);
    // One factor serves all levels but where the weight of the last slot changes it, at the first step.
    let factors = if Plan::changes_factor(model) { 2 } else { 1 };
    let spare = linear.factorizations.saturating_sub(factors);
    let uniform = setup.scene.time.grid == gronwall::scene::TimeGrid::Uniform;
    let one_matrix = plan == Plan::Condensed || model.is_linear();
    zero(one_matrix && uniform, "factorizations to spare", spare as usize);
    let passes = linear.solves.saturating_sub(levels);
    zero(!volume, "solves to spare", passes as usize);
    found
}

#[test]
fn absent_terms_cost_nothing() {
    // Scenes without memory, contact, projection; and those with, whose counters are not zero.
    let (mut without, mut with) = ([0; 3], [0; 3]);
    for setup in bodies() {
        let data = on_a_mesh(&setup);
        let info = run(&setup, &data);
        assert_eq!(paid_for_nothing(&setup, &data, &info), Vec::<String>::new());
        let terms = [
            (!setup.body.material.memory.is_empty(), info.peak_history_bytes),
            (setup.model.boundary.is_some(), info.active_set_changes as usize),
            (setup.model.projection.is_some(), info.work.tangents as usize),
        ];
        for (i, (present, count)) in terms.into_iter().enumerate() {
            if present {
                with[i] += usize::from(count > 0);
            } else {
                without[i] += 1;
            }
        }
    }
    // What is never counted could not be zero for a reason.
    assert!(without.iter().chain(&with).all(|&scenes| scenes >= 3), "{without:?} {with:?}");
}

/// A solver that keeps a memory of weight zero for a scene without one, and one that solves in the volume what needs no
/// more than a recursion, are found.
#[test]
fn a_term_that_is_paid_for_in_vain_is_found() {
    let mut setups = bodies().into_iter();
    let bare = |s: &Setup| s.body.material.memory.is_empty() && s.model.boundary.is_none();
    let mut setup = setups.find(bare).expect("a scene without memory and contact");
    let data = on_a_mesh(&setup);
    let kernel = Box::new(ExponentialSum { terms: vec![(0.0, 1.0)] });
    let tensor = setup.model.elasticity.clone();
    setup.model.memory.push(MemoryTerm { kernel, tensor });
    let found = paid_for_nothing(&setup, &data, &run(&setup, &data));
    assert!(found.iter().any(|line| line.contains("bytes of history")), "{found:?}");
    let sound = run(&setup, &data);
    let heavy = CaseInfo {
        work: gronwall::contact::Work { residuals: 3, tangents: 2, ..sound.work },
        active_set_changes: 1,
        ..sound
    };
    assert!(paid_for_nothing(&setup, &data, &heavy).len() >= 3);
}
