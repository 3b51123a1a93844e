//! `sweep gronwall`: truncation errors, envelopes and their effectivities, horizons, perturbations.

use std::path::PathBuf;

use clap::Args;

use super::machine::Common;
use super::study::show;
use super::{CliError, Scenes};
use run::sweep::admit_constants;
use scene::Scene;
use scene::setup::Subject;
use studies::theory::gronwall::{StudyRuns, study, study_runs};

/// `sweep gronwall`.
#[derive(Args)]
#[command(
    after_help = "Effectivity = bound / measured error. The chain e <= weighted envelope <= primed envelope <= closed form, primed <= printed envelope <= its closed form is claimed at every n of every run. So is that the difference of two solutions under perturbed loads stays below its recurrence. Exit code 1: a claim fails; it is named with the first n at which it does.\n\nJSON keys with --json: scene, fingerprint (of its text), holds, claims (line, says, n, steps, level, at, left, relation, right, low, difference, accuracy, tightness, standing, holds, note), n, truth, constants (m0, beta_phi, lipschitz = |R||q| or that of S, C1, C2; of a body: yielding = mu L_kappa sqrt|Omega|, memory_norm, c_j_squared_bound; abstract: m_A, alpha_phi, alpha_j, c_j_squared, r_norm, q_norm), grids (steps, k, C2_k, error_end, error_max, truncation_end, truncation_max, floor, effectivity of weighted, primed, closed, limit, printed, printed_closed: each at_end, least), horizons (k, truth, rows: horizon, steps, error, truncation, weighted, primed, closed, limit, printed, printed_closed, c2, growth), perturbations (size, steps, load, difference, growth, weighted, primed, least_effectivity).\n\nFiles with --out: SCENE-gronwall.csv (every level of every run), SCENE-gronwall.json, SCENE-gronwall-claims.csv, SCENE-gronwall-envelope.svg, SCENE-gronwall-horizon.svg."
)]
pub(crate) struct Gronwall {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Cells per unit length, h = 1/n; abstract scenes have none [default: the first of the scene's list]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=4096))]
    n: Option<u32>,
    /// Numbers N of time steps, k = T/N [default: the scene's list up to 1024]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<Vec<u32>>,
    /// Horizons T at the step of the largest N, multiples of it
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    horizons: Vec<f64>,
    /// Directory for SCENE-gronwall.csv, SCENE-gronwall.json, its claims as CSV and the pictures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// Most steps taken from the scene's list: the weighted envelope takes O(N²).
const MOST_STEPS: u32 = 1024;

impl Gronwall {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let scene = scenes.scene(&self.scene)?;
        let plan = self.plan(&scene)?;
        if let Some(n) = plan.n.filter(|_| scene.as_contact().is_some()) {
            scene.check_cells(n)?;
        }
        scene.check_steps(&plan.steps)?;
        admit_constants(&scene, true, &self.common.allowance.limit())?;
        let subject = Subject::new(scene)?;
        // An abstract problem keeps a few numbers per level.
        if let (Subject::Contact(setup), Some(n)) = (&subject, plan.n) {
            study_runs(setup, n, &plan).admit(&self.common.allowance.limit())?;
        }
        let found = study(&subject, &plan).map_err(CliError::other)?;
        show(&found, self.out.as_deref(), self.common.json)
    }

    fn plan(&self, scene: &Scene) -> Result<StudyRuns, CliError> {
        let sweep = scene.sweep.as_ref();
        let n = self.n.or_else(|| sweep.and_then(|sweep| sweep.n.first().copied()));
        let admitted =
            |list: &Vec<u32>| list.iter().copied().filter(|&steps| steps <= MOST_STEPS).collect();
        let steps = self.steps.clone().or_else(|| sweep.map(|sweep| admitted(&sweep.steps)));
        let Some(mut steps) = steps.filter(|steps| !steps.is_empty()) else {
            return Err(CliError::other("no numbers of steps: give --steps 16,32,64"));
        };
        steps.sort_unstable();
        steps.dedup();
        Ok(StudyRuns { n, steps, horizons: self.horizons.clone() })
    }
}
