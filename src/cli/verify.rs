//! `sweep verify`: runs another program's solver under the same sweep, measured and judged like the built-in one.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use super::machine::{Allowance, on_interrupt, options};
use super::scenes::Grid;
use super::swept::{ForCi, Swept};
use super::{
    CliError, Scenes, TABLE_WIDTH, print_beside, print_json, print_text, verdict_table, width,
};
use files::shortened;
use judge::record::{CaseRecord, Key};
use judge::verdict::{Failure, failures};
use report::json_table;
use run::external::{
    ExternalSolver, LOG, Way, by_density, case_dir, last_lines, look_for_cause, on_pressures,
    solver_first, write_case,
};
use run::plan_for;
use run::sweep::{
    Machine, OutputDirectory, Provenance, ScenePlan, admit_constants, judge_plan, run_sweep,
};
use scene::setup::{MeshData, NewtonMarch, Scheme, Subject};

/// Limits of the log shown for a failed case: lines (a long traceback), and bytes per line.
const LINES_SHOWN: usize = 60;
const WIDTH: usize = 400;

/// `sweep verify`.
#[derive(Args)]
#[command(
    after_help = "Each case is a directory SCENE/nN-NSTEPS, below DIR/cases of --out or below the directory of --export, with mesh, times, loads and numbers; its README.md says what the files mean and what the solver has to write: displacement.npy, (N + 1) x vertices x d, or displacement.csv. CMD gets the directory as its last argument. A case fails if the solver fails, runs too long, or writes an array of the wrong shape or with NaN or infinity in it.\n\nThe displacements are measured as functions of the scene's element on the mesh given, P2 with midpoints as further vertices; stresses are those of this program's laws. Constants are judged for that element and the scene's time rule; a solver of another kind needs --orders-only.\n\nExamples:\n  sweep verify viscoelastic --solver 'python3 solver.py'\n  sweep verify viscoelastic --export cases        write the cases, solve elsewhere, then\n  sweep verify viscoelastic --results cases\n\nKeys of --json: docs/JSON.md. Exit codes as of sweep run: 0 all verdicts pass, 1 one does not, 2 nothing could be judged."
)]
pub(crate) struct Verify {
    /// Name of a scene with an exact solution, or path of a TOML file
    scene: String,
    /// The command that solves one case
    #[arg(long, value_name = "CMD", required_unless_present_any = ["results", "export"], conflicts_with_all = ["results", "export"])]
    solver: Option<String>,
    /// Judge the answers in this directory, laid out as --export writes the cases
    #[arg(long, value_name = "DIR", conflicts_with = "export")]
    results: Option<PathBuf>,
    /// Write the cases into this directory and stop
    #[arg(long, value_name = "DIR")]
    export: Option<PathBuf>,
    // The files of a case hold every level, which limits the steps.
    #[command(flatten)]
    grid: Grid<100_000>,
    /// Time limit per case, in seconds. It covers the solver, its child processes and reading the answer
    #[arg(long, value_name = "SECONDS", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..))]
    time_limit: u64,
    /// Cases at a time
    #[arg(long, value_name = "J", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    // As for the built-in solver; the needs of another one are unknown.
    #[command(flatten)]
    allowance: Allowance,
    /// Also measure the pressures, which the solver writes to pressure.npy
    #[arg(long)]
    pressure: bool,
    /// How loads are handed over: assembled, or also as functions, values of f0 and f2 at quadrature points, which the
    /// solver assembles itself
    #[arg(long, value_name = "FORM", value_enum, default_value = "assembled")]
    loads: Loads,
    /// Judge only the orders, not the constants, because the solver uses another element or time rule
    #[arg(long)]
    orders_only: bool,
    /// Also run the built-in solver and compare the errors
    #[arg(long)]
    beside: bool,
    /// Directory for records and report
    #[arg(long, value_name = "DIR", default_value = "reports/verify")]
    out: PathBuf,
    #[command(flatten)]
    ci: ForCi,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// How loads are handed over.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Loads {
    Assembled,
    Density,
}

