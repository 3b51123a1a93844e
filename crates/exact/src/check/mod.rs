//! Verification of an exact solution before any solve: loads in two forms, contact state, purity, regularity.

mod contact_state;
mod lines;
mod loads;
mod polytope;
mod regularity;
mod sliding;
mod smoothness;

pub use regularity::{regularity_in_space, regularity_in_time};
pub use smoothness::second_difference;

use super::Exact;
use fem::mesh::Face;
use serde::Serialize;

/// How a line of the report is to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    Verified,
    /// A fact without a claim.
    Fact,
    /// A hypothesis of the theorem that fails, or is verified only to the given accuracy.
    Weak,
    /// The accuracy of a number does not decide.
    Unknown,
    /// The data are inconsistent.
    #[serde(rename = "FAILED")]
    Failed,
}

/// One line of the report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What was looked at.
    pub subject: String,
    /// How it is to be read.
    pub status: Status,
    /// The number behind it, NaN where there is none.
    pub value: f64,
    /// The finding in words.
    pub text: String,
}

impl Finding {
    /// A line.
    pub fn new(subject: &str, status: Status, value: f64, text: String) -> Self {
        Self { subject: subject.into(), status, value, text }
    }
}

/// A plane piece of the boundary of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyFace {
    /// The side that it is part of.
    pub side: u32,
    pub face: Face,
    pub clamped: bool,
    pub contact: bool,
}

/// All checks of an exact solution on a body with this boundary.
pub fn check(exact: &Exact, faces: &[BodyFace]) -> Vec<Finding> {
    let mut findings = loads::strong_against_weak(exact, faces);
    if let Some(coarse) = &exact.data.polytope {
        findings.extend(polytope::zeta(exact, coarse));
    }
    findings.extend(contact_state::contact(exact, faces));
    findings.extend(regularity::regularity(exact, faces));
    findings
}

/// Times at which fields are checked: two inside and the end.
fn times(exact: &Exact) -> [f64; 3] {
    [0.37, 0.71, 1.0].map(|fraction| fraction * exact.data.horizon)
}
