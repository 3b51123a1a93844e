//! A term that a scene does not have costs nothing, by the counters of a run.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use algebra::tensor::Symmetric;
use fem::contact::{BoundaryRule, CaseInfo, MemoryTerm, Model, Plan, march};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::history::{TimeGrid, TimeRule};
use vhi::law::{
    AnyProjection, ExponentialSum, HistoryKernel, NoPotential, Potential, Projection, Response,
    YieldLimit,
};
use vhi::{InVolume, Newton};

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
    let plan = Plan::of(&data.space, model);
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
    // Without bound and jumps a graph is one piece; that of friction jumps at rest.
    let one_piece = model.friction.is_none()
        && model.boundary.iter().all(|boundary| {
            let points = data.space.trace.points.iter();
            let mut places = points.map(|point| data.space.mesh.point(&[point.vertex], &[1.0]));
            boundary.potential.jumps().is_empty()
                && places.all(|x| (boundary.gap)(x, 0.0).is_infinite())
        });
    zero(one_piece, "changes of the active set", info.active_set_changes as usize);
    zero(model.projection.is_none(), "assembled tangents", info.work.tangents as usize);
    zero(!volume, "residuals in the volume", info.work.residuals as usize);
    zero(true, "applications of Λ", info.fixed_point_iterations as usize);
    zero(true, "convex problems", info.convex_problems as usize);
    // One factor serves all levels but where the weight of the last slot changes it: at the first step, and with Gregory's
    // rules of order p at each of the first p - 1 steps.
    let factors = match setup.scene.time.rule {
        _ if !Plan::changes_factor(model) => 1,
        scene::TimeRule::Gregory { order } => order,
        _ => 2,
    };
    let spare = linear.factorizations.saturating_sub(factors);
    let uniform = setup.scene.time.grid == scene::TimeGrid::Uniform;
    zero(!volume && uniform, "factorizations to spare", spare as usize);
    let passes = linear.solves.saturating_sub(levels);
    zero(!volume, "solves to spare", passes as usize);
    found
}

#[test]
fn absent_terms_cost_nothing() {
    // Scenes without memory, contact, projection; and those with, whose counters are not zero.
    let (mut without, mut with, mut recursive) = ([0; 3], [0; 3], [0; 2]);
    for setup in bodies() {
        let data = on_a_mesh(&setup);
        let info = run(&setup, &data);
        assert_eq!(paid_for_nothing(&setup, &data, &info), Vec::<String>::new());
        let terms = [
            (!setup.body.material.memory.is_empty(), info.peak_history_bytes),
            (!setup.model.boundary.is_empty(), info.active_set_changes as usize),
            (setup.model.projection.is_some(), info.work.tangents as usize),
        ];
        for (i, (present, count)) in terms.into_iter().enumerate() {
            if present {
                with[i] += usize::from(count > 0);
            } else {
                without[i] += 1;
            }
        }
        let terms = setup.model.memory.len();
        if let Some(found) = sums_in_vain(setup, &data) {
            assert_eq!(found, Vec::<String>::new());
            recursive[usize::from(terms > 0)] += 1;
        }
    }
    assert!(recursive[0] >= 3 && recursive[1] >= 10, "{recursive:?}");
    // What is never counted could not be zero for a reason.
    assert!(without.iter().chain(&with).all(|&scenes| scenes >= 3), "{without:?} {with:?}");
}

