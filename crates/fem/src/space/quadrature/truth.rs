//! The rules by which loads and moments of a truth are integrated.

use super::rule::{Rule, edge};
use super::{
    tetrahedron_degree_5, tetrahedron_degree_6, tetrahedron_product, triangle_degree_4,
    triangle_degree_6, triangle_degree_8, triangle_product,
};
use crate::space::Element;

/// The rules by which loads and moments of a truth are integrated.
#[derive(Debug, Clone)]
pub struct TruthRules {
    /// Loads in the cells, but for σ of an exact solution.
    pub load: Rule,
    /// σ of an exact solution in loads of the weak form: the rule of the moments, which have the means of σ.
    pub stress: Rule,
    /// Moments of the exact fields in the cells.
    pub error: Rule,
    /// Loads and moments of an exact solution on the sides.
    pub side: Rule,
    /// Tractions given as formulas.
    pub traction: Rule,
}

impl TruthRules {
    /// The rules in dimension 2 or 3: degrees 4 and 6 in the cells of the plane, 5 and 6 in space; in the plane 6 Gauss
    /// points on the sides, degree 11, beyond the 3 of the compliance rule, and 4 for tractions.
    pub fn of(dimension: usize) -> Self {
        let (load, error, side, traction) = match dimension {
            2 => (triangle_degree_4(), triangle_degree_6(), edge(6), edge(4)),
            _ => {
                let side = triangle_degree_6();
                (tetrahedron_degree_5(), tetrahedron_degree_6(), side.clone(), side)
            }
        };
        Self { load, stress: error.clone(), error, side, traction }
    }

    /// The rules for an element: for quadratic ones two degrees more in the cells, in space on the sides as well, and as many
    /// points as keep what a kink leaves out far below the smaller error; of higher degree p for polynomials of degree
    /// 2p + 4 and more.
    pub fn for_element(element: Element, dimension: usize) -> Self {
        let linear = Self::of(dimension);
        match (dimension, element.degree()) {
            (_, ..=1) => linear,
            (2, 2) => linear.with_cells(triangle_degree_6(), triangle_product(5)),
            (2, p) => linear.with_cells(triangle_product(p + 3), triangle_product(p + 4)),
            (_, 2) => linear
                .with_cells(tetrahedron_product(4), tetrahedron_product(5))
                .with_sides(triangle_degree_8()),
            (_, p) => linear
                .with_cells(tetrahedron_product(p + 2), tetrahedron_product(p + 3))
                .with_sides(triangle_product(p + 3)),
        }
    }

    /// The next rule of each of [`Self::for_element`].
    pub fn stronger_for(element: Element, dimension: usize) -> Self {
        let linear = Self::stronger(dimension);
        match (dimension, element.degree()) {
            (_, ..=1) => linear,
            (2, 2) => linear.with_cells(triangle_degree_8(), triangle_product(7)),
            (2, p) => linear.with_cells(triangle_product(p + 5), triangle_product(p + 6)),
            (_, p) => linear
                .with_cells(tetrahedron_product(p + 3), tetrahedron_product(p + 4))
                .with_sides(triangle_product(p + 4)),
        }
    }

    fn with_cells(self, load: Rule, error: Rule) -> Self {
        Self { load, stress: error.clone(), error, ..self }
    }

    fn with_sides(self, side: Rule) -> Self {
        Self { side: side.clone(), traction: side, ..self }
    }

    /// The next rule of each: what the usual one leaves out shows in the difference.
    pub fn stronger(dimension: usize) -> Self {
        let (load, error, side, traction) = match dimension {
            2 => (triangle_degree_6(), triangle_degree_8(), edge(8), edge(6)),
            _ => {
                let side = triangle_degree_8();
                (tetrahedron_degree_6(), tetrahedron_product(4), side.clone(), side)
            }
        };
        Self { load, stress: error.clone(), error, side, traction }
    }
}
