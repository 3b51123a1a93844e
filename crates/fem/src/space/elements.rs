//! The elements that scenes can name, a file each.

mod crouzeix_raviart;
mod linear;
mod quadratic;

use super::element::Element;

impl Element {
    /// Linear: nodes at the vertices, one strain a cell.
    pub const P1: Self = Self::new(&linear::Linear);
    /// Quadratic: nodes at the vertices and at the midpoints of edges, linear strains.
    pub const P2: Self = Self::new(&quadratic::Quadratic);
    /// Linear, continuous at the barycentres of facets alone.
    pub const CR: Self = Self::new(&crouzeix_raviart::CrouzeixRaviart);
    /// Those that scenes can name.
    pub const ALL: [Self; 3] = [Self::P1, Self::P2, Self::CR];
}
