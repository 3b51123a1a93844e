//! The study of a scene: grids, horizons and perturbations, with every link of the chain checked.

use super::GronwallError;
use super::constants::InequalityConstants;
use super::estimate::{Envelopes, Estimate, LinkViolation, effectivities};
use super::horizon::{Horizons, horizons};
use super::measure::TemporalRun;
use super::prepare::prepare;
use super::stability::{Perturbation, perturbations};
use algebra::linalg::largest;
use scene::setup::Subject;
use serde::Serialize;

/// What is asked of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRuns {
    /// Mesh cells per unit length; none for abstract scenes.
    pub n: Option<u32>,
    /// Numbers N of steps.
    pub steps: Vec<u32>,
    /// Horizons T, at the step of the largest N; none if empty.
    pub horizons: Vec<f64>,
}

/// One grid with its bounds; as JSON without its curves, which the table of all levels holds.
#[derive(Serialize)]
pub struct StudiedGrid {
    /// N.
    pub steps: u32,
    /// Largest step.
    pub k: f64,
    /// C2 k.
    #[serde(rename = "C2_k")]
    pub c2_k: f64,
    /// e_N, and max_n e_n.
    pub error_end: f64,
    pub error_max: f64,
    /// g_N, and max_n g_n.
    pub truncation_end: f64,
    pub truncation_max: f64,
    /// Floor of e_n.
    pub floor: f64,
    /// Bound over error of every envelope.
    pub effectivity: Effectivities,
    #[serde(skip)]
    pub run: TemporalRun,
    #[serde(skip)]
    pub envelopes: Envelopes,
    #[serde(skip)]
    pub violations: Vec<LinkViolation>,
}

/// All that was found.
#[derive(Serialize)]
pub struct Study {
    pub scene: String,
    /// Fingerprint of the scene's text.
    pub fingerprint: String,
    /// Mesh cells per unit length; none for abstract scenes.
    pub n: Option<u32>,
    pub constants: InequalityConstants,
    /// Where the truth of the error comes from.
    pub truth: String,
    pub grids: Vec<StudiedGrid>,
    pub horizons: Option<Horizons>,
    pub perturbations: Vec<Perturbation>,
    /// Every link that fails.
    pub violations: Vec<FailedLink>,
    /// "pass" where none does, "fail" otherwise.
    pub verdict: &'static str,
}

/// A link that fails, with the part of the study it belongs to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FailedLink {
    pub part: String,
    #[serde(flatten)]
    pub violation: LinkViolation,
}

/// bound/e of one grid, for every envelope.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effectivities {
    pub weighted: Effectivity,
    pub primed: Effectivity,
    pub closed: Effectivity,
    pub limit: Effectivity,
    /// Absent where C2 k ≥ 1.
    pub printed: Option<Effectivity>,
    pub printed_closed: Option<Effectivity>,
}

/// bound/e of one grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Effectivity {
    /// At t_N = T; absent if e_N is at its floor.
    pub at_end: Option<f64>,
    /// max_n bound/max_n e.
    pub of_maxima: f64,
    /// The least over n ≥ 1: how close the bound comes to being attained.
    pub least: Option<f64>,
}

impl Effectivity {
    pub(crate) fn new(bound: &[f64], estimate: &Estimate) -> Self {
        let ratios = effectivities(bound, estimate);
        Self {
            at_end: ratios.last().copied().flatten(),
            of_maxima: largest(bound) / largest(&estimate.error),
            least: ratios.into_iter().flatten().reduce(f64::min),
        }
    }
}

impl StudiedGrid {
    fn new(run: TemporalRun) -> Result<Self, GronwallError> {
        let (envelopes, violations) = run.estimate.judged()?;
        let (estimate, truncation) = (&run.estimate, run.truncation());
        let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
        let of = |bound: &[f64]| Effectivity::new(bound, estimate);
        let k = estimate.grid.largest_step();
        Ok(Self {
            steps: run.steps,
            k,
            c2_k: estimate.c2() * estimate.weights.of_step(k),
            error_end: last(&estimate.error),
            error_max: largest(&estimate.error),
            truncation_end: last(&truncation),
            truncation_max: largest(&truncation),
            floor: estimate.floor,
            effectivity: Effectivities {
                weighted: of(&envelopes.weighted),
                primed: of(&envelopes.primed),
                closed: of(&envelopes.closed),
                limit: of(&envelopes.limit),
                printed: envelopes.printed.as_deref().map(of),
                printed_closed: envelopes.printed_closed.as_deref().map(of),
            },
            violations,
            run,
            envelopes,
        })
    }
}

impl Study {
    /// Runs everything.
    ///
    /// # Errors
    /// [`GronwallError`].
    pub fn run(subject: &Subject, plan: StudyRuns) -> Result<Self, GronwallError> {
        let scene = subject.scene();
        let in_time = prepare(subject, plan.n, &plan.steps)?;
        let mut grids = Vec::new();
        for &steps in &plan.steps {
            grids.push(StudiedGrid::new(in_time.measure(steps)?)?);
        }
        let finest = plan.steps.iter().copied().max().unwrap_or(1);
        let perturbations = perturbations(&*in_time, finest)?;
        let horizons = match plan.horizons[..] {
            [] => None,
            _ => {
                let k = scene.time.horizon / f64::from(finest);
                Some(horizons(subject, plan.n, k, &plan.horizons)?)
            }
        };
        let violations = failed_links(&grids, horizons.as_ref(), &perturbations);
        Ok(Self {
            scene: scene.name.clone(),
            fingerprint: scene.source.hash.clone(),
            n: plan.n,
            constants: in_time.constants(),
            truth: in_time.truth(),
            grids,
            horizons,
            perturbations,
            verdict: if violations.is_empty() { "pass" } else { "fail" },
            violations,
        })
    }
}

fn failed_links(
    grids: &[StudiedGrid],
    horizons: Option<&Horizons>,
    perturbations: &[Perturbation],
) -> Vec<FailedLink> {
    let grids = grids.iter().map(|grid| (format!("N = {}", grid.steps), &grid.violations));
    let horizons = horizons.iter().map(|h| (format!("horizons, k = {}", h.k), &h.violations));
    let perturbations = perturbations
        .iter()
        .map(|p| (format!("{} perturbation {:e}", p.shape.name(), p.size), &p.violations));
    let parts = grids.chain(horizons).chain(perturbations);
    parts
        .flat_map(|(part, violations)| {
            violations.iter().map(move |v| FailedLink { part: part.clone(), violation: v.clone() })
        })
        .collect()
}
