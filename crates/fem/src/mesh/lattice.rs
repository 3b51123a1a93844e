//! Rectangles (0,a)×(0,b) and boxes (0,a)×(0,b)×(0,c): a lattice of squares or cubes, each cut into the simplices
//! x_π1 ≥ x_π2 ≥ … around its diagonal (Kuhn's triangulation).
//!
//! On a plane z = const the mesh of a box is that of a rectangle, so that plane P1 functions, continued along z, are P1
//! there.

use super::grading::in_rectangle;
use super::{Family, Mesh, WHOLE};
use algebra::linalg::signed_unit;

/// The sides of a box, in the order of `Mesh::sides`; a rectangle has the first four.
const SIDES: [(&str, [f64; 3]); 6] = [
    ("left", [-1.0, 0.0, 0.0]),
    ("right", [1.0, 0.0, 0.0]),
    ("bottom", [0.0, -1.0, 0.0]),
    ("top", [0.0, 1.0, 0.0]),
    ("front", [0.0, 0.0, -1.0]),
    ("back", [0.0, 0.0, 1.0]),
];

/// The orders in which a path along the edges of a square or cube takes the axes, even ones first: these simplices are
/// positively oriented as the path goes.
const PLANE_PATHS: [&[usize]; 2] = [&[0, 1], &[1, 0]];
pub(super) const PATHS: [&[usize]; 6] =
    [&[0, 1, 2], &[1, 2, 0], &[2, 0, 1], &[0, 2, 1], &[1, 0, 2], &[2, 1, 0]];

/// Cuts (0, size₀)×(0, size₁)(×(0, size₂)) into simplices with n squares or cubes a unit length; `n·size` must be
/// whole (validated with the scene), else it is rounded.
pub fn lattice<const D: usize>(size: [f64; D], n: u32, family: Family) -> Mesh {
    let grid = Grid { counts: size.map(|s| ((s * f64::from(n)).round() as usize).max(1)) };
    let counts = grid.counts;
    let place = |at: [usize; D]| (0..D).map(move |a| size[a] * at[a] as f64 / counts[a] as f64);
    let mut coordinates: Vec<f64> =
        indices(counts.map(|count| count + 1)).flat_map(place).collect();
    match family {
        Family::Structured => {}
        Family::Perturbed { amplitude, seed, axes } => {
            let reach = axes.map(|moved| if moved { amplitude / f64::from(n) } else { 0.0 });
            grid.perturb(&mut coordinates, reach, seed);
        }
        Family::Graded { corner, exponent } => {
            in_rectangle([size[0], size[1]], corner, exponent, &mut coordinates);
        }
    }
    let cells = grid.cells();
    let (mut facets, mut facet_side) = (Vec::new(), Vec::new());
    for side in 0..2 * D {
        grid.facets(side, &mut facets);
        facet_side.resize(facets.len() / D, side as u32);
    }
    Mesh {
        dimension: D,
        n,
        h: 1.0 / f64::from(n),
        coordinates,
        cell_region: vec![0; cells.len() / (D + 1)],
        regions: vec![WHOLE.to_string()],
        cells,
        facets,
        facet_normal: facet_side.iter().flat_map(|&s| &SIDES[s as usize].1[..D]).copied().collect(),
        facet_side,
        sides: SIDES[..2 * D].iter().map(|(name, _)| (*name).to_string()).collect(),
    }
}

/// All lists of indices below `counts`, the first ones fastest.
fn indices<const D: usize>(counts: [usize; D]) -> impl Iterator<Item = [usize; D]> {
    (0..counts.iter().product()).map(move |mut number| {
        counts.map(|count| {
            let index = number % count;
            number /= count;
            index
        })
    })
}

/// Vertices by their indices.
struct Grid<const D: usize> {
    counts: [usize; D],
}

impl<const D: usize> Grid<D> {
    fn number(&self, at: [usize; D]) -> u32 {
        at.iter().zip(self.counts).rev().fold(0, |number, (at, count)| number * (count + 1) + at)
            as u32
    }

