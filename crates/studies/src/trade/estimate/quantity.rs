//! Named quantities at t = T: how far each is from its limit, from the same companions.

use judge::fit::{Triple, ValueSample};

/// Below this order differences fall too slowly to say anything about what is left.
pub(super) const LEAST_ORDER: f64 = 0.3;

/// A quantity with what h and k leave open in it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct QuantityEstimate {
    /// Its name, see `solution::FinalState`.
    pub name: String,
    /// Its value in the run.
    pub value: f64,
    /// The value with what either extrapolation adds, where both have a limit.
    pub extrapolated: Option<f64>,
    /// Bound of the distance to the limit: the sum of the two grid convergence indices.
    pub uncertainty: Option<f64>,
    /// Observed orders in h and k.
    pub orders: [Option<f64>; 2],
    /// Why there is no bound.
    pub reason: Option<String>,
}

/// Reads the values of a quantity on [4h, 2h, h] and on [4k, 2k, k]; None for a direction that was not run.
pub(super) fn quantity(
    name: &str,
    space: Option<[f64; 3]>,
    time: Option<[f64; 3]>,
    value: f64,
) -> QuantityEstimate {
    let read = |values: Option<[f64; 3]>| {
        values.map(|[coarse, middle, fine]| {
            let at = |step: f64, value: f64| ValueSample { step, value };
            Triple::of([at(4.0, coarse), at(2.0, middle), at(1.0, fine)])
        })
    };
    let triples = [read(space), read(time)];
    let (mut shift, mut width, mut reason) = (0.0, 0.0, None);
    for (step, triple) in ["h", "k"].into_iter().zip(triples) {
        let refused = match triple {
            Some(Triple::Converging { order, limit, gci }) if order >= LEAST_ORDER => {
                shift += limit - value;
                width += gci;
                continue;
            }
            // No order, but no further away than the values are from each other.
            Some(Triple::Oscillating { half_range }) => {
                width += 2.0 * half_range;
                continue;
            }
            Some(Triple::Stationary) => continue,
            Some(Triple::Converging { order, .. } | Triple::Diverging { order }) => {
                format!("pre-asymptotic in {step}: order {order:.2}")
            }
            None => format!("no companions in {step}"),
        };
        reason.get_or_insert(refused);
    }
    QuantityEstimate {
        name: name.into(),
        value,
        extrapolated: reason.is_none().then_some(value + shift),
        uncertainty: reason.is_none().then_some(width),
        orders: triples.map(|triple| triple.and_then(Triple::order)),
        reason,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_holds_the_limit_of_power_laws() {
        // 5 + 2h² + k² at h = k = 0.1.
        let at = |h: f64, k: f64| 5.0 + 2.0 * h * h + k * k;
        let space = [at(0.4, 0.1), at(0.2, 0.1), at(0.1, 0.1)];
        let time = [at(0.1, 0.4), at(0.1, 0.2), at(0.1, 0.1)];
        let found = quantity("q", Some(space), Some(time), at(0.1, 0.1));
        // Differences of numbers of size 5 with 16 digits, over 3.
        assert!((found.extrapolated.expect("a limit") - 5.0).abs() < 1e-13);
        // Roache's factor 1.25 on both corrections.
        assert!((found.uncertainty.expect("a bound") - 1.25 * 0.03).abs() < 1e-13);
        let orders = found.orders.map(|order| order.expect("an order"));
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 1e-10));
    }

    #[test]
    fn what_does_not_converge_has_no_bound() {
        let growing = quantity("q", Some([0.0, 1.0, 3.0]), Some([3.0; 3]), 3.0);
        assert!(growing.uncertainty.is_none() && growing.extrapolated.is_none());
        assert!(growing.reason.expect("a reason").contains("in h"));
        assert!(quantity("q", None, Some([3.0; 3]), 3.0).uncertainty.is_none());
        let oscillating = quantity("q", Some([3.1, 2.9, 3.0]), Some([3.0; 3]), 3.0);
        assert!((oscillating.uncertainty.expect("a range") - 0.2).abs() < 1e-15);
    }
}
