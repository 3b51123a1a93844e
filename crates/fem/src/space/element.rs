//! What an element is: nodes, shape functions, and the points where strain, stress and projection live. All that the
//! program needs of one besides is derived from these here.

use std::collections::HashMap;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::Deref;

use super::mean_square::MeanSquare;
use super::quadrature::{
    Rule, edge, tetrahedron_degree_5, tetrahedron_product, triangle_degree_4, triangle_product,
};
use crate::mesh::Mesh;

/// A finite element on simplices with values at points as degrees of freedom: V^h has all polynomials of its degree on each
/// cell.
///
/// Points are given by their barycentric coordinates b_0, …, b_d. Of a facet they are those of the cell but for the one
/// that is zero there, and its nodes and functions are those of the cell. So a simplex is known by its number of corners:
/// d + 1 of a cell, d of a facet.
pub trait FiniteElement: fmt::Debug + Send + Sync {
    /// Its name in scenes and records, which no other element has.
    fn name(&self) -> &'static str;

    /// The degree p of its polynomials.
    fn degree(&self) -> usize;

    /// Nodes of a simplex with so many corners in the order of the shape functions, those at corners first.
    fn nodes(&self, corners: usize) -> Vec<Vec<f64>>;

    /// Values of the shape functions of a cell or facet at `b`.
    fn values(&self, b: &[f64]) -> Vec<f64>;

    /// ∂φ_a/∂b_i of the shape functions φ_a of a cell at `b`, as if the d + 1 coordinates were independent.
    fn slopes(&self, b: &[f64]) -> Vec<Vec<f64>>;

    /// The points of a cell at which strains live: as many as determine polynomials of degree p - 1, by a rule that is exact
    /// for the products of two.
    fn strain_rule(&self, dimension: usize) -> Rule;

    /// Weights of the nodes of a facet, and their sum: the means of the shape functions. Nodes of weight zero carry no law
    /// on Γ3.
    fn facet_weights(&self, dimension: usize) -> (Vec<f64>, f64);
}

