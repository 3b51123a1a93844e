//! Tables as people have them: lines are made plain and cut into cells (`line`), rows that agree make a block (`text`) with the names
//! above it (`names`), lists and records of a log are gathered (`lists`, `loose`), sizes and errors are found among the columns by their
//! names and numbers (`columns`, `sizes`, `guess`, `cell`), and rows become groups (`read`, `group`). What is guessed is said.

mod cell;
mod columns;
mod group;
mod guess;
mod line;
mod lists;
mod loose;
mod names;
mod read;
mod sizes;
mod text;

pub use cell::named;
pub use group::{Group, Measurement, Quantity, Reading, Row, TableError};
pub use read::{Tables, read};

#[cfg(test)]
mod tests;
