//! Output of commands: text on stdout and stderr, files in a given directory.

use std::io::{self, Write};
use std::path::Path;
use std::sync::OnceLock;

use super::CliError;
use files::{harmless, harmless_json, make_directory, read_file, replace_file, write_named};
use judge::verdict::Verdict;
use serde::Serialize;

/// The first failed write to stdout; nothing is written after it.
static STOPPED: OnceLock<io::Error> = OnceLock::new();

/// Prints a value, its keys in the order of the alphabet.
pub(crate) fn print_json(value: &impl Serialize) -> Result<(), CliError> {
    print_as_it_is(&harmless_json(&sorted(value)?));
    Ok(())
}

fn sorted(value: &impl Serialize) -> Result<String, CliError> {
    let text = serde_json::to_value(value).map(|value| format!("{value:#}"));
    text.map_err(CliError::other)
}

/// Prints to stdout; control characters of foreign text are disarmed.
pub(crate) fn print_text(text: &str) {
    print_as_it_is(&harmless(text));
}

/// Prints a table of verdicts, coloured if stdout allows it.
pub(crate) fn print_verdicts(table: &str) {
    print_as_it_is(&super::colour::shown(&harmless(table)));
}

/// Prints text with this program's control sequences. If stdout fails the command goes on, since its files and verdict
/// are still wanted; [`delivered`] sets the exit code.
pub(crate) fn print_as_it_is(text: &str) {
    if STOPPED.get().is_some() {
        return;
    }
    let mut out = io::stdout().lock();
    if let Err(error) = writeln!(out, "{text}").and_then(|()| out.flush()) {
        stopped(error);
    }
}

/// Keeps the first failure of stdout.
pub(crate) fn stopped(error: io::Error) {
    STOPPED.get_or_init(|| error);
}

/// The exit code of a command after printing. A closed pipe is no failure (the reader has what it wanted), a full disk
/// is.
pub(crate) fn delivered(code: u8) -> Result<u8, CliError> {
    match STOPPED.get() {
        Some(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::about("standard output", format!("{error}: the results are not there")))
        }
        _ => Ok(code),
    }
}

/// Prints a line on stderr, ignoring failures.
pub(crate) fn print_error(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", harmless(line));
}

/// Prints words beside their label, wrapped on a terminal only.
pub(crate) fn print_beside(label: &str, room: usize, words: &str) {
    print_text(&report::beside(label, room, words, width(u16::MAX)));
}

/// Columns for a table: of the terminal, else COLUMNS, else `usual`.
pub fn width(usual: u16) -> u16 {
    let terminal = || Some(console::Term::stdout().size_checked()?.1);
    let given = || std::env::var("COLUMNS").ok()?.parse().ok();
    terminal().or_else(given).map_or(usual, |columns: u16| columns.clamp(NARROWEST, WIDEST))
}

pub(crate) fn verdict_table(verdicts: &[Verdict]) -> String {
    report::verdict_table(verdicts, width(TABLE_WIDTH))
}

/// Width of a table where nothing else is known.
pub(crate) const TABLE_WIDTH: u16 = 100;

/// Narrowest table.
const NARROWEST: u16 = 60;
const WIDEST: u16 = 180;

/// Creates a directory and its parents; removes unfinished files of a killed process.
pub(crate) fn create_dir(dir: &Path) -> Result<(), CliError> {
    Ok(make_directory(dir)?)
}

/// Writes a file of a directory atomically.
pub(crate) fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), CliError> {
    Ok(replace_file(path, bytes.as_ref())?)
}

/// Writes to a path of the user, through links and into pipes.
pub(crate) fn write_user_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), CliError> {
    Ok(write_named(path, bytes.as_ref())?)
}

/// Copies a written file to a path of the user, through links and into pipes.
pub(crate) fn copy_named(from: &Path, to: &Path) -> Result<(), CliError> {
    Ok(write_named(to, &read_file(from)?)?)
}