impl Verify {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        if let Some(folder) = &self.export {
            return export(&self.plan(scenes, Arc::new(NewtonMarch))?, folder);
        }
        if let Some(folder) = self.results.as_ref().filter(|folder| !folder.is_dir()) {
            let why = "no such directory: it is the one of --export, above that of the scene";
            return Err(CliError::about(format!("--results {}", folder.display()), why));
        }
        let folder = self.results.clone().unwrap_or_else(|| self.out.join("cases"));
        // The answers stand in their files when a cause is looked for.
        let pressures = self.pressure;
        let solver = |way, folder| ExternalSolver { way, folder, pressures };
        let answers = solver(Way::Results, folder.clone());
        let plan = self.plan(scenes, Arc::new(solver(self.way()?, folder)))?;
        if let Some(remark) = plan.step_remark()? {
            super::output::remark(&plan.scene().name, &remark);
        }
        let out = OutputDirectory::take(&self.out)?;
        on_interrupt("interrupted; the same command starts again".to_owned())?;
        let mut judged = self.judged(plan, out)?;
        if let Subject::Contact(setup) = &judged.plans[0].subject {
            let found = look_for_cause(&judged.verdicts, setup, judged.plans[0].runs(), &answers);
            solver_first(&mut judged.verdicts, setup, found.as_ref());
            judged.cause = found;
        }
        judged.write(&self.out)?;
        self.ci.write_junit(&judged)?;
        let built_in = || {
            let out = OutputDirectory::take(&self.out.join("own"))?;
            self.judged(self.plan(scenes, Arc::new(NewtonMarch))?, out)
        };
        let beside = self.beside.then(built_in).transpose()?;
        let compared = beside.as_ref().map(|built_in| compare(&judged.records, &built_in.records));
        // Of the scene as it is written: the plan has no claims that the solver cannot answer.
        let note = on_pressures(&scenes.scene(&self.scene)?, self.pressure);
        if self.json {
            let mut document = judged.document();
            document["pressures"] = json!(note);
            document["cause"] = json!(judged.cause);
            if let Some(rows) = &compared {
                document["beside"] = rows.clone();
            }
            print_json(&document)?;
        } else {
            judged.print();
            if let Some(cause) = &judged.cause {
                print_beside("cause: ", 0, &cause.in_words());
                print_beside("  ", 0, &cause.numbers);
            }
            note.iter().for_each(|note| print_text(&format!("note: {note}")));
            self.print_failures(&judged);
            print_text(&format!("report: {}", self.out.join("index.html").display()));
            if let (Some(built_in), Some(rows)) = (&beside, &compared) {
                print_text(&format!("built-in solver:\n{}", verdict_table(&built_in.verdicts)));
                let columns = ">n = n; >N = steps; norm = norm; >error = solver 7; >built-in = own 7; >difference = difference 2";
                print_text(&json_table(rows, columns, width(TABLE_WIDTH)));
            }
        }
        if !self.json {
            self.ci.annotate(&judged)?;
        }
        Ok(judged.exit_code())
    }

    /// Prints failed cases that no verdict names, and the solver's output for the first one.
    fn print_failures(&self, judged: &Swept) {
        let failed = failures(&judged.records);
        let named = |reason: &str| judged.verdicts.iter().any(|v| v.reason.contains(reason));
        for Failure { key: Key { n, steps, .. }, reason } in
            failed.iter().filter(|f| !named(&f.reason))
        {
            let n = n.map_or(String::new(), |n| format!("n = {n}, "));
            print_text(&format!("{n}N = {steps}: {reason}"));
        }
        let log = |Failure { key: Key { scene, n, steps }, .. }: &Failure| {
            let log = case_dir(&self.out.join("cases"), scene, (*n)?, *steps).join(LOG);
            let lines = last_lines(&log);
            // Output already quoted in a reason is omitted.
            (!lines.iter().all(|line| named(line))).then_some((log, lines))
        };
        if let Some((path, lines)) = failed.iter().find_map(log) {
            let shown = lines[lines.len().saturating_sub(LINES_SHOWN)..].iter();
            let shown: Vec<_> = shown.map(|line| shortened(line, WIDTH)).collect();
            print_text(&format!("{}:", path.display()));
            print_text(&shown.join("\n"));
        }
    }

    /// The cases by a scheme.
    fn plan(&self, scenes: &Scenes, scheme: Arc<dyn Scheme>) -> Result<ScenePlan, CliError> {
        let mut scene = scenes.scene(&self.scene)?;
        if self.loads == Loads::Density {
            scene = by_density(scene)?;
        }
        admit_constants(&scene, false, &self.allowance.limit())?;
        let plan = plan_for(scheme, scene, &self.grid.overrides(), self.pressure)?;
        if plan.cases.is_empty() {
            return Err(plan.scene().no_case("verify").into());
        }
        Ok(plan)
    }

    fn way(&self) -> Result<Way, CliError> {
        let Some(command) = &self.solver else { return Ok(Way::Results) };
        let words = shlex::split(command).filter(|words| !words.is_empty());
        let wrong = "no command, or a quote without end";
        let about = || CliError::about(format!("--solver {command:?}"), wrong);
        let limit = Duration::from_secs(self.time_limit);
        Ok(Way::Command { words: words.ok_or_else(about)?, limit })
    }

    fn judged(&self, plan: ScenePlan, out: OutputDirectory) -> Result<Swept, CliError> {
        let plans = vec![plan];
        let progress = super::output::Display::new();
        let flags = [
            (self.pressure, "--pressure"),
            (self.loads == Loads::Density, "--loads density"),
            (self.orders_only, "--orders-only"),
        ];
        // The memory of an external solver does not count.
        let (jobs, memory) = (usize::from(self.jobs), self.allowance.limit());
        let options = options("verify", &flags);
        let machine = Machine { jobs, memory, build: super::BUILD, options };
        let records = run_sweep(&plans, &out, &machine, false, &progress)?;
        let provenance = Provenance::of_run(&plans, &machine).json();
        let verdicts = judge_plan(&plans[0], &records, !self.orders_only);
        let _out = Some(out);
        Ok(Swept { plans, records, verdicts, provenance, _out, ..Swept::default() })
    }
}

