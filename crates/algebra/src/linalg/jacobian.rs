//! A Jacobian as solvers take it.

use super::pattern::BlockPattern;
use super::{axpy, dot};

/// K + a bᵀ + C, K sparse and symmetric, C a few single entries.
#[derive(Debug, Clone, Default)]
pub struct Jacobian {
    /// The lower triangle of K.
    pub values: Vec<f64>,
    /// a bᵀ.
    pub rank_one: Option<RankOne>,
    /// C.
    pub couplings: Vec<NonsymmetricEntry>,
    /// The unknowns whose rows and columns in K are zero off the diagonal.
    pub held: Vec<usize>,
}

/// The rank-one part a bᵀ.
#[derive(Debug, Clone, Default)]
pub struct RankOne {
    pub a: Vec<f64>,
    pub b: Vec<f64>,
}

/// A nonsymmetric entry of the Jacobian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonsymmetricEntry {
    pub row: usize,
    pub column: usize,
    pub value: f64,
}

impl Jacobian {
    /// Transposes C: the transposed Jacobian if C is its only nonsymmetric part.
    pub fn transpose_couplings(&mut self) {
        for coupling in &mut self.couplings {
            (coupling.row, coupling.column) = (coupling.column, coupling.row);
        }
    }

    pub(super) fn multiply(&self, pattern: &BlockPattern, x: &[f64], out: &mut [f64]) {
        pattern.multiply(&self.values, x, out);
        if let Some(rank_one) = &self.rank_one {
            axpy(dot(&rank_one.b, x), &rank_one.a, out);
        }
        for coupling in &self.couplings {
            out[coupling.row] += coupling.value * x[coupling.column];
        }
    }
}
