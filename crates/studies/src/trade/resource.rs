//! What a run costs.

/// What a run costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Resource {
    /// CPU seconds.
    Time,
    /// Peak memory of a process that does it alone, predicted.
    Memory,
}

/// Bytes in MiB.
pub(super) fn megabytes(bytes: f64) -> String {
    format!("{:.0} MiB", bytes / (1024.0 * 1024.0))
}
