/// Why a text is no table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{line}: {what}")]
pub struct TableError {
    pub line: u64,
    /// What is wrong there, with the value, and the way out.
    pub what: String,
}

impl TableError {
    pub(super) fn at(line: u64, what: impl Into<String>) -> Self {
        Self { line, what: what.into() }
    }
}
