//! Curved laws: rational, exponential, and a power continued by its tangent. All that a scene says of one is here.

use super::diagnostic::SceneError;
use super::reading::Reading;
use super::written;
use exact::CurveNumbers;
use vhi::law::Curve;

pub(super) const KINDS: [&str; 3] = ["rational", "exponential", "power"];

/// Curves with a stiffness and a length.
pub(super) const WITH_STIFFNESS: &[&str] = &["rational", "exponential"];

/// Largest exponent integrated exactly between kinks: with a hat function and the 8 Gauss points of the exact rule, 14
/// + 1 = 15.
const EXACT_EXPONENT: f64 = 14.0;

/// Refuses keys of other kinds.
pub(super) fn check_keys(
    reading: &Reading,
    table: &str,
    kind: &str,
    written: &written::Law,
) -> Result<(), SceneError> {
    let power: &[&str] = &["power"];
    let keys = [
        ("length", written.length.is_some(), WITH_STIFFNESS),
        ("coefficient", written.coefficient.is_some(), power),
        ("exponent", written.exponent.is_some(), power),
        ("until", written.until.is_some(), power),
        ("jump", written.jump.is_some(), &KINDS),
    ];
    reading.only(table, kind, &keys)
}

/// A curve of [`KINDS`].
pub(super) fn read(
    reading: &Reading,
    table: &str,
    kind: &str,
    written: &written::Law,
) -> Result<Curve, SceneError> {
    match kind {
        "power" => power(reading, table, written),
        decaying => {
            let [stiffness, length] = stiffness_and_length(reading, table, written)?;
            Ok(match decaying {
                "rational" => Curve::Rational { stiffness, length },
                _ => Curve::Exponential { stiffness, length },
            })
        }
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

fn power(reading: &Reading, table: &str, written: &written::Law) -> Result<Curve, SceneError> {
    let of = |name, value, line| positive(reading, table, name, value, &written.kind, line);
    let coefficient = of("coefficient", written.coefficient, "coefficient = 2.0")?;
    let exponent = of("exponent", written.exponent, "exponent = 1.5")?;
    if exponent < 1.0 {
        let message =
            format!("`exponent` = {exponent}: below 1 the slope of the law is infinite at r = 0");
        let hint = "give an exponent of at least 1";
        return Err(reading.error(&format!("{table}.exponent"), message, hint));
    }
    let until = of("until", written.until, "until = 0.1")?;
    let slope = coefficient * exponent * until.powf(exponent - 1.0);
    if !slope.is_finite() {
        let message = format!("the slope of the law at r = {until} is {slope}");
        let hint = "(2.8b) asks for linear growth: lower `until` or `exponent`";
        return Err(reading.error(&format!("{table}.until"), message, hint));
    }
    Ok(Curve::Power { coefficient, exponent, until })
}

/// Whether Gauss points between kinks integrate p to rounding.
pub(super) fn has_exact_rule(curve: Curve) -> bool {
    match curve {
        Curve::Rational { .. } | Curve::Exponential { .. } => true,
        Curve::Power { exponent, .. } => exponent.fract() == 0.0 && exponent <= EXACT_EXPONENT,
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
