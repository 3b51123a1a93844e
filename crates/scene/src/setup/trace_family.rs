//! Trace constants on a family of meshes, and their limit.

use std::sync::Arc;

use super::{Setup, SetupError};
use fem::contact::{TraceMass, TracePart, trace_constants};
use vhi::law::TensorField;

/// sup ‖v_ν‖²/(𝒞ε(v), ε(v)), or the same of v_τ, on meshes, each twice as fine as the one before.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceFamily {
    /// n and the value there.
    pub values: Vec<(u32, f64)>,
    /// The extrapolated limit.
    pub limit: f64,
    /// Change of the limit if the finest mesh is left out; NaN if unknown.
    pub uncertainty: f64,
}

/// The trace constants of `tensor` on the meshes `levels` (each twice as fine as the one before), a family for each of
/// `squares`.
///
/// # Errors
/// A mesh whose stiffness matrix cannot be factorized.
pub fn trace_families<const K: usize>(
    setup: &Setup,
    tensor: &TensorField,
    squares: [(TracePart, TraceMass); K],
    levels: &[u32],
) -> Result<[TraceFamily; K], SetupError> {
    let mut values = [(); K].map(|()| Vec::new());
    for &n in levels {
        let space = match tensor.is_uniform() {
            true => Arc::new(setup.plain_space(n)),
            false => setup.linear_space(n)?,
        };
        let found = trace_constants(&space, tensor, squares)
            .map_err(|source| SetupError::Constant { n, source })?;
        values.iter_mut().zip(found).for_each(|(values, found)| values.push((n, found.value)));
    }
    Ok(values.map(TraceFamily::new))
}

impl TraceFamily {
    /// Aitken extrapolation: removes errors that shrink by a constant factor from mesh to mesh, of unknown order.
    pub(crate) fn new(values: Vec<(u32, f64)>) -> Self {
        let sequence: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
        let limit = aitken(&sequence);
        let uncertainty = match sequence.len() {
            0..=2 => f64::NAN,
            // Without a second extrapolation: the whole Aitken step.
            3 => (limit - sequence[2]).abs(),
            count => (limit - aitken(&sequence[..count - 1])).abs(),
        };
        Self { values, limit, uncertainty }
    }
}

fn aitken(values: &[f64]) -> f64 {
    let [.., a, b, c] = values else { return values.last().copied().unwrap_or(0.0) };
    let (first, second) = (b - a, c - b);
    let shrinks = second.abs() < first.abs() && first != 0.0;
    if shrinks { c + second * second / (first - second) } else { *c }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_geometric_sequence_is_extrapolated_exactly() {
        let values = (0..5).map(|i| (8 << i, 0.44 - 0.1 * 0.36f64.powi(i))).collect();
        let family = TraceFamily::new(values);
        assert!((family.limit - 0.44).abs() < 1e-13 && family.uncertainty < 1e-12);
    }

    #[test]
    fn the_uncertainty_covers_a_second_term() {
        let exact = 0.44;
        let value = |i: i32| exact - 0.1 * 0.36f64.powi(i) + 0.02 * 0.25f64.powi(i);
        let family = TraceFamily::new((0..5).map(|i| (8 << i, value(i))).collect());
        assert!((family.limit - exact).abs() < family.uncertainty && family.uncertainty < 1e-3);
    }

    #[test]
    fn a_sequence_that_does_not_settle_is_not_extrapolated() {
        let family = TraceFamily::new(vec![(8, 1.0), (16, 2.0), (32, 4.0)]);
        assert_eq!(family.limit, 4.0);
        assert!(TraceFamily::new(vec![(8, 1.0)]).uncertainty.is_nan());
    }
}
