//! Uniform refinement: each coarse triangle into n² congruent parts, each tetrahedron into n³ of equal volume.
//!
//! The cells of a coarse cell stand together, those of a triangle in strips along its first edge; the facets of a coarse
//! facet stand together as well, along an edge from its first end to its second. So meshes n and m of one coarse mesh nest
//! if n divides m.

use rustc_hash::FxHashMap;

use super::{CoarseMesh, Family, Mesh, edgewise, grading};
use algebra::linalg::signed_unit;

impl CoarseMesh {
    /// The mesh with n parts of every coarse edge. Scenes validate that only plane meshes are graded.
    pub fn refined(&self, n: u32, family: Family) -> Mesh {
        let (mut vertices, d) = (Vertices::new(self, n), self.dimension);
        let mut cells = Vec::with_capacity((d + 1) * self.count() * n.pow(d as u32) as usize);
        for (c, corners) in self.cells.iter().enumerate() {
            match vertices.of_triangles.get(c) {
                Some(numbers) => strips(n, |i, j| numbers[place(n, i, j)], &mut cells),
                None => edgewise::parts(&self.corners(c), n, |part| {
                    cells.extend(part.map(|weights| vertices.in_cell(corners, weights)));
                }),
            }
        }
        let (mut facets, mut facet_side, mut facet_normal) = (Vec::new(), Vec::new(), Vec::new());
        for facet in &self.facets {
            match facet.corners[..] {
                [p, q] => {
                    let mut at = |s: u32| vertices.number(&[(p, n - s), (q, s)]);
                    (0..n).for_each(|s| facets.extend([at(s), at(s + 1)]));
                }
                [a, b, c, ..] => {
                    let at = |i: u32, j: u32| vertices.number(&[(a, n - i - j), (b, i), (c, j)]);
                    strips(n, at, &mut facets);
                }
                _ => {}
            }
            facet_side.resize(facets.len() / d, facet.side);
            facet_normal.extend((0..n.pow(d as u32 - 1)).flat_map(|_| &facet.normal[..d]));
        }
        let each = |&region: &u32| std::iter::repeat_n(region, n.pow(d as u32) as usize);
        let mut mesh = Mesh {
            dimension: d,
            n,
            h: self.longest_edge() / f64::from(n),
            coordinates: vertices.coordinates,
            cells,
            cell_region: self.region.iter().flat_map(each).collect(),
            regions: self.regions.clone(),
            facets,
            facet_side,
            facet_normal,
            sides: self.sides.clone(),
        };
        match family {
            Family::Structured => {}
            Family::Perturbed { amplitude, seed, axes } => {
                perturb(&mut mesh, amplitude, seed, axes);
            }
            Family::Graded { corner, exponent } => {
                let number = |t: usize, i, j| vertices.of_triangles[t][place(n, i, j)] as usize;
                grading::towards(self, n, corner, exponent, number, &mut mesh.coordinates);
            }
        }
        mesh
    }
}

