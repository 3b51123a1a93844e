//! Boxes (0,a)×(0,b)×(0,c): n×n×n cubes a unit cube, each cut into the six tetrahedra
//! x_π1 ≥ x_π2 ≥ x_π3 around its diagonal (Kuhn's triangulation).
//!
//! On a plane z = const the mesh is that of [`super::rectangle`], so that plane P1 functions,
//! continued along z, are P1 here.

use super::{Family, Mesh, WHOLE};
use algebra::linalg::signed_unit;

/// The sides of a box, in the order of `Mesh::sides`: plane scenes keep theirs.
const SIDES: [(&str, [f64; 3]); 6] = [
    ("left", [-1.0, 0.0, 0.0]),
    ("right", [1.0, 0.0, 0.0]),
    ("bottom", [0.0, -1.0, 0.0]),
    ("top", [0.0, 1.0, 0.0]),
    ("front", [0.0, 0.0, -1.0]),
    ("back", [0.0, 0.0, 1.0]),
];

/// The orders in which a path along three edges of a cube takes the axes, even ones first: these
/// tetrahedra are positively oriented as the path goes.
const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];

/// Cuts (0, size₀)×(0, size₁)×(0, size₂) into tetrahedra with n cubes a unit length; `n·size` must be
/// whole (validated with the scene), else it is rounded.
pub fn cuboid(size: [f64; 3], n: u32, family: Family) -> Mesh {
    let counts = size.map(|s| ((s * f64::from(n)).round() as usize).max(1));
    let grid = Grid { counts };
    let mut coordinates = Vec::with_capacity(3 * grid.number([0, 0, counts[2] + 1]) as usize);
    for l in 0..=counts[2] {
        for j in 0..=counts[1] {
            for i in 0..=counts[0] {
                let at = [i, j, l];
                coordinates.extend((0..3).map(|a| size[a] * at[a] as f64 / counts[a] as f64));
            }
        }
    }
    if let Family::Perturbed { amplitude, seed, axes } = family {
        let reach = axes.map(|moved| if moved { amplitude / f64::from(n) } else { 0.0 });
        grid.perturb(&mut coordinates, reach, seed);
    }
    let cells = grid.cells();
    let (mut facets, mut facet_side) = (Vec::new(), Vec::new());
    for (side, _) in SIDES.iter().enumerate() {
        grid.facets(side, &mut facets);
        facet_side.resize(facets.len() / 3, side as u32);
    }
    Mesh {
        dimension: 3,
        n,
        h: 1.0 / f64::from(n),
        coordinates,
        cell_region: vec![0; cells.len() / 4],
        regions: vec![WHOLE.to_string()],
        cells,
        facets,
        facet_normal: facet_side.iter().flat_map(|&side| SIDES[side as usize].1).collect(),
        facet_side,
        sides: SIDES.iter().map(|(name, _)| (*name).to_string()).collect(),
    }
}

/// Vertices by three indices.
struct Grid {
    counts: [usize; 3],
}

impl Grid {
    fn number(&self, [i, j, l]: [usize; 3]) -> u32 {
        ((l * (self.counts[1] + 1) + j) * (self.counts[0] + 1) + i) as u32
    }

    fn cells(&self) -> Vec<u32> {
        let mut cells = Vec::with_capacity(24 * self.counts.iter().product::<usize>());
        for l in 0..self.counts[2] {
            for j in 0..self.counts[1] {
                for i in 0..self.counts[0] {
                    for (p, path) in PATHS.iter().enumerate() {
                        let mut at = [i, j, l];
                        let mut cell = [self.number(at); 4];
                        for (step, &axis) in path.iter().enumerate() {
                            at[axis] += 1;
                            cell[step + 1] = self.number(at);
                        }
                        if p >= 3 {
                            cell.swap(1, 2);
                        }
                        cells.extend(cell);
                    }
                }
            }
        }
        cells
    }

    /// The triangles of one side, seen counter-clockwise from outside; each square is cut along the
    /// diagonal that the tetrahedra have there.
    fn facets(&self, side: usize, facets: &mut Vec<u32>) {
        let (axis, far) = (side / 2, side % 2 == 1);
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        for q in 0..self.counts[b] {
            for p in 0..self.counts[a] {
                let vertex = |dp: usize, dq: usize| {
                    let mut at = [0; 3];
                    (at[axis], at[a], at[b]) =
                        (if far { self.counts[axis] } else { 0 }, p + dp, q + dq);
                    self.number(at)
                };
                let [low, right, high, left] =
                    [vertex(0, 0), vertex(1, 0), vertex(1, 1), vertex(0, 1)];
                if far {
                    facets.extend([low, right, high, low, high, left]);
                } else {
                    facets.extend([low, high, right, low, left, high]);
                }
            }
        }
    }

    /// Moves interior vertices by at most `reach` a coordinate.
    fn perturb(&self, coordinates: &mut [f64], reach: [f64; 3], seed: u64) {
        let mut state = seed;
        for l in 1..self.counts[2] {
            for j in 1..self.counts[1] {
                for i in 1..self.counts[0] {
                    let first = 3 * self.number([i, j, l]) as usize;
                    for (value, reach) in coordinates[first..first + 3].iter_mut().zip(reach) {
                        *value += reach * signed_unit(&mut state);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

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
            let mesh = cuboid([2.0, 1.0, 0.5], 4, family);
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
        let mesh = cuboid([2.0, 1.0, 0.5], 2, Family::Structured);
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
        let mesh = cuboid([1.0, 1.0, 1.0], 2, Family::Structured);
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
