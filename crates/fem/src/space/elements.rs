//! The elements that scenes can name.

use super::element::{Element, FiniteElement, barycentre};
use super::quadrature::{Rule, tetrahedron_degree_2, triangle_degree_2};

impl Element {
    /// Linear: nodes at the vertices, one strain a cell.
    pub const P1: Self = Self::new(&Linear);
    /// Quadratic: nodes at the vertices and at the midpoints of edges, linear strains.
    pub const P2: Self = Self::new(&Quadratic);
    /// Those that scenes can name.
    pub const ALL: [Self; 2] = [Self::P1, Self::P2];
}

#[derive(Debug)]
struct Linear;

impl FiniteElement for Linear {
    fn name(&self) -> &'static str {
        "P1"
    }

    fn degree(&self) -> usize {
        1
    }

    fn nodes(&self, corners: usize) -> Vec<Vec<f64>> {
        (0..corners).map(|a| barycentre(&[a], corners)).collect()
    }

    fn values(&self, b: &[f64]) -> Vec<f64> {
        b.to_vec()
    }

    fn slopes(&self, b: &[f64]) -> Vec<Vec<f64>> {
        self.nodes(b.len())
    }

    fn strain_rule(&self, dimension: usize) -> Rule {
        Rule::barycentre(dimension)
    }

    fn facet_weights(&self, dimension: usize) -> (Vec<f64>, f64) {
        (vec![1.0; dimension], dimension as f64)
    }
}

#[derive(Debug)]
struct Quadratic;

/// Corners of the edges of an edge, of a triangle and of a tetrahedron, in the order of the nodes at their midpoints: those
/// of a simplex are the first ones.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

fn edges(corners: usize) -> &'static [[usize; 2]] {
    &EDGES[..corners * (corners - 1) / 2]
}

impl FiniteElement for Quadratic {
    fn name(&self) -> &'static str {
        "P2"
    }

    fn degree(&self) -> usize {
        2
    }

    fn nodes(&self, corners: usize) -> Vec<Vec<f64>> {
        let at_corners = (0..corners).map(|a| barycentre(&[a], corners));
        at_corners.chain(edges(corners).iter().map(|edge| barycentre(edge, corners))).collect()
    }

    fn values(&self, b: &[f64]) -> Vec<f64> {
        let corners = b.iter().map(|b| b * (2.0 * b - 1.0));
        corners.chain(edges(b.len()).iter().map(|[i, j]| 4.0 * b[*i] * b[*j])).collect()
    }

    fn slopes(&self, b: &[f64]) -> Vec<Vec<f64>> {
        let at = |entries: &[(usize, f64)]| {
            let mut slopes = vec![0.0; b.len()];
            entries.iter().for_each(|&(i, slope)| slopes[i] = slope);
            slopes
        };
        let corners = b.iter().enumerate().map(|(a, b)| at(&[(a, 4.0 * b - 1.0)]));
        let between = |&[i, j]: &[usize; 2]| at(&[(i, 4.0 * b[j]), (j, 4.0 * b[i])]);
        corners.chain(edges(b.len()).iter().map(between)).collect()
    }

    fn strain_rule(&self, dimension: usize) -> Rule {
        if dimension == 2 { triangle_degree_2() } else { tetrahedron_degree_2() }
    }

    /// Simpson's on an edge; on a triangle zero at the vertices, where nothing carries a law.
    fn facet_weights(&self, dimension: usize) -> (Vec<f64>, f64) {
        match dimension {
            2 => (vec![1.0, 1.0, 4.0], 6.0),
            _ => (vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], 3.0),
        }
    }
}
