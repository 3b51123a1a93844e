//! What a command leaves: text on stdout, files in the directory that it was given.

use std::io::Write;
use std::path::Path;

use super::CliError;
use crate::record::{harmless, harmless_json, replace_file};

/// Prints a JSON value.
pub fn print_json(value: &serde_json::Value) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(value).map_err(CliError::other)?;
    print_as_it_is(&harmless_json(&text));
    Ok(())
}

/// Prints to stdout; what others have written in the text does nothing there.
pub fn print_text(text: &str) {
    print_as_it_is(&harmless(text));
}

/// Prints a table of verdicts, in colour where stdout shows it.
pub fn print_verdicts(table: &str) {
    print_as_it_is(&super::colour::shown(&harmless(table)));
}

/// Prints colours and commands to stdout, which this program means; a closed pipe ends the program quietly instead of with a panic.
pub fn print_as_it_is(text: &str) {
    let mut out = std::io::stdout().lock();
    if writeln!(out, "{text}").and_then(|()| out.flush()).is_err() {
        std::process::exit(0);
    }
}

/// Bytes in MiB.
pub fn megabytes(bytes: f64) -> String {
    format!("{:.0} MiB", bytes / (1024.0 * 1024.0))
}

/// Creates a directory and what is above it.
pub fn create_dir(dir: &Path) -> Result<(), CliError> {
    std::fs::create_dir_all(dir).map_err(|error| CliError::about(dir.display(), error))
}

/// Writes a file in one piece.
pub fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), CliError> {
    replace_file(path, bytes.as_ref()).map_err(|error| CliError::about(path.display(), error))
}

/// Writes a JSON value in one piece.
pub fn write_json(path: &Path, value: &serde_json::Value) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(value).map_err(CliError::other)?;
    write_file(path, format!("{text}\n"))
}
