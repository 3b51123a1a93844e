//! `sweep run` and `sweep gate`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;
use rayon::prelude::*;

use super::machine::{Allowance, on_interrupt, processors};
use super::scenes::Chosen;
use super::swept::{ForCi, Swept};
use super::{CliError, Scenes, print_json, print_text};
use files::{counted, quoted, read_file, write_named};
use judge::record::{CaseRecord, Key, RecordError, write_sorted};
use judge::verdict::{Baseline, Verdict, failures, write_json};
use run::sweep::{
    Machine, OutputDirectory, Provenance, ScenePlan, SweepError, judge_plan, reference_error,
    run_sweep,
};

pub(super) const LATEST: &str = "reports/latest";
/// The recorded baseline of the default folder.
pub(super) const BASELINE: &str = "reports/baseline.json";

/// `sweep run`.
#[derive(Args)]
#[command(
    after_help = "With --json the output is verdict.json, whose keys are in docs/JSON.md.\n\nMany processes: `sweep run … --list-cases > cases.txt`, for some of its lines `sweep run … --only KEY… --out parts/0`, and at the end `sweep merge parts --cases cases.txt --out merged`."
)]
pub(crate) struct Run {
    #[command(flatten)]
    what: What,
    /// Keep the cases that are already in the directory and run the others
    #[arg(long)]
    resume: bool,
    /// Print the keys of the cases without running them
    #[arg(long)]
    list_cases: bool,
    /// Run only these cases and write their records to --out, unjudged, for `sweep merge`
    #[arg(long, value_name = "KEY", num_args = 1.., requires = "out", conflicts_with = "list_cases")]
    only: Vec<Key>,
    /// Print verdict.json to stdout instead of the table
    #[arg(long)]
    json: bool,
}

/// `sweep gate`.
#[derive(Args)]
pub(crate) struct Gate {
    #[command(flatten)]
    what: What,
    #[command(flatten)]
    ci: ForCi,
    /// Write verdict.json to this file as well
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

#[derive(Args, Default, Clone)]
pub(super) struct What {
    #[command(flatten)]
    pub(super) chosen: Chosen,
    /// Directory for records and report
    #[arg(long, value_name = "DIR", default_value = LATEST)]
    pub(super) out: PathBuf,
    /// Cases at a time [default: number of processors]
    #[arg(long, value_name = "J", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) jobs: Option<u16>,
    // A case above the limit is recorded as failed; others wait until they fit.
    #[command(flatten)]
    pub(super) allowance: Allowance,
    /// Compare errors and work with this baseline [default: reports/baseline.json for scenes of the
    /// default folder or of the program itself, where the file exists; else the program's own for its own scenes;
    /// `sweep baseline` writes it]
    #[arg(long, value_name = "FILE")]
    pub(super) baseline: Option<PathBuf>,
}

impl Run {
    /// The main job: all scenes at gate size into reports/latest.
    pub(crate) fn main_job() -> Self {
        let what = What { out: PathBuf::from(LATEST), ..What::default() };
        Self { what, resume: false, list_cases: false, only: Vec::new(), json: false }
    }

    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        if self.list_cases {
            return self.list(scenes);
        }
        if !self.only.is_empty() {
            return self.record(scenes);
        }
        // Named scenes are explored: they are compared with a baseline that is named too.
        let compared = !self.what.chosen.named() || self.what.baseline.is_some();
        let swept = self.what.sweep(scenes, self.what.plans(scenes)?, self.resume, compared)?;
        swept.write(&self.what.out)?;
        if self.json {
            print_json(&swept.document())?;
        } else {
            swept.print();
            print_text(&format!("report: {}", self.what.out.join("index.html").display()));
        }
        Ok(swept.exit_code())
    }

