//! `sweep merge`: merges the records of many processes and judges them like those of one; `sweep baseline` records errors
//! and work.

use std::path::PathBuf;

use super::machine::{Allowance, options};
use super::run::{BASELINE, LATEST, What, recorded};
use super::scenes::Chosen;
use super::swept::Swept;
use super::{CliError, Scenes, print_json, print_text};
use clap::Args;
use files::{counted, same_file};
use judge::record::write_sorted;
use judge::verdict::{Baseline, exit_code, write_json};
use run::merge::{Merged, Parts, read_keys};
use run::sweep::{Circumstances, OutputDirectory, ScenePlan, replace_records};

/// `sweep merge`.
#[derive(Args)]
#[command(
    after_help = "A DIR is a directory of `sweep run` or `gate` with cases.csv and provenance.json, or a directory of such directories. The merge refuses, with exit code 2 and both names, records from another version of the program, another text of a scene or another platform than the rest, incomplete or malformed lines, two records of one case that differ in more than seconds_*, and cases that are not in the list. Missing cases are named and nothing is written, unless --incomplete is given.\n\nWritten into --out: cases.csv (sorted), provenance.json and verdict.json, as a single process would have written them except for seconds_* and the key `run` of the provenance. `sweep report` makes the pages.\n\nWith --baseline, errors and work are compared for the cases in the baseline, as by `sweep gate`; the result is the key `baseline` of verdict.json.\n\nExit codes: 0 all verdicts are as expected, 1 one is not or an error deviates from the baseline, 2 nothing could be judged, or a case failed or is missing.\n\nExamples:\n  sweep merge parts --cases cases.txt --out merged && sweep report merged\n  sweep merge monday tuesday --out both"
)]
pub(crate) struct MergeCommand {
    /// Directories with records
    #[arg(value_name = "DIR", required = true)]
    parts: Vec<PathBuf>,
    /// Directory for the merged records
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The cases that have to be there, as `sweep run --list-cases` prints them [default: those on the grids of the
    /// scenes' files]
    #[arg(long, value_name = "FILE")]
    cases: Option<PathBuf>,
    /// Record missing cases as skipped, and judge: the verdicts of their scenes fail
    #[arg(long)]
    incomplete: bool,
    /// Compare errors and work with this baseline; `sweep baseline` writes it [default: no comparison]
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// Print verdict.json to stdout instead of the table
    #[arg(long)]
    json: bool,
}

impl MergeCommand {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        let wanted = self.cases.as_deref().map(read_keys).transpose()?;
        let baseline = self.baseline.as_deref().map(recorded).transpose()?;
        let parts = Parts::open(&self.parts)?;
        let out = OutputDirectory::take(&self.out)?;
        if let Some(dir) = parts.dirs.iter().find(|dir| same_file(dir, &self.out)) {
            let what =
                "the merged records would replace those that are merged; choose another --out";
            return Err(CliError::about(dir.display(), what));
        }
        let count = parts.dirs.len();
        let merged = parts.merge(wanted.as_deref(), self.incomplete, baseline.as_ref());
        let Merged { records, verdicts, missing, comparison, mut provenance } = merged?;
        let flags = [
            (self.cases.is_some(), "--cases"),
            (self.incomplete, "--incomplete"),
            (self.baseline.is_some(), "--baseline"),
        ];
        provenance.run = Some(Circumstances::new(&super::BUILD, 1, &options("merge", &flags)));
        replace_records(&self.out, &provenance, false)?;
        let table = self.out.join("cases.csv");
        write_sorted(&table, &records)?;
        let provenance = provenance.json();
        let verdict = self.out.join("verdict.json");
        write_json(&verdict, &provenance, &verdicts, &records, comparison.as_ref(), None)?;
        let _out = Some(out);
        let swept = Swept { records, verdicts, provenance, comparison, _out, ..Swept::default() };
        if self.json {
            print_json(&swept.document())?;
        } else {
            swept.print();
            let number = missing.as_ref().map_or(0, |(number, _)| *number);
            print_text(&format!("{}, {number} missing", counted(count, "part")));
            if let Some((_, words)) = &missing {
                super::output::note(&format!("warning: {words}"));
            }
            print_text(&format!("records: {}", table.display()));
        }
        Ok(if missing.is_some() { super::COULD_NOT_JUDGE } else { swept.exit_code() })
    }
}

// `sweep baseline`: records errors and work of the scenes for later comparison.

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
        let old = Baseline::read(&self.file)?;
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
        new.write(&self.file)?;
        let scenes = counted(new.scenes.len(), "scene");
        let changes = counted(changes.len(), "change");
        print_text(&format!("{}: {scenes}, {changes}", self.file.display()));
        Ok(0)
    }
}
