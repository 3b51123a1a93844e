//! Nonlinear least squares of a few parameters.
//!
//! Written here because the published crates for it (levenberg-marquardt, varpro) are bound to
//! an older nalgebra, which would bring a second linear algebra, or give no Jacobian at the
//! minimum, which the covariance of the parameters is made from.

use nalgebra::{DMatrix, DVector};

/// Steps before a start is given up: a start that converges needs some twenty.
const STEPS: usize = 200;

/// A step so small changes an order in its tenth digit.
const SMALL_STEP: f64 = 1e-10;

/// Damping at which no descent direction is left.
const LARGEST_DAMPING: f64 = 1e12;

/// A local minimum of ‖r(x)‖².
#[derive(Debug, Clone)]
pub(super) struct Minimum {
    pub(super) x: DVector<f64>,
    pub(super) residuals: DVector<f64>,
    pub(super) jacobian: DMatrix<f64>,
}

impl Minimum {
    /// Standard errors of x: roots of the diagonal of s² (JᵀJ)⁻¹, s² = ‖r‖² / freedom. None if
    /// the parameters are dependent.
    pub(super) fn deviations(&self, freedom: usize) -> Option<DVector<f64>> {
        let variance = self.residuals.norm_squared() / freedom as f64;
        let inverse = self.jacobian.tr_mul(&self.jacobian).try_inverse()?;
        let squares = inverse.diagonal() * variance;
        squares.iter().all(|x| x.is_finite() && *x >= 0.0).then(|| squares.map(f64::sqrt))
    }
}

/// Levenberg-Marquardt with Marquardt's scaling: (JᵀJ + μ diag JᵀJ) δ = −Jᵀr, μ divided by 3
/// on descent and doubled on ascent. None if it meets a number that is none, or does not end.
pub(super) fn minimise(
    start: DVector<f64>,
    problem: impl Fn(&DVector<f64>) -> (DVector<f64>, DMatrix<f64>),
) -> Option<Minimum> {
    let mut x = start;
    let (mut residuals, mut jacobian) = problem(&x);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        if !residuals.norm_squared().is_finite() {
            return None;
        }
        let step = damped_step(&residuals, &jacobian, damping)?;
        let next = &x + &step;
        let (next_residuals, next_jacobian) = problem(&next);
        let small = step.amax() < SMALL_STEP * (1.0 + x.amax());
        // A residual that is not a number is not a descent.
        if next_residuals.norm_squared() <= residuals.norm_squared() {
            (x, residuals, jacobian) = (next, next_residuals, next_jacobian);
            damping /= 3.0;
        } else {
            damping *= 2.0;
        }
        if small || damping > LARGEST_DAMPING {
            return Some(Minimum { x, residuals, jacobian });
        }
    }
    None
}

fn damped_step(
    residuals: &DVector<f64>,
    jacobian: &DMatrix<f64>,
    damping: f64,
) -> Option<DVector<f64>> {
    let mut normal = jacobian.tr_mul(jacobian);
    for i in 0..normal.nrows() {
        normal[(i, i)] *= 1.0 + damping;
    }
    normal.cholesky().map(|factor| factor.solve(&-jacobian.tr_mul(residuals)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::linear_fit;

    /// Rosenbrock's valley as r = (10 (y − x²), 1 − x), minimum at (1, 1).
    #[test]
    fn rosenbrock_is_solved() {
        let minimum = minimise(DVector::from_vec(vec![-1.2, 1.0]), |x| {
            let residuals = DVector::from_vec(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
            (residuals, DMatrix::from_row_slice(2, 2, &[-20.0 * x[0], 10.0, -1.0, 0.0]))
        });
        // Zero residual: quadratic convergence to rounding.
        assert!((minimum.unwrap().x - DVector::from_vec(vec![1.0, 1.0])).norm() < 1e-8);
    }

    /// On a linear problem the standard errors are those of linear least squares.
    #[test]
    fn standard_errors_agree_with_linear_least_squares() {
        let design = DMatrix::from_row_slice(4, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 4.0]);
        let values = DVector::from_vec(vec![1.0, 2.5, 2.0, 6.0]);
        let linear = linear_fit(design.clone(), &values).unwrap();
        let problem = |x: &DVector<f64>| (&design * x - &values, design.clone());
        let minimum = minimise(DVector::zeros(2), problem).unwrap();
        let deviations = minimum.deviations(2).unwrap();
        // The minimisation stops at steps of 1e-10; the rest is rounding.
        assert!((&minimum.x - &linear.coefficients).norm() < 1e-9);
        assert!((deviations - &linear.standard_errors).norm() < 1e-9);
        let dependent = Minimum { jacobian: DMatrix::zeros(4, 2), ..minimum };
        assert!(dependent.deviations(2).is_none());
    }

    /// e^{-x} falls for ever: no minimum, and no endless loop.
    #[test]
    fn a_minimum_at_infinity_is_none() {
        let endless = |x: &DVector<f64>| {
            let value = (-x[0]).exp();
            (DVector::from_element(1, value), DMatrix::from_element(1, 1, -value))
        };
        assert!(minimise(DVector::zeros(1), endless).is_none());
    }

    /// A kink: from its bottom every step goes up, and the damping ends the search there.
    #[test]
    fn a_kink_is_a_minimum() {
        let kink = |x: &DVector<f64>| {
            let sign = if x[0] < 0.0 { -1.0 } else { 1.0 };
            let value = 1.0 + x[0].abs();
            (DVector::from_element(1, value), DMatrix::from_element(1, 1, sign))
        };
        let minimum = minimise(DVector::zeros(1), kink).unwrap();
        assert!(minimum.x[0].abs() < 1e-9, "{}", minimum.x[0]);
    }

    #[test]
    fn a_number_that_is_none_ends_it() {
        let nowhere =
            |_: &DVector<f64>| (DVector::from_element(2, f64::NAN), DMatrix::identity(2, 1));
        assert!(minimise(DVector::zeros(1), nowhere).is_none());
    }
}