    /// The keys of all cases, in the order in which one process would judge them.
    fn list(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let plans = self.what.plans(scenes)?;
        if !self.json {
            let words = plans.iter().flat_map(ScenePlan::keys).map(|key| key.word());
            print_text(&words.collect::<Vec<String>>().join("\n"));
            return Ok(0);
        }
        let mut cases = Vec::new();
        for plan in &plans {
            cases.extend(plan.keys().into_iter().zip(plan.costs()?.cases).map(|(key, cost)| {
                serde_json::json!({
                    "key": key.word(), "scene": key.scene, "n": key.n, "steps": key.steps,
                    "memory_bytes": cost.memory_bytes.round() as u64,
                })
            }));
        }
        print_json(&serde_json::json!({ "cases": cases }))?;
        Ok(0)
    }

    /// Runs the cases of `--only`; a case that fails is a record, which `sweep merge` finds.
    fn record(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let mut what = self.what.clone();
        if what.chosen.scenes.is_empty() {
            let names: BTreeSet<&String> = self.only.iter().map(|key| &key.scene).collect();
            what.chosen.scenes = names.into_iter().cloned().collect();
        }
        let mut plans = what.plans(scenes)?;
        let is_there = |key: &Key| plans.iter().any(|plan| plan.keys().contains(key));
        if let Some(key) = self.only.iter().find(|key| !is_there(key)) {
            let why = "these scenes and grids have no such case: give the same SCENE, --n and --steps as for --list-cases";
            return Err(CliError::about(key.word(), why));
        }
        for plan in &mut plans {
            let keys = plan.keys();
            plan.take(keys.iter().filter(|key| self.only.contains(key)));
        }
        plans.retain(|plan| !plan.cases.is_empty());
        let keys: Vec<String> = self.only.iter().map(Key::word).collect();
        let resuming = format!("{} --only {}", what.resuming(scenes), keys.join(" "));
        let out = OutputDirectory::take(&what.out)?;
        let (machine, records) = what.records(&plans, &out, self.resume, &resuming)?;
        let failed = failures(&records).len();
        if failed > 0 {
            // The table has no column for reasons.
            let provenance = Provenance::of_run(&plans, &machine).json();
            write_json(&what.out.join("verdict.json"), &provenance, &[], &records, None, None)?;
        }
        write_sorted(&what.out.join("cases.csv"), &records)?;
        let (cases, out) = (counted(records.len(), "case"), what.out.display());
        print_text(&format!("{cases} in {out}, {failed} failed"));
        Ok(0)
    }
}

impl Gate {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let plans = self.what.plans(scenes)?;
        if !plans.iter().any(|plan| plan.scene().judge) {
            let names: Vec<_> = plans.iter().map(|plan| &*plan.scene().name).collect();
            return Err(CliError::other(format!(
                "there is nothing to judge, because {} has judge = false; name a judged scene, or use sweep run",
                names.join(", ")
            )));
        }
        let swept = self.what.sweep(scenes, plans, false, true)?;
        let Swept { provenance, verdicts, records, comparison, .. } = &swept;
        let document = self.what.out.join("verdict.json");
        write_json(&document, provenance, verdicts, records, comparison.as_ref(), None)?;
        if let Some(path) = &self.json {
            write_named(path, &read_file(&document)?)?;
        }
        self.ci.write_junit(&swept)?;
        swept.print();
        self.ci.annotate(&swept)?;
        Ok(swept.exit_code())
    }
}

impl What {
    /// Runs and judges the plans, against the baseline if `compared`.
    pub(super) fn sweep(
        &self,
        scenes: &Scenes,
        plans: Vec<ScenePlan>,
        resume: bool,
        compared: bool,
    ) -> Result<Swept, CliError> {
        // An unreadable baseline is reported before the sweep.
        let baseline = if compared { self.read_baseline(scenes)? } else { None };
        let out = OutputDirectory::take(&self.out)?;
        let (machine, records) = self.records(&plans, &out, resume, &self.resuming(scenes))?;
        // Predicted constants are integrals of the exact solution: on many scenes they take seconds.
        let judged = plans.par_iter().map(|plan| judge_plan(plan, &records, true));
        let verdicts = judged.collect::<Vec<Vec<Verdict>>>().concat();
        let provenance = Provenance::of_run(&plans, &machine).json();
        let comparison = baseline.map(|baseline| {
            let own_grids = self.chosen.grid.is_own();
            let runs: Vec<_> = plans.iter().map(|plan| plan.compared(own_grids)).collect();
            baseline.compare(&runs, &records, &verdicts)
        });
        let found =
            |plan: &ScenePlan| Some((plan.scene().name.clone(), reference_error(plan, &records)?));
        let references = plans.iter().filter_map(found).collect();
        let _out = Some(out);
        let cause = None;
        Ok(Swept { plans, records, verdicts, provenance, comparison, references, cause, _out })
    }

