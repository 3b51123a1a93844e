//! Elements on simplices: their nodes, shape functions, the points where strain, stress and projection live, and how the
//! squares of their functions are integrated. What the rest of the program knows of an element is here, but for the jumps
//! of one whose functions are not continuous (`jumps`).

use std::collections::HashMap;

use super::quadrature::{
    Rule, edge, tetrahedron_degree_2, tetrahedron_degree_5, triangle_degree_2, triangle_degree_4,
};
use crate::mesh::Mesh;

/// Polynomials on simplices, continuous over the mesh unless an element says otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Element {
    /// Linear: nodes at the vertices, one strain a cell.
    #[default]
    P1,
    /// Quadratic: nodes at the vertices and at the midpoints of edges, linear strains.
    P2,
    /// Linear on triangles, continuous at the midpoints of edges alone, where the nodes are (Crouzeix and Raviart): V^h is
    /// not in V, and jumps across edges are penalised. On a facet its functions count by their means, their values at the
    /// midpoint: a constant.
    CR,
}

/// Corners of the edges of an edge, of a triangle and of a tetrahedron, in the order of the nodes at their midpoints: those
/// of a simplex are the first ones.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Nodes of cells and of boundary facets, as points of the mesh.
pub(crate) struct Places {
    pub cells: Vec<u32>,
    pub facets: Vec<u32>,
    /// The first point of the mesh with a node: those before it have none.
    pub first: u32,
}

impl Element {
    /// Every element.
    pub const ALL: [Self; 3] = [Self::P1, Self::P2, Self::CR];

    /// Its name in scenes and records.
    pub fn name(self) -> &'static str {
        match self {
            Self::P1 => "P1",
            Self::P2 => "P2",
            Self::CR => "CR",
        }
    }

    /// Whether V^h is a part of V.
    pub fn is_conforming(self) -> bool {
        self != Self::CR
    }

    /// Whether the corners of a cell are among its nodes.
    pub fn has_nodes_at_corners(self) -> bool {
        self != Self::CR
    }

    /// The degree of its polynomials.
    pub fn degree(self) -> usize {
        match self {
            Self::P1 | Self::CR => 1,
            Self::P2 => 2,
        }
    }

    /// Nodes on a simplex with so many corners; of an element of the plane alone an edge is a facet, a triangle a cell.
    pub fn nodes_on(self, corners: usize) -> usize {
        match self {
            Self::P1 => corners,
            Self::P2 => corners + edges(corners).len(),
            Self::CR => edges(corners).len(),
        }
    }

    /// The points of a cell at which strains live: as many as determine a strain of V^h, by a rule that is exact for
    /// the products of two.
    pub fn strain_rule(self, dimension: usize) -> Rule {
        match self {
            Self::P1 | Self::CR => {
                let centre = vec![1.0 / (dimension + 1) as f64; dimension + 1];
                Rule { points: vec![centre], weights: vec![1.0] }
            }
            Self::P2 if dimension == 2 => triangle_degree_2(),
            Self::P2 => tetrahedron_degree_2(),
        }
    }

    /// Values of the shape functions of a simplex at barycentric coordinates `b`.
    pub fn values(self, b: &[f64]) -> Vec<f64> {
        match self {
            Self::P1 => b.to_vec(),
            Self::P2 => {
                let corners = b.iter().map(|b| b * (2.0 * b - 1.0));
                corners.chain(edges(b.len()).iter().map(|[i, j]| 4.0 * b[*i] * b[*j])).collect()
            }
            // One at the midpoint of its edge, zero at those of the other two.
            Self::CR => edges(b.len()).iter().map(|[i, j]| 2.0 * (b[*i] + b[*j]) - 1.0).collect(),
        }
    }

    /// Appends their gradients at `b`, d numbers each, from those of the barycentric coordinates.
    pub(super) fn append_gradients(self, b: &[f64], linear: &[f64], out: &mut Vec<f64>) {
        let d = b.len() - 1;
        let of = |corner: usize| &linear[d * corner..d * (corner + 1)];
        match self {
            Self::P1 => out.extend_from_slice(linear),
            Self::P2 => {
                for (a, value) in b.iter().enumerate() {
                    out.extend(of(a).iter().map(|g| (4.0 * value - 1.0) * g));
                }
                for &[i, j] in edges(b.len()) {
                    let both = of(i).iter().zip(of(j));
                    out.extend(both.map(|(gi, gj)| 4.0 * (b[j] * gi + b[i] * gj)));
                }
            }
            Self::CR => {
                for &[i, j] in edges(b.len()) {
                    out.extend(of(i).iter().zip(of(j)).map(|(gi, gj)| 2.0 * (gi + gj)));
                }
            }
        }
    }

    /// Weights of the vertex rule on a facet with so many corners, over their sum. They are the means of the shape
    /// functions: equal ones, or Simpson's on an edge; on a triangle those of quadratics are zero at the vertices, where
    /// nothing carries a law.
    pub fn facet_weights(self, corners: usize) -> (Vec<f64>, f64) {
        match self {
            Self::P1 => (vec![1.0; corners], corners as f64),
            Self::P2 if corners == 2 => (vec![1.0, 1.0, 4.0], 6.0),
            Self::P2 => (vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], 3.0),
            Self::CR => (vec![1.0], 1.0),
        }
    }

    /// A rule on a simplex with so many corners that is exact for the product of two of its functions, up to degree 4.
    pub fn square_rule(self, corners: usize) -> Rule {
        match corners {
            2 => edge(3),
            3 => triangle_degree_4(),
            _ => tetrahedron_degree_5(),
        }
    }

    /// Means of products of two shape functions over a simplex with so many corners, row by row.
    pub fn mass(self, corners: usize) -> Vec<f64> {
        let rule = self.square_rule(corners);
        let count = self.nodes_on(corners);
        let mut mass = vec![0.0; count * count];
        for (b, weight) in rule.points.iter().zip(&rule.weights) {
            let values = self.values(b);
            for (ab, mean) in mass.iter_mut().enumerate() {
                *mean += weight * values[ab / count] * values[ab % count];
            }
        }
        mass
    }

    /// How |v|² is integrated over a simplex with so many corners.
    pub fn mean_square(self, corners: usize) -> MeanSquare {
        let mass = match self {
            Self::P1 => Vec::new(),
            Self::P2 | Self::CR => self.mass(corners),
        };
        MeanSquare { scale: 1.0 / (corners * (corners + 1)) as f64, mass }
    }

    /// The nodes of all cells and facets of `mesh`. Midpoints become further points of it, behind its vertices.
    pub(crate) fn places(self, mesh: &mut Mesh) -> Places {
        let (mut cells, mut facets) = (Vec::new(), Vec::new());
        let with_corners = match self {
            Self::P1 => {
                let (cells, facets) = (mesh.cells.clone(), mesh.facets.clone());
                return Places { cells, facets, first: 0 };
            }
            Self::P2 => true,
            Self::CR => false,
        };
        let first = if with_corners { 0 } else { mesh.vertices() as u32 };
        let mut known = HashMap::new();
        let mut add = |mesh: &mut Mesh, corners: Vec<u32>, out: &mut Vec<u32>| {
            if with_corners {
                out.extend_from_slice(&corners);
            }
            append_midpoints(mesh, &corners, &mut known, out);
        };
        for c in 0..mesh.cell_count() {
            let corners = mesh.cell(c).to_vec();
            add(mesh, corners, &mut cells);
        }
        for f in 0..mesh.facet_side.len() {
            let corners = mesh.facet(f).to_vec();
            add(mesh, corners, &mut facets);
        }
        Places { cells, facets, first }
    }
}

