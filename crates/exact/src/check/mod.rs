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

/// How a line of the report is to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    Verified,
    /// A fact without a claim.
    Fact,
    /// A hypothesis of the theorem that fails, or is verified only to the given accuracy.
    Weak,
    /// The accuracy of a number does not decide.
    Unknown,
    /// The data are inconsistent.
    Failed,
}

impl Status {
    /// Its word in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Verified => "verified",
            Self::Fact => "fact",
            Self::Weak => "weak",
            Self::Unknown => "unknown",
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
    /// The finding in words.
    pub text: String,
}

impl Finding {
    /// A line.
    pub fn new(subject: &str, status: Status, value: f64, text: String) -> Self {
        Self { subject: subject.into(), status, value, text }
    }
}

/// A side of the rectangle or box in the checks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideOfBox {
    /// Outward normal, an axis, padded with zeros.
    pub normal: [f64; 3],
    pub clamped: bool,
    pub contact: bool,
}

impl SideOfBox {
    pub(crate) fn axis(&self) -> usize {
        (0..3).find(|&i| self.normal[i] != 0.0).unwrap_or(0)
    }

    /// Its number among the sides, in the order x = 0, x = size\[0\], y = 0, and so on.
    pub(crate) fn number(&self) -> u32 {
        2 * self.axis() as u32 + u32::from(self.normal[self.axis()] > 0.0)
    }

    /// The coordinate along the normal, in a box of the given size.
    pub(crate) fn level(&self, size: &[f64]) -> f64 {
        let axis = self.axis();
        if self.normal[axis] > 0.0 { size[axis] } else { 0.0 }
    }

    /// The axes along the side, in order.
    pub(crate) fn along(&self, size: &[f64]) -> Vec<usize> {
        (0..size.len()).filter(|&axis| axis != self.axis()).collect()
    }

    pub(crate) fn measure(&self, size: &[f64]) -> f64 {
        self.along(size).iter().map(|&axis| size[axis]).product()
    }

    /// Points of the side: the product of `places(axis)` over its axes, the last of which varies fastest.
    pub(crate) fn points(&self, size: &[f64], places: impl Fn(usize) -> Vec<f64>) -> Vec<[f64; 3]> {
        let mut start = [0.0; 3];
        start[self.axis()] = self.level(size);
        let along = self.along(size).into_iter();
        along.fold(vec![start], |points, axis| spread(points, axis, &places(axis)))
    }
}

/// Each point at all places of an axis, which vary fastest.
fn spread(points: Vec<[f64; 3]>, axis: usize, places: &[f64]) -> Vec<[f64; 3]> {
    let at_places = |point: [f64; 3]| {
        places.iter().map(move |&place| {
            let mut point = point;
            point[axis] = place;
            point
        })
    };
    points.into_iter().flat_map(at_places).collect()
}

/// `count` + 1 equidistant places of [0, length], ends included.
fn places(length: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|i| i as f64 / count as f64 * length).collect()
}

/// All checks of an exact solution, on a rectangle or box with these sides or on its polytope.
pub fn check(exact: &Exact, sides: &[SideOfBox]) -> Vec<Finding> {
    let mut findings = match &exact.data.polytope {
        None => loads::strong_against_weak(exact, sides),
        Some(polytope) => {
            let zeta = polytope::zeta(exact, polytope);
            std::iter::once(polytope::loads(exact, polytope)).chain(zeta).collect()
        }
    };
    findings.extend(contact_state::contact(exact, sides));
    findings.extend(regularity::regularity(exact, sides));
    findings
}

/// Times at which fields are checked: two inside and the end.
fn times(exact: &Exact) -> [f64; 3] {
    [0.37, 0.71, 1.0].map(|fraction| fraction * exact.data.horizon)
}
