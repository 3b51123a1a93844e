//! `sweep bound`: the step-size bound (3.4) in four numbers, with its constants.

use std::path::PathBuf;

use super::machine::Common;
use super::{CliError, Scenes, study};
use clap::Args;
use scene::Extension;
use scene::setup::Subject;
use studies::theory::bound::{BoundStudy, study_runs};

/// `sweep bound`.
#[derive(Args)]
#[command(
    after_help = "Every inequality is a claim: measured factors <= sharpened <= (3.15) at each step size of a ladder, thresholds in their order, samples <= declared constants. A step has lost its solution where Newton's method finds none from the solution at the largest smaller k, that of the run and random states, or only one whose tangent is singular or beyond: bisected in k. \
JSON keys with --json: scene, fingerprint (of its text), holds, claims (line, says, n, steps, level, at, left, relation, right, low, difference, accuracy, tightness, standing, holds, note), n, steps, constants (name, value, uncertainty, how, safe, note), thresholds (paper_norm, theorem, sharpened, solvable, norm_one, radius_one, loss, loss_reason, loss_eigenvalue, not_followed: why norm_one, radius_one and loss are null and rungs is empty, where m0 <= 0), ratio, attained, worst, levels, meshes (mesh, level, t, k, norm, radius, sharpened), starts (same, distinct, failed), rungs (k, norm, radius, rightmost, distinct, finite_worst, sharpened, theorem, paper_norm, newton, fixed_point, at_solution), m0_unknown (between what m0 lies, where its sign is unknown; else null). Files with --out: SCENE-bound.json, SCENE-bound-claims.csv, SCENE-bound.svg. Exit code 1: a claim does not hold."
)]
pub(crate) struct BoundCommand {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Cells per unit length of the mesh on which the factors are measured, h = 1/n [default: 16]
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=128))]
    n: Option<u32>,
    /// Number N of time steps of the run whose worst level is studied [default: the scene's smallest]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<u32>,
    /// Write SCENE-bound.json, its claims as CSV and its picture into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// Default mesh of the measured factors.
const MESH: u32 = 16;

impl BoundCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let subject = scenes.subject(&self.scene, &self.common.allowance.limit())?;
        let scene = subject.scene();
        let singular = "it puts sup |q| beside k, not k^(1-a)";
        scene.without(&[Extension::SingularKernel], "sweep bound", singular)?;
        let fewest = scene.sweep.as_ref().and_then(|sweep| sweep.steps.iter().min().copied());
        let steps = self.steps.or(fewest).unwrap_or(8);
        scene.check_steps(&[steps])?;
        let bound = match &subject {
            Subject::Contact(setup) => {
                let n = self.n.unwrap_or(MESH);
                scene.check_cells(n)?;
                study_runs(setup, n, steps).admit(&self.common.allowance.limit())?;
                BoundStudy::new(setup, n, steps)
            }
            // An abstract problem keeps a few numbers per level.
            Subject::Abstract(setup) => {
                super::abstract_problem::no_mesh(scene, self.n)?;
                BoundStudy::of_abstract(setup, steps)
            }
        }
        .map_err(|error| CliError::about(&scene.name, error))?;
        study::show(&bound.findings(), self.out.as_deref(), self.common.json)
    }
}