    fn cells(&self) -> Vec<u32> {
        let paths = if D == 2 { &PLANE_PATHS[..] } else { &PATHS };
        let mut cells =
            Vec::with_capacity((D + 1) * paths.len() * self.counts.iter().product::<usize>());
        for low in indices(self.counts) {
            for (p, path) in paths.iter().enumerate() {
                let (mut at, first) = (low, cells.len());
                cells.push(self.number(at));
                for &axis in *path {
                    at[axis] += 1;
                    cells.push(self.number(at));
                }
                if 2 * p >= paths.len() {
                    cells.swap(first + 1, first + 2);
                }
            }
        }
        cells
    }

    /// The edges or triangles of one side, seen counter-clockwise from outside; each square is cut along the diagonal
    /// that the tetrahedra have there.
    fn facets(&self, side: usize, facets: &mut Vec<u32>) {
        let (axis, far) = (side / 2, side % 2 == 1);
        // In the plane the second direction is that of the normal.
        let (a, b) = ((axis + 1) % D, (axis + 2) % D);
        let across = if D == 2 { 1 } else { self.counts[b] };
        for (q, p) in (0..across).flat_map(|q| (0..self.counts[a]).map(move |p| (q, p))) {
            let vertex = |dp: usize, dq: usize| {
                let mut at = [0; D];
                (at[b], at[a]) = (q + dq, p + dp);
                at[axis] = if far { self.counts[axis] } else { 0 };
                self.number(at)
            };
            if D == 2 {
                let ends = [vertex(0, 0), vertex(1, 0)];
                facets.extend(if far == (axis == 0) { ends } else { [ends[1], ends[0]] });
                continue;
            }
            let [low, right, high, left] = [vertex(0, 0), vertex(1, 0), vertex(1, 1), vertex(0, 1)];
            facets.extend(match far {
                true => [low, right, high, low, high, left],
                false => [low, high, right, low, left, high],
            });
        }
    }

