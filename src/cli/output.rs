//! What a command leaves: text on stdout, files in the directory that it was given.

use std::io::Write;
use std::path::Path;

use super::CliError;
use crate::record::replace_file;

/// Prints a JSON value.
pub fn print_json(value: &serde_json::Value) -> Result<(), CliError> {
    print_text(&serde_json::to_string_pretty(value).map_err(CliError::other)?);
    Ok(())
}

/// Prints to stdout; a closed pipe ends the program quietly instead of with a panic.
pub fn print_text(text: &str) {
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
