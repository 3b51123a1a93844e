//! Elements on simplices: their nodes, shape functions, the points where strain, stress and projection live, and how the
//! squares of their functions are integrated. What the rest of the program knows of an element is here, but for the jumps
//! of one whose functions are not continuous (`jumps`).

use std::collections::HashMap;

use super::mean_square::MeanSquare;
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
    /// Linear, continuous at the barycentres of facets alone, where the nodes are (Crouzeix and Raviart): V^h is not in V,
    /// and jumps across facets are penalised. On a facet its functions count by their means, their values at the
    /// barycentre: a constant.
    CR,
}

/// A cell or a facet in dimension d.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Simplex {
    dimension: usize,
    corners: usize,
}

impl Simplex {
    /// A cell.
    pub fn cell(dimension: usize) -> Self {
        Self { dimension, corners: dimension + 1 }
    }

    /// A facet of one.
    pub fn facet(dimension: usize) -> Self {
        Self { dimension, corners: dimension }
    }

    fn is_facet(self) -> bool {
        self.corners == self.dimension
    }
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

    /// Nodes on a simplex.
    pub fn nodes_on(self, simplex: Simplex) -> usize {
        let Simplex { dimension, corners } = simplex;
        match self {
            Self::P1 => corners,
            Self::P2 => corners + edges(corners).len(),
            Self::CR => facets(dimension, corners).count(),
        }
    }

