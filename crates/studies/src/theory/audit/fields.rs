//! The truth as the audit reads it: ε, H, u and f0 at points of the cells, contact data on edges.

use super::edges::EdgeSample;
use super::pointwise::Plane;
use super::strips::CellPoints;
use fem::contact::LoadError;

/// Values of the truth at points of cells.
#[derive(Default)]
pub(crate) struct CellValues {
    /// Points, weights, cells.
    pub at: CellPoints,
    /// u.
    pub u: Vec<[f64; 2]>,
    /// ε.
    pub strain: Vec<Plane>,
    /// H = ∫ b(t-s) ε(u(s)) ds; zero without memory.
    pub history: Vec<Plane>,
    /// f0 = -Div σ.
    pub force: Vec<[f64; 2]>,
}

/// Values of the truth over Ω at one time.
#[derive(Default)]
pub(crate) struct Volume {
    /// Cells in which the fields are smooth but for the vertical cuts.
    pub plain: CellValues,
    /// Cells that a curve crosses, in 16 parts.
    pub crossed: CellValues,
    /// The same cells in 4 parts: the difference measures the quadrature error.
    pub check: CellValues,
}

/// A truth on one mesh, level after level.
pub(crate) trait Fields {
    /// Values over Ω at t; `zeta` is ζ(t).
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn volume(&mut self, t: f64, zeta: f64) -> Result<Volume, LoadError>;

    /// Points of Γ2 and Γ3 at t. Edges are cut where the truth or one of `traces` (values of a normal
    /// trace at the points of Γ3) crosses a kink of the law, and where two of them cross.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn edges(&mut self, t: f64, zeta: f64, traces: &[&[f64]])
    -> Result<Vec<EdgeSample>, LoadError>;

    /// The nodal interpolant of u(t), clamped nodes included.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn interpolant(&mut self, t: f64) -> Result<Vec<f64>, LoadError>;

    /// ζ(t); `None` where no term depends on it.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn zeta(&mut self, t: f64) -> Result<Option<f64>, LoadError>;

    /// ε and H with the weights of points that stay the same at all times: for sums over the past.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn remembered(&mut self, t: f64) -> Result<CellValues, LoadError>;

    /// λ at the points of the trace where it acts there, since u(t) ∈ V^h; otherwise it is part of the edges.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn nodal_multiplier(&mut self, t: f64) -> Result<Option<Vec<f64>>, LoadError>;
}

/// (u, ε, H) at each point from interior outputs [u, ε_xx, ε_xy, ε_yy, H_xx, H_xy, H_yy].
pub(crate) fn sort_interior(out: &[Vec<f64>]) -> (Vec<[f64; 2]>, Vec<Plane>, Vec<Plane>) {
    let points = 0..out[0].len();
    let tensors = |first: usize| -> Vec<Plane> {
        let [Some(xx), Some(xy), Some(yy)] = [0, 1, 2].map(|i| out.get(first + i)) else {
            return vec![[0.0; 3]; points.len()];
        };
        points.clone().map(|p| [xx[p], yy[p], std::f64::consts::SQRT_2 * xy[p]]).collect()
    };
    (vectors(out), tensors(2), tensors(5))
}

/// The first two outputs at each point.
pub(crate) fn vectors(out: &[Vec<f64>]) -> Vec<[f64; 2]> {
    out[0].iter().zip(&out[1]).map(|(&x, &y)| [x, y]).collect()
}