fn edges(corners: usize) -> &'static [[usize; 2]] {
    &EDGES[..corners * (corners - 1) / 2]
}

/// Appends the midpoints of the edges of a simplex.
fn append_midpoints(
    mesh: &mut Mesh,
    corners: &[u32],
    known: &mut HashMap<[u32; 2], u32>,
    out: &mut Vec<u32>,
) {
    for &[i, j] in edges(corners.len()) {
        let ends = [corners[i].min(corners[j]), corners[i].max(corners[j])];
        out.push(*known.entry(ends).or_insert_with(|| {
            let middle = mesh.point(&ends, &[0.5, 0.5]);
            let number = mesh.vertices() as u32;
            mesh.coordinates.extend_from_slice(&middle[..mesh.dimension]);
            number
        }));
    }
}

/// The mean of |v|² over a simplex for v in its element.
pub struct MeanSquare {
    /// Of linear functions: (Σ v_a² + (Σ v_a)²)/(N (N + 1)), N the number of corners.
    scale: f64,
    /// Of others: means of products of shape functions.
    mass: Vec<f64>,
}

impl MeanSquare {
    /// ∫ |v|² over a simplex of this measure, from the values of v at its nodes.
    #[inline]
    pub fn over<const D: usize>(&self, measure: f64, v: &[[f64; D]]) -> f64 {
        if !self.mass.is_empty() {
            let rows = v.iter().zip(self.mass.chunks_exact(v.len()));
            let product = |a: &[f64; D], b: &[f64; D]| (0..D).map(|i| a[i] * b[i]).sum::<f64>();
            let row =
                |a, row: &[f64]| v.iter().zip(row).map(|(b, m)| m * product(a, b)).sum::<f64>();
            return measure * rows.map(|(a, own)| row(a, own)).sum::<f64>();
        }
        // Corners of a triangle as a constant: loops are unrolled.
        match v.first_chunk::<3>().filter(|_| v.len() == 3) {
            Some(v) => self.linear(measure, v),
            None => self.linear(measure, v),
        }
    }

