//! One power law through a line of grids, on logarithms.

use nalgebra::{DMatrix, DVector};

use super::{FitError, Interval, Sample, linear_fit};

/// log e = log C + p log s in least squares.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerLaw {
    pub order: f64,
    pub constant: f64,
    /// log e − log C − p log s, coarse to fine.
    pub residuals: Vec<f64>,
    /// 95 % Student interval of p; none for two points.
    pub interval: Option<Interval>,
}

/// Fits a power law to at least two samples of distinct steps.
///
/// # Errors
/// [`FitError::TooFew`], [`FitError::Singular`].
pub fn power_law(samples: &[Sample]) -> Result<PowerLaw, FitError> {
    let found = samples.len();
    if found < 2 {
        return Err(FitError::TooFew { found, needed: 2 });
    }
    let logs: Vec<f64> = samples.iter().map(|sample| sample.step.ln()).collect();
    let centre = logs.iter().sum::<f64>() / found as f64;
    let design = DMatrix::from_fn(found, 2, |row, column| [1.0, logs[row] - centre][column]);
    let values = DVector::from_fn(found, |row, _| samples[row].error.ln());
    let fit = linear_fit(design, &values).ok_or(FitError::Singular { points: found })?;
    let order = fit.coefficients[1];
    Ok(PowerLaw {
        order,
        constant: (fit.coefficients[0] - order * centre).exp(),
        interval: fit.interval(1),
        residuals: fit.residuals.iter().copied().collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_law_is_found() {
        let samples: Vec<Sample> = [0.5, 0.3, 0.1, 0.07]
            .map(|step: f64| Sample { step, error: 7.0 * step.powf(1.5) })
            .to_vec();
        let law = power_law(&samples).unwrap();
        // A dozen roundings of logarithms of size 5.
        assert!((law.order - 1.5).abs() < 1e-13 && (law.constant - 7.0).abs() < 1e-12);
        assert!(law.interval.unwrap().half_width() < 1e-13);
        assert!(power_law(&samples[..2]).unwrap().interval.is_none());
        assert!(power_law(&samples[..1]).is_err());
    }
}