/// Writes the files of all runs of the plan, including those for time errors.
fn export(plan: &ScenePlan, folder: &Path) -> Result<u8, CliError> {
    let Subject::Contact(setup) = &plan.subject else { return Ok(0) };
    let mut runs = plan.runs();
    runs.sort_unstable();
    runs.dedup();
    for of_mesh in runs.chunk_by(|a, b| a.0 == b.0) {
        let data = MeshData::new(setup, of_mesh[0].0, None)?;
        for &(_, steps) in of_mesh {
            let dir = case_dir(folder, &setup.scene.name, data.space.mesh.n, steps);
            write_case(&dir, setup, &data, steps)?;
            print_text(&dir.display().to_string());
        }
    }
    Ok(0)
}

/// The errors that both have, a row each.
fn compare(solver: &[CaseRecord], built_in: &[CaseRecord]) -> Value {
    let of_record = |record: &CaseRecord| {
        let same = built_in.iter().find(|other| other.key() == record.key());
        let entries = record.errors.iter().map(|entry| {
            let (norm, solver) = (&entry.norm, entry.error?);
            let own = same?.errors.iter().find(|other| other.norm == *norm)?.error?;
            let difference = (solver - own).abs() / own;
            Some(json!({
                "n": record.n, "steps": record.steps, "norm": norm,
                "solver": solver, "own": own, "difference": difference,
            }))
        });
        entries.flatten().collect::<Vec<_>>()
    };
    solver.iter().flat_map(of_record).collect()
}
