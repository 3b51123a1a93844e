//! Entries of an error table and the steps that they were computed with.

/// Relative difference of steps that count as one level: tables carry 1/3 as 0.333333333.
const SAME_LEVEL: f64 = 1e-9;

/// Whether two positive steps are one up to rounding.
pub fn same_level(a: f64, b: f64) -> bool {
    a.min(b) >= a.max(b) * (1.0 - SAME_LEVEL)
}

/// One entry of an error table. A missing error or step is NaN, an unmeasured floor is 0.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Point {
    pub h: f64,
    pub k: f64,
    pub error: f64,
    /// Error that exact discretisation would leave: solver tolerance and rounding.
    #[serde(skip)]
    pub floor: f64,
}

/// The step that is refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    Space,
    Time,
}

impl Direction {
    pub const BOTH: [Self; 2] = [Self::Space, Self::Time];

    /// Name of its step.
    pub fn name(self) -> &'static str {
        match self {
            Self::Space => "h",
            Self::Time => "k",
        }
    }

    /// Name of the constant of its term.
    pub fn constant(self) -> &'static str {
        match self {
            Self::Space => "C_h",
            Self::Time => "C_k",
        }
    }

    /// The direction that is not refined.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Space => Self::Time,
            Self::Time => Self::Space,
        }
    }

    /// The step of a point in this direction.
    pub fn step(self, point: &Point) -> f64 {
        match self {
            Self::Space => point.h,
            Self::Time => point.k,
        }
    }
}