/// An element of the program or of its user; two are equal if they have one name.
#[derive(Clone, Copy)]
pub struct Element(&'static dyn FiniteElement);

impl Element {
    /// An element whose name no other has; its parts have to belong together, as the tests of this module ask of those of the
    /// program.
    pub const fn new(element: &'static dyn FiniteElement) -> Self {
        Self(element)
    }
}

impl Deref for Element {
    type Target = dyn FiniteElement;

    fn deref(&self) -> &Self::Target {
        self.0
    }
}

impl fmt::Debug for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl PartialEq for Element {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Element {}

impl Hash for Element {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name().hash(state);
    }
}

impl Default for Element {
    fn default() -> Self {
        Self::P1
    }
}

/// The barycentre of some corners of a simplex with `corners` of them; of one, this corner.
pub(super) fn barycentre(of: &[usize], corners: usize) -> Vec<f64> {
    let share = 1.0 / of.len() as f64;
    (0..corners).map(|a| if of.contains(&a) { share } else { 0.0 }).collect()
}

/// Nodes of cells and of boundary facets, as points of the mesh.
pub(crate) struct Places {
    pub cells: Vec<u32>,
    pub facets: Vec<u32>,
}

impl Element {
    /// A rule on a simplex with so many corners that is exact for the product of two of its functions.
    pub fn square_rule(self, corners: usize) -> Rule {
        let degree = self.degree();
        match corners {
            2 => edge(degree.max(2) + 1),
            3 if degree <= 2 => triangle_degree_4(),
            3 => triangle_product(degree + 1),
            _ if degree <= 2 => tetrahedron_degree_5(),
            _ => tetrahedron_product(degree + 1),
        }
    }

    /// Means of products of two shape functions over a simplex with so many corners, row by row.
    pub fn mass(self, corners: usize) -> Vec<f64> {
        let rule = self.square_rule(corners);
        let count = self.nodes(corners).len();
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
        let mass = if self == Self::P1 { Vec::new() } else { self.mass(corners) };
        MeanSquare::new(corners, mass)
    }

    /// The nodes of all cells and facets of `mesh`. Those at no corner become further points of it, behind its vertices.
    pub(crate) fn places(self, mesh: &mut Mesh) -> Places {
        let (d, mut known) = (mesh.dimension, HashMap::new());
        let (cells, facets) = (mesh.cells.clone(), mesh.facets.clone());
        if self == Self::P1 {
            return Places { cells, facets };
        }
        let mut nodes = |all: &[u32], corners: usize| {
            let places = self.nodes(corners);
            let mut out = Vec::with_capacity(all.len() / corners * places.len());
            for corners in all.chunks_exact(corners) {
                for b in &places {
                    let all = corners.iter().copied().zip(b.iter().copied());
                    out.push(point_of(mesh, all.filter(|(_, b)| *b != 0.0).collect(), &mut known));
                }
            }
            out
        };
        let cells = nodes(&cells, d + 1);
        let facets = nodes(&facets, d);
        Places { cells, facets }
    }
}

/// The point of the mesh with these weights of vertices, which is added where there is none yet.
fn point_of(
    mesh: &mut Mesh,
    mut weights: Vec<(u32, f64)>,
    known: &mut HashMap<Vec<(u32, u64)>, u32>,
) -> u32 {
    if let [(corner, _)] = weights[..] {
        return corner;
    }
    weights.sort_unstable_by_key(|(vertex, _)| *vertex);
    let key = weights.iter().map(|(vertex, weight)| (*vertex, weight.to_bits())).collect();
    *known.entry(key).or_insert_with(|| {
        let (around, b): (Vec<u32>, Vec<f64>) = weights.into_iter().unzip();
        let at = mesh.point(&around, &b);
        let number = mesh.vertices() as u32;
        mesh.coordinates.extend_from_slice(&at[..mesh.dimension]);
        number
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, lattice};
    use crate::space::quadrature::{tetrahedron_degree_6, triangle_degree_6};

    #[test]
    fn means_are_those_of_a_rule_that_is_exact_for_them() {
        for element in Element::ALL {
            let simplices = [(2, edge(5)), (3, triangle_degree_6()), (4, tetrahedron_degree_6())];
            for (corners, rule) in simplices {
                let count = element.nodes(corners).len();
                let v: Vec<[f64; 2]> =
                    (0..count).map(|a| [(a as f64 + 0.3).sin(), (2.0 * a as f64).cos()]).collect();
                let mut square = 0.0;
                for (b, weight) in rule.points.iter().zip(&rule.weights) {
                    let shape = element.values(b);
                    for i in 0..2 {
                        let at: f64 = shape.iter().zip(&v).map(|(s, v)| s * v[i]).sum();
                        square += weight * at * at;
                    }
                }
                let found = element.mean_square(corners).over(3.0, &v);
                assert!((found - 3.0 * square).abs() < 2e-14, "{element:?} {corners}");
            }
        }
    }

    #[test]
    fn each_edge_has_one_midpoint() {
        let mut mesh = lattice([1.0, 1.0], 3, Family::Structured);
        let (vertices, cells, facets) = (mesh.vertices(), mesh.cell_count(), mesh.facet_side.len());
        let places = Element::P2.places(&mut mesh);
        // Euler: edges of a disc.
        assert_eq!(mesh.vertices() - vertices, vertices + cells - 1);
        assert_eq!((places.cells.len(), places.facets.len()), (6 * cells, 3 * facets));
        for nodes in places.facets.chunks_exact(3) {
            assert_eq!(mesh.point(&nodes[..2], &[0.5, 0.5]), mesh.point(&nodes[2..], &[1.0]));
        }
        let mut mesh = lattice([1.0; 3], 2, Family::Structured);
        let (vertices, cells, facets) = (mesh.vertices(), mesh.cell_count(), mesh.facet_side.len());
        let places = Element::P2.places(&mut mesh);
        // Euler: V - E + F - C = 1 of a ball, F = 2 C + half of the facets.
        assert_eq!(mesh.vertices() - vertices, vertices + cells + facets / 2 - 1);
        assert_eq!((places.cells.len(), places.facets.len()), (10 * cells, 6 * facets));
    }
}
