//! The data of Problem 1 in ℝ^m.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::history::{TimeGrid, TimeRule};
use crate::law::{HistoryKernel, Potential};
use algebra::linalg::complement;

/// A function of y = (Su)_i and r = u_i.
pub trait ComponentLaw: Send + Sync {
    fn value(&self, y: f64, r: f64) -> f64;
    fn by_y(&self, y: f64, r: f64) -> f64;
    fn by_r(&self, y: f64, r: f64) -> f64;
}

/// One term of the history: q(t, s) Q before u(s), or before a history v of its own.
pub struct FiniteKernel {
    /// q.
    pub kernel: Box<dyn HistoryKernel + Send + Sync>,
    /// r of v(s) = start + ∫_0^s r(s, τ) u(τ) dτ, in place of u(s).
    pub inner: Option<Box<dyn HistoryKernel + Send + Sync>>,
    /// Q.
    pub matrix: DMatrix<f64>,
}

impl FiniteKernel {
    /// The weights of u_0, …, u_n in the sums at all t_n: W_ni = w_ni q(t_n, t_i), or by the repeated rule
    /// Σ_{i ≤ j ≤ n} w_nj q(t_n, t_j) w_ji r(t_j, t_i), in O(N³).
    pub fn weights(&self, rule: &dyn TimeRule, grid: &TimeGrid) -> Vec<Vec<f64>> {
        let of = |kernel: &dyn HistoryKernel| -> Vec<Vec<f64>> {
            (0..=grid.steps()).map(|n| rule.kernel_row(kernel, grid, n)).collect()
        };
        let outer = of(&*self.kernel);
        let Some(inner) = &self.inner else { return outer };
        let inner = of(&**inner);
        let repeated = |row: Vec<f64>| {
            let mut sums = vec![0.0; row.len()];
            for (w, own) in row.iter().zip(&inner) {
                sums.iter_mut().zip(own).for_each(|(sum, r)| *sum += w * r);
            }
            sums
        };
        outer.into_iter().map(repeated).collect()
    }
}

/// γ_i: u ↦ a_i·u with its part of j and K.
pub struct Functional {
    /// a_i; all of them linearly independent.
    pub a: DVector<f64>,
    /// w_i, the weight of j_i.
    pub weight: f64,
    /// ∂j_i.
    pub potential: Arc<dyn Potential>,
    /// a_i·u ≤ upper, or ∞.
    pub upper: f64,
    /// a_i·u ≥ lower, or -∞.
    pub lower: f64,
}

/// Problem 1 in ℝ^m. Forces are vectors of ℝ^m too: ⟨f, v⟩ = f·v.
///
/// ```text
/// ⟨A u, v⟩ = (M u + g(u))·v,  S_n u = R(Σ_l Σ_j W^l_nj Q_l z^l_j + a_S),  φ(y, u, v) = N(y, u)·v,
/// j(γu) = Σ_i w_i j_i(a_i·u),  K = {lower_i ≤ a_i·u ≤ upper_i}
/// ```
///
/// z^l_j is u_j, or by the same rule v_j = start + Σ_i W_ji u_i of the inner kernel.
/// g and N act component by component; without them A is linear and N(y, u) = y.
pub struct FiniteModel {
    /// Gram matrix of X.
    pub inner_product: DMatrix<f64>,
    /// M.
    pub matrix: DMatrix<f64>,
    /// g_i(r) per component; empty for linear A.
    pub nonlinear: Vec<Box<dyn ComponentLaw>>,
    /// Terms of the history; may be empty.
    pub kernels: Vec<FiniteKernel>,
    /// Where inner histories begin: the displacement at t = 0, if u is a velocity.
    pub start: DVector<f64>,
    /// R.
    pub r: DMatrix<f64>,
    /// a_S.
    pub a_s: DVector<f64>,
    /// N_i(y, r) per component; empty for N(y, u) = y.
    pub force: Vec<Box<dyn ComponentLaw>>,
    pub functionals: Vec<Functional>,
    /// Quadrature in time.
    pub time_rule: Box<dyn TimeRule>,
}

impl FiniteModel {
    /// m.
    pub fn dimension(&self) -> usize {
        self.matrix.nrows()
    }

    /// ‖v‖_X.
    pub fn norm(&self, v: &DVector<f64>) -> f64 {
        v.dot(&(&self.inner_product * v)).max(0.0).sqrt()
    }

    /// N(y, u).
    pub fn force_of(&self, y: &DVector<f64>, u: &DVector<f64>) -> DVector<f64> {
        if self.force.is_empty() {
            return y.clone();
        }
        DVector::from_fn(u.len(), |i, _| self.force[i].value(y[i], u[i]))
    }

    /// A u.
    pub fn operator(&self, u: &DVector<f64>) -> DVector<f64> {
        let mut out = &self.matrix * u;
        for (i, g) in self.nonlinear.iter().enumerate() {
            out[i] += g.value(0.0, u[i]);
        }
        out
    }

    /// Coordinates in which the functionals come first: C with a_i·(C w) = w_i, the rest orthonormal. A permutation of
    /// the identity if the functionals are unit vectors, None if they are linearly dependent.
    pub(crate) fn coordinates(&self) -> Option<DMatrix<f64>> {
        let m = self.dimension();
        let mut rows: Vec<Vec<f64>> =
            self.functionals.iter().map(|functional| functional.a.as_slice().to_vec()).collect();
        rows.extend(complement(&rows, m)?);
        DMatrix::from_fn(m, m, |i, j| rows[i][j]).try_inverse()
    }
}
