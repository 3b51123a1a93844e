//! What one row of a table measures.

use crate::fit::Point;

/// What a table measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    Error,
    /// A functional whose exact value is unknown.
    Value,
}

/// A row that serves, or the reason why it does not.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub line: u64,
    /// With values in place of errors, `error` holds the value.
    pub point: Point,
    /// Standard deviation of the error, absolute.
    pub sigma: Option<f64>,
    pub gap: Option<String>,
}

/// A point with the relative standard deviation of its error, if known.
pub type Measurement = (Point, Option<f64>);
