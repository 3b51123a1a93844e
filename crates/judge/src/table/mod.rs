//! Foreign tables as text: points with scenes and norms.
//!
//! Separators are comma, semicolon, tab, blanks, `|` (Markdown, org, pretty-printed) and LaTeX's `&`; lines of `name =
//! value` pairs work as well. Columns are known by name, see [`understood`].

mod cells;
mod columns;
mod group;
mod latex;
mod name;
mod number;
mod read;
mod runs;

pub use group::{Group, Measurement, Quantity, Row};
pub use name::understood;
pub use read::{Reading, Tables, read};

/// Why a text is no table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{line}: {what}")]
pub struct TableError {
    pub line: u64,
    /// What is wrong there, with the value, and the way out.
    pub what: String,
}

impl TableError {
    fn at(line: u64, what: impl Into<String>) -> Self {
        Self { line, what: what.into() }
    }
}

#[cfg(test)]
mod tests;
