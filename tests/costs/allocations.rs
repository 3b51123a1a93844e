//! The step loop allocates nothing: marches of N and 2N steps make the same number of allocations, but for what they
//! keep on purpose.

use std::hint::black_box;

use allocation_counter::measure;
use fem::contact::{Discretization, Load, LoadError, MemoryTerm, Model, Plan, march};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::Newton;
use vhi::history::{Memory, TimeGrid};
use vhi::law::{
    AnyProjection, ExponentialSum, FourthOrder, INTERPOLATED_TO, Isotropic, MemoryKernel, VonMises,
    YieldLimit,
};

use super::shipped;

/// F(t) = t F(1), without formulas, which make vectors at every time; an allocation wherever it is asked
/// for if it is a wasteful one.
struct Ramp {
    force: Vec<f64>,
    wasteful: bool,
}

impl Load for Ramp {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        if self.wasteful {
            drop(black_box(out.to_vec()));
        }
        for (value, force) in out.iter_mut().zip(&self.force) {
            *value = t * force;
        }
        Ok(())
    }
}

/// κ of `punch` without a formula.
struct Rising;

impl YieldLimit for Rising {
    fn value(&self, zeta: f64) -> f64 {
        0.10 + 0.05 * zeta
    }

    fn slope(&self, _: f64) -> f64 {
        0.05
    }
}

/// Allocations of a march, and its factorizations.
fn allocations(model: &Model, data: &MeshData, grid: &TimeGrid, wasteful: bool) -> (u64, u64) {
    let mut force = vec![0.0; data.space.dofs()];
    let ended = TruthLoad(&*data.truth).assemble(1.0, &mut force);
    ended.unwrap_or_else(|error| panic!("{error}"));
    let mut factorizations = 0;
    let counted = measure(|| {
        let mut load = Ramp { force, wasteful };
        let newton = Newton::default();
        let info = march(&data.space, model, grid, &mut load, &newton, &mut |_| Ok(()));
        let info = info.unwrap_or_else(|error| panic!("{error}"));
        factorizations = u64::from(info.work.linear.factorizations);
    });
    (counted.count_total, factorizations)
}

/// (1 + t/τ)^-p: no sum of exponentials, and smooth; interpolated to this error, or summed directly.
struct Power(Option<f64>);

impl MemoryKernel for Power {
    fn value(&self, lag: f64) -> f64 {
        -(1.0 + lag / 0.25).powf(-1.5)
    }

    fn interpolated_to(&self) -> Option<f64> {
        self.0
    }
}

/// Floors are recorded anew when the load has doubled, or a residual is the largest so far: the logarithm of N times more
/// or less, with some five vectors each, and more often where little balances, as on graded grids; lists of what is kept grow by doubling; and the vectors of iterative solves are
/// made when an iteration first needs them. So many allocations may come with twice the steps; one a level would be 256
/// at least.
const FLOORS: u64 = 100;

/// A march whose allocations are counted.
struct Case {
    /// What it is there for.
    what: &'static str,
    scene: &'static str,
    n: u32,
    /// N; the march is compared with one of 2N steps.
    steps: u32,
    plan: Plan,
    /// What makes the case of the scene.
    change: fn(&mut Setup),
    /// What its memory is.
    memory: fn(&Memory) -> bool,
    /// Vectors a level that are kept on purpose.
    kept: u64,
}

fn nothing(_: &mut Setup) {}

fn general(setup: &mut Setup) {
    let kernel = || Box::new(Power(Some(INTERPOLATED_TO)));
    setup.model.memory.iter_mut().for_each(|term| term.kernel = kernel());
}

fn direct(setup: &mut Setup) {
    setup.model.memory.iter_mut().for_each(|term| term.kernel = Box::new(Power(None)));
}

/// ℬ₀ with other Lamé numbers than a multiple of 𝒜.
fn no_multiple(setup: &mut Setup) {
    setup.model.memory[0].tensor = Isotropic { lambda: 0.1, mu: 0.3 }.into();
}

/// ℬ₀ by its numbers.
fn full(setup: &mut Setup) {
    let mut matrix = [[0.0; 6]; 6];
    let isotropic = Isotropic { lambda: 0.1, mu: 0.3 }.matrix::<3>();
    for (row, numbers) in matrix.iter_mut().zip(isotropic) {
        row[..3].copy_from_slice(&numbers);
    }
    setup.model.memory[0].tensor = FourthOrder::Full(matrix).into();
}

fn two_terms(setup: &mut Setup) {
    let kernel = Box::new(ExponentialSum { terms: vec![(-0.1, 2.0), (-0.1, 0.5)] });
    let tensor = Isotropic { lambda: 0.1, mu: 0.3 }.into();
    setup.model.memory.push(MemoryTerm { kernel, tensor });
}

fn two_direct_terms(setup: &mut Setup) {
    two_terms(setup);
    direct(setup);
}

fn is_recursive(memory: &Memory) -> bool {
    matches!(memory, Memory::Recursive { .. })
}

fn is_direct(memory: &Memory) -> bool {
    matches!(memory, Memory::Direct { .. })
}

fn is_fast(memory: &Memory) -> bool {
    matches!(memory, Memory::Fast(_))
}

const PLAIN: Case = Case {
    what: "plain",
    scene: "punch",
    n: 16,
    steps: 256,
    plan: Plan::Newton,
    change: nothing,
    memory: is_recursive,
    kept: 0,
};

const DIRECT: Case = Case { what: "direct sums", memory: is_direct, ..PLAIN };

