//! The command line: one file per command; results on stdout, progress and errors on stderr.

mod abstract_problem;
mod audit;
mod baseline;
mod bound;
mod case;
mod check;
mod chosen;
mod colour;
mod constants;
mod diagnose;
mod estimate;
mod explain;
mod extension;
mod extremes;
mod fit;
mod floors;
mod github;
mod gronwall;
mod help;
mod interrupt;
mod list;
mod machine;
mod merge;
mod output;
mod plan;
mod progress;
mod report;
mod run;
mod shell;
mod solve;
mod study;
mod swept;
mod target;
mod trade;
mod until_resolved;
mod verify;

use ::run::sweep::Build;
use std::ffi::OsString;
use std::fmt::Display;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

pub use fit::{Fitted, fitted};

use clap::{Parser, Subcommand};
use output::{
    create_dir, delivered, megabytes, print_as_it_is, print_beside, print_error, print_json,
    print_text, print_verdicts, verdict_table, width, write_file, write_json,
};

use ::run::sweep::{MemoryLimit, admit_constants, admit_run};
use scene::setup::{Setup, SetupError, Subject};
use scene::{Registry, Scene, SceneError};

/// Set by build.rs.
const BUILD: Build = Build {
    commit: env!("GRONWALL_COMMIT"),
    compiler: env!("GRONWALL_COMPILER"),
    target: env!("GRONWALL_TARGET"),
    optimisation: env!("GRONWALL_OPTIMISATION"),
};
const COULD_NOT_JUDGE: u8 = 2;

/// Verifies and benchmarks error estimates of history-dependent variational-hemivariational
/// inequalities. Without a command: runs the scenes that it comes with at gate size, prints the
/// verdicts and writes reports/latest/.
#[derive(Parser)]
#[command(
    name = "sweep",
    version,
    after_help = "Examples:\n  sweep                                      the main job; then open reports/latest/index.html\n  sweep list                                 what there is\n  sweep run pure-mild affine --out reports/two\n  sweep explain punch                        what a scene requires, and what it costs\n  sweep solve punch --n 16 --steps 16 --pictures reports/punch\n  sweep fit table.csv --p 1                  orders of anybody's errors\n\nExit codes: 0 all verdicts as expected, 1 one is not, 2 it could not judge. Colour is used on a terminal alone, and not with NO_COLOR."
)]
struct Arguments {
    /// Folder of the scenes [default: manufactured, where that folder is; else those inside the program]
    #[arg(long = "scenes", id = "folder", value_name = "FOLDER", global = true)]
    scenes: Option<PathBuf>,
    /// No progress, notes or warnings on stderr; errors are still printed
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// A line for each case that ends, also beside the bar of a terminal
    #[arg(short, long, global = true)]
    verbose: bool,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Run refinement sweeps, fit orders, judge them, write a report
    Run(run::Run),
    /// Run sweeps for CI: verdicts only
    Gate(run::Gate),
    /// Record errors and work of the scenes in reports/baseline.json, and say what changes
    Baseline(baseline::BaselineCommand),
    /// List the scenes with their terms and predicted orders
    List(list::List),
    /// Verify the manufactured data and the hypotheses of a scene, without solving
    Check(check::Check),
    /// Say what a scene requires: terms, algorithms, sizes, predicted cost
    Explain(explain::Explain),
    /// Check the proofs of Theorems 10 and 11 line by line on real runs
    Audit(audit::Audit),
    /// Name the term at fault: run the scene again with one term removed at a time
    Diagnose(diagnose::DiagnoseCommand),
    /// Solve one case and print named quantities
    Solve(solve::Solve),
    /// Step-size bound (3.4) in four numbers: paper, sharpened, measured, loss of solvability
    Bound(bound::BoundCommand),
    /// Evaluate Gronwall's inequality on runs: truncation errors, envelopes, horizons, perturbations
    Gronwall(gronwall::Gronwall),
    /// Climb ladders of extreme parameters: units, moduli, steps, meshes, gaps, loads
    Extremes(extremes::Extremes),
    /// Measure the floors of a scene's errors: solver, history, quadrature, reference
    Floors(floors::FloorsCommand),
    /// Speed against accuracy: work-precision over the knobs of a scene, cost model, best n and N
    Trade(trade::TradeCommand),
    /// Fit orders to a table with columns h, k, error
    Fit(fit::Fit),
    /// Put another program's solver under the same sweep
    Verify(verify::Verify),
    /// Write a sweep as jobs for many processes or machines, with predicted time and memory
    Plan(plan::PlanCommand),
    /// Run cases of a plan in this process, and leave their records in a separate directory
    Case(case::CaseCommand),
    /// Merge the records of many processes, and judge them as those of one
    Merge(merge::MergeCommand),
    /// Rebuild every output from the records in a directory, without solving
    Report(report::Report),
    /// Print completions for a shell
    Completions(shell::Completions),
    /// Print the man page
    Man(shell::Man),
}

