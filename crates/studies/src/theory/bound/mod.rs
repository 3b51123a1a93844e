//! The bound (3.4) on the step size, made measurable: constants, the contraction factor of Λ, and the
//! step size at which the discrete problem itself loses its unique solution. Every inequality is a claim: measured factors ≤
//! sharpened ≤ (3.15) at every k, thresholds the other way, samples ≤ declared constants.

mod constants;
mod document;
mod factor;
mod ladder;
pub mod sampled;

pub use constants::{Constant, Obtained};
pub use factor::{Contraction, Crossing, Starts, contraction, finite_factor};
pub use ladder::{
    BoundError, ContractionStudy, FactorAtLevel, Loss, StepLadder, StepRung, Thresholds,
};

use ::run::sweep::Runs;
use algebra::linalg::KRYLOV_VECTORS;
use constants::TraceConstants;
use fem::contact::{Discretization, Evolution};
use files::digits;
use judge::claim::{Claim, Place, Statement};
use scene::Scene;
use scene::setup::{AbstractLoad, AbstractSetup, MeshData, Setup, Smallness, TruthLoad};
use vhi::finite::FiniteEvolution;
use vhi::{StepBounds, StepState};

/// Everything that `sweep bound` says of a scene.
#[derive(Debug, Clone)]
pub struct BoundStudy {
    /// Name of the scene.
    pub scene: String,
    /// Fingerprint of the scene's text.
    pub fingerprint: String,
    /// Cells per unit length; none without a mesh.
    pub n: Option<u32>,
    /// N of the run.
    pub steps: u32,
    /// Every constant.
    pub constants: Vec<Constant>,
    /// The bounds, with the constants of the mesh n.
    pub limits: StepBounds,
    /// Factors.
    pub study: ContractionStudy,
    /// Every inequality.
    pub claims: Vec<Claim>,
    /// Between what m0 lies, where its sign is unknown.
    pub unknown: Option<[f64; 2]>,
}

/// The mesh of the samples: eight unknowns a unit length suffice for tensors of every kind.
const SAMPLE_MESH: u32 = 4;
/// Rounding of a norm: eigenvalues settle to 1e-13, and the norm is their root.
const NORM: f64 = 1e-9;
/// Rounding of finite perturbations: 1e-13 over 1e-6, with room for the condition.
const FINITE: f64 = 1e-5;
/// Derivative against differences. A kink of Λ that a perturbation of 1e-6 crosses concerns few cells.
const DERIVATIVE: f64 = 0.02;
/// Thresholds are bracketed to 1e-7 relative, a singular tangent is approached to 1e-6.
const THRESHOLD: f64 = 5e-6;
/// Below this bound of the factor Λ reaches 1e-13 within the iterations it is given.
const SURE: f64 = 0.9;
/// Rounding of an eigenvalue that settles to 1e-13.
const EIGENVALUE: f64 = 1e-10;

impl BoundStudy {
    /// Studies a scene on the mesh `n`, along a run with `steps` steps.
    ///
    /// # Errors
    /// [`BoundError`].
    pub fn new(setup: &Setup, n: u32, steps: u32) -> Result<Self, BoundError> {
        if setup.model.time_rule.last_share() == 0.0 {
            return Err(BoundError::NoLastSlot);
        }
        let traces = TraceConstants::new(setup, &*setup.space(n)?)?;
        let whole = scene::setup::constants(setup)?;
        let constants = traces.as_ref().map_or_else(|| whole.clone(), |of| of.on_mesh(setup));
        let limits = constants.step_bounds(setup.model.time_rule.as_ref());
        let fits = setup.scene.check_cells(SAMPLE_MESH).is_ok();
        let small = setup.space(if fits { SAMPLE_MESH } else { n })?;
        let samples = sampled::sample(setup, &constants, &small)?;
        let study = study(setup, &limits, n, steps)?;
        let table = constants::table(setup, &whole, constants.m0, traces.as_ref());
        let (known, m0) = (whole.smallness(), whole.m0);
        let grid = (Some(n), steps);
        let mut study = Self::of(&setup.scene, grid, table, samples, limits, study, (known, m0));
        // The proved bound of c_j² against the eigenvalues of the mesh, in both masses, and of the meshes for the limit.
        if let (Some(traces), Some(bound)) = (traces, constants.c_j_squared_bound) {
            let on_mesh = traces.strain.values.map(|value| (format!("n = {n}"), value));
            let of_limit = traces.strain.limit.iter().flat_map(|limit| &limit.values);
            let of_limit = of_limit.map(|(cells, value)| (format!("{cells} cells"), *value));
            study.claims.extend(on_mesh.into_iter().chain(of_limit).map(|(at, value)| {
                let says = ("c_j^2", "on a mesh <= its proved bound");
                claim(at, says, [value, bound], EIGENVALUE * bound)
            }));
        }
        study.unknown = (known == Smallness::Unknown).then_some(whole.m0_range);
        Ok(study)
    }

