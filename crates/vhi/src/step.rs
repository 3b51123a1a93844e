//! The view of one time level that solvers have.

use super::{BoundaryGraph, StepState};
use algebra::linalg::FactorError;

/// Problem 9 at one time level in coordinates: find u and pressures c with
///
///   F(u) + Σ_i w_i c_i s_i e_i = 0, c_i ∈ G_i(s_i u_i),
///
/// where F is single-valued (A, φ with the history up to this level, smooth boundary terms, minus the load) and the
/// graphs G_i = ∂j + ∂I_{≤ g} act on single coordinates (dof, sign s_i, weight w_i) or on two as a vector: the
/// constraint v ∈ K^h and a diagonal, possibly set-valued part of ∂j.
pub trait StepInequality {
    fn dofs(&self) -> usize;

    fn graph(&self) -> &BoundaryGraph;

    /// α_i ≥ 0 such that r ↦ G_i(r) + α_i r is monotone, and so is the part of ∂j within F after adding w_i α_i s_i u_i
    /// on every coordinate.
    fn descent(&self, i: usize) -> f64 {
        self.graph().descent(i)
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]);

    /// Takes the pressures c_i on the chosen pieces, before [`Self::linearize`]: graphs that depend on other
    /// coordinates use them in the Jacobian. No operation otherwise.
    fn take_pressures(&mut self, _pressures: &[f64]) {}

    /// Prepares solves with the generalized Jacobian of F at the u of the last [`Self::residual`], plus `slopes[i]` on
    /// the coordinate of graph i (a stiffness), with the increment of graph i prescribed where `prescribed[i]` is set
    /// (an increment of the dof). After the slopes of the coordinates follow the mixed slopes of the vector laws, in
    /// order.
    ///
    /// # Errors
    /// The factorization fails: the Jacobian is not positive definite.
    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError>;

    /// Solves with the prepared Jacobian in place, to a residual of at most `forcing` times the right side; a direct
    /// solve ignores it.
    ///
    /// # Errors
    /// The factorization fails; [`FactorError::SingularInZeta`] if a low-rank part makes the Jacobian
    /// singular.
    fn solve(&mut self, rhs: &mut [f64], forcing: f64) -> Result<(), FactorError>;

    /// Size of the forces that cancel in F(u): rounding in F is a small multiple of ε times this.
    fn force_scale(&self, u: &[f64]) -> f64;

    /// Adds to single forces the rounding that they have beyond that, over ε: of laws so stiff that u_ν - s, once rounded,
    /// moves them by more. It is kept apart from the size of all forces, so that the balance of the others stays sharp.
    fn add_rounding(&self, state: &StepState, sizes: &mut [f64]) {
        self.graph().add_rounding(state, sizes);
    }
}