/// A solver that keeps a memory of weight zero for a scene without one, and one that solves in the volume what needs no
/// more than a recursion, are found.
#[test]
fn a_term_that_is_paid_for_in_vain_is_found() {
    let mut setups = bodies();
    let bare = |s: &Setup| {
        let on_contact = !s.model.boundary.is_empty() || s.model.friction.is_some();
        s.body.material.memory.is_empty() && !on_contact
    };
    let mut setup = setups.find(bare).expect("a scene without memory and contact");
    let data = on_a_mesh(&setup);
    let kernel = Box::new(ExponentialSum { terms: vec![(0.0, 1.0)] });
    let tensor = setup.model.elasticity.clone();
    setup.model.memory.push(MemoryTerm { kernel, tensor });
    let found = paid_for_nothing(&setup, &data, &run(&setup, &data));
    assert!(found.iter().any(|line| line.contains("bytes of history")), "{found:?}");
    let sound = run(&setup, &data);
    let heavy = CaseInfo {
        work: fem::contact::Work { residuals: 3, tangents: 2, ..sound.work },
        active_set_changes: 1,
        ..sound
    };
    assert!(paid_for_nothing(&setup, &data, &heavy).len() >= 3);
}

/// How often components of a model were asked: a scene without a term has nobody to ask.
#[derive(Clone, Default)]
struct Asked(Arc<AtomicUsize>);

impl Asked {
    fn once(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn count(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }
}

/// The rule of a scene; sums over the past, which kernels weigh, are counted.
struct CountedRule(Box<dyn TimeRule>, Asked);

impl TimeRule for CountedRule {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        self.0.weight(grid, n, j)
    }

    fn kernel_weight(
        &self,
        kernel: &dyn HistoryKernel,
        grid: &TimeGrid,
        n: usize,
        j: usize,
    ) -> f64 {
        self.1.once();
        self.0.kernel_weight(kernel, grid, n, j)
    }

    fn is_trapezoidal(&self) -> bool {
        self.0.is_trapezoidal()
    }
}

/// Weights of kernels that a march of `setup` asks for.
fn weights(setup: &mut Setup, data: &MeshData) -> usize {
    let asked = Asked::default();
    let rule = std::mem::replace(&mut setup.model.time_rule, Box::new(vhi::history::Trapezoid));
    setup.model.time_rule = Box::new(CountedRule(rule, asked.clone()));
    run(setup, data);
    asked.count()
}

/// What is wrong with the sums of a march: without memory no weight of a kernel is asked for, with a recursion that of the
/// last slot, and only a general kernel is summed over the past. None where the scene itself has sums.
fn sums_in_vain(mut setup: Setup, data: &MeshData) -> Option<Vec<String>> {
    let (name, terms, levels) =
        (setup.scene.name.clone(), setup.model.memory.len(), STEPS as usize + 1);
    let recursive = setup.model.memory.iter().all(|term| term.kernel.exponentials().is_some());
    if !(recursive && setup.model.time_rule.is_trapezoidal()) {
        return None;
    }
    let (asked, mut found) = (weights(&mut setup, data), Vec::new());
    if asked != terms * levels {
        found.push(format!("{name}: {asked} weights of {terms} kernels at {levels} levels"));
    }
    // What is summed is counted: a recursion that sums would be seen.
    let asked = weights(&mut setup.with_history(None), data);
    if asked < terms * levels + terms * levels * (levels - 1) / 2 {
        found.push(format!("{name}: {asked} weights of sums"));
    }
    Some(found)
}

/// A law that vanishes, and counts how often it is asked.
struct CountedNothing(Asked, bool);

impl Potential for CountedNothing {
    fn subdifferential(&self, r: f64) -> (f64, f64) {
        self.0.once();
        NoPotential.subdifferential(r)
    }

    fn value_and_slope(&self, r: f64) -> (f64, f64) {
        self.0.once();
        NoPotential.value_and_slope(r)
    }

    fn jumps(&self) -> &[f64] {
        &[]
    }

    fn kinks(&self) -> &[f64] {
        &[]
    }

    fn alpha(&self) -> f64 {
        0.0
    }

    fn growth(&self) -> (f64, f64) {
        (0.0, 0.0)
    }

    fn is_absent(&self) -> bool {
        self.1
    }
}

