//! Tables as people have them: lines are classified (`text`), the block of rows that agree is found and its columns
//! are named (`name`), sizes and errors are read (`columns`), and rows become groups (`read`). What is guessed is said.

mod columns;
mod error;
mod group;
mod name;
mod number;
mod read;
mod row;
mod runs;
mod text;

pub use columns::Reading;
pub use error::TableError;
pub use group::Group;
pub use name::named;
pub use read::{Tables, read};
pub use row::{Measurement, Quantity, Row};

#[cfg(test)]
mod tests;
