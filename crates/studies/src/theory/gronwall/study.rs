//! The study of a scene: grids, horizons and perturbations, with every link of the chain checked.

use super::GronwallError;
use super::constants::Summary;
use super::estimate::{Envelopes, Violation, effectivities, maximum};
use super::horizon::{Horizons, horizons};
use super::in_time::prepare;
use super::measure::TemporalRun;
use super::stability::{Perturbation, perturbations};
use scene::setup::Subject;

/// What is asked of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Mesh cells a unit length; none for abstract scenes.
    pub n: Option<u32>,
    /// Numbers N of steps.
    pub steps: Vec<u32>,
    /// Horizons T, at the step of the largest N; none if empty.
    pub horizons: Vec<f64>,
}

/// One grid with its bounds.
pub struct StudiedGrid {
    pub run: TemporalRun,
    pub envelopes: Envelopes,
    pub violations: Vec<Violation>,
}

/// All that was found.
pub struct Study {
    pub scene: String,
    pub question: String,
    pub plan: Plan,
    pub constants: Summary,
    /// Where the truth of the error comes from.
    pub truth: String,
    pub grids: Vec<StudiedGrid>,
    pub horizons: Option<Horizons>,
    pub perturbations: Vec<Perturbation>,
}

/// bound/e of one grid.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Effectivity {
    /// At t_N = T; absent if e_N is at its floor.
    pub at_end: Option<f64>,
    /// max_n bound/max_n e.
    pub of_maxima: f64,
    /// The least over n ≥ 1: how close the bound comes to being attained.
    pub least: Option<f64>,
}

impl StudiedGrid {
    /// The effectivity of one of the bounds.
    pub fn effectivity(&self, bound: &[f64]) -> Effectivity {
        let ratios = effectivities(bound, &self.run.estimate);
        Effectivity {
            at_end: ratios.last().copied().flatten(),
            of_maxima: maximum(bound) / maximum(&self.run.estimate.error),
            least: ratios.into_iter().flatten().reduce(f64::min),
        }
    }
}

impl Study {
    /// Runs everything.
    ///
    /// # Errors
    /// [`GronwallError`].
    pub fn run(subject: &Subject, plan: Plan) -> Result<Self, GronwallError> {
        let scene = subject.scene();
        let in_time = prepare(subject, plan.n, &plan.steps)?;
        let mut grids = Vec::new();
        for &steps in &plan.steps {
            let run = in_time.measure(steps)?;
            let envelopes =
                run.estimate.envelopes().map_err(|source| GronwallError::Step { steps, source })?;
            let violations = envelopes.violations(&run.estimate);
            grids.push(StudiedGrid { run, envelopes, violations });
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
        Ok(Self {
            scene: scene.name.clone(),
            question: scene.question.clone(),
            constants: in_time.constants(),
            truth: in_time.truth(),
            plan,
            grids,
            horizons,
            perturbations,
        })
    }

    /// Every link that fails, with the part of the study it belongs to.
    pub fn violations(&self) -> Vec<(String, Violation)> {
        let grids = self
            .grids
            .iter()
            .map(|own| (format!("N = {}", own.run.steps), own.violations.as_slice()));
        let horizons = self
            .horizons
            .iter()
            .map(|h| (format!("horizons, k = {}", h.k), h.violations.as_slice()));
        let perturbations = self.perturbations.iter().map(|p| {
            (format!("{} perturbation {:e}", p.shape.name(), p.size), p.violations.as_slice())
        });
        grids
            .chain(horizons)
            .chain(perturbations)
            .flat_map(|(part, own)| own.iter().map(move |v| (part.clone(), v.clone())))
            .collect()
    }
}