/// Questions to a law that vanishes, which says so or does not, on the facets of Γ3; and how many are allowed: one a
/// point and level, for the pressures that are shown.
fn questions(name: &str, rule: BoundaryRule, says_so: bool) -> (usize, usize) {
    let mut setup = super::shipped::setup(name);
    let asked = Asked::default();
    let boundary = setup.model.boundary.first_mut().expect("a scene with contact");
    (boundary.potential, boundary.rule) = (Arc::new(CountedNothing(asked.clone(), says_so)), rule);
    let data = on_a_mesh(&setup);
    let (mut load, grid) = (TruthLoad(&*data.truth), setup.grid(STEPS));
    let newton = InVolume(Newton::default());
    march(&data.space, &setup.model, &grid, &mut load, &newton, &mut |_| Ok(()))
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    (asked.count(), data.space.trace.points.len() * (STEPS as usize + 1))
}

/// A compliance that vanishes is evaluated on no facet, neither by the solver nor by the separate evaluation of the KKT
/// system; one that does not say so is.
#[test]
fn a_law_that_vanishes_is_not_integrated() {
    for (name, rule) in [
        ("signorini", BoundaryRule::Exact),
        ("signorini", BoundaryRule::Gauss),
        ("punch-box", BoundaryRule::Gauss),
    ] {
        let (asked, allowed) = questions(name, rule, true);
        assert!(asked <= allowed, "{name} {rule:?}: {asked} {allowed}");
        let (asked, allowed) = questions(name, rule, false);
        assert!(asked > 3 * allowed, "{name} {rule:?}: {asked} {allowed}");
    }
}

/// No projection, or one that never acts; evaluations are counted.
struct CountedProjection {
    stresses: Asked,
    tangents: Asked,
    limit: Option<Far>,
}

/// A limit that no strain reaches.
struct Far;

impl YieldLimit for Far {
    fn value(&self, _: f64) -> f64 {
        f64::MAX
    }

    fn slope(&self, _: f64) -> f64 {
        0.0
    }
}

impl Projection for CountedProjection {
    fn stress<const S: usize>(&self, _: &Symmetric<S>, _: f64) -> Option<Symmetric<S>> {
        self.stresses.once();
        None
    }

    fn response<const S: usize>(&self, _: &Symmetric<S>, _: f64) -> Option<Response<S>> {
        self.tangents.once();
        None
    }

    fn limit(&self) -> Option<&dyn YieldLimit> {
        self.limit.as_ref().map(|limit| limit as &dyn YieldLimit)
    }
}

/// Stresses and tangents of the projection that a march in the volume asks for, cell by cell, and how many stresses the
/// separate evaluation asks for: one a cell and level.
fn projections(name: &str, limit: Option<Far>) -> [usize; 3] {
    let setup = super::shipped::setup(name);
    let data = on_a_mesh(&setup);
    let [stresses, tangents] = [(); 2].map(|()| Asked::default());
    let counted =
        CountedProjection { stresses: stresses.clone(), tangents: tangents.clone(), limit };
    let projection = Some(AnyProjection::new(counted));
    let model = Model { projection, ..setup.scene_model() };
    let (mut load, grid) = (TruthLoad(&*data.truth), setup.grid(STEPS));
    let newton = InVolume(Newton::default());
    march(&data.space, &model, &grid, &mut load, &newton, &mut |_| Ok(()))
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    let checks = data.space.mesh.cell_count() * (STEPS as usize + 1);
    [stresses.count(), tangents.count(), checks]
}

/// A projection that is absent is evaluated in no cell by the solver; one that is there and never acts is.
#[test]
fn a_projection_that_is_absent_is_not_evaluated() {
    for name in ["elastic-punch", "viscoelastic", "signorini"] {
        let [stresses, tangents, checks] = projections(name, None);
        assert_eq!((stresses, tangents), (checks, 0), "{name}");
        let [stresses, tangents, checks] = projections(name, Some(Far));
        assert!(stresses > checks && tangents > 0, "{name}: {stresses} {tangents} {checks}");
    }
}
