//! The points where strain, stress and projection live: one a cell where strains are constant on cells.

use super::{Geometry, Nodes, strain_of};

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

/// All of them, cell by cell.
#[derive(Debug, Clone)]
pub struct StrainPoints<'a> {
    geometry: &'a Geometry,
    nodes: &'a Nodes,
    next: usize,
    cell: usize,
    local: usize,
}

impl<'a> StrainPoints<'a> {
    /// The points of a space.
    pub(crate) fn new(geometry: &'a Geometry, nodes: &'a Nodes) -> Self {
        Self { geometry, nodes, next: 0, cell: 0, local: 0 }
    }

    /// The points of a cell and of the cells behind it.
    pub(crate) fn from_cell(geometry: &'a Geometry, nodes: &'a Nodes, cell: usize) -> Self {
        Self { geometry, nodes, next: geometry.shares.len() * cell, cell, local: 0 }
    }

    #[inline]
    fn here(&self) -> StrainPoint<'a> {
        StrainPoint {
            index: self.next,
            cell: self.cell,
            weight: self.geometry.measure[self.cell] * self.geometry.shares[self.local],
            gradients: self.geometry.gradients(self.next),
            nodes: self.nodes.of_cell(self.cell),
        }
    }
}

impl<'a> Iterator for StrainPoints<'a> {
    type Item = StrainPoint<'a>;

    #[inline]
    fn next(&mut self) -> Option<StrainPoint<'a>> {
        if self.cell == self.geometry.measure.len() {
            return None;
        }
        let here = self.here();
        self.next += 1;
        self.local += 1;
        if self.local == self.geometry.shares.len() {
            (self.cell, self.local) = (self.cell + 1, 0);
        }
        Some(here)
    }
}
