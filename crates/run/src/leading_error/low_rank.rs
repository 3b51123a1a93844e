//! Linearised steps with a sparse symmetric matrix plus a few terms a bᵀ: one for ζ, one per slipping vertex for
//! friction whose bound follows the normal law.

use nalgebra::{DMatrix, DVector};

use super::NoConstant;
use algebra::linalg::{Front, axpy, dot};
use fem::contact::Discretization;

/// a bᵀ, both over all nodes.
pub(super) struct RankOne {
    pub column: Vec<f64>,
    pub row: Vec<f64>,
}

/// Smaller pivots are zero up to rounding.
const VANISHING: f64 = 1e-9;

/// (K + Σ a_i b_iᵀ)⁻¹ `right`, over all nodes, by the Sherman–Morrison–Woodbury formula; `values` are K's.
///
/// # Errors
/// [`NoConstant::Singular`]; a K that cannot be factorized.
pub(super) fn solve(
    space: &Discretization,
    t: f64,
    values: &[f64],
    mut right: Vec<f64>,
    terms: &[RankOne],
) -> Result<Vec<f64>, NoConstant> {
    let dofs = space.dofs();
    let analysis = space.analysis()?;
    let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
    analysis.factorize(&space.pattern, values, &mut factor, &mut workspace)?;
    let mut front = Front::default();
    let mut solved = |side: &[f64]| {
        let mut x = side[..dofs].to_vec();
        analysis.solve(&factor, &mut x, &mut front);
        x
    };
    let mut error = solved(&right);
    // nalgebra does not solve systems without rows.
    if !terms.is_empty() {
        let answers: Vec<Vec<f64>> = terms.iter().map(|term| solved(&term.column)).collect();
        let along = |i: usize, vector: &[f64]| dot(&terms[i].row[..dofs], vector);
        let capacitance = DMatrix::from_fn(terms.len(), terms.len(), |i, j| {
            f64::from(u8::from(i == j)) + along(i, &answers[j])
        });
        let factors = capacitance.lu();
        let pivots = factors.u().diagonal();
        if pivots.iter().any(|pivot| pivot.is_nan() || pivot.abs() <= VANISHING) {
            return Err(NoConstant::Singular { t });
        }
        let rows = DVector::from_fn(terms.len(), |i, _| along(i, &error));
        let shares = factors.solve(&rows).ok_or(NoConstant::Singular { t })?;
        for (share, answer) in shares.iter().zip(&answers) {
            axpy(-share, answer, &mut error);
        }
    }
    right.fill(0.0);
    right[..dofs].copy_from_slice(&error);
    Ok(right)
}
