//! Ctrl-C during a sweep: the records stay, and a message says how to go on.

use std::io::{IsTerminal, Write};
use std::path::Path;

use super::CliError;

/// What shells report for a process that SIGINT ended.
const INTERRUPTED: i32 = 128 + 2;

/// From now on Ctrl-C ends the program with a message and code 130. No case is waited for: a table cut off at
/// any byte can be resumed, as after a crash.
pub fn on_interrupt(out: &Path, resuming: &str) -> Result<(), CliError> {
    let message = format!(
        "interrupted; finished cases are kept in {}\ngo on with: {resuming}",
        out.display()
    );
    ctrlc::set_handler(move || {
        crate::external::end_solvers();
        let mut stderr = std::io::stderr().lock();
        // A bar stands in the last line of a terminal.
        let line = if stderr.is_terminal() { "\n" } else { "" };
        // With stderr closed there is nobody to tell.
        let _ = writeln!(stderr, "{line}{message}");
        std::process::exit(INTERRUPTED);
    })
    .map_err(|error| CliError::about("no handler for Ctrl-C", error))
}