    /// Moves interior vertices by at most `reach` a coordinate.
    fn perturb(&self, coordinates: &mut [f64], reach: [f64; 3], seed: u64) {
        let mut state = seed;
        for inner in indices(self.counts.map(|count| count - 1)) {
            let first = D * self.number(inner.map(|i| i + 1)) as usize;
            for (value, reach) in coordinates[first..first + D].iter_mut().zip(reach) {
                *value += reach * signed_unit(&mut state);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

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
            let mesh = lattice([2.0, 1.0], 6, family);
            assert!((area(&mesh) - 2.0).abs() < 1e-13);
            assert_eq!(mesh.facets_on(&[2]).count(), 12);
            assert_eq!(mesh.facets_on(&[0]).count(), 6);
        }
    }

    #[test]
    fn perturbation_moves_interior_vertices_only_and_repeats() {
        let family = perturbed(3);
        let (a, b) = (lattice([1.0, 1.0], 4, family), lattice([1.0, 1.0], 4, family));
        assert_eq!(a.coordinates, b.coordinates);
        let straight = lattice([1.0, 1.0], 4, Family::Structured);
        let moved = a.coordinates.iter().zip(&straight.coordinates).filter(|(p, q)| p != q);
        assert_eq!(moved.count(), 2 * 9);
    }
    #[test]
    fn columns_stay_where_vertices_move_along_y_alone() {
        let family = Family::Perturbed { amplitude: 0.2, seed: 3, axes: [false, true, false] };
        let (moved, straight) =
            (lattice([1.0, 1.0], 4, family), lattice([1.0, 1.0], 4, Family::Structured));
        let differ = |axis: usize| {
            (0..25).filter(|&v| moved.vertex(v)[axis] != straight.vertex(v)[axis]).count()
        };
        assert_eq!([differ(0), differ(1)], [0, 9]);
    }

    fn edge(mesh: &Mesh, a: u32, b: u32) -> [f64; 3] {
        let (p, q) = (mesh.vertex(a), mesh.vertex(b));
        [0, 1, 2].map(|i| q[i] - p[i])
    }

    fn cross(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
        [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
    }

    fn dot(p: [f64; 3], q: [f64; 3]) -> f64 {
        p.iter().zip(q).map(|(p, q)| p * q).sum()
    }

    fn volume(mesh: &Mesh, c: usize) -> f64 {
        let v = mesh.cell(c);
        let [p, q, r] = [1, 2, 3].map(|a| edge(mesh, v[0], v[a]));
        dot(cross(p, q), r) / 6.0
    }

    #[test]
    fn tetrahedra_tile_the_box_and_meet_face_to_face() {
        for family in
            [Family::Structured, Family::Perturbed { amplitude: 0.15, seed: 5, axes: [true; 3] }]
        {
            let mesh = lattice([2.0, 1.0, 0.5], 4, family);
            let volumes: Vec<f64> = (0..mesh.cell_count()).map(|c| volume(&mesh, c)).collect();
            assert!(volumes.iter().all(|v| *v > 0.0));
            // 384 roundings.
            assert!((volumes.iter().sum::<f64>() - 1.0).abs() < 1e-13);
            let mut faces: BTreeMap<[u32; 3], usize> = BTreeMap::new();
            for c in 0..mesh.cell_count() {
                for left_out in 0..4 {
                    let face: Vec<u32> =
                        (0..4).filter(|a| *a != left_out).map(|a| mesh.cell(c)[a]).collect();
                    *faces.entry(sorted(&face)).or_default() += 1;
                }
            }
            let outer = faces.iter().filter(|(_, count)| **count == 1).count();
            assert!(faces.values().all(|count| *count <= 2));
            assert_eq!(outer, mesh.facet_side.len());
            for f in 0..mesh.facet_side.len() {
                assert_eq!(faces.get(&sorted(mesh.facet(f))), Some(&1), "facet {f}");
            }
        }
    }

    fn sorted(face: &[u32]) -> [u32; 3] {
        let mut face = [face[0], face[1], face[2]];
        face.sort_unstable();
        face
    }

    #[test]
    fn sides_have_their_area_and_outward_normal() {
        let mesh = lattice([2.0, 1.0, 0.5], 2, Family::Structured);
        for (side, area) in [0.5, 0.5, 1.0, 1.0, 2.0, 2.0].into_iter().enumerate() {
            let sides = [side as u32];
            let normal = SIDES[side].1;
            let sum: f64 = mesh
                .facets_on(&sides)
                .map(|f| {
                    let v = mesh.facet(f);
                    assert_eq!(mesh.normal(f), normal);
                    let twice = cross(edge(&mesh, v[0], v[1]), edge(&mesh, v[0], v[2]));
                    assert_eq!(dot(twice, normal), dot(twice, twice).sqrt(), "side {side}");
                    0.5 * dot(twice, normal)
                })
                .sum();
            assert!((sum - area).abs() < 1e-14, "side {side}: {sum}");
        }
    }

    #[test]
    fn cells_keep_to_one_triangle_of_the_plane_mesh() {
        let mesh = lattice([1.0, 1.0, 1.0], 2, Family::Structured);
        for c in 0..mesh.cell_count() {
            let side = |a: usize| {
                let [x, y, _] = [0, 1, 2].map(|i| 2.0 * mesh.vertex(mesh.cell(c)[a])[i]);
                let [i, j] = [0, 1].map(|i| {
                    let low = (0..4).map(|a| 2.0 * mesh.vertex(mesh.cell(c)[a])[i]);
                    low.fold(f64::INFINITY, f64::min)
                });
                (x - i) - (y - j)
            };
            let (above, below) = ((0..4).any(|a| side(a) < 0.0), (0..4).any(|a| side(a) > 0.0));
            assert!(!(above && below), "cell {c} crosses the diagonal");
        }
    }
}
