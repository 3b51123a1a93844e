//! The study of a scene: grids, horizons and perturbations, with every link of the chain checked.

use super::GronwallError;
use super::bounds::Bounds;
use super::constants::InequalityConstants;
use super::estimate::{Effectivity, Estimate, Judged, LinkViolation};
use super::horizon::{Horizons, horizons};
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
    pub effectivity: Bounds<Effectivity>,
    #[serde(skip)]
    pub judged: Judged,
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

impl StudiedGrid {
    fn new(estimate: Estimate) -> Result<Self, GronwallError> {
        let judged = Judged::new(estimate)?;
        let estimate = &judged.estimate;
        let [zeta, memory] = &estimate.truncation;
        let truncation: Vec<f64> = zeta.iter().zip(memory).map(|(z, b)| z + b).collect();
        let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
        let k = estimate.grid.largest_step();
        Ok(Self {
            steps: estimate.grid.steps() as u32,
            k,
            c2_k: estimate.c2() * estimate.weights.of_step(k),
            error_end: last(&estimate.error),
            error_max: largest(&estimate.error),
            truncation_end: last(&truncation),
            truncation_max: largest(&truncation),
            floor: estimate.floor,
            effectivity: judged.envelopes.map(|bound| Effectivity::new(bound, estimate)),
            judged,
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
        let mut study = Self {
            scene: scene.name.clone(),
            fingerprint: scene.source.hash.clone(),
            n: plan.n,
            constants: in_time.constants(),
            truth: in_time.truth(),
            grids,
            horizons,
            perturbations,
            violations: Vec::new(),
            verdict: "pass",
        };
        study.violations = study.failed_links();
        if !study.violations.is_empty() {
            study.verdict = "fail";
        }
        Ok(study)
    }

    /// All runs, each with its name in the table of levels and in words.
    pub(super) fn judged(&self) -> impl Iterator<Item = (String, String, &Judged)> {
        let grids = self.grids.iter();
        let grids = grids.map(|g| ("time".into(), format!("N = {}", g.steps), &g.judged));
        let horizons = self.horizons.iter();
        let horizons =
            horizons.map(|h| ("horizon".into(), format!("horizons, k = {}", h.k), &h.judged));
        let perturbations = self.perturbations.iter().map(|p| {
            let (shape, size) = (p.shape.name(), p.size);
            (format!("{shape}-{size:e}"), format!("{shape} perturbation {size:e}"), &p.judged)
        });
        grids.chain(horizons).chain(perturbations)
    }

    fn failed_links(&self) -> Vec<FailedLink> {
        let failed = self.judged().flat_map(|(_, part, judged)| {
            let of =
                move |v: &LinkViolation| FailedLink { part: part.clone(), violation: v.clone() };
            judged.violations.iter().map(of)
        });
        failed.collect()
    }
}