    /// Runs the cases of the plans; `resuming` is the command that goes on with them.
    fn records(
        &self,
        plans: &[ScenePlan],
        out: &OutputDirectory,
        resume: bool,
        resuming: &str,
    ) -> Result<(Machine, Vec<CaseRecord>), CliError> {
        let jobs = self.jobs.map_or_else(processors, usize::from);
        let options = self.options(resume).join(" ");
        let machine =
            Machine { jobs, memory: self.allowance.limit(), build: super::BUILD, options };
        let kept = self.out.display();
        let go_on = format!("finished cases are kept in {kept}\ngo on with: {resuming}");
        on_interrupt(format!("interrupted; {go_on}"))?;
        let progress = super::output::Display::new();
        match run_sweep(plans, out, &machine, resume, &progress) {
            Ok(records) => Ok((machine, records)),
            // Records are kept whatever stopped the writing.
            Err(SweepError::Record(error @ RecordError::Io(_))) => {
                Err(CliError::other(format!("{error}\n{go_on}")))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// The baseline of this run. That of the default folder applies to its scenes only; scenes inside the program use
    /// theirs, unless one was recorded here.
    fn read_baseline(&self, scenes: &Scenes) -> Result<Option<Baseline>, CliError> {
        let elsewhere =
            scenes.named || self.chosen.scenes.iter().any(|name| name.ends_with(".toml"));
        match &self.baseline {
            Some(path) => recorded(path).map(Some),
            None if elsewhere => Ok(None),
            None => match Baseline::read(BASELINE.as_ref())? {
                None if scenes.folder.is_none() => Ok(Some(crate::shipped::baseline()?)),
                read => Ok(read),
            },
        }
    }

    /// The command that resumes this sweep.
    fn resuming(&self, scenes: &Scenes) -> String {
        let paths = [
            ("--scenes", scenes.folder.as_ref().map(|folder| folder.display().to_string())),
            ("--out", Some(self.out.display().to_string())),
            ("--baseline", self.baseline.as_ref().map(|path| path.display().to_string())),
        ];
        let given = paths.into_iter().filter_map(|(name, value)| Some((name, value?)));
        let mut words: Vec<String> = vec!["sweep".into(), "run".into()];
        words.extend(self.chosen.scenes.iter().map(|scene| quoted(scene)));
        words.extend(given.flat_map(|(name, value)| [name.to_owned(), quoted(&value)]));
        words.extend(self.options(true));
        words.join(" ")
    }

    /// The options without paths.
    fn options(&self, resume: bool) -> Vec<String> {
        let list = |list: &[u32]| list.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
        let grid = &self.chosen.grid;
        let options = [
            ("--n", grid.n.as_deref().map(list)),
            ("--steps", grid.steps.as_deref().map(list)),
            ("--jobs", self.jobs.map(|jobs| jobs.to_string())),
            ("--memory-limit", self.allowance.memory_limit.map(|limit| limit.bytes().to_string())),
        ];
        let given = options.into_iter().filter_map(|(name, value)| Some([name.into(), value?]));
        let flags = [("--all", self.chosen.all), ("--resume", resume)];
        let set = flags.into_iter().filter(|(_, set)| *set).map(|(name, _)| name.into());
        given.flatten().chain(set).collect()
    }

    pub(super) fn plans(&self, scenes: &Scenes) -> Result<Vec<ScenePlan>, CliError> {
        self.chosen.plans(scenes, &self.allowance.limit())
    }
}

/// A baseline that is named.
pub(super) fn recorded(path: &Path) -> Result<Baseline, CliError> {
    let read = Baseline::read(path)?;
    read.ok_or_else(|| CliError::about(path.display(), "no such file"))
}
