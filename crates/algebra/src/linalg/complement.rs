//! Vectors across others.

use super::{axpy, dot, norm};

/// A vector closer than this share of it to the span of those before would lose 8 digits in a change of coordinates.
const INDEPENDENT: f64 = 1e-8;

/// Orthonormal vectors across `rows` that complete them to d, each by the axis furthest from what is there; `None` if the
/// rows are linearly dependent.
pub fn complement(rows: &[Vec<f64>], d: usize) -> Option<Vec<Vec<f64>>> {
    let across = |basis: &[Vec<f64>], mut v: Vec<f64>| {
        for known in basis {
            axpy(-dot(known, &v), known, &mut v);
        }
        let length = norm(&v);
        (length, v.into_iter().map(|x| x / length).collect())
    };
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for row in rows {
        let (length, unit) = across(&basis, row.clone());
        if length <= INDEPENDENT * norm(row) {
            return None;
        }
        basis.push(unit);
    }
    while basis.len() < d {
        let axis = |i| (0..d).map(|j| f64::from(u8::from(i == j))).collect();
        let candidates = (0..d).map(|i| across(&basis, axis(i)));
        let (_, furthest) = candidates.max_by(|a, b| a.0.total_cmp(&b.0))?;
        basis.push(furthest);
    }
    Some(basis.split_off(rows.len()))
}