    /// Studies an abstract scene along a run with `steps` steps.
    ///
    /// # Errors
    /// [`BoundError`].
    pub fn of_abstract(setup: &AbstractSetup, steps: u32) -> Result<Self, BoundError> {
        let (model, c) = (&setup.model, &setup.constants);
        if model.time_rule.last_share() == 0.0 {
            return Err(BoundError::NoLastSlot);
        }
        let limits = c.step_bounds(model.time_rule.as_ref());
        let (grid, mut load) = (setup.grid(steps), AbstractLoad(setup));
        let mut level = FiniteEvolution::new(model, &grid, &mut load)?;
        let levels = ladder::all_levels(&mut level, &limits, None)?;
        let mut study = ContractionStudy::of_levels(levels, steps)?;
        let mut level = FiniteEvolution::new(model, &grid, &mut load)?;
        let state = ladder::run_to(&mut level, study.worst.level, |_, _, _| Ok(()))?;
        study.climb(&mut level, state, &limits)?;
        let samples = sampled::finite(model, c);
        let known = if c.m0 > 0.0 { Smallness::Holds } else { Smallness::Fails };
        let (table, m0) = (constants::finite(c, model), (known, c.m0));
        Ok(Self::of(&setup.scene, (None, steps), table, samples, limits, study, m0))
    }

    /// What follows from all that was found.
    fn of(
        scene: &Scene,
        (n, steps): (Option<u32>, u32),
        constants: Vec<Constant>,
        samples: Vec<Claim>,
        limits: StepBounds,
        study: ContractionStudy,
        (known, m0): (Smallness, f64),
    ) -> Self {
        let mut claims = claims(&limits, &study.rungs, &study.thresholds);
        // 0 < m0: everything that the bound says rests on it.
        if known == Smallness::Fails {
            claims.push(claim("", ("(2.9)", "0 < m0"), [0.0, m0], -f64::MIN_POSITIVE));
        }
        claims.extend(samples);
        if study.worst.k < limits.solvable_limit() {
            let others = f64::from(study.starts.distinct);
            let says = ("uniqueness in the run", "other solutions from random starts <= 0");
            claims.push(claim(at(study.worst.k), says, [others, 0.0], 0.0));
        }
        Self {
            scene: scene.name.clone(),
            fingerprint: scene.source.hash.clone(),
            n,
            steps,
            constants,
            limits,
            study,
            claims,
            unknown: None,
        }
    }

    /// Whether every inequality and every declared constant holds.
    pub fn holds(&self) -> bool {
        Claim::all_hold(&self.claims)
    }
}

fn at(k: f64) -> String {
    format!("k = {}", digits(k, 7))
}

fn claim(
    at: impl Into<String>,
    (source, says): (&'static str, &'static str),
    sides: [f64; 2],
    accuracy: f64,
) -> Claim {
    let place = Place { at: at.into(), ..Place::default() };
    Claim::at_most(Statement { source, says }, place, sides, accuracy)
}

