//! Tables refined along a path k = c h^s: the order along it, and what it says of p and q.

use super::{Point, Sample, power_law, same_level};

/// Relative deviation of k from c h^s: numbers of steps are integers, N = √n rarely is. It changes the order along the
/// path by less than q · 0.02 / log 2 over a halving.
const OFF_THE_PATH: f64 = 0.02;

/// Two points always lie on a path.
const POINTS: usize = 3;

/// k = c h^s on every point of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefinementPath {
    /// s: 1 for k proportional to h, ½ for the balanced path of E = O(h + k²).
    pub exponent: f64,
    pub constant: f64,
}

impl RefinementPath {
    /// The order in h along the path of C_h h^p + C_k k^q: min(p, s q).
    pub fn order(self, p: f64, q: f64) -> f64 {
        p.min(self.exponent * q)
    }

    /// Which of p and q the order along the path tests: that of the slower term, or both if s q = p.
    pub fn tests(self, p: f64, q: f64) -> [bool; 2] {
        // Two thirds of the largest half-width a verdict allows; closer orders are not told apart.
        let balanced = 0.1;
        let ahead = p - self.exponent * q;
        [ahead <= balanced, ahead >= -balanced]
    }
}

/// The path through all points with both steps, if h and k are refined together along one.
pub fn path(points: &[Point]) -> Option<RefinementPath> {
    let positive = |step: f64| step.is_finite() && step > 0.0;
    let both = points.iter().filter(|point| positive(point.h) && positive(point.k));
    let mut samples: Vec<Sample> =
        both.map(|point| Sample { step: point.h, error: point.k }).collect();
    samples.sort_by(|a, b| b.step.total_cmp(&a.step));
    let repeated = |pair: &[Sample]| {
        let falls = |coarse: f64, fine: f64| fine < coarse && !same_level(coarse, fine);
        !falls(pair[0].step, pair[1].step) || !falls(pair[0].error, pair[1].error)
    };
    if samples.len() < POINTS || samples.windows(2).any(repeated) {
        return None;
    }
    let law = power_law(&samples).ok()?;
    let largest = law.residuals.iter().fold(0.0, |largest: f64, r| largest.max(r.abs()));
    let found = RefinementPath { exponent: law.order, constant: law.constant };
    (largest <= OFF_THE_PATH).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_path(steps: &[(f64, f64)]) -> Vec<Point> {
        steps.iter().map(|&(h, k)| Point { h, k, error: 1.0, floor: 0.0 }).collect()
    }

    #[test]
    fn paths_are_found_with_their_exponent() {
        for exponent in [0.5, 1.0, 2.0] {
            let steps = [0.25, 0.125, 0.0625, 0.03].map(|h: f64| (h, 3.0 * h.powf(exponent)));
            let found = path(&on_path(&steps)).unwrap();
            assert!((found.exponent - exponent).abs() < 1e-13);
            assert!((found.constant - 3.0).abs() < 1e-12);
        }
        // N = round(√n) for n = 100, 200, 400: 10, 14, 20; √200 = 14.14, 1 % off.
        let rounded = [(0.01, 0.1), (0.005, 1.0 / 14.0), (0.0025, 0.05)];
        assert!((path(&on_path(&rounded)).unwrap().exponent - 0.5).abs() < 0.01);
    }

    #[test]
    fn points_without_steps_are_passed_over() {
        let steps = [(0.25, 0.25), (0.125, 0.125), (0.0625, 0.0625)];
        for other in [
            (f64::INFINITY, 1.0),
            (0.0, 0.03),
            (0.03, 0.0),
            (0.03, f64::NAN),
            (f64::NAN, 0.03),
            (0.5, -0.5),
        ] {
            let found = path(&on_path(&[&steps[..], &[other]].concat()));
            assert!((found.unwrap().exponent - 1.0).abs() < 1e-13, "{other:?}");
        }
    }

    #[test]
    fn grids_lines_and_pairs_are_no_paths() {
        let grid = [(0.5, 0.5), (0.5, 0.25), (0.25, 0.5), (0.25, 0.25)];
        assert_eq!(path(&on_path(&grid)), None);
        let line = [(0.5, 0.1), (0.25, 0.1), (0.125, 0.1)];
        assert_eq!(path(&on_path(&line)), None);
        assert_eq!(path(&on_path(&[(0.5, 0.5), (0.25, 0.25)])), None);
        // k grows while h falls; a k that is 5 % off.
        assert_eq!(path(&on_path(&[(0.5, 0.1), (0.25, 0.2), (0.125, 0.4)])), None);
        assert_eq!(path(&on_path(&[(0.5, 0.5), (0.25, 0.27), (0.125, 0.125)])), None);
        let without = [(0.5, f64::NAN), (0.25, f64::NAN), (0.125, f64::NAN)];
        assert_eq!(path(&on_path(&without)), None);
    }

    #[test]
    fn a_path_tests_the_slower_term() {
        let path = |exponent| RefinementPath { exponent, constant: 1.0 };
        assert_eq!((path(1.0).order(1.0, 2.0), path(1.0).tests(1.0, 2.0)), (1.0, [true, false]));
        assert_eq!((path(0.5).order(1.0, 2.0), path(0.5).tests(1.0, 2.0)), (1.0, [true, true]));
        assert_eq!((path(0.25).order(1.0, 2.0), path(0.25).tests(1.0, 2.0)), (0.5, [false, true]));
    }
}
