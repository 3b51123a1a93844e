//! The step loop allocates nothing: marches of N and 2N steps make the same number of allocations, but for what they
//! keep on purpose.

use std::hint::black_box;

use allocation_counter::measure;
use gronwall::contact::{Load, LoadError, Model, Plan, march};
use gronwall::history::TimeGrid;
use gronwall::law::{NoProjection, Projection, VonMises, YieldLimit};
use gronwall::setup::{MeshData, TruthLoad};
use gronwall::vhi::Newton;

use super::shipped;

/// F(t) = t F(1), without formulas, which make vectors of their own at every time; an allocation wherever it is asked
/// for if it is a wasteful one.
struct Ramp {
    force: Vec<Vec<f64>>,
    wasteful: bool,
}

impl Ramp {
    fn waste(&self, out: &[f64]) {
        if self.wasteful {
            drop(black_box(out.to_vec()));
        }
    }
}

impl Load for Ramp {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        self.waste(out);
        for (value, force) in out.iter_mut().zip(&self.force[0]) {
            *value = t * force;
        }
        Ok(())
    }

    fn basis(&self) -> Option<&[Vec<f64>]> {
        Some(&self.force)
    }

    fn factors(&self, t: f64, out: &mut [f64]) {
        self.waste(out);
        out[0] = t;
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
fn allocations<P: Projection>(
    model: &Model<P>,
    data: &MeshData,
    grid: &TimeGrid,
    wasteful: bool,
) -> (u64, u64) {
    let mut force = vec![vec![0.0; data.space.dofs()]];
    let ended = TruthLoad(&*data.truth).assemble(1.0, &mut force[0]);
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

/// Floors are recorded anew when the load has doubled, or a residual is the largest so far: the logarithm of N times more
/// or less, with some five vectors each; and the vectors of iterative solves are made when an iteration first needs them.
/// So many allocations may come with twice the steps; one a level would be 256.
const FLOORS: u64 = 100;

/// Allocations that 512 steps have over 256, without those of the library in the factorizations that they have more.
fn more<P: Projection>(
    name: &str,
    model: &Model<P>,
    data: &MeshData,
    grids: &[TimeGrid; 3],
    wasteful: bool,
) -> u64 {
    // What is made when it is first asked for is made before.
    allocations(model, data, &grids[0], false);
    let [(once, factors), (twice, more_factors)] =
        [1, 2].map(|i| allocations(model, data, &grids[i], wasteful));
    let space = &data.space;
    let values = space.stiffness(&model.elasticity);
    let (mut factor, mut workspace) = (space.analysis.factor(), space.analysis.workspace(2));
    let of_a_factor = measure(|| {
        let done = space.analysis.factorize(&space.pattern, &values, &mut factor, &mut workspace);
        assert!(done.is_ok());
    });
    let library = of_a_factor.count_total * more_factors.saturating_sub(factors);
    println!("{name}: {once} {twice} allocations, {factors} {more_factors} factors, {library}");
    twice.saturating_sub(once + library)
}

/// The same for a plan, by a scene whose formulas are replaced by numbers: they make vectors wherever they are
/// evaluated, and the KKT check evaluates those of Γ3 anew at every level.
fn more_with_twice_the_steps(plan: Plan, wasteful: bool) -> u64 {
    let name = match plan {
        Plan::Recursion => "linear-punch",
        Plan::Condensed => "elastic-punch",
        Plan::Newton => "punch",
    };
    let setup = shipped::setup(name);
    let data = shipped::on_mesh(&setup, 16);
    assert_eq!(Plan::of(&data.space, &setup.model, 256, true), plan, "{name}");
    let grids = [2, 256, 512].map(|steps| setup.grid(steps));
    let Model { elasticity, memory, projection, mut boundary, time_rule } = setup.model;
    if let Some(boundary) = &mut boundary {
        let gap = (boundary.gap)([0.0; 3]);
        boundary.gap = Box::new(move |_| gap);
        boundary.shift = Box::new(|_| 0.0);
    }
    match projection {
        None => {
            let model = Model { elasticity, memory, projection: NoProjection, boundary, time_rule };
            more(name, &model, &data, &grids, wasteful)
        }
        Some(VonMises { mu, .. }) => {
            let projection = VonMises { mu, limit: Rising };
            let model = Model { elasticity, memory, projection, boundary, time_rule };
            more(name, &model, &data, &grids, wasteful)
        }
    }
}

const PLANS: [Plan; 3] = [Plan::Recursion, Plan::Condensed, Plan::Newton];

#[test]
fn the_step_loop_allocates_nothing() {
    for plan in PLANS {
        let more = more_with_twice_the_steps(plan, false);
        assert!(more < FLOORS, "{plan:?}: {more}");
    }
}

#[test]
fn an_allocation_a_level_is_seen() {
    for plan in PLANS {
        let more = more_with_twice_the_steps(plan, true);
        assert!(more > FLOORS, "{plan:?}: {more}");
    }
}
