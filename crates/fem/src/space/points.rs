//! The points where strain, stress and projection live: one a cell where strains are constant on cells.

use super::strain_of;

/// A point of a cell.
#[derive(Debug, Clone, Copy)]
pub struct StrainPoint<'a> {
    /// Its number among all points.
    pub index: usize,
    /// Its cell.
    pub cell: usize,
    /// Its share of the measure of the cell.
    pub weight: f64,
    /// Shape gradients there, d numbers for each of `nodes`.
    pub gradients: &'a [f64],
    /// The nodes of the cell.
    pub nodes: &'a [u32],
}

impl StrainPoint<'_> {
    /// ε(v) of a nodal vector.
    #[inline]
    pub fn strain<const S: usize>(&self, v: &[f64]) -> [f64; S] {
        strain_of(self.gradients, self.nodes, v)
    }
}
