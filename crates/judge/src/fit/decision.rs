//! The three answers to a claim.

use serde::Serialize;

/// What a comparison says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Decision {
    /// The prediction lies in a narrow interval.
    Pass,
    /// The measurement refutes the prediction, or is not there.
    Fail,
    /// The data do not decide.
    Unresolved,
}

impl Decision {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
            Self::Unresolved => "unresolved",
        }
    }

    /// Of two questions of which both have to pass: fails if one fails, passes if both pass.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Fail, _) | (_, Self::Fail) => Self::Fail,
            (Self::Pass, Self::Pass) => Self::Pass,
            _ => Self::Unresolved,
        }
    }
}
