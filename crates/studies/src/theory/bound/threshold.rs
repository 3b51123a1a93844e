//! Step sizes up to which steps are known, or found, to have one solution.

pub use super::crossing::Crossing;
use super::run::ContractionStudy;
use serde::Serialize;
use vhi::StepBounds;

/// Step sizes up to which something holds: null where it does for every k.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Thresholds {
    /// (3.4) with the norm that the paper takes of ℬ.
    pub paper_norm: f64,
    /// (3.4) with the operator norm.
    pub theorem: f64,
    /// With the weight k/2 of the last slot, part by part.
    pub sharpened: f64,
    /// Below it each step is a strongly monotone problem.
    pub solvable: f64,
    /// Step size at which ‖DΛ‖ reaches one.
    pub norm_one: Option<Crossing>,
    /// Step size at which the spectral radius of DΛ reaches one.
    pub radius_one: Option<Crossing>,
    /// Step size at which the solution that is followed in k ends.
    pub loss: Option<(f64, f64)>,
    /// How it ends.
    pub loss_reason: Option<String>,
    /// The largest real eigenvalue of DΛ there.
    pub loss_eigenvalue: Option<f64>,
    /// Why no solution was followed, where none was.
    pub not_followed: Option<String>,
    /// Linear scenes: 𝒜 + (k/2)ℬ(0) singular on S^d.
    pub loss_tensors: Option<f64>,
    /// The k at which 𝒜 + (k/2)ℬ(0) is singular on V^h.
    pub loss_mesh: Option<f64>,
}

impl Thresholds {
    pub(super) fn new(limits: &StepBounds, study: &ContractionStudy) -> Self {
        let found = &study.thresholds;
        let loss = found.loss.as_ref();
        Self {
            paper_norm: limits.paper_limit(),
            theorem: limits.limit(),
            sharpened: limits.sharpened_limit(),
            solvable: limits.solvable_limit(),
            norm_one: found.norm,
            radius_one: found.radius,
            loss: loss.map(|loss| loss.bracket),
            loss_reason: loss.map(|loss| loss.reason.to_string()),
            loss_eigenvalue: loss.map(|loss| loss.rightmost),
            not_followed: study.not_followed.clone(),
            loss_tensors: study.linear.map(|loss| loss.tensors),
            loss_mesh: study.linear.map(|loss| loss.mesh),
        }
    }
}
