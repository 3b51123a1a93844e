//! How values of other crates, and results, stand in the JSON of a trade.

use judge::fit::{ErrorCombination, FittedValue, Interval};
use scene::Norm;
use serde::{Serialize, Serializer};

use super::Knob;

/// A model, or `{"reason": …}`.
pub(super) fn or_reason<T: Serialize, S: Serializer>(
    found: &Result<T, String>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Reason<'a> {
        reason: &'a str,
    }
    match found {
        Ok(model) => model.serialize(serializer),
        Err(reason) => Reason { reason }.serialize(serializer),
    }
}

/// `[lo, hi]`.
pub(super) fn ends<S: Serializer>(interval: &Interval, to: S) -> Result<S::Ok, S::Error> {
    [interval.lo, interval.hi].serialize(to)
}

/// `[lo, hi]`, or null.
pub(super) fn some_ends<S: Serializer>(
    interval: &Option<Interval>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    interval.map(|i| [i.lo, i.hi]).serialize(serializer)
}

/// An exponent of the cost with its interval.
pub(super) fn exponent<S: Serializer>(found: &FittedValue, to: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Exponent {
        exponent: f64,
        interval: [f64; 2],
    }
    let FittedValue { value, interval } = *found;
    Exponent { exponent: value, interval: [interval.lo, interval.hi] }.serialize(to)
}

pub(super) fn model<S: Serializer>(
    model: &ErrorCombination,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(model.name())
}

pub(super) fn norm<S: Serializer>(norm: &Norm, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(norm.name())
}

pub(super) fn knob<S: Serializer>(knob: &Knob, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&knob.name())
}
