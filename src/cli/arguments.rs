//! The arguments of the command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use super::machine::COMMON;
use super::{
    audit, baseline, bound, check, diagnose, extremes, fit, gronwall, list, merge, report, run,
    shell, solve, trade, verify,
};

/// Verify predicted orders of convergence, of contact problems or of your own program
#[derive(Parser)]
#[command(
    name = "sweep",
    version,
    max_term_width = 120,
    after_help = "Without a command, sweep runs its own scenes, prints the verdicts and writes reports/latest/.\n\nExamples:\n  sweep                                      the main job; then open reports/latest/index.html\n  sweep list                                 what there is\n  sweep run pure-mild affine --out reports/two\n  sweep check punch                          what holds of a scene, and what it requires\n  sweep solve punch --n 16 --steps 16 --pictures reports/punch\n  sweep fit table.csv --p 1                  orders of anybody's errors\n\nExit codes: 0 all verdicts are as expected, 1 a verdict is not as expected, 2 nothing could be judged. Colour is used only on a terminal, and never if NO_COLOR is set."
)]
pub(super) struct Arguments {
    /// Folder of the scenes [default: manufactured, where that folder is; else those inside the program]
    #[arg(long = "scenes", id = "folder", value_name = "FOLDER", global = true, help_heading = COMMON)]
    pub(super) scenes: Option<PathBuf>,
    /// Print only errors on stderr: no progress, notes or warnings
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = COMMON)]
    pub(super) quiet: bool,
    /// Print a line when each case finishes, even where a progress bar is shown
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
    /// Check the data and hypotheses of a scene and predict its memory, without solving
    Check(check::Check),
    /// Check the proofs of Theorems 10 and 11 line by line on real runs
    Audit(audit::Audit),
    /// Find the term at fault by running the scene again with one term removed at a time
    Diagnose(diagnose::DiagnoseCommand),
    /// Solve one case and print named quantities
    Solve(solve::Solve),
    /// Step-size bound (3.4) in four numbers: paper, sharpened, measured, loss of solvability
    Bound(bound::BoundCommand),
    /// Evaluate Gronwall's inequality on runs: truncation errors, envelopes, horizons, perturbations
    Gronwall(gronwall::Gronwall),
    /// Test extreme parameters: units, moduli, steps, meshes, gaps, loads
    Extremes(extremes::Extremes),
    /// Measure time against error over the settings of a scene, and find the cheapest n and N
    Trade(trade::TradeCommand),
    /// Fit orders to a table with columns h, k, error
    Fit(fit::Fit),
    /// Test another program's solver with the same sweep
    Verify(verify::Verify),
    /// Merge the records of many processes and judge them like those of a single run
    Merge(merge::MergeCommand),
    /// Rebuild every output from the records in a directory, without solving
    Report(report::Report),
    /// Print completions for a shell
    Completions(shell::Completions),
    /// Print the man page
    Man(shell::Man),
}
