//! `sweep baseline`: records errors and work of the scenes for later comparison.

use std::path::PathBuf;

use clap::Args;

use super::chosen::Chosen;
use super::machine::Allowance;
use super::run::{BASELINE, LATEST, What};
use super::{CliError, Scenes, print_text};
use files::counted;
use judge::verdict::{Baseline, exit_code};
use run::sweep::ScenePlan;

/// `sweep baseline`.
#[derive(Args)]
#[command(
    after_help = "Exit codes: 0 the file was written; 1 a verdict is not as expected; 2 a case failed. With 1 and 2 nothing is written, because the baseline of a wrong run would approve its errors."
)]
pub(crate) struct BaselineCommand {
    /// Names of scenes, whose entries alone are recorded anew; none: all that are not marked long,
    /// and entries of scenes that no longer exist are removed
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// The file
    #[arg(long, value_name = "FILE", default_value = BASELINE)]
    file: PathBuf,
    /// Directory for the records of the run
    #[arg(long, value_name = "DIR", default_value = LATEST)]
    out: PathBuf,
    /// Cases at a time [default: number of processors]
    #[arg(long, value_name = "J", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Record the scenes marked long as well
    #[arg(long)]
    all: bool,
    #[command(flatten)]
    allowance: Allowance,
}

impl BaselineCommand {
    pub(super) fn execute(self, scenes: &Scenes) -> Result<u8, CliError> {
        let old = Baseline::read(&self.file).map_err(CliError::other)?;
        let named = self.scenes.clone();
        let chosen = Chosen { scenes: named, all: self.all, ..Chosen::default() };
        let Self { out, jobs, allowance, .. } = self;
        let what = What { chosen, out, jobs, allowance, ..What::default() };
        let swept = what.sweep(scenes, what.plans(scenes)?, false, false)?;
        let code = exit_code(&swept.records, &swept.verdicts);
        if code > 0 {
            swept.print();
            print_text(
                "nothing was recorded, because every case must converge and every verdict must be as expected",
            );
            return Ok(code);
        }
        let sources = swept.plans.iter().map(ScenePlan::scene);
        let hashes: Vec<(&str, &str)> =
            sources.map(|scene| (scene.name.as_str(), scene.source.hash.as_str())).collect();
        let mut new = Baseline::of(&swept.records, &hashes).owing(&swept.verdicts);
        let before = old.unwrap_or_default();
        if !self.scenes.is_empty() {
            for (name, recorded) in &before.scenes {
                new.scenes.entry(name.clone()).or_insert_with(|| recorded.clone());
            }
        }
        let changes = before.changes(&new);
        changes.iter().for_each(|line| print_text(line));
        new.write(&self.file).map_err(CliError::other)?;
        let scenes = counted(new.scenes.len(), "scene");
        let changes = counted(changes.len(), "change");
        print_text(&format!("{}: {scenes}, {changes}", self.file.display()));
        Ok(0)
    }
}
