//! Linear least squares with Student intervals.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::Interval;

/// Solution of min ‖X c − y‖.
#[derive(Debug, Clone)]
pub struct LinearFit {
    pub coefficients: DVector<f64>,
    pub residuals: DVector<f64>,
    /// From s² (XᵀX)⁻¹ with s² = ‖y − X c‖² / degrees of freedom.
    pub standard_errors: DVector<f64>,
    pub degrees_of_freedom: usize,
}

impl LinearFit {
    /// 95 % Student interval of one coefficient; none without degrees of freedom.
    pub fn interval(&self, coefficient: usize) -> Option<Interval> {
        let quantile = student_quantile(self.degrees_of_freedom)?;
        let radius = quantile * self.standard_errors[coefficient];
        Some(Interval::around(self.coefficients[coefficient], radius))
    }
}

/// Fits by QR; none with fewer rows than columns or dependent columns.
pub fn linear_fit(design: DMatrix<f64>, values: &DVector<f64>) -> Option<LinearFit> {
    let (rows, columns) = design.shape();
    if rows < columns {
        return None;
    }
    let (q, r) = design.clone().qr().unpack();
    let inverse = r.try_inverse().filter(|inverse| inverse.iter().all(|x| x.is_finite()))?;
    let coefficients = &inverse * q.transpose() * values;
    let residuals = values - design * &coefficients;
    let degrees_of_freedom = rows - columns;
    let variance = residuals.norm_squared() / degrees_of_freedom.max(1) as f64;
    let standard_errors =
        DVector::from_fn(columns, |i, _| (variance * inverse.row(i).norm_squared()).sqrt());
    Some(LinearFit { coefficients, residuals, standard_errors, degrees_of_freedom })
}

/// 97.5 % quantile of Student's t, for two-sided 95 % intervals.
pub fn student_quantile(degrees_of_freedom: usize) -> Option<f64> {
    StudentsT::new(0.0, 1.0, degrees_of_freedom as f64).ok().map(|t| t.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_the_tables() {
        for (degrees, quantile) in [(1, 12.706204736432), (2, 4.302652729696), (30, 2.042272456301)]
        {
            // statrs gives the quantile to 9 digits.
            assert!((student_quantile(degrees).unwrap() - quantile).abs() < 1e-9 * quantile);
        }
        assert!(student_quantile(0).is_none());
    }

    /// y = 1 + 2x with residuals (1, −2, 1)/6 on x = 0, 1, 2: s² = 1/6, se(slope)² = s²/2.
    #[test]
    fn a_regression_by_hand() {
        let design = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0]);
        let values = DVector::from_vec(vec![1.0 + 1.0 / 6.0, 3.0 - 1.0 / 3.0, 5.0 + 1.0 / 6.0]);
        let fit = linear_fit(design, &values).unwrap();
        assert!((fit.coefficients[0] - 1.0).abs() < 1e-14);
        assert!((fit.coefficients[1] - 2.0).abs() < 1e-14);
        assert!((fit.standard_errors[1] - (1.0f64 / 12.0).sqrt()).abs() < 1e-14);
        assert!(linear_fit(DMatrix::from_element(3, 2, 1.0), &values).is_none());
    }
}
