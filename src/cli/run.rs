//! `sweep run` and `sweep gate`.

use std::path::PathBuf;

use clap::Args;

use super::extension::restore_added;
use super::github::annotate;
use super::interrupt::{on_interrupt, quoted};
use super::{CliError, Scenes, print_json, print_text};
use crate::record::{CaseRecord, counted};
use crate::report::{SceneSummary, write_all, write_junit};
use crate::scene::Scene;
use crate::setup::Subject;
use crate::sweep::{
    Overrides, Provenance, ScenePlan, foresee, judge_scene, run_more, run_sweep, scene_summary,
};
use crate::verdict::{Verdict, exit_code, failures, render_table};

/// The default directory of reports.
const LATEST: &str = "reports/latest";

/// `sweep run`.
#[derive(Args)]
#[command(
    after_help = "JSON keys with --json are those of verdict.json (provenance, verdicts, failures)."
)]
pub struct Run {
    #[command(flatten)]
    what: What,
    /// Keep the cases that the directory already has, run the others
    #[arg(long)]
    resume: bool,
    /// Print verdict.json to stdout instead of the table
    #[arg(long)]
    json: bool,
}

/// `sweep gate`.
#[derive(Args)]
pub struct Gate {
    #[command(flatten)]
    what: What,
    /// Write the verdicts as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Write verdict.json to this file as well
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Print annotations for GitHub Actions, and append the verdicts to the file that
    /// GITHUB_STEP_SUMMARY names; set by GITHUB_ACTIONS=true as well
    #[arg(long)]
    github: bool,
}

/// Scenes, grids and threads.
#[derive(Args)]
struct What {
    /// Names of scenes, or paths of TOML files; none: all that are not marked long
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Cells per unit length, h = 1/n, in place of the scene's list
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=4096))]
    n: Option<Vec<u32>>,
    /// Numbers N of time steps, k = T/N, in place of the scene's list
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    steps: Option<Vec<u32>>,
    /// Directory for records and report
    #[arg(long, value_name = "DIR", default_value = LATEST)]
    out: PathBuf,
    /// Cases at a time [default: number of processors]
    #[arg(long, value_name = "J", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Run the scenes marked long as well
    #[arg(long)]
    all: bool,
    /// Run the cases that unresolved verdicts name as well, for three rounds at most
    #[arg(long)]
    extend: bool,
    /// CPU seconds that the added cases may take, as predicted
    #[arg(long, value_name = "SECONDS", default_value_t = BUDGET, requires = "extend", value_parser = seconds)]
    budget: f64,
}

/// What added cases may take unless --budget says more: as much as the main job.
const BUDGET: f64 = 60.0;

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err(format!("`{text}` is no number of seconds")),
    }
}

impl Run {
    /// The main job: all scenes at gate size into reports/latest.
    pub fn main_job() -> Self {
        let what = What {
            scenes: Vec::new(),
            n: None,
            steps: None,
            out: PathBuf::from(LATEST),
            jobs: None,
            all: false,
            extend: false,
            budget: BUDGET,
        };
        Self { what, resume: false, json: false }
    }

    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let swept = self.what.sweep(scenes, self.what.plans(scenes)?, self.resume)?;
        write_all(
            &self.what.out,
            &swept.summaries,
            &swept.records,
            &swept.verdicts,
            &swept.provenance,
        )?;
        swept.print(self.json)?;
        if !self.json {
            print_text(&format!("report: {}", self.what.out.join("index.html").display()));
        }
        Ok(exit_code(&swept.records, &swept.verdicts))
    }
}

impl Gate {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let plans = self.what.plans(scenes)?;
        let sources: Vec<Scene> = plans.iter().map(|plan| plan.scene().clone()).collect();
        if !plans.iter().any(|plan| plan.scene().judge) {
            let names: Vec<_> = plans.iter().map(|plan| &*plan.scene().name).collect();
            return Err(CliError::Other(format!(
                "nothing to judge: judge = false in {}; name a judged scene, or use sweep run",
                names.join(", ")
            )));
        }
        let swept = self.what.sweep(scenes, plans, false)?;
        let document = |path: &std::path::Path| {
            crate::verdict::write_json(path, &swept.provenance, &swept.verdicts, &swept.records)
                .map_err(|error| CliError::Other(error.to_string()))
        };
        document(&self.what.out.join("verdict.json"))?;
        if let Some(path) = &self.json {
            document(path)?;
        }
        if let Some(path) = &self.junit {
            write_junit(path, &swept.verdicts)?;
        }
        swept.print(false)?;
        if self.github || std::env::var_os("GITHUB_ACTIONS").is_some_and(|set| set == "true") {
            annotate(&sources, &swept.records, &swept.verdicts)?;
        }
        Ok(exit_code(&swept.records, &swept.verdicts))
    }
}