const CASES: [Case; 19] = [
    PLAIN,
    Case { scene: "linear-punch", plan: Plan::Linear, ..PLAIN },
    Case { scene: "elastic-punch", plan: Plan::Condensed, ..PLAIN },
    Case { n: 6, change: direct, kept: 1, ..DIRECT },
    Case { scene: "linear-punch", plan: Plan::Linear, change: direct, kept: 1, ..DIRECT },
    Case { scene: "elastic-punch", plan: Plan::Condensed, change: direct, kept: 1, ..DIRECT },
    Case { n: 6, change: two_direct_terms, kept: 2, ..DIRECT },
    Case {
        what: "interpolated memory",
        n: 4,
        steps: 512,
        change: general,
        memory: is_fast,
        ..PLAIN
    },
    Case {
        what: "interpolated memory",
        scene: "elastic-punch",
        n: 4,
        steps: 512,
        plan: Plan::Condensed,
        change: general,
        memory: is_fast,
        ..PLAIN
    },
    Case { what: "in space", scene: "punch-box", n: 4, ..PLAIN },
    Case { what: "two terms of memory", change: two_terms, ..PLAIN },
    Case {
        what: "two terms, linear",
        scene: "linear-punch",
        plan: Plan::Linear,
        change: two_terms,
        ..PLAIN
    },
    Case {
        what: "no multiple",
        scene: "elastic-punch",
        plan: Plan::Condensed,
        change: no_multiple,
        ..PLAIN
    },
    Case {
        what: "two terms, condensed",
        scene: "elastic-punch",
        plan: Plan::Condensed,
        change: two_terms,
        ..PLAIN
    },
    Case { what: "a curved law on edges", scene: "law-rational", plan: Plan::Condensed, ..PLAIN },
    Case { what: "a graded grid", scene: "affine-graded", steps: 512, ..PLAIN },
    Case {
        what: "no multiple on a graded grid",
        scene: "affine-graded",
        steps: 512,
        change: no_multiple,
        ..PLAIN
    },
    Case {
        what: "a full tensor on a graded grid",
        scene: "affine-graded",
        steps: 512,
        change: full,
        ..PLAIN
    },
    Case {
        what: "a full tensor, linear",
        scene: "linear-punch",
        plan: Plan::Linear,
        change: full,
        ..PLAIN
    },
];

/// Allocations of the library in a factorization of `space`.
fn of_a_factor(space: &Discretization, model: &Model) -> u64 {
    let values = space.stiffness(&model.elasticity);
    let analysis = space.analysis().expect("an analysis");
    let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
    let counted = measure(|| {
        let done = analysis.factorize(&space.pattern, &values, &mut factor, &mut workspace);
        assert!(done.is_ok());
    });
    counted.count_total
}

/// Allocations that 2N steps have over N, without those of the library in the factorizations that they have more.
fn more(case: &Case, model: &Model, data: &MeshData, grids: &[TimeGrid; 3], wasteful: bool) -> u64 {
    // What is made when it is first asked for is made before.
    allocations(model, data, &grids[0], false);
    let [(once, factors), (twice, more_factors)] =
        [1, 2].map(|i| allocations(model, data, &grids[i], wasteful));
    let library = of_a_factor(&data.space, model) * more_factors.saturating_sub(factors);
    let Case { what, scene, .. } = case;
    println!(
        "{scene} {what}: {once} {twice} allocations, {factors} {more_factors} factors, {library}"
    );
    twice.saturating_sub(once + library)
}

/// Allocations of a case with twice the steps, by a scene whose formulas are replaced by numbers: they make vectors
/// wherever they are evaluated, and the KKT check evaluates those of Γ3 anew at every level.
fn more_with_twice_the_steps(case: &Case, wasteful: bool) -> u64 {
    let mut setup = shipped::setup(case.scene);
    (case.change)(&mut setup);
    let data = shipped::on_mesh(&setup, case.n);
    let name = case.what;
    let grids = [2, case.steps, 2 * case.steps].map(|steps| setup.grid(steps));
    for grid in &grids[1..] {
        assert_eq!(Plan::of(&data.space, &setup.model), case.plan, "{name}");
        assert!(!setup.model.memory.is_empty());
        let rule = &*setup.model.time_rule;
        let memory = |term: &MemoryTerm| Memory::new(&*term.kernel, rule, grid, 1);
        assert!(setup.model.memory.iter().map(memory).all(|m| (case.memory)(&m)), "{name}");
    }
    let (projected, mu) = (setup.model.projection.is_some(), setup.projection_mu());
    let mut model = setup.model;
    for boundary in &mut model.boundary {
        let gap = (boundary.gap)([0.0; 3], 0.0);
        boundary.gap = Box::new(move |_, _| gap);
        boundary.shift = Box::new(|_| 0.0);
    }
    if projected {
        model.projection = Some(AnyProjection::new(VonMises { mu, limit: Rising }));
    }
    more(case, &model, &data, &grids, wasteful)
}

/// Nothing but what is kept on purpose, and that once a level.
#[test]
fn the_step_loop_allocates_nothing() {
    for case in &CASES {
        let (more, kept) = (more_with_twice_the_steps(case, false), case.kept * case.steps as u64);
        let Case { what, scene, .. } = case;
        assert!((kept..kept + FLOORS).contains(&more), "{scene} {what}: {more}, {kept} kept");
    }
}

#[test]
fn an_allocation_a_level_is_seen() {
    for case in &CASES {
        let (more, kept) = (more_with_twice_the_steps(case, true), case.kept * case.steps as u64);
        let Case { what, scene, .. } = case;
        assert!(more >= kept + FLOORS, "{scene} {what}: {more}, {kept} kept");
    }
}
