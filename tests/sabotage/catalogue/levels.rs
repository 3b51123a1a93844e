//! A march of levels with a hand in what is committed to the history. It is a loop around the levels of the library,
//! as an external solver would be; the separate evaluation of the KKT system is optional in it.

use fem::contact::{
    BoundaryRule, CaseError, CaseInfo, Discretization, Evolution, KKT_ALLOWED, LastSlot, Model,
    StepView, kkt_residual,
};
use fem::space::quadrature::gauss_legendre;
use scene::setup::TruthLoad;
use vhi::history::TimeGrid;
use vhi::law::{Potential, Projection};
use vhi::{
    BoundaryGraph, HistoryInequality, Newton, OpenInequality, StepInequality, StepSolver,
    StepState, Stepper,
};

use super::{Marched, Run};
use crate::wrong::as_level;

/// What is committed for level n: from the solution, the state before the solve, and what was committed last.
pub type Commit = fn(usize, &StepState, &StepState, &StepState) -> StepState;

/// A force at displacements, written into the second.
type Force<'a> = dyn Fn(&[f64], &mut [f64]) + 'a;

/// What is done to the levels.
struct Hand<'f> {
    commit: Commit,
    /// Whether levels are solved with the last weights of level 1.
    stale: bool,
    /// A force besides that of the level.
    beside: Option<&'f Force<'f>>,
}

impl Hand<'_> {
    const NONE: Self = Hand { commit: SOUND, stale: false, beside: None };
}

/// An evolution with a hand in it.
struct Tampered<'a, 'f> {
    inner: Evolution<'a>,
    hand: Hand<'f>,
    level: usize,
    start: StepState,
    last: StepState,
    /// The last weights of level 1, and the level's.
    slots: Option<[LastSlot; 2]>,
}

impl HistoryInequality for Tampered<'_, '_> {
    type Error = CaseError;

    fn grid(&self) -> &TimeGrid {
        self.inner.grid()
    }

    fn open(&mut self) -> Result<(), CaseError> {
        self.inner.open()?;
        if self.hand.stale && self.level > 0 {
            let of_level = self.inner.last_slot();
            let first = self.slots.take().map_or_else(|| of_level.clone(), |[first, _]| first);
            self.inner.set_last_slot(first.clone());
            self.slots = Some([first, of_level]);
        }
        Ok(())
    }

    fn commit(&mut self, solution: &StepState) {
        let committed = (self.hand.commit)(self.level, solution, &self.start, &self.last);
        if let Some([_, of_level]) = &self.slots {
            self.inner.set_last_slot(of_level.clone());
        }
        // ‖ε‖ is that of the last evaluated state.
        let mut force = vec![0.0; committed.u.len()];
        self.inner.residual(&committed.u, &mut force);
        self.inner.commit(&committed);
        self.last = solution.clone();
        self.level += 1;
    }
}

impl OpenInequality for Tampered<'_, '_> {
    fn freeze(&mut self, eta: Option<&[f64]>) {
        self.inner.freeze(eta);
    }

    fn norm(&self, v: &[f64]) -> f64 {
        self.inner.norm(v)
    }
}

impl StepInequality for Tampered<'_, '_> {
    as_level!(inner: dofs graph linearize solve force_scale);

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        if self.start.u.is_empty() {
            self.start.u = u.to_vec();
        }
        self.inner.residual(u, out);
        if let Some(beside) = self.hand.beside {
            beside(u, out);
        }
    }
}

/// Solves all levels by `solver`.
pub(super) fn march(
    run: Run<'_>,
    solver: &dyn StepSolver,
    commit: Commit,
    checked: bool,
) -> Marched {
    levels(run, Hand { commit, ..Hand::NONE }, solver, checked)
}

/// What a level leaves is its solution.
pub(super) const SOUND: Commit = |_, solution, _, _| solution.clone();

/// Solves all levels with `solver`, and does not check the KKT system.
pub(super) fn unchecked(run: Run<'_>, solver: &dyn StepSolver) -> Marched {
    march(run, solver, SOUND, false)
}

/// Solves all levels as if the factor of level 1 served them all: with its last weights.
pub(super) fn march_stale(run: Run<'_>, checked: bool) -> Marched {
    levels(run, Hand { stale: true, ..Hand::NONE }, &Newton::default(), checked)
}

