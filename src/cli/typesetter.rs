//! The PDF of a report, by the program `typeset` that stands beside this one.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::CliError;
use super::output::write_user_file;

/// The program, and the file for its PDF.
pub(super) struct Typesetter<'a> {
    program: PathBuf,
    file: &'a Path,
}

impl<'a> Typesetter<'a> {
    /// The program beside this one.
    pub(super) fn find(file: &'a Path) -> Result<Self, CliError> {
        let name = format!("typeset{}", std::env::consts::EXE_SUFFIX);
        let program = std::env::current_exe().map_err(CliError::other)?.with_file_name(name);
        if program.is_file() {
            return Ok(Self { program, file });
        }
        Err(CliError::other(format!(
            "a PDF is set by the program `typeset`, and {} is not there: in a clone `make pdf` builds it for target/release, `cargo install --path crates/report --features pdf` for an installed sweep; without it, `typst compile report.typ` sets what `sweep report` writes",
            program.display()
        )))
    }

    /// Sets the report in a directory.
    pub(super) fn set(&self, dir: &Path, date: Option<&str>) -> Result<(), CliError> {
        let output = Command::new(&self.program).arg(dir).args(date).output();
        let output = output.map_err(|error| CliError::about(self.program.display(), error))?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            let reason = format!("ended with {}: {}", output.status, said.trim_end());
            return Err(CliError::about(self.program.display(), reason));
        }
        write_user_file(self.file, output.stdout)
    }
}
