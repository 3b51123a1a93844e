//! `sweep diagnose`: finds the term whose removal restores the expected behaviour.

use clap::Args;

use super::machine::{Common, processors, share_threads};
use super::study::show;
use super::{CliError, Scenes};
use files::counted;
use studies::diagnose::{admit_diagnosis, diagnose};

/// `sweep diagnose`.
#[derive(Args)]
#[command(
    after_help = "Exit codes: 0 there is nothing to diagnose, or with --always nothing was found; 1 a verdict is not as expected, or a trial fails; 2 the scene cannot be diagnosed.\n\nJSON keys with --json: scene, fingerprint (of its text), holds, claims (line, says, n, steps, level, at: the trial and the norm, left: an order or a relative error, relation: order or <=, right, low, difference, accuracy, tightness, standing, holds, note), verdicts (as in verdict.json), trials (name, terms, removed, suspects, verdict, claim), culprits (names of terms, or prediction), sentence."
)]
pub(crate) struct DiagnoseCommand {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Run the trials even if every verdict is as expected
    #[arg(long)]
    always: bool,
    #[command(flatten)]
    common: Common,
}

impl DiagnoseCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        share_threads()?;
        let scene = scenes.scene(&self.scene)?;
        admit_diagnosis(&scene, processors(), &self.common.allowance.limit())?;
        let cases = scene.sweep.as_ref().map_or(0, |sweep| sweep.n.len() * sweep.steps.len());
        super::progress::note(&format!(
            "running {} of the scene, then its variants",
            counted(cases, "case")
        ));
        let findings = diagnose(&scene, &|setup| setup, self.always)?.findings();
        show(&findings, None, self.common.json)
    }
}