/// An error that ends a command, as one message on stderr and exit code 2.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    #[error("{0}")]
    Scene(#[from] SceneError),
    #[error("{0}")]
    Setup(#[from] SetupError),
    #[error("error: {0}")]
    Sweep(#[from] ::run::sweep::SweepError),
    #[error("error: {0}")]
    Output(#[from] ::run::sweep::OutputError),
    #[error("error: {0}")]
    Memory(#[from] ::run::sweep::Refused),
    #[error("error: {0}")]
    Report(#[from] ::report::ReportError),
    #[error("error: {0}")]
    Other(String),
}

impl CliError {
    fn other(error: impl Display) -> Self {
        Self::Other(error.to_string())
    }

    /// An error that does not name its file, scene or case.
    fn about(what: impl Display, error: impl Display) -> Self {
        Self::Other(format!("{what}: {error}"))
    }
}

pub fn main() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os()))
}

/// Runs a command line (program name first); returns its exit code.
pub fn run_with(words: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match help::parsed(words) {
        Ok(arguments) => arguments,
        Err(said) => return finished(said_instead(&said)),
    };
    progress::say(match (arguments.quiet, arguments.verbose) {
        (true, _) => progress::Loudness::Quiet,
        (_, true) => progress::Loudness::Verbose,
        _ => progress::Loudness::Usual,
    });
    let scenes = Scenes::new(arguments.scenes);
    let command = arguments.command.unwrap_or(Command::Run(run::Run::main_job()));
    let outcome = match command {
        Command::Run(run) => run.execute(&scenes),
        Command::Gate(gate) => gate.execute(&scenes),
        Command::Baseline(baseline) => baseline.execute(&scenes),
        Command::List(list) => list.execute(&scenes),
        Command::Check(check) => check.execute(&scenes),
        Command::Explain(explain) => explain.execute(&scenes),
        Command::Audit(audit) => audit.execute(&scenes),
        Command::Diagnose(diagnose) => diagnose.execute(&scenes),
        Command::Solve(solve) => solve.execute(&scenes),
        Command::Bound(bound) => bound.execute(&scenes),
        Command::Gronwall(gronwall) => gronwall.execute(&scenes),
        Command::Extremes(extremes) => extremes.execute(),
        Command::Floors(floors) => floors.execute(&scenes),
        Command::Trade(trade) => trade.execute(&scenes),
        Command::Fit(fit) => fit.execute(),
        Command::Verify(verify) => verify.execute(&scenes),
        Command::Plan(plan) => plan.execute(&scenes),
        Command::Case(case) => case.execute(),
        Command::Merge(merge) => merge.execute(),
        Command::Report(report) => report.execute(&scenes),
        Command::Completions(completions) => completions.execute(),
        Command::Man(man) => man.execute(),
    };
    finished(outcome)
}

/// Flushes stdout: no exit code may claim results that were not written.
fn finished(outcome: Result<u8, CliError>) -> u8 {
    match outcome.and_then(delivered) {
        Ok(code) => code,
        Err(error) => {
            print_error(error.to_string().trim_end());
            COULD_NOT_JUDGE
        }
    }
}

fn said_instead(said: &clap::Error) -> Result<u8, CliError> {
    let printed = said.print().and_then(|()| std::io::stdout().flush());
    if let Err(error) = printed
        && !said.use_stderr()
    {
        output::stopped(error);
    }
    if let Some(hint) = help::hint(said) {
        print_error(&hint);
    }
    Ok(u8::try_from(said.exit_code()).unwrap_or(COULD_NOT_JUDGE))
}

/// Source of the scenes.
struct Scenes {
    /// None: the scenes inside the program.
    folder: Option<PathBuf>,
    /// The command line names the folder.
    named: bool,
}

const FOLDER: &str = "manufactured";

impl Scenes {
    fn new(folder: Option<PathBuf>) -> Self {
        let named = folder.is_some();
        let here = || Some(PathBuf::from(FOLDER)).filter(|folder| folder.is_dir());
        Self { folder: folder.or_else(here), named }
    }

    /// Its description for users.
    fn place(&self) -> String {
        match &self.folder {
            Some(folder) => format!("in {}", folder.display()),
            None => "inside this program".to_owned(),
        }
    }

    /// A scene by name or path, made computable.
    fn subject(&self, name: &str, limit: &MemoryLimit) -> Result<Subject, CliError> {
        subject(self.scene(name)?, limit)
    }

    fn scene(&self, name: &str) -> Result<Scene, CliError> {
        // A path needs no folder of scenes.
        if name.ends_with(".toml") {
            return Ok(Scene::read(std::path::Path::new(name))?);
        }
        Ok(self.registry()?.load(name)?)
    }

    fn registry(&self) -> Result<Registry, CliError> {
        match &self.folder {
            Some(folder) => Ok(Registry::open(folder)?),
            None => Ok(crate::shipped::scenes()),
        }
    }

    /// The named scenes, or all.
    fn select(&self, names: &[String]) -> Result<Vec<Scene>, CliError> {
        if !names.is_empty() {
            return names.iter().map(|name| self.scene(name)).collect();
        }
        let registry = self.registry()?;
        let all: Vec<String> = registry.names().map(str::to_owned).collect();
        all.iter().map(|name| Ok(registry.load(name)?)).collect()
    }
}

/// Makes a scene computable, if its constants fit into memory.
fn subject(scene: Scene, limit: &MemoryLimit) -> Result<Subject, CliError> {
    admit_constants(&scene, false, limit)?;
    Ok(Subject::new(scene)?)
}

/// Refuses a scene whose meshes do not fit into memory, before any is made.
fn meshes_fit(setup: &Setup, limit: &MemoryLimit) -> Result<(), CliError> {
    let sweep = setup.scene.sweep.iter();
    let ns = sweep.flat_map(|sweep| sweep.n.iter().copied().chain(sweep.reference.map(|r| r.n)));
    ns.map(|n| n as u32).try_for_each(|n| {
        admit_run(setup, None, (n, 1), limit)
            .map_err(|error| CliError::about(format!("{} n = {n}", setup.scene.name), error))
    })
}

/// The error for a scene without cases; `purpose` is e.g. `run` or `audit`.
fn no_case(scene: &Scene, purpose: &str) -> CliError {
    let hint = "add [sweep] with n and steps, or give --n and --steps";
    scene.error("scene.name", format!("the scene has no case to {purpose}"), hint).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_knows_its_compiler() {
        assert!(BUILD.compiler.starts_with("rustc 1."), "{BUILD:?}");
        let named = ["unknown", "development build"].contains(&BUILD.commit);
        let known = named || BUILD.commit.chars().all(|c| c.is_ascii_hexdigit());
        assert!(known && BUILD.target.contains('-'), "{BUILD:?}");
    }
}