    #[inline(always)]
    fn linear<const D: usize>(&self, measure: f64, v: &[[f64; D]]) -> f64 {
        let (mut total, mut squares) = ([0.0; D], 0.0);
        for value in v {
            for i in 0..D {
                total[i] += value[i];
                squares += value[i] * value[i];
            }
        }
        measure * self.scale * (squares + total.iter().map(|t| t * t).sum::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, cuboid, rectangle};
    use crate::space::quadrature::{tetrahedron_degree_6, triangle_degree_6};

    #[test]
    fn means_are_those_of_a_rule_that_is_exact_for_them() {
        for element in Element::ALL {
            let rules = [(2, edge(5)), (3, triangle_degree_6()), (4, tetrahedron_degree_6())];
            let in_plane = |corners: usize| element.is_conforming() || corners < 4;
            for (corners, rule) in rules.into_iter().filter(|(corners, _)| in_plane(*corners)) {
                let count = element.nodes_on(corners);
                let v: Vec<[f64; 2]> =
                    (0..count).map(|a| [(a as f64 + 0.3).sin(), (2.0 * a as f64).cos()]).collect();
                let (mut square, mut means) = (0.0, vec![0.0; count]);
                for (b, weight) in rule.points.iter().zip(&rule.weights) {
                    let shape = element.values(b);
                    assert!((shape.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                    for i in 0..2 {
                        let at: f64 = shape.iter().zip(&v).map(|(s, v)| s * v[i]).sum();
                        square += weight * at * at;
                    }
                    means.iter_mut().zip(&shape).for_each(|(mean, s)| *mean += weight * s);
                }
                let found = element.mean_square(corners).over(3.0, &v);
                assert!((found - 3.0 * square).abs() < 1e-14, "{element:?} {corners}");
                if corners < 4 && in_plane(corners + 1) {
                    let (weights, sum) = element.facet_weights(corners);
                    let mut pairs = means.iter().zip(&weights);
                    assert!(pairs.all(|(mean, weight)| (mean - weight / sum).abs() < 1e-15));
                }
            }
        }
    }

    #[test]
    fn gradients_are_those_of_the_values() {
        // ∇λ of a triangle, and a step along x.
        let linear = [-1.3, -0.4, 0.9, -0.6, 0.4, 1.0];
        let (b, step) = ([0.2, 0.5, 0.3], 1e-5);
        for element in Element::ALL {
            let mut gradients = Vec::new();
            element.append_gradients(&b, &linear, &mut gradients);
            for axis in 0..2 {
                let moved = |sign: f64| {
                    let at: Vec<f64> =
                        (0..3).map(|a| b[a] + sign * step * linear[2 * a + axis]).collect();
                    element.values(&at)
                };
                let (ahead, behind) = (moved(1.0), moved(-1.0));
                for (a, (p, q)) in ahead.iter().zip(&behind).enumerate() {
                    // Quadratic: central differences are exact but for rounding, 1e-16/1e-5.
                    let difference = (p - q) / (2.0 * step) - gradients[2 * a + axis];
                    assert!(difference.abs() < 1e-10, "{element:?} {a} {axis}: {difference:e}");
                }
            }
        }
    }

    #[test]
    fn each_edge_has_one_midpoint() {
        let mut mesh = rectangle([1.0, 1.0], 3, Family::Structured);
        let (vertices, cells, facets) = (mesh.vertices(), mesh.cell_count(), mesh.facet_side.len());
        let places = Element::P2.places(&mut mesh);
        // Euler: edges of a disc.
        assert_eq!(mesh.vertices() - vertices, vertices + cells - 1);
        assert_eq!((places.cells.len(), places.facets.len()), (6 * cells, 3 * facets));
        for own in places.facets.chunks_exact(3) {
            assert_eq!(mesh.point(&own[..2], &[0.5, 0.5]), mesh.point(&own[2..], &[1.0]));
        }
        let mut mesh = cuboid([1.0; 3], 2, Family::Structured);
        let (vertices, cells, facets) = (mesh.vertices(), mesh.cell_count(), mesh.facet_side.len());
        let places = Element::P2.places(&mut mesh);
        // Euler: V - E + F - C = 1 of a ball, F = 2 C + half of the facets.
        assert_eq!(mesh.vertices() - vertices, vertices + cells + facets / 2 - 1);
        assert_eq!((places.cells.len(), places.facets.len()), (10 * cells, 6 * facets));
    }
}
