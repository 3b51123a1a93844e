//! Elements: nodes with the clamped ones last, shape functions, strains at the points where they live, quadrature.

mod element;
mod elements;
mod mean_square;
mod nodes;
mod polynomials;
pub mod quadrature;
mod shape;
mod strain_shapes;
#[cfg(test)]
mod tests;

pub use element::{Element, FiniteElement};
pub use mean_square::MeanSquare;
pub use nodes::Nodes;
pub use shape::{Geometry, StrainPoint, strain_of};
pub use strain_shapes::StrainShapes;
