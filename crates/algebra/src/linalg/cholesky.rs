//! Sparse Cholesky factorization (faer, supernodal): one symbolic analysis per pattern. It runs on one thread, so that
//! results are bit-identical under any machine load.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Par, Side};

use super::pattern::BlockPattern;

/// Why a factorization was not possible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// A pivot was not positive.
    #[error("the tangent matrix is not positive definite (first at unknown {dof})")]
    NotPositiveDefinite {
        /// The unknown of the pivot.
        dof: usize,
    },
    /// Nonsymmetric entries, which the factor lacks, are too large for the iteration.
    #[error(
        "friction that follows the normal law makes the tangent singular or nearly so: a residual of {relative:.1e} is left, wanted {forcing:.1e}"
    )]
    NotSolved {
        /// Norm of the residual relative to the right side.
        relative: f64,
        /// Requested relative residual.
        forcing: f64,
    },
    #[error("the tangent matrix has an entry that is not a finite number")]
    NotFinite,
    /// The rank-one part of the Jacobian, from ζ_n(u_n), makes it singular or turns its sign.
    #[error(
        "the implicit dependence on ζ makes the tangent singular (1 + bᵀK⁻¹a = {denominator:e})"
    )]
    SingularInZeta {
        /// 1 + bᵀK⁻¹a.
        denominator: f64,
    },
    /// The symbolic analysis ran out of memory or index range.
    #[error("the symbolic factorization of order {order} failed: {reason}")]
    Analysis { order: usize, reason: String },
}

/// Supernodes are merged up to so many columns and this share of stored zeros: about half of faer's defaults, which
/// leaves 6 % less to read in each solve.
const MERGED: [(usize, f64); 4] = [(4, 0.5), (16, 0.2), (48, 0.05), (usize::MAX, 0.02)];

/// Symbolic factorization of a pattern.
#[derive(Debug)]
pub struct Analysis {
    pub(super) symbolic: SymbolicCholesky<u32>,
}

/// Number type of a factor: f64, or f32 for a preconditioner.
pub trait Real: faer::traits::RealField + nalgebra::RealField + Copy {
    const ZERO: Self;
}

impl Real for f64 {
    const ZERO: Self = 0.0;
}

impl Real for f32 {
    const ZERO: Self = 0.0;
}

/// Values of a factorization L Lᵀ.
#[derive(Debug, Clone)]
pub struct Factor<T = f64> {
    pub(super) values: Vec<T>,
}

/// Scratch memory of factorizations.
pub struct Workspace {
    memory: MemBuffer,
}

impl Analysis {
    /// Analyses `pattern` in the order `permutation` (position → dof).
    ///
    /// # Errors
    /// [`FactorError::Analysis`] if memory or the index range is exhausted.
    pub fn new(pattern: &BlockPattern, permutation: &[u32]) -> Result<Self, FactorError> {
        let order = pattern.order();
        let mut inverse = vec![0u32; order];
        for (position, &dof) in permutation.iter().enumerate() {
            inverse[dof as usize] = position as u32;
        }
        let symbolic = factorize_symbolic_cholesky(
            symbolic_matrix(pattern),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(permutation, &inverse, order)),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                supernodal_params: SymbolicSupernodalParams { relax: Some(&MERGED) },
                ..Default::default()
            },
        )
        .map_err(|error| FactorError::Analysis { order, reason: format!("{error:?}") })?;
        Ok(Self { symbolic })
    }

    /// Numbers stored in a factor.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Cost of one factorization in passes over the factor (with a product each): 0.05 multiplications per entry fit
    /// the optimum on meshes of n = 64 and 128 (6 and 9 iterations of GMRES).
    pub fn passes_of_a_factor(&self) -> u32 {
        let entries = (self.factor_entries() as f64).max(1.0);
        (2.0 + 0.05 * self.multiplications() / entries) as u32
    }

    /// Multiplications of one factorization: Σ over columns of their length squared.
    pub fn multiplications(&self) -> f64 {
        let Some(raw) = self.supernodes() else { return 0.0 };
        let supernode = |s: usize| {
            let rows = raw.col_ptr_for_row_idx();
            let width = raw.supernode_end()[s] - raw.supernode_begin()[s];
            let height = width + rows[s + 1] - rows[s];
            (0..width).map(|j| f64::from(height - j).powi(2)).sum::<f64>()
        };
        (0..raw.n_supernodes()).map(supernode).sum()
    }

    /// An empty factor of this pattern.
    pub fn factor<T: Real>(&self) -> Factor<T> {
        Factor { values: vec![T::ZERO; self.symbolic.len_val()] }
    }

    /// Scratch memory for factorizations.
    pub fn workspace(&self) -> Workspace {
        let factorize =
            self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        Workspace { memory: MemBuffer::new(factorize) }
    }

    /// Computes L of the matrix with these lower-triangle `values`.
    ///
    /// # Errors
    /// [`FactorError::NotPositiveDefinite`] names the unknown whose pivot failed.
    pub fn factorize<T: Real>(
        &self,
        pattern: &BlockPattern,
        values: &[T],
        factor: &mut Factor<T>,
        workspace: &mut Workspace,
    ) -> Result<(), FactorError> {
        let matrix = SparseColMatRef::new(symbolic_matrix(pattern), values);
        let outcome = self.symbolic.factorize_numeric_llt(
            &mut factor.values,
            matrix,
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut workspace.memory),
            Default::default(),
        );
        match outcome {
            Ok(_) => Ok(()),
            Err(_) if values.iter().any(|v| !v.is_finite()) => Err(FactorError::NotFinite),
            Err(LltError::NonPositivePivot { index }) => {
                // The index is in the permuted order of the supernodal factorization.
                let dof = match self.symbolic.perm() {
                    Some(perm) => perm.arrays().0.get(index).map_or(index, |&d| d as usize),
                    None => index,
                };
                Err(FactorError::NotPositiveDefinite { dof })
            }
        }
    }
}

