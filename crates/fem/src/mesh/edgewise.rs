//! The parts of a uniformly refined tetrahedron: n³ of equal volume, n parts per edge.
//!
//! With the edges e1 = v1 - v0, e2 = v2 - v1, e3 = v3 - v2 the points v0 + (i e1 + j e2 + l e3)/n,
//! n ≥ i ≥ j ≥ l ≥ 0, fill the tetrahedron, and Kuhn's simplices of the lattice cut it; n = 2 is red refinement, and
//! powers of 2 repeat it. At most three shapes occur, so cells do not degenerate, and the mesh m refines the mesh n if n
//! divides m. Of the three ways to cut the inner octahedra the one with the shortest diagonal is taken; on faces all
//! agree, so neighbours meet. Source: J. Bey, Numer. Math. 85 (2000) 1-29.

use super::geometry::{minus, norm};
use super::lattice::PATHS;

/// Orders of the corners whose inner diagonal joins the middles of 02 and 13, of 01 and 23, of 03 and 12; the sign tells
/// whether the order is even.
const ORDERS: [([usize; 4], bool); 3] =
    [([0, 1, 2, 3], true), ([0, 2, 1, 3], false), ([0, 1, 3, 2], false)];

/// A diagonal must be shorter by this part to be preferred: the choice does not depend on rounding.
const SHORTER: f64 = 1e-9;

/// Shows the parts of the tetrahedron with these corners, each by the weights of its four vertices at the corners.
pub(super) fn parts(corners: &[[f64; 3]], n: u32, mut show: impl FnMut([[u32; 4]; 4])) {
    let (order, even) = shortest_diagonal(corners);
    for cube in 0..n * n * n {
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
            let mut part = points.map(|[i, j, l]| {
                let mut weights = [0; 4];
                order.iter().zip([n - i, i - j, j - l, l]).for_each(|(&a, w)| weights[a] = w);
                weights
            });
            // In even orders Kuhn's first three simplices are negative, in odd ones the others.
            if (p < 3) != even {
                part.swap(2, 3);
            }
            show(part);
        }
    }
}

/// The order of the corners of a tetrahedron with the shortest inner diagonal, and whether it is even.
fn shortest_diagonal(corners: &[[f64; 3]]) -> ([usize; 4], bool) {
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

#[cfg(test)]
mod tests;
