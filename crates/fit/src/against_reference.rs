//! What a reference run hides: errors measured against a finer solution in place of the exact one.

/// An order corrected for the error of the reference, and an estimate of that error.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct AgainstReference {
    /// Order p, from differences of squared errors.
    pub order: f64,
    /// Local order of the last two measured errors; biased upwards.
    pub measured_order: f64,
    /// Estimated error of the reference, C h_ref^p.
    pub reference_error: f64,
    /// Finest error: as measured, and corrected for the reference.
    pub finest: [f64; 2],
}

/// Order from errors e_i against a nested reference of size `reference`, for three sizes of one ratio r, coarsest
/// first.
///
/// In the energy norm of a Galerkin method e_i² = C²(h_i^{2p} - h_ref^{2p}) by orthogonality, nearly so with contact.
/// e_1² - e_2² and e_2² - e_3² are free of the reference and have the ratio r^{2p}. None if the sizes have no common
/// ratio or the differences do not fall.
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
                let expected = 0.3 * reference.powf(order);
                assert!((found.reference_error - expected).abs() < 1e-9, "{found:?}");
                assert!((found.finest[1] - 0.3 * (1.0f64 / 32.0).powf(order)).abs() < 1e-9);
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
