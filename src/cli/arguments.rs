//! The arguments of the command line, their help, completions and manual page.

use std::ffi::OsString;
use std::path::PathBuf;

use super::machine::COMMON;
use super::{
    CliError, Scenes, check, fit, list, merge, print_text, report, run, solve, study, verify,
};
use clap::error::{ContextKind, ContextValue};
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use clap_complete::Shell;
use files::{counted, make_directory};
use scene::nearest;

/// Verify predicted orders of convergence, of contact problems or of your own program
#[derive(Parser)]
#[command(
    name = "sweep",
    version,
    max_term_width = 120,
    after_help = "Without a command, sweep runs its own scenes, prints the verdicts and writes reports/latest/.\n\nExamples:\n  sweep                                      the main job; then open reports/latest/index.html\n  sweep list                                 what there is\n  sweep run pure-mild affine --out reports/two\n  sweep check punch                          which hypotheses a scene satisfies, and its memory\n  sweep solve punch --n 16 --steps 16 --pictures reports/punch\n  sweep fit table.csv --p 1                  orders of your own errors\n\nExit codes: 0 all verdicts are as expected, 1 a verdict is not as expected, 2 nothing could be judged. Colour is used only on a terminal, and never if NO_COLOR is set."
)]
pub(super) struct Arguments {
    /// Folder of the scenes [default: manufactured, where that folder is; else those inside the program]
    #[arg(long = "scenes", id = "folder", value_name = "FOLDER", global = true, help_heading = COMMON)]
    pub(super) scenes: Option<PathBuf>,
    /// Print only errors on stderr: no progress, notes or warnings
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = COMMON)]
    pub(super) quiet: bool,
    /// Print every verdict, and a line when each case finishes, even where a progress bar is shown
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
    /// Record errors and work in reports/baseline.json, say what changes
    Baseline(merge::BaselineCommand),
    /// List the scenes with their terms and predicted orders
    List(list::List),
    /// Check a scene's data and hypotheses, and predict its memory
    Check(check::Check),
    /// Find the term at fault by removing one term at a time
    Diagnose(study::DiagnoseCommand),
    /// Solve one case and print named quantities
    Solve(solve::Solve),
    #[command(flatten)]
    Study(study::StudyCommand),
    /// Test extremes of units, moduli, steps, meshes, gaps, loads
    Extremes(study::Extremes),
    /// Measure time against error, and find the cheapest n and N
    Trade(study::TradeCommand),
    /// Judge the orders of errors in any table
    Fit(fit::Fit),
    /// Test another program's solver with the same sweep
    Verify(verify::Verify),
    /// Merge the records of many processes and judge them as one run
    Merge(merge::MergeCommand),
    /// Rebuild all output from a directory's records, without solving
    Report(report::Report),
    /// Print completions for a shell
    Completions(Completions),
    /// Print the man page
    Man(Man),
}

// Grouped help, and hints for unknown commands.

const GROUPS: [(&str, &[&str]); 6] = [
    ("Judge", &["run", "gate", "baseline", "fit", "verify", "report"]),
    ("Understand", &["list", "check", "solve", "diagnose"]),
    ("Theory", &["audit", "bound", "gronwall", "estimators"]),
    ("Cost and limits", &["trade", "extremes"]),
    ("Many machines", &["merge"]),
    ("Shell", &["completions", "man", "help"]),
];

pub(super) fn parsed(words: impl IntoIterator<Item = OsString>) -> Result<Arguments, clap::Error> {
    let mut command = Arguments::command();
    // The command `help` exists only once the command is built.
    command.build();
    let template = template(&command);
    let mut command = Arguments::command().help_template(template);
    let matches = command.try_get_matches_from_mut(words)?;
    Arguments::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

fn template(command: &clap::Command) -> String {
    let about = |name: &str| {
        let about_command = command.find_subcommand(name).and_then(clap::Command::get_about);
        format!("  {name:<12} {}\n", about_command.map(ToString::to_string).unwrap_or_default())
    };
    let group = |(title, names): (&str, &[&str])| {
        let lines: String = names.iter().map(|name| about(name)).collect();
        format!("{title}:\n{lines}\n")
    };
    let groups: String = GROUPS.into_iter().map(group).collect();
    format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}Options:\n{{options}}{{after-help}}\n"
    )
}