/// The n² parts of a triangle whose vertices are numbered by i + j ≤ n.
fn strips(n: u32, mut at: impl FnMut(u32, u32) -> u32, out: &mut Vec<u32>) {
    for (i, j) in rows(n - 1) {
        out.extend([at(i, j), at(i + 1, j), at(i, j + 1)]);
        if i + j + 2 <= n {
            out.extend([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
}

/// (i, j) with i + j ≤ n, row by row.
fn rows(n: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..=n).flat_map(move |j| (0..=n - j).map(move |i| (i, j)))
}

/// Position of (i, j) in [`rows`].
fn place(n: u32, i: u32, j: u32) -> usize {
    (j * (n + 1) - j * (j.max(1) - 1) / 2 + i) as usize
}

/// The vertices of a refined mesh, by their weights at the corners of a coarse cell.
struct Vertices<'a> {
    coarse: &'a CoarseMesh,
    n: u32,
    coordinates: Vec<f64>,
    /// Numbers of the vertices that are not coarse ones, by (coarse vertex, weight) in order, of positive weights.
    known: FxHashMap<[(u32, u32); 4], u32>,
    /// In the plane, by triangle and [`place`]. Those of coarse edges come first.
    of_triangles: Vec<Vec<u32>>,
}

impl<'a> Vertices<'a> {
    fn new(coarse: &'a CoarseMesh, n: u32) -> Self {
        let d = coarse.dimension;
        let coordinates = coarse.vertices.iter().flat_map(|v| v[..d].to_vec()).collect();
        let (known, of_triangles) = (FxHashMap::default(), Vec::new());
        let mut vertices = Self { coarse, n, coordinates, known, of_triangles };
        let triangles = || coarse.cells.iter().filter(|cell| cell.len() == 3);
        for (triangle, a) in triangles().flat_map(|triangle| (0..3).map(move |a| (triangle, a))) {
            let (p, q) = (triangle[a], triangle[(a + 1) % 3]);
            for s in 1..n {
                vertices.number(&[(p.min(q), n - s), (p.max(q), s)]);
            }
        }
        for triangle in triangles() {
            let number = |(i, j)| vertices.in_cell(triangle, [n - i - j, i, j]);
            let numbers = rows(n).map(number).collect();
            vertices.of_triangles.push(numbers);
        }
        vertices
    }

    fn count(&self) -> u32 {
        (self.coordinates.len() / self.coarse.dimension) as u32
    }

    fn in_cell<const N: usize>(&mut self, corners: &[u32], weights: [u32; N]) -> u32 {
        self.number::<N>(&std::array::from_fn(|a| (corners[a], weights[a])))
    }

    /// The vertex at Σ weight/n · corner.
    fn number<const N: usize>(&mut self, weights: &[(u32, u32); N]) -> u32 {
        let mut key = [(u32::MAX, 0); 4];
        let positive = weights.iter().filter(|(_, weight)| *weight > 0);
        key.iter_mut().zip(positive.clone()).for_each(|(entry, weight)| *entry = *weight);
        key.sort_unstable();
        if key[0].1 == self.n {
            return key[0].0;
        }
        let next = self.count();
        let number = *self.known.entry(key).or_insert(next);
        if number == next {
            let share = |weight: u32| f64::from(weight) / f64::from(self.n);
            let place = positive.fold([0.0; 3], |place, &(v, weight)| {
                let corner = self.coarse.vertices[v as usize];
                [0, 1, 2].map(|i| place[i] + share(weight) * corner[i])
            });
            self.coordinates.extend(&place[..self.coarse.dimension]);
        }
        number
    }
}

/// Moves inner vertices along each of the `axes` by at most `amplitude` times the smallest altitude of the
/// cells around: below 1/√8 no triangle turns over.
fn perturb(mesh: &mut Mesh, amplitude: f64, seed: u64, axes: [bool; 3]) {
    let mut room = vec![f64::INFINITY; mesh.vertices()];
    for c in 0..mesh.cell_count() {
        let altitude = mesh.smallest_altitude(c);
        for &v in mesh.cell(c) {
            room[v as usize] = room[v as usize].min(altitude);
        }
    }
    mesh.facets.iter().for_each(|&v| room[v as usize] = 0.0);
    let mut state = seed;
    for (vertex, room) in mesh.coordinates.chunks_exact_mut(mesh.dimension).zip(room) {
        if room == 0.0 {
            continue;
        }
        for (value, moved) in vertex.iter_mut().zip(axes) {
            let by = amplitude * room * signed_unit(&mut state);
            *value += if moved { by } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangulate;

    fn l_shape() -> CoarseMesh {
        let vertices = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let names = (1..7).map(|i| format!("s{i}")).collect();
        let triangles = triangulate(&vertices).unwrap();
        let polygon = CoarseMesh::polygon(&vertices, &triangles, &[0, 1, 2, 3, 4, 5], names);
        let count = triangles.len() as u32;
        let regions = (0..count).map(|t| format!("r{t}")).collect();
        CoarseMesh { region: (0..count).collect(), regions, ..polygon.unwrap() }
    }

    fn area(mesh: &Mesh, c: usize) -> f64 {
        let [p, q, r] = [0, 1, 2].map(|a| mesh.vertex(mesh.cell(c)[a]));
        0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))
    }

    const FAMILIES: [Family; 3] = [
        Family::Structured,
        Family::Perturbed { amplitude: 0.24, seed: 5, axes: [true; 3] },
        Family::Graded { corner: [1.0, 1.0], exponent: 2.5 },
    ];

    #[test]
    fn cells_tile_the_polygon_and_meet_edge_to_edge() {
        for family in FAMILIES {
            for n in [1, 2, 3, 5] {
                let mesh = &l_shape().refined(n, family);
                let areas: Vec<f64> = (0..mesh.cell_count()).map(|c| area(mesh, c)).collect();
                assert!(areas.iter().all(|a| *a > 0.0), "{family:?} {n}");
                // 100 roundings of numbers up to 3.
                assert!((areas.iter().sum::<f64>() - 3.0).abs() < 1e-13);
                // Euler: V - E + C = 1, and E = (3C + boundary)/2.
                let (cells, boundary) = (mesh.cell_count(), mesh.facet_side.len());
                assert_eq!(mesh.vertices() + cells, 1 + (3 * cells + boundary) / 2);
                assert_eq!(boundary, 6 * n as usize);
                assert_eq!(mesh.cell_region.iter().filter(|r| **r == 3).count() as u32, n * n);
            }
        }
    }

    #[test]
    fn congruent_cells_have_the_nominal_size() {
        let coarse = l_shape();
        let mesh = &coarse.refined(4, Family::Structured);
        for c in 0..mesh.cell_count() {
            let expected = coarse.measure_of(c / 16) / 16.0;
            assert!((area(mesh, c) - expected).abs() < 1e-15);
        }
        assert_eq!(mesh.h(), coarse.longest_edge() / 4.0);
        assert!((mesh.quality().longest - mesh.h()).abs() < 1e-14);
    }

    #[test]
    fn normals_point_outward_and_facets_follow_their_edge() {
        let mesh = &l_shape().refined(3, Family::Structured);
        for f in 0..mesh.facet_side.len() {
            let ends = mesh.facet(f).to_vec();
            let owner =
                (0..mesh.cell_count()).find(|&c| ends.iter().all(|v| mesh.cell(c).contains(v)));
            let third = [1.0 / 3.0; 3];
            let inside = mesh.point(mesh.cell(owner.unwrap()), &third);
            let middle = mesh.point(&ends, &[0.5, 0.5]);
            let normal = mesh.normal(f);
            let out: f64 = (0..2).map(|i| normal[i] * (middle[i] - inside[i])).sum();
            let [p, q] = [mesh.vertex(ends[0]), mesh.vertex(ends[1])];
            let along = normal[0] * (q[0] - p[0]) + normal[1] * (q[1] - p[1]);
            assert!(out > 0.1 && along.abs() < 1e-15, "facet {f}");
        }
    }
}
