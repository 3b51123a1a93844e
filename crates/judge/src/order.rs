//! The order of a ladder in three lines: errors in, a prediction, a verdict out.

use fit::{Claim, ClaimError, FitError, Known, Level, LevelError, Posterior, Ruling, infer};

/// Errors on a ladder of steps, and what is known of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    ladder: Vec<(f64, f64)>,
    known: Known,
}

/// A ladder with the order that is expected of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    order: Order,
    claim: Claim,
}

/// What a ladder says of its order, and of the predicted one.
#[derive(Debug, Clone)]
pub struct Verdict {
    pub posterior: Posterior,
    pub ruling: Ruling,
}

/// Why an order cannot be judged.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum OrderError {
    #[error(transparent)]
    Ladder(#[from] FitError),
    #[error(transparent)]
    Prediction(#[from] ClaimError),
}

impl Order {
    /// Of steps (h or k) and errors, in any order, each step once.
    #[must_use]
    pub fn of(ladder: &[(f64, f64)]) -> Self {
        Self { ladder: ladder.to_vec(), known: Known::default() }
    }

    /// The relative standard deviation of the errors, 0.01 for one percent.
    #[must_use]
    pub fn noise(mut self, deviation: f64) -> Self {
        self.known.noise = Some(deviation);
        self
    }

    /// The errors have a factor |log h|^M.
    #[must_use]
    pub fn log_power(mut self, power: f64) -> Self {
        self.known.log = power;
        self
    }

    /// The errors are those against an exact solution.
    #[must_use]
    pub fn exact_solution(mut self) -> Self {
        self.known.reference = Some(0.0);
        self
    }

    /// The errors are those against a run with this finer step.
    #[must_use]
    pub fn reference_run(mut self, step: f64) -> Self {
        self.known.reference = Some(step);
        self
    }

    /// The order with its interval, compared with nothing.
    ///
    /// # Errors
    /// As [`infer`].
    pub fn infer(&self) -> Result<Posterior, FitError> {
        let levels = self.ladder.iter().map(|&(step, error)| Level::new(step, error));
        infer(&levels.collect::<Result<Vec<_>, LevelError>>()?, &self.known)
    }

    /// The order that a theorem predicts: it passes within 0.15 of it, and a higher one does not fail.
    #[must_use]
    pub fn predicted(self, order: f64) -> Predicted {
        let log = self.known.log;
        let claim = Claim { order, at_least: false, exact: false, tolerance: fit::TOLERANCE, log };
        Predicted { order: self, claim }
    }
}

impl Predicted {
    /// The prediction is a lower bound.
    #[must_use]
    pub fn at_least(mut self) -> Self {
        self.claim.at_least = true;
        self
    }

    /// A higher order fails as well.
    #[must_use]
    pub fn exactly(mut self) -> Self {
        self.claim.exact = true;
        self
    }

    /// How far from the prediction an order may be.
    #[must_use]
    pub fn within(mut self, tolerance: f64) -> Self {
        self.claim.tolerance = tolerance;
        self
    }

    /// # Errors
    /// A ladder without an order, or a prediction that is none.
    pub fn judge(&self) -> Result<Verdict, OrderError> {
        let claim = self.claim.checked()?;
        let posterior = self.order.infer()?;
        let ruling = posterior.decide(&claim);
        Ok(Verdict { posterior, ruling })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fit::Decision;

    /// e = h² (1 + h/3).
    const SECOND: [(f64, f64); 4] = [
        (0.25, 0.0677083333),
        (0.125, 0.0162760417),
        (0.0625, 0.0039876302),
        (0.03125, 0.0009867350),
    ];

    #[test]
    fn a_prediction_passes_fails_and_bounds() {
        let decided =
            |predicted: Predicted| predicted.judge().expect("four levels").ruling.decision;
        let order = || Order::of(&SECOND);
        assert_eq!(decided(order().predicted(2.0)), Decision::Pass);
        assert_eq!(decided(order().predicted(3.0)), Decision::Fail);
        assert_eq!(decided(order().predicted(1.0).at_least()), Decision::Pass);
        assert_eq!(decided(order().predicted(1.0).exactly()), Decision::Fail);
        assert_eq!(decided(order().exact_solution().predicted(2.0).within(0.1)), Decision::Pass);
    }

    #[test]
    fn what_cannot_be_judged_is_refused() {
        let refused = |predicted: Predicted| predicted.judge().expect_err("no verdict");
        let order = || Order::of(&SECOND);
        assert_eq!(
            refused(Order::of(&SECOND[..2]).predicted(2.0)),
            FitError::TooFew { found: 2, needed: 3 }.into()
        );
        assert_eq!(refused(order().predicted(2.0).at_least().exactly()), ClaimError::Both.into());
        assert_eq!(refused(order().predicted(2.0).within(0.0)), ClaimError::Tolerance(0.0).into());
        assert!(matches!(refused(order().predicted(f64::NAN)), OrderError::Prediction(_)));
        assert!(matches!(refused(order().noise(-1.0).predicted(2.0)), OrderError::Ladder(_)));
        assert!(matches!(
            refused(order().reference_run(0.1).predicted(2.0)),
            OrderError::Ladder(FitError::Reference { .. })
        ));
        assert!(order().log_power(1e9).infer().is_err());
    }
}