/// A finished sweep.
struct Swept {
    records: Vec<CaseRecord>,
    verdicts: Vec<Verdict>,
    summaries: Vec<SceneSummary>,
    provenance: serde_json::Value,
}

impl What {
    fn sweep(
        &self,
        scenes: &Scenes,
        mut plans: Vec<ScenePlan>,
        resume: bool,
    ) -> Result<Swept, CliError> {
        let jobs = match self.jobs {
            Some(jobs) => usize::from(jobs),
            None => std::thread::available_parallelism().map_or(1, usize::from),
        };
        on_interrupt(&self.out, &self.resuming(scenes))?;
        let progress = super::progress::Display::new();
        if resume {
            restore_added(&mut plans, &self.out)?;
        }
        let mut records = run_sweep(&plans, &self.out, jobs, resume, &progress)?;
        let judged = |plans: &[ScenePlan], records: &[CaseRecord]| -> Vec<Verdict> {
            let of = |plan: &ScenePlan| {
                let foreseen = foresee(&plan.subject, records);
                judge_scene(plan.scene(), records, &plan.keys(), &foreseen)
            };
            plans.iter().flat_map(of).collect()
        };
        let mut verdicts = judged(&plans, &records);
        while self.extend && super::extension::extended(&mut plans, &verdicts, self.budget)? {
            let progress = super::progress::Display::new();
            records = run_more(&plans, records, &self.out, jobs, &progress)?;
            verdicts = judged(&plans, &records);
        }
        let summaries = plans.iter().map(|plan| scene_summary(plan.scene())).collect();
        let provenance = Provenance::of_run(&plans).json();
        Ok(Swept { records, verdicts, summaries, provenance })
    }

    /// The command that goes on with this sweep.
    fn resuming(&self, scenes: &Scenes) -> String {
        let list = |list: &[u32]| list.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
        let options = [
            ("--scenes", Some(scenes.folder.display().to_string())),
            ("--n", self.n.as_deref().map(list)),
            ("--steps", self.steps.as_deref().map(list)),
            ("--jobs", self.jobs.map(|jobs| jobs.to_string())),
            ("--out", Some(self.out.display().to_string())),
        ];
        let given = options.into_iter().filter_map(|(name, value)| Some((name, value?)));
        let mut words: Vec<String> = vec!["sweep".into(), "run".into()];
        words.extend(self.scenes.iter().map(|scene| quoted(scene)));
        words.extend(given.flat_map(|(name, value)| [name.to_owned(), quoted(&value)]));
        words.extend(self.all.then(|| "--all".into()));
        if self.extend {
            words.extend(["--extend".into(), "--budget".into(), self.budget.to_string()]);
        }
        words.push("--resume".into());
        words.join(" ")
    }

    fn plans(&self, scenes: &Scenes) -> Result<Vec<ScenePlan>, CliError> {
        let overrides = Overrides { n: self.n.clone(), steps: self.steps.clone() };
        let named = !self.scenes.is_empty();
        let mut plans = Vec::new();
        for scene in scenes.select(&self.scenes)? {
            if scene.long && !self.all && !named {
                continue;
            }
            let listed = |list: &Option<Vec<u32>>| list.clone().unwrap_or_default();
            scene.check_grid(&listed(&self.n), &listed(&self.steps))?;
            let plan = ScenePlan::new(Subject::new(scene)?, &overrides);
            let scene = plan.scene();
            if plan.cases.is_empty() && !named {
                // A scene without a grid is there for `sweep solve`.
                continue;
            }
            if plan.cases.is_empty() {
                let hint = "add [sweep] with n and steps, or give --n and --steps";
                return Err(scene.error("scene.name", "the scene has no case to run", hint).into());
            }
            if let Some(remark) = plan.step_remark()? {
                super::progress::remark(&plan.scene().name, &remark);
            }
            plans.push(plan);
        }
        if plans.is_empty() {
            let folder = scenes.folder.display();
            return Err(CliError::Other(format!(
                "no scene to run in {folder}: name one, or add --all"
            )));
        }
        Ok(plans)
    }
}

impl Swept {
    fn print(&self, json: bool) -> Result<(), CliError> {
        if json {
            let document = serde_json::json!({
                "provenance": self.provenance,
                "verdicts": self.verdicts,
                "failures": failures(&self.records),
            });
            return print_json(&document);
        }
        print_text(&render_table(&self.verdicts));
        let failed = failures(&self.records).len();
        let judged = if self.verdicts.is_empty() {
            String::new()
        } else {
            let met = self.verdicts.iter().filter(|verdict| verdict.as_expected()).count();
            format!("; {met} of {} as expected", counted(self.verdicts.len(), "verdict"))
        };
        let cases = counted(self.records.len(), "case");
        print_text(&format!("{cases}, {failed} failed{judged}"));
        Ok(())
    }
}
