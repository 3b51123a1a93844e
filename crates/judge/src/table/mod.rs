//! Tables as people have them: lines are classified, rows that agree make a block with the names above it (`text`), what stands in
//! no rows is gathered (`loose`), sizes and errors are found among the columns by their names and numbers (`columns`, `cell`), and
//! rows become groups (`read`, `group`). What is guessed is said.

mod cell;
mod columns;
mod group;
mod loose;
mod read;
mod text;

pub use cell::named;
pub use columns::Reading;
pub use group::{Group, Measurement, Quantity, Row, TableError};
pub use read::{Tables, read};

#[cfg(test)]
mod tests;
