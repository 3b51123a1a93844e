//! The elements that scenes can name, a file each.

mod linear;
mod quadratic;

use super::element::Element;

impl Element {
    /// Linear: nodes at the vertices, one strain a cell.
    pub const P1: Self = Self::new(&linear::Linear);
    /// Quadratic: nodes at the vertices and at the midpoints of edges, linear strains.
    pub const P2: Self = Self::new(&quadratic::Quadratic);
    /// Those that scenes can name.
    pub const ALL: [Self; 2] = [Self::P1, Self::P2];
}