/// A suggestion for an unknown command.
pub(super) fn hint(said: &clap::Error) -> Option<String> {
    let Some(ContextValue::String(word)) = said.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    let registry = Scenes::new(None).registry().ok();
    let scenes: Vec<&str> = registry.iter().flat_map(|registry| registry.names()).collect();
    let commands = GROUPS.iter().flat_map(|(_, names)| names.iter().copied());
    let of_scene =
        |scene: &str| format!("`sweep run {scene}` runs it, `sweep check {scene}` says what it is");
    if scenes.contains(&word.as_str()) {
        return Some(format!("hint: `{word}` is a scene: {}", of_scene(word)));
    }
    let command = nearest(word, commands).map(|near| format!("hint: did you mean `sweep {near}`?"));
    let scene = || {
        nearest(word, scenes.iter().copied())
            .map(|near| format!("hint: did you mean the scene `{near}`? {}", of_scene(near)))
    };
    command.or_else(scene)
}

// Completions and man pages, generated from the definition of the command line.

const PROGRAM: &str = "sweep";

/// `sweep completions`.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  sweep completions bash > ~/.local/share/bash-completion/completions/sweep\n  sweep completions zsh > \"${fpath[1]}/_sweep\"\n  sweep completions fish > ~/.config/fish/completions/sweep.fish"
)]
pub(crate) struct Completions {
    /// The shell
    shell: Shell,
}

/// `sweep man`.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  sweep man | man -l -\n  sweep man --out ~/.local/share/man/man1"
)]
pub(crate) struct Man {
    /// Write a page for the program and for each command into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Completions {
    /// For the command line `program`.
    pub(super) fn execute(&self, program: &mut clap::Command) -> Result<u8, CliError> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, program, PROGRAM, &mut text);
        print_text(String::from_utf8_lossy(&text).trim_end());
        Ok(0)
    }
}

impl Man {
    /// For the command line `command`.
    pub(super) fn execute(&self, command: clap::Command) -> Result<u8, CliError> {
        if let Some(out) = &self.out {
            make_directory(out)?;
            let pages = 1 + command.get_subcommands().count();
            clap_mangen::generate_to(command, out)
                .map_err(|error| CliError::about(out.display(), error))?;
            print_text(&format!("{} in {}", counted(pages, "page"), out.display()));
            return Ok(0);
        }
        let mut text = Vec::new();
        let page = clap_mangen::Man::new(command);
        page.render(&mut text)?;
        print_text(String::from_utf8_lossy(&text).trim_end());
        Ok(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_in_one_group() {
        let mut command = Arguments::command();
        command.build();
        let mut there: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        let mut grouped: Vec<&str> = GROUPS.map(|(_, names)| names).concat();
        there.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(there, grouped);
        let text = template(&command);
        assert!(
            text.contains("  run          Run refinement sweeps")
                && !text.contains("  run          \n")
        );
        assert!(text.contains("  bound        Step-size bound (3.4)"), "{text}");
    }

    #[test]
    fn a_word_that_is_no_command_gets_a_hint() {
        let hint = |word: &str| {
            parsed(["sweep", word].map(Into::into)).err().and_then(|error| hint(&error))
        };
        assert_eq!(hint("rnu").as_deref(), Some("hint: did you mean `sweep run`?"));
        assert!(hint("pure-mild").is_some_and(|said| said.contains("sweep run pure-mild")));
        assert!(hint("pure-mlid").is_some_and(|said| said.contains("the scene `pure-mild`")));
        assert_eq!(hint("xyzzy-quux"), None);
    }
}
