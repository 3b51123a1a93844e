//! Another program, run on one case under a time limit.

use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use wait_timeout::ChildExt;

/// What the program prints goes here.
pub const LOG: &str = "solver.log";
/// Last lines of the log that a failure shows.
const LINES_SHOWN: usize = 5;

/// Why a program gave no answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProcessError {
    /// It cannot be started.
    #[error("`{program}` cannot be started: {reason}")]
    Start { program: String, reason: String },
    /// It ran too long and was ended.
    #[error("the solver was stopped after {0} s: --time-limit gives it longer")]
    TooLong(u64),
    /// It ended with another status than 0.
    #[error("the solver ended with {status}{said}")]
    Failed { status: String, said: String },
}

/// Runs `words` with `dir` as its last argument and its working directory unchanged.
///
/// # Errors
/// [`ProcessError`]; the end of what it printed is in the message.
pub fn run(words: &[String], dir: &Path, limit: Duration) -> Result<(), ProcessError> {
    let (program, arguments) = words.split_first().ok_or_else(|| ProcessError::Start {
        program: String::new(),
        reason: "no command".into(),
    })?;
    let start = |error: std::io::Error| ProcessError::Start {
        program: program.clone(),
        reason: error.to_string(),
    };
    let log = File::create(dir.join(LOG)).map_err(start)?;
    let both = log.try_clone().map_err(start)?;
    let mut child = Command::new(program)
        .args(arguments)
        .arg(dir)
        .stdin(Stdio::null())
        .stdout(log)
        .stderr(both)
        .spawn()
        .map_err(start)?;
    let status = match child.wait_timeout(limit).map_err(start)? {
        Some(status) => status,
        None => {
            // It may have ended by itself in between; either way it is gone afterwards.
            let _ = child.kill();
            let _ = child.wait();
            return Err(ProcessError::TooLong(limit.as_secs()));
        }
    };
    if status.success() {
        return Ok(());
    }
    Err(ProcessError::Failed { status: status.to_string(), said: last_lines(&dir.join(LOG)) })
}

fn last_lines(path: &Path) -> String {
    let bytes = std::fs::read(path).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    let shown = &lines[lines.len().saturating_sub(LINES_SHOWN)..];
    if shown.is_empty() { String::new() } else { format!(": {}", shown.join(" | ")) }
}
