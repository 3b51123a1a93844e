//! Foreign tables as text: points with scenes and norms.
//!
//! Separators are comma, semicolon, tab, blanks, `|` (Markdown, org, pretty-printed) and LaTeX's `&`; lines of `name =
//! value` pairs work as well. Columns are known by name, see [`understood`].

mod cells;
mod columns;
mod error;
mod group;
mod latex;
mod name;
mod number;
mod read;
mod row;
mod runs;

pub use columns::Reading;
pub use error::TableError;
pub use group::Group;
pub use name::understood;
pub use read::{Tables, read};
pub use row::{Measurement, Quantity, Row};

#[cfg(test)]
mod tests;
