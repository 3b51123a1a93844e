//! Completions and man pages, generated from the definition of the command line.

use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;

use super::{CliError, create_dir, print_text};
use files::counted;

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
    pub(super) fn execute(&self, program: &mut Command) -> Result<u8, CliError> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, program, PROGRAM, &mut text);
        print_text(String::from_utf8_lossy(&text).trim_end());
        Ok(0)
    }
}

impl Man {
    /// For the command line `command`.
    pub(super) fn execute(&self, command: Command) -> Result<u8, CliError> {
        if let Some(out) = &self.out {
            create_dir(out)?;
            let pages = 1 + command.get_subcommands().count();
            clap_mangen::generate_to(command, out)
                .map_err(|error| CliError::about(out.display(), error))?;
            print_text(&format!("{} in {}", counted(pages, "page"), out.display()));
            return Ok(0);
        }
        let mut text = Vec::new();
        let page = clap_mangen::Man::new(command);
        page.render(&mut text).map_err(CliError::other)?;
        print_text(String::from_utf8_lossy(&text).trim_end());
        Ok(0)
    }
}