/// Solves all levels with two Gauss points on each edge of Γ3 where the scheme has three; the KKT system is checked.
pub(super) fn march_by_two_points(run: Run<'_>) -> Marched {
    let (space, model) = (&*run.data.space, &run.setup.model);
    let Some(boundary) = model
        .boundary
        .first()
        .filter(|b| b.rule == BoundaryRule::Gauss && space.mesh.dimension == 2)
    else {
        return run.sound();
    };
    // Two points less three.
    let points = [gauss_legendre(2), gauss_legendre(3)].into_iter().zip([1.0, -1.0]);
    let points: Vec<(f64, f64)> = points
        .flat_map(|(rule, sign)| rule.iter().map(move |(x, w)| (0.5 * (1.0 + x), 0.5 * sign * w)))
        .collect();
    let force = |u: &[f64], out: &mut [f64]| {
        let mut nodal = vec![0.0; space.nodes.len()];
        nodal[..u.len()].copy_from_slice(u);
        for (f, measure) in space.trace.measure.iter().enumerate() {
            let ends: Vec<usize> = space.trace.facet(f).iter().map(|&i| i as usize).collect();
            let corner = |i: usize| space.mesh.point(&[space.trace.points[i].vertex], &[1.0]);
            for &(x, weight) in &points {
                let shape = [1.0 - x, x];
                let along = |value: &dyn Fn(usize) -> f64| {
                    shape[0] * value(ends[0]) + shape[1] * value(ends[1])
                };
                let normal = along(&|i| space.trace.normal(i, &nodal));
                let place = [0, 1, 2].map(|c| along(&|i| corner(i)[c]));
                let law = boundary.potential_at(place);
                let pressure = law.subdifferential(normal - (boundary.shift)(place)).0;
                for (i, shape) in ends.iter().zip(shape) {
                    let point = &space.trace.points[*i];
                    if !point.clamped {
                        out[point.unknown as usize] +=
                            point.sign * measure * weight * shape * pressure;
                    }
                }
            }
        }
    };
    levels(run, Hand { beside: Some(&force), ..Hand::NONE }, &Newton::default(), true)
}

fn levels(run: Run<'_>, hand: Hand<'_>, solver: &dyn StepSolver, checked: bool) -> Marched {
    let (space, model, grid) = (&*run.data.space, &run.setup.model, run.setup.grid(run.steps));
    let mut load = TruthLoad(&*run.data.truth);
    let inner = Evolution::new(space, model, &grid, &mut load).expect("an analysis");
    let (start, last) = (StepState::default(), StepState::default());
    let mut levels = Tampered { inner, hand, level: 0, start, last, slots: None };
    let mut stepper = Stepper::new(&levels, solver);
    let mut info = CaseInfo::default();
    let mut shown = Shown::new(space);
    for n in 0..=grid.steps() {
        levels.start = StepState::default();
        info.newton_iterations += stepper.step(&mut levels)?.iterations;
        let view = shown.level(model, space, n, grid.time(n), &levels.inner, &stepper.state);
        let residual = kkt_residual(space, model, &view, levels.inner.load());
        if checked && (residual.is_nan() || residual > KKT_ALLOWED) {
            let t = grid.time(n);
            return Err(CaseError::Kkt { n, t, residual, allowed: KKT_ALLOWED });
        }
        (run.observe)(&view)?;
    }
    Ok(info)
}

/// Vectors of a view.
struct Shown {
    u: Vec<f64>,
    compliance: Vec<f64>,
    multiplier: Vec<f64>,
}

impl Shown {
    fn new(space: &Discretization) -> Self {
        let points = space.trace.points.len();
        let u = vec![0.0; space.nodes.len()];
        Self { u, compliance: vec![0.0; points], multiplier: vec![0.0; points] }
    }

    fn level<'v>(
        &'v mut self,
        model: &Model,
        space: &Discretization,
        n: usize,
        t: f64,
        levels: &'v Evolution<'_>,
        state: &StepState,
    ) -> StepView<'v> {
        self.u[..state.u.len()].copy_from_slice(&state.u);
        let free = space.trace.points.iter().enumerate().filter(|(_, point)| !point.clamped);
        let coordinates = levels.graph().coordinates.iter().zip(&state.pressure);
        for ((i, _), (at, &pressure)) in free.zip(coordinates) {
            let side = space.trace.points[i].side;
            let Some(boundary) = model.boundary_on(side) else { break };
            let normal = space.trace.normal(i, &self.u);
            let place = space.mesh.point(&[space.trace.points[i].vertex], &[1.0]);
            let (lo, hi) = boundary.potential_at(place).subdifferential(normal - at.shift);
            let by_vertices = boundary.rule == BoundaryRule::Vertex;
            self.compliance[i] = match by_vertices && normal < at.gap {
                true => pressure.clamp(lo, hi),
                false => lo,
            };
            self.multiplier[i] = pressure - if by_vertices { self.compliance[i] } else { 0.0 };
        }
        let zeta = levels.zeta();
        StepView {
            n,
            t,
            u: &self.u,
            history: levels.history(),
            zeta,
            kappa: model.projection.limit().map_or(f64::INFINITY, |limit| limit.value(zeta)),
            strain_norm: levels.problem().strain_norm(),
            compliance: &self.compliance,
            multiplier: &self.multiplier,
            friction: &[],
        }
    }
}
