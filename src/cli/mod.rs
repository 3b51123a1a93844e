//! The command line: one file per command; results on stdout, progress and errors on stderr.

mod abstract_problem;
mod arguments;
mod build;
mod check;
mod error;
mod fit;
mod list;
mod machine;
mod merge;
mod output;
mod report;
mod run;
mod scenes;
mod solve;
mod study;
mod swept;
mod verify;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::CommandFactory;

pub use error::CliError;
pub use fit::{Fitted, fitted};

use arguments::{Arguments, Command};
use build::BUILD;
use error::COULD_NOT_JUDGE;
use output::{
    TABLE_WIDTH, delivered, print_as_it_is, print_beside, print_error, print_json, print_text,
    print_verdicts, prints_all, verdict_table, width,
};
use scenes::{Scenes, note_groups, subject};

/// Parses the arguments of the process and runs the command.
pub fn main() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os()))
}

/// Runs a command line (program name first); returns its exit code.
pub fn run_with(words: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match arguments::parsed(words) {
        Ok(arguments) => arguments,
        Err(said) => return finished(said_instead(&said)),
    };
    output::say(match (arguments.quiet, arguments.verbose) {
        (true, _) => output::Loudness::Quiet,
        (_, true) => output::Loudness::Verbose,
        _ => output::Loudness::Usual,
    });
    let scenes = Scenes::new(arguments.scenes);
    let command = arguments.command.unwrap_or(Command::Run(run::Run::main_job()));
    let outcome = match command {
        Command::Run(run) => run.execute(&scenes),
        Command::Gate(gate) => gate.execute(&scenes),
        Command::Baseline(baseline) => baseline.execute(&scenes),
        Command::List(list) => list.execute(&scenes),
        Command::Check(check) => check.execute(&scenes),
        Command::Diagnose(diagnose) => diagnose.execute(&scenes),
        Command::Solve(solve) => solve.execute(&scenes),
        Command::Study(study) => study.execute(&scenes),
        Command::Extremes(extremes) => extremes.execute(),
        Command::Trade(trade) => trade.execute(&scenes),
        Command::Fit(fit) => fit.execute(),
        Command::Verify(verify) => verify.execute(&scenes),
        Command::Merge(merge) => merge.execute(),
        Command::Report(report) => report.execute(&scenes),
        Command::Completions(completions) => completions.execute(&mut Arguments::command()),
        Command::Man(man) => man.execute(Arguments::command()),
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
    if let Some(hint) = arguments::hint(said) {
        print_error(&hint);
    }
    Ok(u8::try_from(said.exit_code()).unwrap_or(COULD_NOT_JUDGE))
}
