//! The truth as the audit reads it: ε, H, u and f0 at points of the cells, contact data on edges.

use super::edges::EdgeSample;
use super::strips::CellPoints;
use fem::contact::LoadError;

/// A symmetric plane tensor field in Mandel notation: xx, yy, √2 xy.
pub(crate) type PlaneField = [Vec<f64>; 3];

/// Values of the truth at points of cells.
#[derive(Default)]
pub(crate) struct CellValues {
    /// Points, weights, cells.
    pub at: CellPoints,
    /// u_x, u_y.
    pub u: [Vec<f64>; 2],
    /// ε_xx, ε_yy, √2 ε_xy.
    pub strain: PlaneField,
    /// H = ∫ b(t-s) ε(u(s)) ds likewise; empty without memory.
    pub history: PlaneField,
    /// f0 = -Div σ.
    pub force: [Vec<f64>; 2],
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

/// How F(w) is evaluated for the truth.
pub(crate) enum Forces {
    /// In strong form: ∫ f0·w + ∫_{Γ2} f2·w + ∫_{Γ3} h3·w.
    Strong,
    /// u(t) ∈ V^h, and all w are: by the load vector.
    Vector,
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

    /// (weights, ε, H) at points that stay the same at all times: for sums over the past.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn remembered(&mut self, t: f64) -> Result<Remembered, LoadError>;

    fn forces(&self) -> Forces;

    /// λ at the points of the trace where it acts there (u(t) ∈ V^h); otherwise it is part of the edges.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn nodal_multiplier(&mut self, t: f64) -> Result<Option<Vec<f64>>, LoadError>;
}

/// Strain and its memory at fixed points.
#[derive(Default, Clone)]
pub(crate) struct Remembered {
    /// Areas.
    pub weights: Vec<f64>,
    /// ε in Mandel notation.
    pub strain: PlaneField,
    /// H; empty without memory.
    pub history: PlaneField,
}

/// Reorders interior outputs [u, ε_xx, ε_xy, ε_yy, H_xx, H_xy, H_yy].
pub(crate) fn sort_interior(mut out: Vec<Vec<f64>>) -> ([Vec<f64>; 2], PlaneField, PlaneField) {
    let mut take = |i: usize| out.get_mut(i).map(std::mem::take).unwrap_or_default();
    let root = |values: Vec<f64>| -> Vec<f64> {
        values.into_iter().map(|v| std::f64::consts::SQRT_2 * v).collect()
    };
    let u = [take(0), take(1)];
    let strain = [take(2), take(4), root(take(3))];
    let history = [take(5), take(7), root(take(6))];
    (u, strain, history)
}
