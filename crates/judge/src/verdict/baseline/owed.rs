//! What a scene owes: verdicts that a run has to judge and constants that it has to compare. They are recorded
//! with the baseline.

use serde::{Deserialize, Serialize};

use crate::verdict::{Variable, Verdict};
use fit::Decision;

/// A verdict that is owed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Owed {
    pub norm: String,
    pub variable: Variable,
    /// Constants compared with their prediction, that pass or fail.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub constants: Vec<String>,
}

/// Totals over the compared scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Owing {
    pub verdicts: usize,
    /// Constants that are compared with their prediction.
    pub constants: usize,
}

impl Owed {
    fn of(verdict: &Verdict) -> Self {
        let settled =
            verdict.constant.iter().filter(|claim| claim.decision != Decision::Unresolved);
        Self {
            norm: verdict.norm.clone(),
            variable: verdict.variable,
            constants: settled.map(|claim| claim.name.to_owned()).collect(),
        }
    }

    /// What the verdicts of a scene settle.
    pub(super) fn of_scene(scene: &str, verdicts: &[Verdict]) -> Vec<Self> {
        verdicts.iter().filter(|verdict| verdict.scene == scene).map(Self::of).collect()
    }

    pub(super) fn is_of(&self, other: &Self) -> bool {
        (&self.norm, self.variable) == (&other.norm, other.variable)
    }

    pub(super) fn name(&self) -> String {
        format!("{} in {}", self.norm, self.variable.name())
    }
}
