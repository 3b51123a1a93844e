//! Verification of an exact solution, before any solve: loads in two forms, contact state, purity,
//! regularity.

mod contact_state;
mod loads;
mod polygon;
mod regularity;
mod smoothness;

pub use regularity::{regularity_in_space, regularity_in_time};
pub use smoothness::second_difference;

use super::Exact;

/// How a line of the report is to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Verified.
    Verified,
    /// A fact without a claim.
    Fact,
    /// A hypothesis of the theorem that does not hold here, or holds to the accuracy given only.
    Weak,
    /// The data contradict themselves.
    Failed,
}

impl Status {
    /// Its word in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Verified => "verified",
            Self::Fact => "fact",
            Self::Weak => "weak",
            Self::Failed => "FAILED",
        }
    }
}

/// One line of the report.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What was looked at.
    pub subject: String,
    /// How it is to be read.
    pub status: Status,
    /// The number behind it, NaN where there is none.
    pub value: f64,
    /// In words.
    pub text: String,
}

impl Finding {
    /// A line.
    pub fn new(subject: &str, status: Status, value: f64, text: String) -> Self {
        Self { subject: subject.into(), status, value, text }
    }
}

/// A side of the rectangle in the checks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideOfRectangle {
    /// Outward normal.
    pub normal: [f64; 2],
    /// True on Γ1.
    pub clamped: bool,
    /// True on Γ3.
    pub contact: bool,
}

impl SideOfRectangle {
    /// The point at fraction s of the side of a rectangle of the given size.
    pub fn point(&self, size: [f64; 2], s: f64) -> [f64; 3] {
        let [nx, ny] = self.normal;
        if nx != 0.0 {
            [if nx > 0.0 { size[0] } else { 0.0 }, s * size[1], 0.0]
        } else {
            [s * size[0], if ny > 0.0 { size[1] } else { 0.0 }, 0.0]
        }
    }

    /// Its length in a rectangle of the given size.
    pub fn length(&self, size: [f64; 2]) -> f64 {
        if self.normal[0] != 0.0 { size[1] } else { size[0] }
    }
}

/// All checks of an exact solution, on a rectangle with these sides or on its polygon.
pub fn check(exact: &Exact, sides: &[SideOfRectangle]) -> Vec<Finding> {
    let mut findings = match &exact.data.polygon {
        None => loads::strong_against_weak(exact, sides),
        Some(polygon) => {
            let zeta = polygon::zeta(exact, polygon);
            std::iter::once(polygon::loads(exact, polygon)).chain(zeta).collect()
        }
    };
    findings.extend(contact_state::contact(exact, sides));
    findings.extend(regularity::regularity(exact, sides));
    findings
}

/// Times at which fields are looked at: two inside and the end.
fn times(exact: &Exact) -> [f64; 3] {
    [0.37, 0.71, 1.0].map(|fraction| fraction * exact.data.horizon)
}
