//! Data shared by all cases on one mesh: space, exact solution, reference trajectories, A-projection.

use super::{Result, Setup, SetupError, elasticity, load_check};
use crate::{Data, LoadForm, Side};
use exact::{ByTime, Exact, ExactOnMesh, InterpolatedOnMesh, Truth};
use fem::contact::{
    CaseError, CaseInfo, Discretization, Floors, ForceAtPoints, LevelFields, Load, LoadError,
    Observer, StepView, march, strain_norm,
};
use fem::norms::{
    ElasticProjection, Moments, ReferenceError, ReferenceRun, Refinement, Trajectory,
};
use fem::space::StrainPoint;
use fem::space::quadrature::TruthRules;
use formula::{BoundProgram, Graph, Node, Program};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use vhi::StepSolver;
use vhi::law::TensorField;

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
            if setup.body.data.is_interpolated() && remainders.is_none() {
                return Ok(RuleCheck::default());
            }
            self.compared(setup, remainders.as_ref())
        });
        known.as_ref().map_err(Clone::clone)
    }

    /// Compares the rules: those of the scene with the next ones, by these with error estimates of hereditary integrals, if there
    /// are any. Fields by the next rules are not kept: their formulas take more memory than the case.
    ///
    /// # Errors
    /// A load or field that is not finite, a mesh on which A cannot be factorized.
    fn compared(
        &self,
        setup: &Setup,
        remainders: Option<&Arc<Exact>>,
    ) -> Result<RuleCheck, LoadError> {
        let space = &self.space;
        let times = check_times(setup, space.mesh.cell_count());
        let by = |rules: &TruthRules, exact: Option<&Arc<Exact>>| {
            truth(setup, exact, space, None, rules)
                .map_err(|error| LoadError::Reference { reason: error.to_string() })
        };
        let loads = |truth: &dyn Truth| -> Result<Vec<Arc<Vec<f64>>>, LoadError> {
            times.iter().map(|&t| truth.load(t)).collect()
        };
        let (element, d, exact) = (space.element, setup.scene.dimension, setup.exact.as_ref());
        let usual = match &self.by_scene_rules {
            Some(known) => known.clone(),
            None => by(&TruthRules::for_element(element, d), exact)?,
        };
        let next = || by(&TruthRules::stronger_for(element, d), remainders.or(exact));
        let mut stronger = next()?;
        // Moments of a reference run are exact.
        let compared = times.iter().filter(|_| exact.is_some());
        let moments = compared.map(|&t| Ok((t, stronger.moments(t)?)));
        let moments = moments.collect::<Result<_, LoadError>>()?;
        if matches!(setup.body.data, Data::Exact { form: LoadForm::Strong, .. }) {
            // Frees the points of the moments before those of the loads are made; in the weak form they are shared.
            stronger = next()?;
        }
        let pairs = [loads(&*usual)?, loads(&*stronger)?];
        let elastic = elasticity(&setup.body.material);
        let floors = load_floors(space, &pairs, &elastic, setup.projection_mu())?;
        Ok(RuleCheck { floors, moments })
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
            let (refinement, moments) = (OnceLock::new(), ByTime::default());
            Arc::new(ReferenceTruth { space: space.clone(), load, reference, refinement, moments })
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

// Loads given as formulas f0, f2, and the reference run that replaces their solution.

/// F(t)(v) = ∫ f0·v + ∫_{Γ2} f2·v on one mesh, a term for the body and one for each side.
struct GivenLoad(Vec<Term>);

impl GivenLoad {
    /// The load of `body` and `traction` formulas on `space`.
    fn new(
        graph: &Graph,
        horizon: f64,
        body: &[Node],
        traction: &[(Side, Vec<Node>)],
        space: &Discretization,
        rules: &TruthRules,
    ) -> Self {
        let of_formulas = (graph, horizon);
        let inside = Term::new(of_formulas, body, || ForceAtPoints::in_cells(space, &rules.load));
        let outside = traction.iter().map(|(side, formulas)| {
            let on_side = || ForceAtPoints::on_side(space, &rules.traction, side.0);
            Term::new(of_formulas, formulas, on_side)
        });
        Self(std::iter::once(inside).chain(outside).flatten().collect())
    }

    fn at(&self, t: f64, space: &Discretization) -> Result<Vec<f64>, LoadError> {
        let mut force = vec![0.0; space.nodes.len()];
        self.0.iter().for_each(|term| term.add_to(t, &mut force));
        force.truncate(space.dofs());
        if let Some(dof) = force.iter().position(|f| !f.is_finite()) {
            let vertex = space.nodes.vertex[dof / space.nodes.dimension];
            let place = space.mesh.vertex(vertex).to_vec();
            let what = "the load near a vertex".to_string();
            return Err(LoadError::NotFinite { what, value: force[dof], place, t });
        }
        Ok(force)
    }
}

/// ∫ f·v over a part of the body or its boundary, of the components of f that are not zero.
struct Term {
    components: Vec<usize>,
    /// f at the points of the rule.
    bound: Mutex<BoundProgram>,
    integral: ForceAtPoints,
}

impl Term {
    /// None if f is zero.
    fn new(
        (graph, horizon): (&Graph, f64),
        formulas: &[Node],
        place: impl FnOnce() -> (ForceAtPoints, Vec<[f64; 3]>),
    ) -> Option<Self> {
        let is_zero = |i: &usize| graph.value_of_constant(formulas[*i]) == Some(0.0);
        let components: Vec<usize> = (0..formulas.len()).filter(|i| !is_zero(i)).collect();
        if components.is_empty() {
            return None;
        }
        let (integral, points) = place();
        let nonzero: Vec<Node> = components.iter().map(|&i| formulas[i]).collect();
        let bound = Mutex::new(Program::compile(graph, &nonzero, horizon).bind(&points));
        Some(Self { components, bound, integral })
    }

    /// Adds the integral at time t to a nodal vector.
    fn add_to(&self, t: f64, force: &mut [f64]) {
        let values = self.bound.lock().unwrap_or_else(PoisonError::into_inner).values_at(t, 0.0);
        for (&component, values) in self.components.iter().zip(&values) {
            self.integral.add(component, values, force);
        }
    }
}

/// Given loads on one mesh, with a reference run in place of the exact solution.
struct ReferenceTruth {
    space: Arc<Discretization>,
    load: GivenLoad,
    reference: Option<Arc<ReferenceRun>>,
    /// Position of the reference mesh within this one.
    refinement: OnceLock<Result<Refinement, ReferenceError>>,
    moments: ByTime<Moments>,
}

impl Truth for ReferenceTruth {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        self.load.at(t, &self.space).map(Arc::new)
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        let reference = self.reference.as_ref().ok_or(LoadError::NoTruth { t })?;
        let refused = |error: &ReferenceError| LoadError::Reference { reason: error.to_string() };
        let refinement = self.refinement.get_or_init(|| reference.refinement(&self.space));
        let refinement = refinement.as_ref().map_err(refused)?;
        self.moments.get_or(t, || {
            reference.moments(refinement, &self.space, t).map_err(|error| refused(&error))
        })
    }
}

