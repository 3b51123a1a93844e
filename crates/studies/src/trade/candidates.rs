//! "Which n and N for this error?": the cheapest whole numbers that a scene has and the models allow.

use std::cell::RefCell;
use std::collections::HashMap;

use judge::fit::FLOORS_ABOVE;
use run::sweep::{TooLarge, scene_reference};
use scene::setup::{Setup, SetupError, Subject, check_step_sizes};

/// No larger n or N is proposed: `sweep solve` takes no larger n, and N beyond it is a separate campaign.
pub(crate) const MOST: [u32; 2] = [4096, 100_000];

/// Finest n and N whose errors show: half of those of the scene's reference run, which has no error against itself.
pub(super) fn finest(setup: &Setup) -> Option<[u32; 2]> {
    scene_reference(setup).map(|r| [r.n / 2, r.steps / 2])
}

/// The whole numbers n and N that suit a scene.
pub(crate) struct Candidates<'a> {
    /// h of n.
    pub h: Box<dyn Fn(u32) -> f64 + 'a>,
    /// The largest time step of N, falling.
    pub k: Box<dyn Fn(u32) -> f64 + 'a>,
    /// Whether n suits the domain (and the reference run).
    pub cells: Box<dyn Fn(u32) -> bool + 'a>,
    /// Whether N suits the reference run and (3.4).
    pub steps: Box<dyn Fn(u32) -> bool + 'a>,
    /// What to do where no choice serves.
    way_out: &'static str,
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

/// Why no choice is the answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoAnswer {
    /// Nothing is known of the errors or of the costs, or a mesh cannot be made.
    #[error("{0}")]
    Refused(String),
    #[error("an error of {target} cannot be aimed at: it must be positive")]
    NotPositive { target: f64 },
    /// Below what solver and rounding leave.
    #[error(
        "an error of {target:.3e} is out of reach: solver and rounding leave up to {floor:.1e}, and {FLOORS_ABOVE} times that is the least that can be seen"
    )]
    BelowFloor { target: f64, floor: f64 },
    /// Finer than the finest choice, where the error is `least`.
    #[error(
        "an error of {target:.3e} is out of reach: the least on n <= {n}, N <= {steps} is {least:.3e}{way_out}"
    )]
    OutOfReach { target: f64, n: u32, steps: u32, least: f64, way_out: &'static str },
    /// The cheapest choice does not fit into memory, nor any other that has the error.
    #[error("an error of {target:.3e} asks for n = {n}, N = {steps}: {source}")]
    Memory { target: f64, n: u32, steps: u32, source: TooLarge },
}

impl From<SetupError> for NoAnswer {
    fn from(error: SetupError) -> Self {
        Self::Refused(error.to_string())
    }
}

impl NoAnswer {
    /// Refuses a target that solver and rounding hide.
    pub(super) fn admit(target: f64, floor: f64) -> Result<(), Self> {
        match target <= FLOORS_ABOVE * floor {
            true => Err(Self::BelowFloor { target, floor }),
            false => Ok(()),
        }
    }
}

/// A number at (h, k).
pub(crate) type AtSteps<'a> = dyn Fn(f64, f64) -> f64 + 'a;

impl<'a> Candidates<'a> {
    /// The candidates of a scene; `beside_reference`: errors are to be measured against its reference run, whose n and N
    /// they must divide.
    ///
    /// # Errors
    /// The scene cannot be set up.
    pub(crate) fn new(setup: &'a Setup, beside_reference: bool) -> Result<Self, SetupError> {
        let (scene, subject) = (&setup.scene, Subject::new(setup.scene.clone())?);
        let safe = remembered(move |steps| check_step_sizes(&subject, &[steps]).is_ok());
        let divides = move |steps| !beside_reference || scene.check_cases(&[], &[steps]).is_ok();
        Ok(Self {
            h: Box::new(|n| setup.body.domain.h(n)),
            k: Box::new(remembered(|steps| {
                // Numbers of steps without a grid are left out by `steps`.
                scene.time.grid(steps).map_or(0.0, |grid| grid.largest_step())
            })),
            cells: Box::new(move |n| match beside_reference {
                true => scene.check_cases(&[n], &[]).is_ok(),
                false => scene.check_cells(n).is_ok(),
            }),
            steps: Box::new(move |steps| divides(steps) && safe(steps)),
            way_out: if beside_reference { "" } else { "; start from a finer run" },
        })
    }

