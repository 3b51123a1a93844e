//! Curved laws: rational, exponential, and a power continued by its tangent.

use super::diagnostic::SceneError;
use super::reading::Reading;
use super::written;

/// p(r) for r > 0, zero for r ≤ 0; all numbers are positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    /// stiffness · r/(1 + (r/length)²).
    Rational { stiffness: f64, length: f64 },
    /// stiffness · r exp(-r/length).
    Exponential { stiffness: f64, length: f64 },
    /// coefficient · r^exponent up to r = until, then its tangent; exponent ≥ 1.
    Power { coefficient: f64, exponent: f64, until: f64 },
}

/// Largest exponent integrated exactly between kinks: with a hat function and the 8 Gauss points of the exact rule, 14
/// + 1 = 15.
const EXACT_EXPONENT: f64 = 14.0;

impl Curve {
    pub(super) fn rational(
        reading: &Reading,
        table: &str,
        written: &written::Law,
    ) -> Result<Self, SceneError> {
        let [stiffness, length] = stiffness_and_length(reading, table, written)?;
        Ok(Self::Rational { stiffness, length })
    }

    pub(super) fn exponential(
        reading: &Reading,
        table: &str,
        written: &written::Law,
    ) -> Result<Self, SceneError> {
        let [stiffness, length] = stiffness_and_length(reading, table, written)?;
        Ok(Self::Exponential { stiffness, length })
    }

    pub(super) fn power(
        reading: &Reading,
        table: &str,
        written: &written::Law,
    ) -> Result<Self, SceneError> {
        let coefficient = positive(
            reading,
            table,
            "coefficient",
            written.coefficient,
            &written.kind,
            "coefficient = 2.0",
        )?;
        let exponent = positive(
            reading,
            table,
            "exponent",
            written.exponent,
            &written.kind,
            "exponent = 1.5",
        )?;
        if exponent < 1.0 {
            let message = format!(
                "`exponent` = {exponent}: below 1 the slope of the law is infinite at r = 0"
            );
            let hint = "give an exponent of at least 1";
            return Err(reading.error(&format!("{table}.exponent"), message, hint));
        }
        let until = positive(reading, table, "until", written.until, &written.kind, "until = 0.1")?;
        let slope = coefficient * exponent * until.powf(exponent - 1.0);
        if !slope.is_finite() {
            let message = format!("the slope of the law at r = {until} is {slope}");
            let hint = "(2.8b) asks for linear growth: lower `until` or `exponent`";
            return Err(reading.error(&format!("{table}.until"), message, hint));
        }
        Ok(Self::Power { coefficient, exponent, until })
    }

    /// The steepest descent of p: the extreme of p' with respect to q = r/length.
    ///
    /// Rational: p' = c(1 - q²)/(1 + q²)² has its minimum -c/8 at q² = 3. Exponential: p' = c(1 - q)e^{-q} has its
    /// minimum -c e⁻² at q = 2. Power: p' ≥ 0. p is continuous, so by the mean value theorem (p(r) - p(s))(r - s) ≥ min
    /// p' (r - s)².
    pub(crate) fn alpha(&self) -> f64 {
        match *self {
            Self::Rational { stiffness, .. } => 0.125 * stiffness,
            Self::Exponential { stiffness, .. } => stiffness / std::f64::consts::E.powi(2),
            Self::Power { .. } => 0.0,
        }
    }

    /// Whether Gauss points between kinks integrate p to rounding.
    pub(super) fn has_exact_rule(&self) -> bool {
        match *self {
            Self::Rational { .. } | Self::Exponential { .. } => true,
            Self::Power { exponent, .. } => exponent.fract() == 0.0 && exponent <= EXACT_EXPONENT,
        }
    }
}

fn stiffness_and_length(
    reading: &Reading,
    table: &str,
    written: &written::Law,
) -> Result<[f64; 2], SceneError> {
    let kind = &written.kind;
    Ok([
        positive(reading, table, "stiffness", written.stiffness, kind, "stiffness = 2.0")?,
        positive(reading, table, "length", written.length, kind, "length = 0.05")?,
    ])
}

fn positive(
    reading: &Reading,
    table: &str,
    name: &str,
    value: Option<f64>,
    kind: &str,
    line: &str,
) -> Result<f64, SceneError> {
    let key = format!("{table}.{name}");
    let value = reading.needed(&key, value, kind, line)?;
    reading.positive(&key, value)
}