// Quadrature error of loads and errors on a mesh, by comparison with the next rule at a few times.

/// Factor of the largest response of A = 𝒜 + μ to a difference of loads, for all times. The response bounds the change
/// of an error, which is smaller, since errors are nearly orthogonal to V^h (`sweep check --floors` measures it).
const SAFETY: f64 = 1.5;

/// Parts of [0, T] at whose ends rules are compared: once with moving fronts, once at the end, where some scenes have
/// none.
const TIMES: u32 = 2;
/// Times on meshes of few cells, where two times may miss a front.
const TIMES_ON_FEW: u32 = 4;
const FEW: usize = 4096;

/// Relative rounding of equal times.
const SAME_TIME: f64 = 1e-9;

/// Comparison of loads and moments with the next rules.
#[derive(Debug, Default)]
pub struct RuleCheck {
    /// Contribution of the load quadrature to each norm.
    pub floors: Floors,
    /// Moments of the exact fields by the next rule, with their times.
    moments: Vec<(f64, Arc<Moments>)>,
}

impl RuleCheck {
    /// The moments by the next rule, if t is one of the compared times.
    pub fn moments(&self, t: f64) -> Option<&Moments> {
        let close = |(time, _): &&(f64, Arc<Moments>)| (time - t).abs() <= SAME_TIME * t.abs();
        self.moments.iter().find(close).map(|(_, moments)| &**moments)
    }
}

/// The times at which rules are compared.
fn check_times(setup: &Setup, cells: usize) -> Vec<f64> {
    let steps = setup.scene.sweep.as_ref().and_then(|sweep| sweep.steps.iter().max());
    let most = if cells <= FEW { TIMES_ON_FEW } else { TIMES };
    let parts = steps.map_or(most, |&steps| most.min(steps));
    (1..=parts).map(|i| setup.scene.time.horizon * f64::from(i) / f64::from(parts)).collect()
}

/// Floors from load vectors at equal times by two rules; `elasticity` and `mu` are the scene's.
fn load_floors(
    space: &Discretization,
    [usual, stronger]: &[Vec<Arc<Vec<f64>>>; 2],
    elasticity: &TensorField,
    mu: f64,
) -> Result<Floors, LoadError> {
    let mut operator = ElasticProjection::new(space, elasticity, mu, false)
        .map_err(|error| LoadError::Reference { reason: error.to_string() })?;
    let still = LevelFields { u: vec![0.0; space.nodes.len()], ..LevelFields::default() };
    // Stresses follow strains by the largest modulus; on Γ3 strains are those of its cells.
    let largest = elasticity.eigenvalues(space.mesh.dimension).1;
    let mut floors = Floors::default();
    for (usual, stronger) in usual.iter().zip(stronger) {
        let difference: Vec<f64> = stronger.iter().zip(&**usual).map(|(a, b)| a - b).collect();
        let u = operator.response(&difference);
        let pressure = largest * strain_on_contact(space, &u);
        let moved = LevelFields { u, ..LevelFields::default() }.distance(&still, space);
        floors = floors.max(Floors { stress: largest * moved.v, pressure, ..moved });
    }
    Ok(floors.times(SAFETY))
}

/// ‖ε(v)‖ on Γ3, from the cells with a side on it: a cell of measure m has about 2m/h of Γ3. In space the norm in the
/// body is used.
fn strain_on_contact(space: &Discretization, v: &[f64]) -> f64 {
    if space.mesh.dimension != 2 {
        return strain_norm(space, v);
    }
    let mut on_contact = vec![false; space.mesh.vertices()];
    for &facet in &space.trace.mesh_facet {
        let corners = space.mesh.facet(facet as usize).iter();
        corners.for_each(|&vertex| on_contact[vertex as usize] = true);
    }
    let touches = |at: &StrainPoint<'_>| {
        let corners = space.mesh.cell(at.cell).iter();
        corners.filter(|&&vertex| on_contact[vertex as usize]).count() > 1
    };
    let squares = space
        .points()
        .filter(touches)
        .map(|at| at.weight * at.strain::<3>(v).iter().map(|e| e * e).sum::<f64>());
    (2.0 * squares.sum::<f64>() / space.mesh.h()).sqrt()
}
