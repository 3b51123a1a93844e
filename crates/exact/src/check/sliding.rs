//! Friction on Γ3 at samples: |s| ≤ S, s = S u_τ/|u_τ| where u_τ slips, and the share of Γ3 that sticks.

use super::{Finding, Status};
use crate::Sliding;

/// |u_τ| below this share of the largest is rounding of the formulas.
const AT_REST: f64 = 1e-12;

/// Worst values over the samples.
pub(super) struct SlidingExtremes {
    /// Largest |s| - S.
    excess: f64,
    /// Largest S |u_τ| - s·u_τ, which is nonnegative for |s| ≤ S.
    unaligned: f64,
    slip: f64,
    bound: f64,
    least: f64,
    /// |u_τ| of all samples.
    slips: Vec<f64>,
}

impl Default for SlidingExtremes {
    fn default() -> Self {
        let (excess, least) = (f64::NEG_INFINITY, f64::INFINITY);
        Self { excess, unaligned: 0.0, slip: 0.0, bound: 0.0, least, slips: Vec::new() }
    }
}

impl SlidingExtremes {
    pub(super) fn add(&mut self, sliding: &Sliding) {
        let (s, u_tau, bound) = (sliding.size(), sliding.slipped(), sliding.bound);
        // NaN counts as an infinite violation.
        let excess = if s.is_nan() || bound.is_nan() { f64::INFINITY } else { s - bound };
        self.excess = self.excess.max(excess);
        self.unaligned = self.unaligned.max(sliding.unaligned());
        self.slip = self.slip.max(u_tau);
        self.bound = self.bound.max(bound);
        self.least = self.least.min(bound);
        self.slips.push(u_tau);
    }

    /// The findings; stresses on Γ3 have size `scale`.
    pub(super) fn findings(&self, scale: f64, samples: usize) -> Vec<Finding> {
        let verified = |holds: bool| if holds { Status::Verified } else { Status::Failed };
        let holds = self.excess <= 1e-9 * scale && self.least >= 0.0;
        let text = format!(
            "largest |s| - S is {:.2e}, largest S {:.3e}, smallest {:.1e}",
            self.excess, self.bound, self.least
        );
        let bounded = Finding::new("|s| <= S", verified(holds), self.excess, text);
        let aligned = self.unaligned <= 1e-9 * scale * self.slip;
        let text = format!("largest S |u_tau| - s u_tau is {:.2e}", self.unaligned);
        let aligned = Finding::new("s u_tau = S |u_tau|", verified(aligned), self.unaligned, text);
        let threshold = AT_REST * self.slip;
        let slipping = self.slips.iter().filter(|slip| slip.abs() > threshold).count();
        let slipping = 100.0 * slipping as f64 / samples.max(1) as f64;
        let text = format!(
            "of Gamma3 x [0,T]: sticking {:.0} %, slipping {slipping:.0} %",
            100.0 - slipping
        );
        vec![bounded, aligned, Finding::new("friction states", Status::Fact, slipping, text)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statuses(samples: &[[f64; 3]]) -> Vec<Status> {
        let mut extremes = SlidingExtremes::default();
        let plane =
            |numbers: &[f64; 3]| Sliding::new([[1.0, 0.0, 0.0], [0.0; 3]], 2, |i| numbers[i]);
        samples.iter().for_each(|numbers| extremes.add(&plane(numbers)));
        extremes.findings(1.0, samples.len()).into_iter().map(|finding| finding.status).collect()
    }

    #[test]
    fn a_law_is_verified_and_each_violation_seen() {
        let [yes, no, fact] = [Status::Verified, Status::Failed, Status::Fact];
        let sound = [[0.2, 0.01, 0.2], [-0.2, -0.02, 0.2], [0.1, 0.0, 0.2]];
        assert_eq!(statuses(&sound), [yes, yes, fact]);
        for wrong in [[-0.2, 0.01, 0.2], [0.1, 0.01, 0.2]] {
            assert_eq!(statuses(&[wrong]), [yes, no, fact], "{wrong:?}");
        }
        for wrong in [[0.3, 0.0, 0.2], [0.0, 0.0, -0.1], [f64::NAN, 0.0, 0.2]] {
            assert_eq!(statuses(&[wrong])[0], no, "{wrong:?}");
        }
    }

    /// In space |s| ≤ S is a ball: neither two components within S nor a stress of size S off the slip direction
    /// suffice.
    #[test]
    fn a_box_of_stresses_is_no_ball() {
        let findings = |numbers: [f64; 5]| {
            let mut extremes = SlidingExtremes::default();
            extremes.add(&Sliding::new([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], 3, |i| numbers[i]));
            extremes
                .findings(1.0, 1)
                .into_iter()
                .map(|finding| finding.status)
                .take(2)
                .collect::<Vec<_>>()
        };
        let [yes, no] = [Status::Verified, Status::Failed];
        assert_eq!(findings([0.3, 0.4, 0.03, 0.04, 0.5]), [yes, yes]);
        assert_eq!(findings([0.5, 0.5, 0.03, 0.04, 0.5])[0], no);
        assert_eq!(findings([0.4, 0.3, 0.03, 0.04, 0.5]), [yes, no]);
    }
}
