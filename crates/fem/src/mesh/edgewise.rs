//! Uniform refinement in space: each coarse tetrahedron into n³ of equal volume, n parts per edge.
//!
//! With the edges e1 = v1 - v0, e2 = v2 - v1, e3 = v3 - v2 the points v0 + (i e1 + j e2 + l e3)/n,
//! n ≥ i ≥ j ≥ l ≥ 0, fill the tetrahedron, and Kuhn's simplices of the lattice cut it; n = 2 is red refinement, and
//! powers of 2 repeat it. At most three shapes occur, so cells do not degenerate, and the mesh m refines the mesh n if n
//! divides m. Of the three ways to cut the inner octahedra the one with the shortest diagonal is taken; on faces all
//! agree, so neighbours meet. Source: J. Bey, Numer. Math. 85 (2000) 1-29.

use std::collections::HashMap;

use super::geometry::{minus, norm};
use super::lattice::PATHS;
use super::{Mesh, Solid};

/// Orders of the corners whose inner diagonal joins the middles of 02 and 13, of 01 and 23, of 03 and 12; the sign tells
/// whether the order is even.
const ORDERS: [([usize; 4], bool); 3] =
    [([0, 1, 2, 3], true), ([0, 2, 1, 3], false), ([0, 1, 3, 2], false)];

/// A diagonal must be shorter by this part to be preferred: the choice does not depend on rounding.
const SHORTER: f64 = 1e-9;

/// The mesh with n parts of every edge of `solid`.
pub(super) fn refined(solid: &Solid, n: u32) -> Mesh {
    let mut vertices = Vertices::new(solid, n);
    let pieces = (n * n * n) as usize;
    let mut cells = Vec::with_capacity(4 * pieces * solid.cells.len());
    for c in 0..solid.cells.len() {
        let (order, even) = shortest_diagonal(&solid.corners(c));
        let corners = order.map(|a| solid.cells[c][a]);
        for cube in 0..pieces as u32 {
            let start = [cube / (n * n), cube / n % n, cube % n];
            for (p, path) in PATHS.iter().enumerate() {
                let mut at = start;
                let mut points = [at; 4];
                for (step, &axis) in path.iter().enumerate() {
                    at[axis] += 1;
                    points[step + 1] = at;
                }
                if points.iter().any(|&[i, j, l]| i > n || j > i || l > j) {
                    continue;
                }
                let mut cell = points.map(|[i, j, l]| {
                    let weights = [n - i, i - j, j - l, l];
                    vertices.number(std::array::from_fn::<_, 4, _>(|a| (corners[a], weights[a])))
                });
                if (p < 3) != even {
                    cell.swap(2, 3);
                }
                cells.extend(cell);
            }
        }
    }
    let (mut facets, mut facet_side, mut facet_normal) = (Vec::new(), Vec::new(), Vec::new());
    for face in &solid.faces {
        let [a, b, c] = face.corners;
        let mut at = |i: u32, j: u32| vertices.number([(a, n - i - j), (b, i), (c, j)]);
        for j in 0..n {
            for i in 0..n - j {
                facets.extend([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 2 <= n {
                    facets.extend([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        let pieces = (n * n) as usize;
        facet_side.extend(std::iter::repeat_n(face.side, pieces));
        facet_normal.extend(std::iter::repeat_n(face.normal, pieces).flatten());
    }
    let each = |&region: &u32| std::iter::repeat_n(region, pieces);
    Mesh {
        dimension: 3,
        n,
        h: solid.longest_edge() / f64::from(n),
        coordinates: vertices.coordinates,
        cells,
        facets,
        facet_side,
        sides: solid.sides.clone(),
        facet_normal,
        cell_region: solid.region.iter().flat_map(each).collect(),
        regions: solid.regions.clone(),
    }
}

/// The order of the corners of a tetrahedron with the shortest inner diagonal, and whether it is even.
fn shortest_diagonal(corners: &[[f64; 3]; 4]) -> ([usize; 4], bool) {
    let diagonal = |order: &[usize; 4]| {
        let [a, b, c, d] = order.map(|a| corners[a]);
        let [p, q] = [minus(b, a), minus(d, c)];
        norm([0, 1, 2].map(|i| p[i] + q[i]))
    };
    let mut best = ORDERS[0];
    for candidate in &ORDERS[1..] {
        if diagonal(&candidate.0) < (1.0 - SHORTER) * diagonal(&best.0) {
            best = *candidate;
        }
    }
    best
}

/// The vertices of a refined mesh, by their weights at the corners of a coarse simplex.
struct Vertices<'a> {
    solid: &'a Solid,
    n: u32,
    coordinates: Vec<f64>,
    /// Numbers of the vertices that are not coarse ones, by (coarse vertex, weight) in order, of positive weights.
    known: HashMap<[(u32, u32); 4], u32>,
}

impl<'a> Vertices<'a> {
    fn new(solid: &'a Solid, n: u32) -> Self {
        let coordinates = solid.vertices.iter().flatten().copied().collect();
        Self { solid, n, coordinates, known: HashMap::new() }
    }

    /// The vertex at Σ weight/n · corner.
    fn number<const N: usize>(&mut self, weights: [(u32, u32); N]) -> u32 {
        let mut key = [(u32::MAX, 0); 4];
        let positive = weights.into_iter().filter(|(_, weight)| *weight > 0);
        key.iter_mut().zip(positive).for_each(|(entry, weight)| *entry = weight);
        key.sort_unstable();
        if key[0].1 == self.n {
            return key[0].0;
        }
        let next = (self.coordinates.len() / 3) as u32;
        let number = *self.known.entry(key).or_insert(next);
        if number == next {
            let share = |weight: u32| f64::from(weight) / f64::from(self.n);
            let members = key.iter().take_while(|(v, _)| *v != u32::MAX);
            let place = members.fold([0.0; 3], |place, &(v, weight)| {
                let corner = self.solid.vertices[v as usize];
                [0, 1, 2].map(|i| place[i] + share(weight) * corner[i])
            });
            self.coordinates.extend(place);
        }
        number
    }
}

#[cfg(test)]
mod tests;
