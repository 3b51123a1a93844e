//! "Which n and N for this error?": the cheapest whole numbers that the models allow.

/// What may be chosen from.
pub(crate) struct Choices<'a> {
    /// Smallest n, and smallest N: models are not trusted on coarser grids than were run.
    pub least: [u32; 2],
    /// Largest n, and largest N.
    pub most: [u32; 2],
    /// h of n.
    pub h: &'a dyn Fn(u32) -> f64,
    /// k of N, falling.
    pub k: &'a dyn Fn(u32) -> f64,
    /// Whether n suits the domain (and the reference run).
    pub cells: &'a dyn Fn(u32) -> bool,
    /// Whether N suits the reference run and (3.4).
    pub steps: &'a dyn Fn(u32) -> bool,
}

/// An answer.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Answer {
    /// Cells per unit length.
    pub n: u32,
    /// Number of steps.
    pub steps: u32,
    /// The error there.
    pub error: f64,
    /// CPU seconds there.
    #[serde(rename = "cpu_seconds")]
    pub seconds: f64,
}

/// An error that no choice reaches.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoAnswer {
    /// Not a positive number.
    #[error("an error of {target} cannot be aimed at: it must be positive")]
    NotPositive {
        /// What was asked.
        target: f64,
    },
    /// Below what solver and rounding leave.
    #[error(
        "an error of {target:.3e} is out of reach: solver and rounding leave up to {floor:.1e}, and {times} times that is the least that can be seen"
    )]
    BelowFloor {
        /// What was asked.
        target: f64,
        /// The floor.
        floor: f64,
        /// How far above it an error must be.
        times: f64,
    },
    /// Finer than the finest choice.
    #[error(
        "an error of {target:.3e} is out of reach: the least on n <= {n}, N <= {steps} is {least:.3e}"
    )]
    OutOfReach {
        /// What was asked.
        target: f64,
        /// Largest n.
        n: u32,
        /// Largest N.
        steps: u32,
        /// The error there.
        least: f64,
    },
}

/// A number at (h, k).
pub(crate) type AtSteps<'a> = dyn Fn(f64, f64) -> f64 + 'a;

/// The cheapest choice whose predicted error is at most `target`: the least `seconds` under `error` ≤ `target`, the one
/// growing and the other falling with either refinement.
///
/// # Errors
/// [`NoAnswer`].
pub(crate) fn cheapest(
    error: &AtSteps<'_>,
    seconds: &AtSteps<'_>,
    target: f64,
    choices: &Choices<'_>,
) -> Result<Answer, NoAnswer> {
    if target.is_nan() || target <= 0.0 {
        return Err(NoAnswer::NotPositive { target });
    }
    let [least, most] = [choices.least, choices.most];
    let mut best: Option<Answer> = None;
    for n in (least[0]..=most[0]).filter(|&n| (choices.cells)(n)) {
        let h = (choices.h)(n);
        // Where N is the smallest, cost still grows with n: no later n can do better.
        if best.is_some_and(|b| seconds(h, (choices.k)(least[1])) > b.seconds) {
            break;
        }
        let Some(steps) = steps(error, target, h, choices) else { continue };
        let k = (choices.k)(steps);
        let found = Answer { n, steps, error: error(h, k), seconds: seconds(h, k) };
        if best.is_none_or(|best| found.seconds < best.seconds) {
            best = Some(found);
        }
    }
    best.ok_or_else(|| NoAnswer::OutOfReach {
        target,
        n: most[0],
        steps: most[1],
        least: error((choices.h)(most[0]), (choices.k)(most[1])),
    })
}

/// The fewest steps on a mesh.
fn steps(error: &AtSteps<'_>, target: f64, h: f64, choices: &Choices<'_>) -> Option<u32> {
    let [least, most] = [choices.least[1], choices.most[1]];
    let serves = |steps: u32| error(h, (choices.k)(steps)) <= target;
    if !serves(most) {
        return None;
    }
    let (mut lo, mut hi) = (least, most);
    while lo < hi {
        let middle = lo + (hi - lo) / 2;
        if serves(middle) {
            hi = middle;
        } else {
            lo = middle + 1;
        }
    }
    (lo..=most).find(|&steps| (choices.steps)(steps))
}

#[cfg(test)]
mod tests {
    use super::super::{ErrorModel, Term};
    use super::*;
    use judge::fit::{ErrorCombination, Interval};

    fn error(h: f64, k: f64) -> f64 {
        let term = |constant, order| {
            Some(Term { constant, order, interval: Interval::around(order, 0.0) })
        };
        let error = ErrorModel {
            model: ErrorCombination::RootSumSquare,
            space: term(0.5, 1.0),
            time: term(0.3, 2.0),
            source: String::new(),
            residual: 0.0,
        };
        error.error(h, k)
    }

    fn cost(h: f64, k: f64) -> f64 {
        1e-6 * h.powf(-2.2) * k.powf(-0.9)
    }

    const ALL: Choices<'_> = Choices {
        least: [4, 2],
        most: [200, 100],
        h: &|n| 1.0 / n as f64,
        k: &|steps| 1.0 / steps as f64,
        cells: &|_| true,
        steps: &|_| true,
    };

    #[test]
    fn the_answer_is_the_cheapest_of_all_pairs() {
        for (choices, target) in [
            (Choices { ..ALL }, 0.02),
            (Choices { ..ALL }, 0.1),
            (Choices { cells: &|n| n % 8 == 0, steps: &|steps| 64 % steps == 0, ..ALL }, 0.03),
        ] {
            let found = cheapest(&error, &cost, target, &choices).expect("an answer");
            let mut least = f64::INFINITY;
            for n in (4..=200).filter(|&n| (choices.cells)(n)) {
                for steps in (2..=100).filter(|&steps| (choices.steps)(steps)) {
                    let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
                    if error(h, k) <= target {
                        least = least.min(cost(h, k));
                    }
                }
            }
            assert_eq!(found.seconds, least, "{found:?}");
            assert!(found.error <= target);
            assert!((choices.cells)(found.n) && (choices.steps)(found.steps));
        }
    }

    #[test]
    fn nonsense_and_the_unreachable_are_refused() {
        for target in [0.0, -1.0, f64::NAN] {
            let refused = cheapest(&error, &cost, target, &ALL);
            assert!(matches!(refused, Err(NoAnswer::NotPositive { .. })));
        }
        let refused = cheapest(&error, &cost, 0.002, &ALL).expect_err("h = 1/200 leaves 0.0025");
        assert!(matches!(refused, NoAnswer::OutOfReach { n: 200, least, .. } if least > 0.0025));
    }
}