/// The inequalities of a ladder and its thresholds.
pub fn claims(bounds: &StepBounds, rungs: &[StepRung], found: &Thresholds) -> Vec<Claim> {
    let mut claims = Vec::new();
    let one = |solved: bool| f64::from(u8::from(solved));
    for rung in rungs {
        let StepRung { norm, sharpened, theorem, .. } = *rung;
        let rounded = FINITE * if sharpened == 0.0 { 1.0 } else { sharpened };
        let (off, allowed) = ((rung.finite_worst - norm).abs(), DERIVATIVE * norm);
        let mut say = |source, says, left, right, accuracy| {
            claims.push(claim(at(rung.k), (source, says), [left, right], accuracy));
        };
        say("sharpened", "|DLambda| <= sharpened factor", norm, sharpened, NORM * sharpened);
        say("radius", "spectral radius <= |DLambda|", rung.radius, norm, FINITE * norm);
        let finite = "finite factor, worst direction <= sharpened";
        say("finite", finite, rung.finite_worst, sharpened, rounded);
        say("derivative", "|finite - derivative| <= 2 % of it", off, allowed, 0.0);
        say("(3.15)", "sharpened factor <= (3.15)", sharpened, theorem, NORM * theorem);
        say("(3.15)", "(3.15) <= (3.15) in the paper's norm", theorem, rung.paper, 0.0);
        if rung.k < bounds.solvable_limit() {
            let newton = one(rung.newton.is_ok());
            say("solvable", "1 <= Newton finds the guaranteed solution", 1.0, newton, 0.0);
            let others = f64::from(rung.distinct);
            say("uniqueness", "solutions beside the one guaranteed <= 0", others, 0.0, 0.0);
        }
        if sharpened < SURE {
            let solved = one(rung.fixed_point.is_ok());
            say("contraction", "1 <= Lambda converges where it must", 1.0, solved, 0.0);
        }
    }
    let (norm, radius) = (found.norm, found.radius);
    let lost = found.loss.as_ref().map(|loss| loss.bracket[1]);
    let [paper, proved] = [bounds.paper_limit(), bounds.limit()].map(Some);
    let [sharpened, solvable] = [bounds.sharpened_limit(), bounds.solvable_limit()].map(Some);
    let [lower, upper] = [0, 1].map(|end: usize| move |crossing: Crossing| crossing[end]);
    let ordered = [
        ("k of (3.4), the paper's norm <= k of (3.4)", paper, proved),
        ("k of (3.4) <= sharpened k", proved, sharpened),
        ("sharpened k <= solvable k", sharpened, solvable),
        ("sharpened k <= k with |DLambda| = 1", sharpened, norm.map(upper)),
        ("k with |DLambda| = 1 <= k with spectral radius 1", norm.map(lower), radius.map(upper)),
        ("solvable k <= k that loses solvability", solvable, lost),
        ("k with spectral radius 1 <= k that loses solvability", radius.map(lower), lost),
    ];
    for (says, left, right) in ordered {
        // What was not found, or holds for every k, is in no order.
        if let (Some(left), Some(right)) = (left, right.filter(|k| *k != f64::INFINITY)) {
            claims.push(claim("", ("threshold", says), [left, right], THRESHOLD * right));
        }
    }
    claims
}

/// Runs the scene on the mesh `n` with `steps` steps and studies its worst level.
///
/// # Errors
/// [`BoundError`].
pub fn study(
    setup: &Setup,
    bounds: &StepBounds,
    n: u32,
    steps: u32,
) -> Result<ContractionStudy, BoundError> {
    let levels_on = |n: u32| {
        let data = MeshData::new(setup, n, None)?;
        on_run(setup, &data, steps, |level| ladder::all_levels(level, bounds, Some(n)))
    };
    let mut study = ContractionStudy::of_levels(levels_on(n)?, steps)?;
    let worst = study.worst.level;
    for other in meshes_beside(setup, n) {
        let at_worst = match other == n {
            true => Some(study.worst),
            false => levels_on(other)?.get(worst - 1).copied(),
        };
        study.meshes.extend(at_worst);
    }
    let data = MeshData::new(setup, n, None)?;
    at_level(setup, &data, steps, worst, |level, state| study.climb(level, state, bounds))?;
    Ok(study)
}

/// The mesh n and its neighbours, as far as the domain has them.
fn meshes_beside(setup: &Setup, n: u32) -> impl Iterator<Item = u32> {
    let fits = |&other: &u32| other > 0 && setup.scene.check_cells(other).is_ok();
    [n / 2, n, 2 * n].into_iter().filter(fits)
}

/// The runs of a study.
pub fn study_runs(setup: &Setup, n: u32, steps: u32) -> Runs<'_> {
    let grid = meshes_beside(setup, n).map(|n| (n, steps)).collect();
    // The factors of the volume's tangent and of the inner product, the vectors of an eigenvalue and a ladder's solutions.
    let vectors = KRYLOV_VECTORS + ladder::SOLUTIONS;
    let beside = move |space: &Discretization, _| {
        8.0 * (2.0 * space.factor_size()[0] + (vectors * space.dofs()) as f64)
    };
    Runs { setup, grid, beside: Box::new(beside) }
}

/// Runs to level `number`, leaves it open, and shows it with its solution.
///
/// # Errors
/// The run's, and those of `see`.
pub fn at_level<T>(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    number: usize,
    see: impl FnOnce(&mut Evolution<'_>, StepState) -> Result<T, BoundError>,
) -> Result<T, BoundError> {
    on_run(setup, data, steps, |level| {
        let state = ladder::run_to(level, number, |_, _, _| Ok(()))?;
        see(level, state)
    })
}

/// Shows a run before its first level.
fn on_run<T>(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    see: impl FnOnce(&mut Evolution<'_>) -> Result<T, BoundError>,
) -> Result<T, BoundError> {
    let grid = setup.grid(steps);
    let mut load = TruthLoad(&*data.truth);
    see(&mut Evolution::new(&data.space, &setup.model, &grid, &mut load)?)
}
