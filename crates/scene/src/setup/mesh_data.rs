//! Data shared by all cases on one mesh: space, exact solution, reference trajectories, A-projection.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::load_check;
use super::rule_check::{RuleCheck, check_times, rule_check};
use super::{GivenLoad, ReferenceTruth, Result, Setup, SetupError};
use crate::{Data, Side};
use exact::{Exact, ExactOnMesh, InterpolatedOnMesh, Truth};
use fem::contact::{
    CaseError, CaseInfo, Discretization, Load, LoadError, Observer, StepView, march,
};
use fem::norms::{ReferenceRun, Trajectory};
use fem::space::quadrature::TruthRules;
use vhi::StepSolver;

/// Cells in which the accuracy of hereditary integrals is checked.
const CELLS_ASKED: usize = 16;

/// A scene on one mesh.
pub struct MeshData {
    /// V^h.
    pub space: Arc<Discretization>,
    /// Loads and exact fields.
    pub truth: Arc<dyn Truth>,
    /// As `truth` by the rules of the scene, even if `truth` has been replaced.
    by_scene_rules: Option<Arc<dyn Truth>>,
    /// Displacements of runs with more steps, by (steps of the run, steps kept).
    trajectories: Mutex<HashMap<(u32, u32), Arc<Trajectory>>>,
    rule_check: OnceLock<Result<RuleCheck, LoadError>>,
    load_check: OnceLock<Result<(), LoadError>>,
}

/// Adapts the load of a truth to the solver.
pub struct TruthLoad<'a>(pub &'a dyn Truth);

impl Load for TruthLoad<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        out.copy_from_slice(&self.0.load(t)?);
        Ok(())
    }
}

impl MeshData {
    /// The scene on mesh n; `reference` is the finer run of a scene without exact solution.
    ///
    /// # Errors
    /// A cell that the boundary of a region cuts.
    pub fn new(setup: &Setup, n: u32, reference: Option<Arc<ReferenceRun>>) -> Result<Self> {
        let rules = TruthRules::for_element(setup.body.element, setup.scene.dimension);
        let mut data = Self::with_rules(setup, n, reference, &rules)?;
        data.by_scene_rules = Some(data.truth.clone());
        Ok(data)
    }

    /// A mesh whose loads and moments use other rules.
    ///
    /// # Errors
    /// A cell that the boundary of a region cuts.
    pub fn with_rules(
        setup: &Setup,
        n: u32,
        reference: Option<Arc<ReferenceRun>>,
        rules: &TruthRules,
    ) -> Result<Self> {
        let space = setup.space(n)?;
        let truth = truth(setup, setup.exact.as_ref(), &space, reference, rules)?;
        Ok(Self::with_truth(space, truth))
    }

    /// A space with a given truth.
    pub fn with_truth(space: Arc<Discretization>, truth: Arc<dyn Truth>) -> Self {
        let (trajectories, rule_check) = (Mutex::default(), OnceLock::new());
        let load_check = OnceLock::new();
        Self { space, truth, by_scene_rules: None, trajectories, rule_check, load_check }
    }

    /// Compares the next rules for loads and errors on this mesh; trivial if u is in V^h. Computed once, independently
    /// of a replaced `truth`.
    ///
    /// # Errors
    /// A load that is not finite.
    pub fn rule_check(&self, setup: &Setup) -> Result<&RuleCheck, LoadError> {
        let known = self.rule_check.get_or_init(|| {
            let remainders = self.with_remainders(setup);
            let interpolated = setup.body.data.is_interpolated();
            if interpolated && remainders.is_none() {
                return Ok(RuleCheck::default());
            }
            let by = |rules: &TruthRules, next: bool| {
                let exact = remainders.as_ref().filter(|_| next).or(setup.exact.as_ref());
                truth(setup, exact, &self.space, None, rules)
                    .map_err(|error| LoadError::Reference { reason: error.to_string() })
            };
            rule_check(setup, &self.space, self.by_scene_rules.clone(), by)
        });
        known.as_ref().map_err(Clone::clone)
    }

    /// Runs an external `solve` and compares the rules in parallel.
    pub fn comparing_beside<T>(&self, setup: &Setup, solve: impl FnOnce() -> T) -> T {
        std::thread::scope(|scope| {
            let compare = || self.rule_check(setup).is_ok();
            let compared = std::thread::Builder::new().spawn_scoped(scope, compare);
            let solved = solve();
            // Errors of the comparison are reported to whoever asks for it; without a thread it is made then.
            drop(compared.map(|compared| compared.join()));
            solved
        })
    }