fn symbolic_matrix(pattern: &BlockPattern) -> SymbolicSparseColMatRef<'_, u32> {
    let order = pattern.order();
    SymbolicSparseColMatRef::new_checked(order, order, &pattern.columns, None, &pattern.rows)
}

#[cfg(test)]
mod tests {
    use super::super::{Front, nested_dissection};
    use super::*;

    fn laplacian() -> (BlockPattern, Vec<f64>, Vec<f64>) {
        let cells: Vec<u32> = (0..28).flat_map(|i| [i, i + 1, i + 2]).collect();
        let pattern = BlockPattern::new(&cells, 3, 2, 30);
        let mut values = vec![0.0; pattern.entries()];
        for dof in 0..60 {
            values[pattern.diagonal(dof)] = 5.0;
            if dof >= 2 {
                values[pattern.position(dof, dof - 2).expect("neighbours")] = -1.0;
            }
        }
        (pattern, values, (0..60).map(|i| f64::from(i / 2)).collect())
    }

    #[test]
    fn solves_with_two_right_sides() {
        let (pattern, values, coordinates) = laplacian();
        let analysis =
            Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, &[])).unwrap();
        let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
        analysis.factorize(&pattern, &values, &mut factor, &mut workspace).unwrap();
        let x: Vec<f64> = (0..120).map(|i| f64::from(i % 7) - 3.0).collect();
        let mut front = Front::default();
        for x in x.chunks(60) {
            let mut b = vec![0.0; 60];
            pattern.multiply(&values, x, &mut b);
            analysis.solve(&factor, &mut b, &mut front);
            assert!(b.iter().zip(x).all(|(p, q)| (p - q).abs() < 1e-14));
        }
    }

    /// A band matrix of half width 4 in natural order: columns of length 5, shorter at the end.
    #[test]
    fn multiplications_of_a_band_matrix() {
        let (pattern, ..) = laplacian();
        let natural: Vec<u32> = (0..60).collect();
        let analysis = Analysis::new(&pattern, &natural).unwrap();
        // Blocks of two couple to the next two nodes: column j reaches row 2⌊j/2⌋ + 5.
        let length = |j: usize| (2 * (j / 2) + 6).min(60) - j;
        let exact: f64 = (0..60).map(|j| (length(j) as f64).powi(2)).sum();
        let found = analysis.multiplications();
        // Supernodes store zeros, at most those of the full triangle.
        let full: f64 = (1..=60).map(|length| f64::from(length).powi(2)).sum();
        assert!(found >= exact && found <= full, "{found} {exact} {full}");
    }

    #[test]
    fn an_indefinite_matrix_names_its_unknown() {
        let (pattern, values, coordinates) = laplacian();
        let analysis =
            Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, &[])).unwrap();
        let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
        for dof in 0..60 {
            let mut bad = values.clone();
            bad[pattern.diagonal(dof)] = -1.0;
            let error = analysis.factorize(&pattern, &bad, &mut factor, &mut workspace);
            assert_eq!(error, Err(FactorError::NotPositiveDefinite { dof }));
        }
        let mut bad = values;
        bad[3] = f64::NAN;
        let error = analysis.factorize(&pattern, &bad, &mut factor, &mut workspace);
        assert_eq!(error, Err(FactorError::NotFinite));
    }
}
