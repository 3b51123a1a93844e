//! Limits of memory and processors.

use clap::Args;

use super::CliError;
use run::sweep::MemoryLimit;

/// What a command may take of the memory.
#[derive(Args, Default, Clone)]
pub(super) struct Allowance {
    /// Memory limit in bytes, or as 512M, 8G. The memory of each case is predicted, and a case that would need more is
    /// not started [default: what the machine has available]
    #[arg(long, value_name = "BYTES")]
    memory_limit: Option<MemoryLimit>,
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

    /// The limit of the command line, if given.
    pub(super) fn given(&self) -> Option<MemoryLimit> {
        self.memory_limit
    }
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