    /// The corner of a cell that node a of an element with nodes on facets is opposite to.
    pub(crate) fn opposite(self, a: usize, dimension: usize) -> usize {
        debug_assert_eq!(self, Self::CR);
        (a + dimension) % (dimension + 1)
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

    /// Values of the shape functions of a cell at barycentric coordinates `b`.
    pub fn values(self, b: &[f64]) -> Vec<f64> {
        self.values_on(Simplex::cell(b.len() - 1), b)
    }

    /// Values of the shape functions of a simplex at its barycentric coordinates `b`.
    pub fn values_on(self, simplex: Simplex, b: &[f64]) -> Vec<f64> {
        match self {
            Self::P1 => b.to_vec(),
            Self::P2 => {
                let corners = b.iter().map(|b| b * (2.0 * b - 1.0));
                corners.chain(edges(b.len()).iter().map(|[i, j]| 4.0 * b[*i] * b[*j])).collect()
            }
            Self::CR if simplex.is_facet() => vec![1.0],
            // One at the barycentre of its facet, zero at those of the others.
            Self::CR => {
                let d = simplex.dimension;
                let on_facet = |facet: Facet| facet.map(|i| b[i]).sum::<f64>();
                let value = |facet| d as f64 * on_facet(facet) - (d - 1) as f64;
                facets(d, b.len()).map(value).collect()
            }
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
                for facet in facets(d, b.len()) {
                    let sum = |axis: usize| facet.clone().map(|i| of(i)[axis]).sum::<f64>();
                    out.extend((0..d).map(|axis| d as f64 * sum(axis)));
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

    /// Means of products of two shape functions over a simplex, row by row.
    pub fn mass(self, simplex: Simplex) -> Vec<f64> {
        let rule = self.square_rule(simplex.corners);
        let count = self.nodes_on(simplex);
        let mut mass = vec![0.0; count * count];
        for (b, weight) in rule.points.iter().zip(&rule.weights) {
            let values = self.values_on(simplex, b);
            for (ab, mean) in mass.iter_mut().enumerate() {
                *mean += weight * values[ab / count] * values[ab % count];
            }
        }
        mass
    }

    /// How |v|² is integrated over a simplex.
    pub fn mean_square(self, simplex: Simplex) -> MeanSquare {
        let mass = match self {
            Self::P1 => Vec::new(),
            Self::P2 | Self::CR => self.mass(simplex),
        };
        MeanSquare::new(simplex.corners, mass)
    }

    /// The nodes of all cells and facets of `mesh`. Those at no corner become further points of it, behind its vertices.
    pub(crate) fn places(self, mesh: &mut Mesh) -> Places {
        let (d, mut known) = (mesh.dimension, HashMap::new());
        let (cells, facets) = (mesh.cells.clone(), mesh.facets.clone());
        if self == Self::P1 {
            return Places { cells, facets, first: 0 };
        }
        let first = if self.has_nodes_at_corners() { 0 } else { mesh.vertices() as u32 };
        let mut nodes = |all: &[u32], simplex: Simplex| {
            let centres = self.centres(simplex);
            let mut out = Vec::new();
            for corners in all.chunks_exact(simplex.corners) {
                if self.has_nodes_at_corners() {
                    out.extend_from_slice(corners);
                }
                for centre in &centres {
                    let around: Vec<u32> = centre.iter().map(|&i| corners[i]).collect();
                    out.push(centre_of(mesh, around, &mut known));
                }
            }
            out
        };
        let cells = nodes(&cells, Simplex::cell(d));
        let facets = nodes(&facets, Simplex::facet(d));
        Places { cells, facets, first }
    }

    /// The corners that the nodes of a simplex at no corner are the barycentres of.
    fn centres(self, simplex: Simplex) -> Vec<Vec<usize>> {
        match self {
            Self::P1 => Vec::new(),
            Self::P2 => edges(simplex.corners).iter().map(|edge| edge.to_vec()).collect(),
            Self::CR => facets(simplex.dimension, simplex.corners).map(Facet::collect).collect(),
        }
    }
}

/// Corners of a simplex.
type Facet = std::iter::Take<std::iter::Skip<std::iter::Cycle<std::ops::Range<usize>>>>;

/// The simplices with d corners of a simplex: the facets of a cell in cyclic order, on a triangle 01, 12, 20; of a facet
/// itself.
fn facets(dimension: usize, corners: usize) -> impl Iterator<Item = Facet> {
    let count = if corners == dimension { 1 } else { corners };
    (0..count).map(move |first| (0..corners).cycle().skip(first).take(dimension))
}

fn edges(corners: usize) -> &'static [[usize; 2]] {
    &EDGES[..corners * (corners - 1) / 2]
}

/// The point of the mesh at the barycentre of some of its vertices, which is added where there is none yet.
fn centre_of(mesh: &mut Mesh, mut around: Vec<u32>, known: &mut HashMap<Vec<u32>, u32>) -> u32 {
    around.sort_unstable();
    if let Some(&number) = known.get(&around) {
        return number;
    }
    let share = 1.0 / around.len() as f64;
    let centre = mesh.point(&around, &[share; 3][..around.len()]);
    let number = mesh.vertices() as u32;
    mesh.coordinates.extend_from_slice(&centre[..mesh.dimension]);
    known.insert(around, number);
    number
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, cuboid, rectangle};
    use crate::space::quadrature::{tetrahedron_degree_6, triangle_degree_6};

    #[test]
    fn means_are_those_of_a_rule_that_is_exact_for_them() {
        for element in Element::ALL {
            let simplices = [
                (Simplex::facet(2), edge(5)),
                (Simplex::cell(2), triangle_degree_6()),
                (Simplex::facet(3), triangle_degree_6()),
                (Simplex::cell(3), tetrahedron_degree_6()),
            ];
            for (simplex, rule) in simplices {
                let count = element.nodes_on(simplex);
                let v: Vec<[f64; 2]> =
                    (0..count).map(|a| [(a as f64 + 0.3).sin(), (2.0 * a as f64).cos()]).collect();
                let (mut square, mut means) = (0.0, vec![0.0; count]);
                for (b, weight) in rule.points.iter().zip(&rule.weights) {
                    let shape = element.values_on(simplex, b);
                    assert!((shape.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                    for i in 0..2 {
                        let at: f64 = shape.iter().zip(&v).map(|(s, v)| s * v[i]).sum();
                        square += weight * at * at;
                    }
                    means.iter_mut().zip(&shape).for_each(|(mean, s)| *mean += weight * s);
                }
                let found = element.mean_square(simplex).over(3.0, &v);
                assert!((found - 3.0 * square).abs() < 2e-14, "{element:?} {simplex:?}");
                if simplex.is_facet() {
                    let (weights, sum) = element.facet_weights(simplex.dimension);
                    let mut pairs = means.iter().zip(&weights);
                    assert!(pairs.all(|(mean, weight)| (mean - weight / sum).abs() < 1e-15));
                }
            }
        }
    }

    #[test]
    fn gradients_are_those_of_the_values() {
        // ∇λ of a triangle and of a tetrahedron, and a step along an axis.
        let triangle = (vec![-1.3, -0.4, 0.9, -0.6, 0.4, 1.0], vec![0.2, 0.5, 0.3]);
        let solid = vec![-1.3, -0.4, 0.2, 0.9, -0.6, 0.5, 0.4, 1.0, -0.1, 0.0, 0.0, -0.6];
        let step = 1e-5;
        for (linear, b) in [triangle, (solid, vec![0.2, 0.4, 0.3, 0.1])] {
            let d = b.len() - 1;
            for (element, axis) in
                Element::ALL.into_iter().flat_map(|e| (0..d).map(move |i| (e, i)))
            {
                let mut gradients = Vec::new();
                element.append_gradients(&b, &linear, &mut gradients);
                let moved = |sign: f64| {
                    let at: Vec<f64> =
                        (0..=d).map(|a| b[a] + sign * step * linear[d * a + axis]).collect();
                    element.values(&at)
                };
                let (ahead, behind) = (moved(1.0), moved(-1.0));
                for (a, (p, q)) in ahead.iter().zip(&behind).enumerate() {
                    // Quadratic: central differences are exact but for rounding, 1e-16/1e-5.
                    let difference = (p - q) / (2.0 * step) - gradients[d * a + axis];
                    assert!(difference.abs() < 1e-10, "{element:?} {a} {axis}: {difference:e}");
                }
            }
        }
    }

    /// Values at nodes are those of the unit vectors, in both dimensions.
    #[test]
    fn functions_are_one_at_their_node_and_zero_at_the_others() {
        for (element, d) in
            Element::ALL.into_iter().flat_map(|element| [(element, 2), (element, 3)])
        {
            let corner = |a: usize| (0..=d).map(|b| f64::from(u8::from(a == b))).collect();
            let corners = (0..=d).filter(|_| element.has_nodes_at_corners()).map(corner);
            let centre = |around: Vec<usize>| -> Vec<f64> {
                let share = 1.0 / around.len() as f64;
                (0..=d).map(|a| if around.contains(&a) { share } else { 0.0 }).collect()
            };
            let centres = element.centres(Simplex::cell(d)).into_iter().map(centre);
            for (a, b) in corners.chain(centres).enumerate() {
                for (c, value) in element.values(&b).into_iter().enumerate() {
                    assert!((value - f64::from(u8::from(a == c))).abs() < 1e-15, "{element:?} {d}");
                }
                if element == Element::CR {
                    assert_eq!(b[element.opposite(a, d)], 0.0);
                }
            }
        }
    }

    #[test]
    fn each_facet_has_one_barycentre() {
        let mut mesh = cuboid([1.0; 3], 2, Family::Structured);
        let (vertices, cells, facets) = (mesh.vertices(), mesh.cell_count(), mesh.facet_side.len());
        let places = Element::CR.places(&mut mesh);
        // Each facet belongs to two cells, but for those on the boundary.
        assert_eq!(mesh.vertices() - vertices, (4 * cells + facets) / 2);
        assert_eq!((places.cells.len(), places.facets.len()), (4 * cells, facets));
        assert_eq!(places.first as usize, vertices);
    }

    #[test]
    fn each_edge_has_one_midpoint() {
        let mut mesh = rectangle([1.0, 1.0], 3, Family::Structured);
        let (vertices, cells, facets) = (mesh.vertices(), mesh.cell_count(), mesh.facet_side.len());
        let places = Element::P2.places(&mut mesh);
        // Euler: edges of a disc.
        assert_eq!(mesh.vertices() - vertices, vertices + cells - 1);
        assert_eq!((places.cells.len(), places.facets.len()), (6 * cells, 3 * facets));
        for nodes in places.facets.chunks_exact(3) {
            assert_eq!(mesh.point(&nodes[..2], &[0.5, 0.5]), mesh.point(&nodes[2..], &[1.0]));
        }
        let mut mesh = cuboid([1.0; 3], 2, Family::Structured);
        let (vertices, cells, facets) = (mesh.vertices(), mesh.cell_count(), mesh.facet_side.len());
        let places = Element::P2.places(&mut mesh);
        // Euler: V - E + F - C = 1 of a ball, F = 2 C + half of the facets.
        assert_eq!(mesh.vertices() - vertices, vertices + cells + facets / 2 - 1);
        assert_eq!((places.cells.len(), places.facets.len()), (10 * cells, 6 * facets));
    }
}
