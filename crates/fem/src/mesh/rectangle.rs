//! Rectangles (0,a)×(0,b): n×n squares a unit square, each cut from lower left to upper right.

use super::grading::in_rectangle;
use super::{Family, Mesh, WHOLE};
use algebra::linalg::signed_unit;

/// The sides of a rectangle, in the order of `Mesh::sides`.
const SIDES: [(&str, [f64; 2]); 4] =
    [("left", [-1.0, 0.0]), ("right", [1.0, 0.0]), ("bottom", [0.0, -1.0]), ("top", [0.0, 1.0])];

/// Triangulates (0, size₀)×(0, size₁) with n cells per unit length; `n·size` must be whole
/// (validated with the scene), else it is rounded.
pub fn rectangle(size: [f64; 2], n: u32, family: Family) -> Mesh {
    let counts = size.map(|s| ((s * f64::from(n)).round() as usize).max(1));
    let number = |i: usize, j: usize| (j * (counts[0] + 1) + i) as u32;
    let mut coordinates = Vec::with_capacity(2 * (counts[0] + 1) * (counts[1] + 1));
    for j in 0..=counts[1] {
        for i in 0..=counts[0] {
            coordinates.push(size[0] * i as f64 / counts[0] as f64);
            coordinates.push(size[1] * j as f64 / counts[1] as f64);
        }
    }
    let mut cells = Vec::with_capacity(6 * counts[0] * counts[1]);
    for j in 0..counts[1] {
        for i in 0..counts[0] {
            let [a, b] = [number(i, j), number(i + 1, j)];
            let [c, d] = [number(i + 1, j + 1), number(i, j + 1)];
            cells.extend([a, b, c, a, c, d]);
        }
    }
    let (mut facets, mut facet_side) = (Vec::new(), Vec::new());
    let mut facet = |a: u32, b: u32, side: u32| {
        facets.extend([a, b]);
        facet_side.push(side);
    };
    for j in 0..counts[1] {
        facet(number(0, j + 1), number(0, j), 0);
        facet(number(counts[0], j), number(counts[0], j + 1), 1);
    }
    for i in 0..counts[0] {
        facet(number(i, 0), number(i + 1, 0), 2);
        facet(number(i + 1, counts[1]), number(i, counts[1]), 3);
    }
    match family {
        Family::Structured => {}
        Family::Perturbed { amplitude, seed, axes } => {
            let reach = axes.map(|moved| if moved { amplitude / f64::from(n) } else { 0.0 });
            perturb(&mut coordinates, counts, reach, seed);
        }
        Family::Graded { corner, exponent } => {
            in_rectangle(size, corner, exponent, &mut coordinates);
        }
    }
    Mesh {
        dimension: 2,
        n,
        h: 1.0 / f64::from(n),
        coordinates,
        cell_region: vec![0; cells.len() / 3],
        regions: vec![WHOLE.to_string()],
        cells,
        facets,
        facet_normal: facet_side.iter().flat_map(|&side| SIDES[side as usize].1).collect(),
        facet_side,
        sides: SIDES.iter().map(|(name, _)| (*name).to_string()).collect(),
    }
}

/// Moves interior vertices by at most `reach`, one number an axis.
fn perturb(coordinates: &mut [f64], counts: [usize; 2], reach: [f64; 3], seed: u64) {
    let mut state = seed;
    for j in 1..counts[1] {
        for i in 1..counts[0] {
            for c in 0..2 {
                coordinates[2 * (j * (counts[0] + 1) + i) + c] +=
                    reach[c] * signed_unit(&mut state);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn perturbed(seed: u64) -> Family {
        Family::Perturbed { amplitude: 0.2, seed, axes: [true; 3] }
    }

    fn area(mesh: &Mesh) -> f64 {
        (0..mesh.cell_count())
            .map(|c| {
                let [p, q, r] = [0, 1, 2].map(|a| mesh.vertex(mesh.cell(c)[a]));
                let signed = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
                assert!(signed > 0.0, "cell {c} is not positively oriented");
                signed / 2.0
            })
            .sum()
    }

    #[test]
    fn cells_tile_the_rectangle_and_sides_have_their_length() {
        for family in [Family::Structured, perturbed(7)] {
            let mesh = rectangle([2.0, 1.0], 6, family);
            assert!((area(&mesh) - 2.0).abs() < 1e-13);
            assert_eq!(mesh.facets_on(&[2]).count(), 12);
            assert_eq!(mesh.facets_on(&[0]).count(), 6);
        }
    }

    #[test]
    fn perturbation_moves_interior_vertices_only_and_repeats() {
        let family = perturbed(3);
        let (a, b) = (rectangle([1.0, 1.0], 4, family), rectangle([1.0, 1.0], 4, family));
        assert_eq!(a.coordinates, b.coordinates);
        let straight = rectangle([1.0, 1.0], 4, Family::Structured);
        let moved = a.coordinates.iter().zip(&straight.coordinates).filter(|(p, q)| p != q);
        assert_eq!(moved.count(), 2 * 9);
    }
    #[test]
    fn columns_stay_where_vertices_move_along_y_alone() {
        let family = Family::Perturbed { amplitude: 0.2, seed: 3, axes: [false, true, false] };
        let (moved, straight) =
            (rectangle([1.0, 1.0], 4, family), rectangle([1.0, 1.0], 4, Family::Structured));
        let differ = |axis: usize| {
            (0..25).filter(|&v| moved.vertex(v)[axis] != straight.vertex(v)[axis]).count()
        };
        assert_eq!([differ(0), differ(1)], [0, 9]);
    }
}
