//! What a reference run hides: errors measured against a finer solution in place of the exact one.

/// An order without the error of the reference, and that error.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct AgainstReference {
    /// p, from differences of squares.
    pub order: f64,
    /// The local order of the last two errors as they were measured, too high.
    pub measured_order: f64,
    /// C h_ref^p, the estimated error of the reference itself.
    pub reference_error: f64,
    /// The finest error as measured, and with that of the reference put back.
    pub finest: [f64; 2],
}

/// From errors e_i of discrete solutions against a nested reference of size `reference`, on three sizes with one
/// ratio r, coarsest first.
///
/// In the energy norm of a Galerkin method the parts are orthogonal, e_i² = C²(h_i^{2p} - h_ref^{2p}), nearly so with
/// contact. The differences e_1² - e_2² and e_2² - e_3² are free of the reference, their ratio is r^{2p}. None if the
/// sizes have no common ratio, or the differences do not fall: then nothing can be said.
pub fn against_reference(points: [(f64, f64); 3], reference: f64) -> Option<AgainstReference> {
    let [(h1, e1), (h2, e2), (h3, e3)] = points;
    let ratio = h1 / h2;
    if !(ratio > 1.0 && super::same_level(ratio, h2 / h3)) {
        return None;
    }
    let (first, second) = (e1 * e1 - e2 * e2, e2 * e2 - e3 * e3);
    if !(first > second && second > 0.0) {
        return None;
    }
    let order = (first / second).ln() / (2.0 * ratio.ln());
    let square = first / (h1.powf(2.0 * order) - h2.powf(2.0 * order));
    let reference_error = square.sqrt() * reference.powf(order);
    Some(AgainstReference {
        order,
        measured_order: (e2 / e3).ln() / ratio.ln(),
        reference_error,
        finest: [e3, e3.hypot(reference_error)],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(order: f64, reference: f64) -> [(f64, f64); 3] {
        [8.0, 16.0, 32.0].map(|n: f64| {
            let h = 1.0 / n;
            (h, 0.3 * (h.powf(2.0 * order) - reference.powf(2.0 * order)).sqrt())
        })
    }

    #[test]
    fn the_reference_is_taken_out() {
        for order in [0.5, 0.745, 1.0] {
            for reference in [1.0 / 64.0, 1.0 / 128.0] {
                let points = measured(order, reference);
                let found = against_reference(points, reference).expect("an order");
                assert!((found.order - order).abs() < 1e-9, "{found:?}");
                let own = 0.3 * reference.powf(order);
                assert!((found.reference_error - own).abs() < 1e-9, "{found:?}");
                assert!((found.finest[1] - 0.3 * (1.0f64 / 32.0).powf(order)).abs() < 1e-9);
                // As measured the order flatters.
                assert!(found.measured_order > order + 5e-3, "{found:?}");
            }
        }
    }

    #[test]
    fn what_tells_nothing_gives_nothing() {
        let reference = 1.0 / 128.0;
        let [a, b, c] = measured(1.0, reference);
        assert_eq!(against_reference([a, b, (1.0 / 24.0, c.1)], reference), None);
        assert_eq!(against_reference([a, (b.0, a.1), c], reference), None);
        assert_eq!(against_reference([a, b, (c.0, f64::NAN)], reference), None);
        assert_eq!(against_reference([c, b, a], reference), None);
    }
}