    /// The cheapest n and N from `least` to `most` whose predicted error is at most `target`: the least `seconds` under
    /// `error` ≤ `target`, the one growing and the other falling with either refinement. Models are not trusted on coarser
    /// grids than were run.
    ///
    /// # Errors
    /// [`NoAnswer`].
    pub(crate) fn cheapest(
        &self,
        error: &AtSteps<'_>,
        seconds: &AtSteps<'_>,
        target: f64,
        [least, most]: [[u32; 2]; 2],
    ) -> Result<Answer, NoAnswer> {
        if target.is_nan() || target <= 0.0 {
            return Err(NoAnswer::NotPositive { target });
        }
        let mut best: Option<Answer> = None;
        for n in (least[0]..=most[0]).filter(|&n| (self.cells)(n)) {
            let h = (self.h)(n);
            // Where N is the smallest, cost still grows with n: no later n can do better.
            if best.is_some_and(|b| seconds(h, (self.k)(least[1])) > b.seconds) {
                break;
            }
            let serves = |steps: u32| error(h, (self.k)(steps)) <= target;
            let Some(steps) = self.fewest(&serves, [least[1], most[1]]) else { continue };
            let k = (self.k)(steps);
            let found = Answer { n, steps, error: error(h, k), seconds: seconds(h, k) };
            if best.is_none_or(|best| found.seconds < best.seconds) {
                best = Some(found);
            }
        }
        best.ok_or_else(|| NoAnswer::OutOfReach {
            target,
            n: most[0],
            steps: most[1],
            least: error((self.h)(most[0]), (self.k)(most[1])),
            way_out: self.way_out,
        })
    }

    /// The fewest steps that serve, where more do as well.
    fn fewest(&self, serves: &dyn Fn(u32) -> bool, [least, most]: [u32; 2]) -> Option<u32> {
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
        (lo..=most).find(|&steps| (self.steps)(steps))
    }
}

/// A function of n or N that is worked out once for each.
fn remembered<T: Copy>(value: impl Fn(u32) -> T) -> impl Fn(u32) -> T {
    let known = RefCell::new(HashMap::new());
    move |at| *known.borrow_mut().entry(at).or_insert_with(|| value(at))
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

    fn all() -> Candidates<'static> {
        Candidates {
            h: Box::new(|n| 1.0 / f64::from(n)),
            k: Box::new(|steps| 1.0 / f64::from(steps)),
            cells: Box::new(|_| true),
            steps: Box::new(|_| true),
            way_out: "",
        }
    }

    const RANGE: [[u32; 2]; 2] = [[4, 2], [200, 100]];

    #[test]
    fn the_answer_is_the_cheapest_of_all_pairs() {
        let few = Candidates {
            cells: Box::new(|n| n % 8 == 0),
            steps: Box::new(|steps| 64 % steps == 0),
            ..all()
        };
        for (choices, target) in [(all(), 0.02), (all(), 0.1), (few, 0.03)] {
            let found = choices.cheapest(&error, &cost, target, RANGE).expect("an answer");
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
            let refused = all().cheapest(&error, &cost, target, RANGE);
            assert!(matches!(refused, Err(NoAnswer::NotPositive { .. })));
        }
        let refused = all().cheapest(&error, &cost, 0.002, RANGE);
        let refused = refused.expect_err("h = 1/200 leaves 0.0025");
        assert!(matches!(refused, NoAnswer::OutOfReach { n: 200, least, .. } if least > 0.0025));
    }
}
