//! Nonlinear least squares of a few parameters.
//!
//! Written here because the published crates (levenberg-marquardt, varpro) need an older nalgebra or give no Jacobian
//! at the minimum, which the covariance of the parameters needs.

use nalgebra::{DMatrix, DVector};

/// Steps before a start is given up; converging ones need about twenty.
const STEPS: usize = 200;

/// Step size that changes an order in its tenth digit.
const SMALL_STEP: f64 = 1e-10;

/// Damping at which no descent direction is left.
const LARGEST_DAMPING: f64 = 1e12;

#[derive(Debug, Clone)]
pub(super) struct Minimum {
    pub(super) x: DVector<f64>,
    pub(super) residuals: DVector<f64>,
    pub(super) jacobian: DMatrix<f64>,
}

impl Minimum {
    /// Standard errors: roots of the diagonal of s² (JᵀJ)⁻¹, s² = ‖r‖² / freedom. None for dependent parameters.
    pub(super) fn deviations(&self, freedom: usize) -> Option<DVector<f64>> {
        let variance = self.residuals.norm_squared() / freedom as f64;
        let inverse = self.jacobian.tr_mul(&self.jacobian).try_inverse()?;
        let squares = inverse.diagonal() * variance;
        squares.iter().all(|x| x.is_finite() && *x >= 0.0).then(|| squares.map(f64::sqrt))
    }
}

/// Levenberg-Marquardt with Marquardt's scaling: (JᵀJ + μ diag JᵀJ) δ = −Jᵀr, μ divided by 3 on descent, doubled on
/// ascent. None if it meets a NaN or does not converge.
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
        // NaN is not a descent.
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
    use crate::linear_fit;

    #[test]
    fn rosenbrock_is_solved() {
        let minimum = minimise(DVector::from_vec(vec![-1.2, 1.0]), |x| {
            let residuals = DVector::from_vec(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
            (residuals, DMatrix::from_row_slice(2, 2, &[-20.0 * x[0], 10.0, -1.0, 0.0]))
        });
        // Zero residual: quadratic convergence to rounding.
        assert!((minimum.unwrap().x - DVector::from_vec(vec![1.0, 1.0])).norm() < 1e-8);
    }

    #[test]
    fn standard_errors_agree_with_linear_least_squares() {
        let design = DMatrix::from_row_slice(4, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 4.0]);
        let values = DVector::from_vec(vec![1.0, 2.5, 2.0, 6.0]);
        let linear = linear_fit(design.clone(), &values).unwrap();
        let problem = |x: &DVector<f64>| (&design * x - &values, design.clone());
        let minimum = minimise(DVector::zeros(2), problem).unwrap();
        let deviations = minimum.deviations(2).unwrap();
        // The minimisation stops at steps of 1e-10.
        assert!((&minimum.x - &linear.coefficients).norm() < 1e-9);
        assert!((deviations - &linear.standard_errors).norm() < 1e-9);
        let dependent = Minimum { jacobian: DMatrix::zeros(4, 2), ..minimum };
        assert!(dependent.deviations(2).is_none());
    }

    #[test]
    fn a_minimum_at_infinity_is_none() {
        let endless = |x: &DVector<f64>| {
            let value = (-x[0]).exp();
            (DVector::from_element(1, value), DMatrix::from_element(1, 1, -value))
        };
        assert!(minimise(DVector::zeros(1), endless).is_none());
    }

    /// At a kink every step ascends, and the damping ends the search.
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
