//! P1 elements: shape gradients, strains, node numbering with the clamped nodes last, quadrature.

mod nodes;
pub mod quadrature;
mod shape;

pub use nodes::Nodes;
pub use shape::{Geometry, strain_of};
