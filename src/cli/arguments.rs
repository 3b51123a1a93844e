//! The arguments of the command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use super::machine::COMMON;
use super::{baseline, check, fit, list, merge, report, run, shell, solve, study, verify};

/// Verifies and benchmarks error estimates of history-dependent variational-hemivariational
/// inequalities. Without a command: runs the scenes that it comes with at gate size, prints the
/// verdicts and writes reports/latest/.
#[derive(Parser)]
#[command(
    name = "sweep",
    version,
    max_term_width = 120,
    after_help = "Examples:\n  sweep                                      the main job; then open reports/latest/index.html\n  sweep list                                 what there is\n  sweep run pure-mild affine --out reports/two\n  sweep check punch                          what holds of a scene, and what it requires\n  sweep solve punch --n 16 --steps 16 --pictures reports/punch\n  sweep fit table.csv --p 1                  orders of anybody's errors\n\nExit codes: 0 all verdicts as expected, 1 one is not, 2 it could not judge. Colour is used on a terminal alone, and not with NO_COLOR."
)]
pub(super) struct Arguments {
    /// Folder of the scenes [default: manufactured, where that folder is; else those inside the program]
    #[arg(long = "scenes", id = "folder", value_name = "FOLDER", global = true, help_heading = COMMON)]
    pub(super) scenes: Option<PathBuf>,
    /// No progress, notes or warnings on stderr; errors are still printed
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = COMMON)]
    pub(super) quiet: bool,
    /// A line for each case that ends, also beside the bar of a terminal
    #[arg(short, long, global = true, help_heading = COMMON)]
    pub(super) verbose: bool,
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Subcommand)]
pub(super) enum Command {
    /// Run refinement sweeps, fit orders, judge them, write a report
    Run(run::Run),
    /// Run sweeps for CI: verdicts only
    Gate(run::Gate),
    /// Record errors and work of the scenes in reports/baseline.json, and say what changes
    Baseline(baseline::BaselineCommand),
    /// List the scenes with their terms and predicted orders
    List(list::List),
    /// Verify the data and hypotheses of a scene, and say what it requires, without solving
    Check(check::Check),
    /// Check the proofs of Theorems 10 and 11 line by line on real runs
    Audit(study::Audit),
    /// Name the term at fault: run the scene again with one term removed at a time
    Diagnose(study::DiagnoseCommand),
    /// Solve one case and print named quantities
    Solve(solve::Solve),
    /// Step-size bound (3.4) in four numbers: paper, sharpened, measured, loss of solvability
    Bound(study::BoundCommand),
    /// Evaluate Gronwall's inequality on runs: truncation errors, envelopes, horizons, perturbations
    Gronwall(study::Gronwall),
    /// Climb ladders of extreme parameters: units, moduli, steps, meshes, gaps, loads
    Extremes(study::Extremes),
    /// Speed against accuracy: work-precision over the settings of a scene, cost model, best n and N
    Trade(study::TradeCommand),
    /// Fit orders to a table with columns h, k, error
    Fit(fit::Fit),
    /// Put another program's solver under the same sweep
    Verify(verify::Verify),
    /// Merge the records of many processes, and judge them as those of one
    Merge(merge::MergeCommand),
    /// Rebuild every output from the records in a directory, without solving
    Report(report::Report),
    /// Print completions for a shell
    Completions(shell::Completions),
    /// Print the man page
    Man(shell::Man),
}
