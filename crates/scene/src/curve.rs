//! Curved laws: rational, exponential, and a power continued by its tangent. All that a scene says of one is here.

use super::diagnostic::Result;
use super::reading::Reading;
use super::spans::join;
use exact::CurveNumbers;
use vhi::law::Curve;

/// Largest exponent integrated exactly between kinks: with a hat function and the 8 Gauss points of the exact rule, 14
/// + 1 = 15.
const EXACT_EXPONENT: f64 = 14.0;

/// A curve: of kind `rational`, `exponential` or `power`.
pub(super) fn read(reading: &Reading, table: &str, kind: &str) -> Result<Curve> {
    let positive = |name: &str| reading.positive(&join(table, name));
    match kind {
        "power" => power(reading, table),
        "rational" => {
            Ok(Curve::Rational { stiffness: positive("stiffness")?, length: positive("length")? })
        }
        _ => Ok(Curve::Exponential {
            stiffness: positive("stiffness")?,
            length: positive("length")?,
        }),
    }
}

/// The numbers of a curve for the manufactured side.
pub(super) fn numbers(curve: Curve) -> CurveNumbers {
    match curve {
        Curve::Rational { stiffness: c, length } => CurveNumbers::Rational { c, r0: length },
        Curve::Exponential { stiffness: c, length } => CurveNumbers::Exponential { c, r0: length },
        Curve::Power { coefficient: c, exponent: m, until } => {
            CurveNumbers::Power { c, m, r1: until }
        }
    }
}

fn power(reading: &Reading, table: &str) -> Result<Curve> {
    let positive = |name: &str| reading.positive(&join(table, name));
    let coefficient = positive("coefficient")?;
    let fits = |exponent: f64| exponent >= 1.0 && exponent.is_finite();
    let fault = "is not at least 1: below it the slope of the law is infinite at r = 0";
    let range = [fault, "give an exponent of at least 1"];
    let exponent = reading.number(&join(table, "exponent"), fits, range)?;
    let until = positive("until")?;
    let slope = coefficient * exponent * until.powf(exponent - 1.0);
    let message = format!("the slope of the law at r = {until} is {slope}");
    let hint = "(2.8b) asks for linear growth: lower `until` or `exponent`";
    reading.refuse_if(!slope.is_finite(), &join(table, "until"), message, hint)?;
    Ok(Curve::Power { coefficient, exponent, until })
}

/// Whether Gauss points between kinks integrate p to rounding.
pub(super) fn has_exact_rule(curve: Curve) -> bool {
    match curve {
        Curve::Rational { .. } | Curve::Exponential { .. } => true,
        Curve::Power { exponent, .. } => exponent.fract() == 0.0 && exponent <= EXACT_EXPONENT,
    }
}
