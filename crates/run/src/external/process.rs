//! Runs another program on one case under a time limit.

use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::group::ProcessGroup;
use super::log::Log;

/// Interval for shortening its log.
const LOOK: Duration = Duration::from_millis(100);

/// Why a program gave no answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProcessError {
    #[error("`{program}` cannot be started: {reason}")]
    Start { program: String, reason: String },
    #[error("the solver was stopped after {0} s: --time-limit gives it longer")]
    TooLong(u64),
    /// It ended with a nonzero status.
    #[error("the solver ended with {status}{said}")]
    Failed { status: String, said: String },
}

/// Runs `words` with `dir` as last argument, in the current working directory. All processes that it starts end with
/// it.
///
/// # Errors
/// [`ProcessError`]; its message includes the last line that the program printed.
pub(crate) fn run(words: &[String], dir: &Path, limit: Duration) -> Result<(), ProcessError> {
    let (program, arguments) = words.split_first().ok_or_else(|| ProcessError::Start {
        program: String::new(),
        reason: "no command".into(),
    })?;
    let start = |error: std::io::Error| ProcessError::Start {
        program: program.clone(),
        reason: error.to_string(),
    };
    let mut log = Log::new(dir).map_err(start)?;
    let mut command = Command::new(program);
    command.args(arguments).arg(dir).stdin(Stdio::null());
    command.stdout(log.handle().map_err(start)?).stderr(log.handle().map_err(start)?);
    let mut group = ProcessGroup::start(&mut command).map_err(start)?;
    let status = wait(&mut group, &mut log, limit).map_err(start)?;
    // Remaining children would write no reliable answer and slow down the next case.
    drop(group);
    log.keep_short().map_err(start)?;
    match status {
        None => Err(ProcessError::TooLong(limit.as_secs())),
        Some(status) if status.success() => Ok(()),
        Some(status) => {
            Err(ProcessError::Failed { status: status.to_string(), said: log.last_line() })
        }
    }
}

fn wait(
    group: &mut ProcessGroup,
    log: &mut Log,
    limit: Duration,
) -> std::io::Result<Option<ExitStatus>> {
    let begin = Instant::now();
    loop {
        let left = limit.saturating_sub(begin.elapsed());
        if let Some(status) = group.wait(left.min(LOOK))? {
            return Ok(Some(status));
        }
        if left.is_zero() {
            return Ok(None);
        }
        log.keep_short()?;
    }
}
