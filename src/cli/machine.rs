//! Limits of memory and processors, and interruption.

use std::io::IsTerminal;

use super::CliError;
use super::output::print_error;
use clap::Args;
use run::sweep::MemoryLimit;

/// What a command may take of the memory.
#[derive(Args, Default, Clone)]
pub(super) struct Allowance {
    /// Memory limit in bytes, or as 512M, 8G. The memory of each case is predicted, and a case that would need more is
    /// not started [default: what the machine has available]
    #[arg(long, value_name = "BYTES")]
    pub(super) memory_limit: Option<MemoryLimit>,
}

/// Heading in help of what most commands take, below their own options.
pub(super) const COMMON: &str = "Options of most commands";

/// What most commands take.
#[derive(Args)]
#[command(next_help_heading = COMMON)]
pub(super) struct Common {
    #[command(flatten)]
    pub(super) allowance: Allowance,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

impl Allowance {
    pub(super) fn limit(&self) -> MemoryLimit {
        self.memory_limit.unwrap_or_else(MemoryLimit::of_machine)
    }
}

/// A command with those of its flags that are given, as the provenance of a run says it.
pub(super) fn options(command: &str, flags: &[(bool, &str)]) -> String {
    let given = flags.iter().filter(|(given, _)| *given).map(|(_, flag)| *flag);
    std::iter::once(command).chain(given).collect::<Vec<_>>().join(" ")
}

/// What Linux says of this process.
pub(super) fn status_of_process(key: &str) -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let value = status.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'))?;
    Some(value.trim().to_owned())
}

pub(super) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Starts the threads that cases, trials and scenes share, before the first of them asks for one.
///
/// # Errors
/// The system refuses them.
pub(super) fn share_threads() -> Result<(), CliError> {
    use std::error::Error;
    let started = rayon::ThreadPoolBuilder::new().build_global();
    // Without a source they are there already.
    match started.as_ref().err().and_then(|error| error.source()) {
        None => Ok(()),
        Some(reason) => Err(CliError::other(format!(
            "the system gives no {} threads: {reason}; set RAYON_NUM_THREADS to fewer, or raise the limit of processes (ulimit -u)",
            processors()
        ))),
    }
}

// Ctrl-C, SIGTERM or a closed terminal during a sweep: records are kept, and a message says how to go on.

/// Shells report a process ended by signal s as 128 + s.
const BY_SIGNAL: i32 = 128;

/// From now on these signals end the program with a message, and code 130 (Ctrl-C), 143 (SIGTERM) or 129 (SIGHUP). No
/// case is waited for: a table cut off at any byte can be resumed.
pub(crate) fn on_interrupt(message: String) -> Result<(), CliError> {
    on_signal(move |signal| {
        run::external::end_solvers();
        // A progress bar occupies the last line of a terminal.
        let line = if std::io::stderr().is_terminal() { "\n" } else { "" };
        print_error(&format!("{line}{message}"));
        std::process::exit(BY_SIGNAL + signal);
    })
    .map_err(|error| CliError::about("no handler for Ctrl-C", error))
}

#[cfg(unix)]
fn on_signal(then: impl Fn(i32) + Send + 'static) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut ends = vec![SIGINT, SIGTERM];
    // A program started by `nohup` ignores SIGHUP, the lowest bit. If unknown, the system's reaction is left alone.
    let ignored = status_of_process("SigIgn").and_then(|mask| u64::from_str_radix(&mask, 16).ok());
    ends.extend(ignored.is_some_and(|mask| mask & 1 == 0).then_some(SIGHUP));
    let mut signals = signal_hook::iterator::Signals::new(ends)?;
    let wait = move || signals.forever().for_each(then);
    std::thread::Builder::new().name("signals".into()).spawn(wait)?;
    Ok(())
}

#[cfg(not(unix))]
fn on_signal(then: impl Fn(i32) + Send + 'static) -> Result<(), ctrlc::Error> {
    const INTERRUPT: i32 = 2;
    ctrlc::set_handler(move || then(INTERRUPT))
}