    /// The exact solution with error estimates of its hereditary integrals, if nonzero in some cells.
    fn with_remainders(&self, setup: &Setup) -> Option<Arc<Exact>> {
        let mesh = &self.space.mesh;
        let centroid = vec![1.0 / (mesh.dimension + 1) as f64; mesh.dimension + 1];
        let every = mesh.cell_count().div_ceil(CELLS_ASKED).max(1);
        let points: Vec<[f64; 3]> = (0..mesh.cell_count())
            .step_by(every)
            .map(|c| mesh.point(mesh.cell(c), &centroid))
            .collect();
        let times = check_times(setup, mesh.cell_count());
        setup.exact.as_ref()?.with_remainders(&points, &times).map(Arc::new)
    }

    /// Solves the scene with `steps` steps on its time grid and shows every level to `observe`. The first time, total
    /// force and moments of given or strong-form loads are checked.
    ///
    /// # Errors
    /// The solver's; [`LoadError::Resultant`]; [`CaseError::BeyondZeta`].
    pub fn march(
        &self,
        setup: &Setup,
        steps: u32,
        solver: &dyn StepSolver,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        let checked = || load_check::check(setup, &self.space, &*self.truth);
        self.load_check.get_or_init(checked).clone()?;
        let mut load = TruthLoad(&*self.truth);
        let grid = setup.grid(steps);
        let reach = setup.kappa.zeta;
        let mut watched = |view: &StepView<'_>| {
            let (n, t, zeta) = (view.n, view.t, view.zeta);
            if zeta > reach {
                Err(CaseError::BeyondZeta { n, t, zeta, reach })
            } else {
                observe(view)
            }
        };
        march(&self.space, &setup.model, &grid, &mut load, solver, &mut watched)
    }

    /// Displacements of a run with `run_steps` steps at the times of the grid with `kept` steps; solved once and
    /// shared.
    pub fn trajectory(
        &self,
        setup: &Setup,
        run_steps: u32,
        kept: u32,
    ) -> Result<Arc<Trajectory>, CaseError> {
        let lock = || self.trajectories.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = lock().get(&(run_steps, kept)) {
            return Ok(known.clone());
        }
        let every = (run_steps / kept.max(1)).max(1) as usize;
        let mut trajectory = Trajectory::default();
        setup.scheme.march(setup, self, run_steps, &mut |view| {
            if view.n % every == 0 {
                trajectory.times.push(view.t);
                trajectory.displacements.push(view.u.to_vec());
            }
            Ok(())
        })?;
        let trajectory = Arc::new(trajectory);
        Ok(lock().entry((run_steps, kept)).or_insert(trajectory).clone())
    }
}

/// Loads and exact fields of a scene on a mesh by the given rules.
fn truth(
    setup: &Setup,
    exact: Option<&Arc<Exact>>,
    space: &Arc<Discretization>,
    reference: Option<Arc<ReferenceRun>>,
    rules: &TruthRules,
) -> Result<Arc<dyn Truth>> {
    Ok(match (&setup.body.data, exact) {
        (Data::Exact { interpolated: true, .. }, Some(exact)) => {
            Arc::new(InterpolatedOnMesh::new(exact.clone(), space.clone(), setup.compliance_rule()))
        }
        (Data::Exact { form, .. }, Some(exact)) => {
            let sides = side_numbers(&setup.body.domain.traction);
            Arc::new(ExactOnMesh::new(exact.clone(), space.clone(), *form, &sides, rules))
        }
        (Data::Loads { body, traction }, _) => {
            let (graph, horizon) = (&setup.scene.formulas, setup.scene.time.horizon);
            let load = GivenLoad::new(graph, horizon, body, traction, space, rules);
            Arc::new(ReferenceTruth::new(space.clone(), load, reference))
        }
        (Data::Exact { .. }, None) => {
            return Err(SetupError::NoTruth { scene: setup.scene.name.clone() });
        }
    })
}

/// Numbers of sides in the meshes of a scene.
pub fn side_numbers(sides: &[Side]) -> Vec<u32> {
    sides.iter().map(|side| side.0).collect()
}

/// The finer run that replaces the exact solution.
///
/// # Errors
/// The solver's, and those of the mesh.
pub fn reference_run(setup: &Setup, n: u32, steps: u32, keep_every: u32) -> Result<ReferenceRun> {
    let data = MeshData::new(setup, n, None)?;
    let mut run = ReferenceRun::new(data.space.clone());
    setup.scheme.march(setup, &data, steps, &mut |view| {
        if view.n % keep_every as usize == 0 {
            run.keep(&setup.model, view);
        }
        Ok(())
    })?;
    // The mesh is kept for the cases, but nothing is solved on it again.
    data.space.forget_factors();
    Ok(run)
}
