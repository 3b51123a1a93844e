//! The bound (3.4) on the step size, made measurable: constants, the contraction factor of Λ, and the
//! step size at which the discrete problem itself loses its unique solution.
//!
//! `factor`, `crossing`, `branch`, `ladder`, `starts`, `run` and `gate` know no mesh: they ask for a
//! [`vhi::FrozenDerivative`] and for [`StepBounds`]. `contact`, `constants`, `linear` and
//! `sampled` are about Problem 14, `finite` about Problem 9 in ℝ^m.

pub mod branch;
mod constant_table;
mod constants;
pub mod contact;
mod crossing;
mod document;
pub mod factor;
mod finite;
pub mod gate;
pub mod ladder;
mod linear;
mod picture;
pub mod run;
pub mod sampled;
mod starts;

pub use crossing::Crossing;

use constant_table::Constant;
use constants::TraceConstants;
use gate::BoundViolation;
use ladder::{BoundError, StepRung};
use run::ContractionStudy;
use sampled::Sampled;

use scene::Scene;
use scene::setup::{Setup, Smallness};
use serde::Serialize;
use vhi::StepBounds;

/// Everything that `sweep bound` says of a scene.
#[derive(Debug, Clone, Serialize)]
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
    /// Declared constants against samples.
    pub samples: Vec<Sampled>,
    /// The bounds, with the constants of the mesh n.
    #[serde(skip)]
    pub limits: StepBounds,
    /// Factors.
    #[serde(flatten)]
    pub study: ContractionStudy,
    /// Step sizes up to which something holds, as JSON: null where it does for every k.
    pub thresholds: serde_json::Value,
    /// The measured threshold of Λ over (3.4) with the paper's norms: how many times too strict that is; none if Λ has no
    /// threshold.
    pub ratio: Option<f64>,
    /// Whether the measured factor equals the sharpened bound at some step size.
    pub attained: bool,
    /// Inequalities that do not hold.
    pub violations: Vec<BoundViolation>,
    /// Between what m0 lies, where its sign is unknown.
    #[serde(rename = "m0_unknown")]
    pub unknown: Option<[f64; 2]>,
}

/// The mesh of the samples: eight unknowns a unit length suffice for tensors of every kind.
const SAMPLE_MESH: u32 = 4;
/// The bound is called attained if the measured factor comes this close.
const ATTAINED: f64 = 1e-6;

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
        let study = contact::study(setup, &limits, n, steps)?;
        let mut found = trace_violations(traces.as_ref(), &constants);
        found.extend(smallness_violation(whole.smallness(), whole.m0));
        let table = constant_table::table(setup, &whole, constants.m0, traces.as_ref());
        let grid = (Some(n), steps);
        let mut study = Self::of(&setup.scene, grid, table, samples, limits, study, found);
        if whole.smallness() == Smallness::Unknown {
            study.unknown = Some(whole.m0_range);
        }
        Ok(study)
    }

    /// What follows from all that was found; `of_traces` are violations that only a mesh can have.
    fn of(
        scene: &Scene,
        (n, steps): (Option<u32>, u32),
        constants: Vec<Constant>,
        samples: Vec<Sampled>,
        limits: StepBounds,
        study: ContractionStudy,
        of_traces: Vec<BoundViolation>,
    ) -> Self {
        let mut violations = gate::violations(&limits, &study.rungs, &study.thresholds);
        violations.extend(of_traces);
        violations.extend(samples.iter().filter(|sample| !sample.holds).map(|sample| {
            let what = format!("{}: needed <= declared", sample.what);
            BoundViolation::new(what, sample.needed, sample.declared)
        }));
        let k = study.worst.k;
        if k < limits.solvable_limit() {
            let others = f64::from(study.starts.distinct);
            let what = "other solutions from random starts <= 0";
            violations.extend(gate::broken(Some(k), what, others, 0.0));
        }
        let attained = |r: &StepRung| r.sharpened > 0.0 && r.norm >= (1.0 - ATTAINED) * r.sharpened;
        let measured = study.thresholds.radius.map(|[low, _]| low);
        Self {
            scene: scene.name.clone(),
            fingerprint: scene.source.hash.clone(),
            n,
            steps,
            constants,
            samples,
            thresholds: thresholds(&limits, &study),
            ratio: measured.map(|k| k / limits.paper_limit()),
            attained: study.rungs.iter().any(attained),
            limits,
            study,
            violations,
            unknown: None,
        }
    }

    pub(crate) fn grids(&self) -> String {
        let mesh = self.n.map_or(String::new(), |n| format!("n = {n}, "));
        format!("{mesh}N = {}", self.steps)
    }

    /// Whether every inequality and every declared constant holds.
    pub fn holds(&self) -> bool {
        self.violations.is_empty()
    }
}

/// 0 < m0: everything that the bound says rests on it.
fn smallness_violation(known: Smallness, m0: f64) -> Option<BoundViolation> {
    (known == Smallness::Fails).then(|| BoundViolation::new("0 < m0, (2.9)", 0.0, m0))
}

/// The proved bound of c_j² against the eigenvalues of the mesh, in both masses, and of the meshes for the limit.
fn trace_violations(
    traces: Option<&TraceConstants>,
    constants: &scene::setup::Constants,
) -> Vec<BoundViolation> {
    let (Some(traces), Some(bound)) = (traces, constants.c_j_squared_bound) else {
        return Vec::new();
    };
    // Rounding of an eigenvalue that settles to 1e-13.
    let most = bound * (1.0 + 1e-10);
    let on_mesh = traces.strain.values.map(|value| (format!("the mesh n = {}", traces.n), value));
    let of_limit = traces.strain.limit.iter().flat_map(|limit| &limit.values);
    let of_limit = of_limit.map(|(cells, value)| (format!("a mesh of {cells} cells"), *value));
    let above = on_mesh.into_iter().chain(of_limit);
    let above = above.filter(|(_, value)| value.is_nan() || *value > most);
    let what = |mesh: &str| format!("c_j^2 on {mesh} <= its proved bound");
    above.map(|(mesh, value)| BoundViolation::new(what(&mesh), value, bound)).collect()
}

/// The step sizes that are proved, and those that were found.
fn thresholds(limits: &StepBounds, study: &ContractionStudy) -> serde_json::Value {
    let (found, loss) = (&study.thresholds, study.thresholds.loss.as_ref());
    serde_json::json!({
        "paper_norm": limits.paper_limit(),
        "theorem": limits.limit(),
        "sharpened": limits.sharpened_limit(),
        "solvable": limits.solvable_limit(),
        "norm_one": found.norm,
        "radius_one": found.radius,
        "loss": loss.map(|loss| loss.bracket),
        "loss_reason": loss.map(|loss| loss.reason.to_string()),
        "loss_eigenvalue": loss.map(|loss| loss.rightmost),
        "not_followed": study.not_followed,
        "loss_tensors": study.linear.map(|loss| loss.tensors),
        "loss_mesh": study.linear.map(|loss| loss.mesh),
    })
}
