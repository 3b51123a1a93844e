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
    /// The rules for linear elements in dimension 2 or 3: degrees 4 and 6 in the cells of the plane, 5 and 6 in space; in the
    /// plane 6 Gauss points on the sides, degree 11, beyond the 3 of the compliance rule, and 4 for tractions.
    pub fn of(dimension: usize) -> Self {
        Self::by(1, dimension, 0)
    }

    /// The rules for an element: for quadratic ones two degrees more in the cells, in space on the sides as well, and as many
    /// points as keep what a kink leaves out far below the smaller error; of higher degree p for polynomials of degree
    /// 2p + 4 and more.
    pub fn for_element(element: Element, dimension: usize) -> Self {
        Self::by(element.degree(), dimension, 0)
    }

    /// The next rule of each of [`Self::for_element`]: what the usual one leaves out shows in the difference.
    pub fn stronger_for(element: Element, dimension: usize) -> Self {
        Self::by(element.degree(), dimension, 1)
    }

    /// The usual rules for elements of degree p, or with `next` = 1 the next ones.
    fn by(p: usize, dimension: usize, next: usize) -> Self {
        let triangle = |degree: usize| match degree {
            4 => triangle_degree_4(),
            6 => triangle_degree_6(),
            _ => triangle_degree_8(),
        };
        let more = 2 * next;
        let (load, error) = match (dimension, p) {
            (2, ..=1) => (triangle(4 + more), triangle(6 + more)),
            (2, 2) => (triangle(6 + more), triangle_product(5 + more)),
            (2, _) => (triangle_product(p + 3 + more), triangle_product(p + 4 + more)),
            (_, ..=1) if next == 0 => (tetrahedron_degree_5(), tetrahedron_degree_6()),
            (_, ..=1) => (tetrahedron_degree_6(), tetrahedron_product(4)),
            _ => (tetrahedron_product(p + 2 + next), tetrahedron_product(p + 3 + next)),
        };
        let side = match (dimension, p) {
            (2, _) => edge(6 + more),
            (_, ..=1) => triangle(6 + more),
            (_, 2) if next == 0 => triangle(8),
            _ => triangle_product(p + 3 + next),
        };
        let traction = if dimension == 2 { edge(4 + more) } else { side.clone() };
        Self { load, stress: error.clone(), error, side, traction }
    }
}
