//! Uniform refinement: each coarse triangle into n² congruent ones, n parts per edge.
//!
//! The cells of a coarse triangle stand together, those of the strip along its first edge first; the
//! facets of a coarse boundary edge stand together as well, from its first end to its second. So meshes
//! n and m of one coarse triangulation nest if n divides m.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{Coarse, Family, Mesh, grading};
use algebra::linalg::signed_unit;

/// The coarse vertices of each vertex: one twice if it is that vertex, or the ends of the edge it halves.
pub type Parents = Vec<[u32; 2]>;

/// The mesh with n parts of every edge of `coarse`.
pub fn refined(coarse: &Arc<Coarse>, n: u32, family: Family) -> Mesh {
    let mut vertices = Vertices::new(coarse, n);
    let mut cells = Vec::with_capacity(3 * coarse.triangles.len() * (n * n) as usize);
    for triangle in 0..coarse.triangles.len() {
        let number = vertices.of_triangle(triangle);
        for j in 0..n {
            for i in 0..n - j {
                cells.extend([number(i, j), number(i + 1, j), number(i, j + 1)]);
                if i + j + 2 <= n {
                    cells.extend([number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
                }
            }
        }
    }
    let (mut facets, mut facet_side, mut facet_normal) = (Vec::new(), Vec::new(), Vec::new());
    for edge in &coarse.edges {
        let (_, normal) = coarse.segment(edge);
        for s in 0..n {
            facets.extend([vertices.on_edge(edge.ends, s), vertices.on_edge(edge.ends, s + 1)]);
            facet_side.push(edge.side);
            facet_normal.extend(normal);
        }
    }
    let each = |&region: &u32| std::iter::repeat_n(region, (n * n) as usize);
    let mut mesh = Mesh {
        dimension: 2,
        n,
        h: coarse.longest_edge() / f64::from(n),
        coordinates: vertices.coordinates,
        cells,
        cell_region: coarse.region.iter().flat_map(each).collect(),
        regions: coarse.regions.clone(),
        facets,
        facet_side,
        facet_normal,
        sides: coarse.sides.clone(),
    };
    match family {
        Family::Structured => {}
        Family::Perturbed { amplitude, seed, axes } => {
            perturb(&mut mesh, amplitude, seed, axes);
        }
        Family::Graded { corner, exponent } => {
            let number =
                |t: usize, i, j| vertices.numbers[t][row_start(n, j) + i as usize] as usize;
            grading::towards(coarse, n, corner, exponent, number, &mut mesh.coordinates);
        }
    }
    mesh
}

/// The vertices of mesh n/2 of which each vertex of mesh n is one, or halves the edge between two.
pub(super) fn parents(coarse: &Arc<Coarse>, n: u32) -> Parents {
    let (mut fine, mut half) = (Vertices::new(coarse, n), Vertices::new(coarse, n / 2));
    let mut parents = vec![[0; 2]; fine.count() as usize];
    for triangle in 0..coarse.triangles.len() {
        let (number, of_half) = (fine.of_triangle(triangle), half.of_triangle(triangle));
        for j in 0..=n {
            for i in 0..=n - j {
                // Edges run along i, along j, and where i + j does not change.
                let (low, high) = (i / 2, i.div_ceil(2));
                parents[number(i, j) as usize] =
                    [of_half(high, j / 2), of_half(low, j.div_ceil(2))];
            }
        }
    }
    parents
}

/// The vertices of a refined mesh.
struct Vertices {
    n: u32,
    coordinates: Vec<f64>,
    /// First inner vertex of each coarse edge, by its ends in order.
    first: BTreeMap<[u32; 2], u32>,
    /// Numbers by triangle, rows j of i = 0..=n - j.
    numbers: Vec<Vec<u32>>,
}

impl Vertices {
    fn new(coarse: &Coarse, n: u32) -> Self {
        let coordinates = coarse.vertices.iter().flatten().copied().collect();
        let mut vertices = Self { n, coordinates, first: BTreeMap::new(), numbers: Vec::new() };
        let share = |i: u32| f64::from(i) / f64::from(n);
        for triangle in &coarse.triangles {
            for i in 0..3 {
                let mut ends = [triangle[i], triangle[(i + 1) % 3]];
                ends.sort_unstable();
                if vertices.first.contains_key(&ends) {
                    continue;
                }
                vertices.first.insert(ends, vertices.count());
                let [a, b] = ends.map(|v| coarse.vertices[v as usize]);
                for s in 1..n {
                    let at = |i: usize| share(n - s) * a[i] + share(s) * b[i];
                    vertices.coordinates.extend([at(0), at(1)]);
                }
            }
        }
        for (t, &[a, b, c]) in coarse.triangles.iter().enumerate() {
            let corners = coarse.corners(t);
            let mut numbers = Vec::with_capacity(((n + 1) * (n + 2) / 2) as usize);
            for j in 0..=n {
                for i in 0..=n - j {
                    numbers.push(if j == 0 {
                        vertices.on_edge([a, b], i)
                    } else if i == 0 {
                        vertices.on_edge([a, c], j)
                    } else if i + j == n {
                        vertices.on_edge([b, c], j)
                    } else {
                        let weights = [n - i - j, i, j].map(share);
                        let at = |axis: usize| -> f64 {
                            (0..3).map(|corner| weights[corner] * corners[corner][axis]).sum()
                        };
                        vertices.coordinates.extend([at(0), at(1)]);
                        vertices.count() - 1
                    });
                }
            }
            vertices.numbers.push(numbers);
        }
        vertices
    }

    fn count(&self) -> u32 {
        (self.coordinates.len() / 2) as u32
    }

    /// Vertex s of the n + 1 on the coarse edge from `ends[0]` to `ends[1]`.
    fn on_edge(&self, ends: [u32; 2], s: u32) -> u32 {
        if s == 0 {
            return ends[0];
        }
        if s == self.n {
            return ends[1];
        }
        match ends[0] < ends[1] {
            true => self.first[&ends] + s - 1,
            false => self.first[&[ends[1], ends[0]]] + self.n - s - 1,
        }
    }

    /// The vertex numbers of a coarse triangle by i and j.
    fn of_triangle(&mut self, t: usize) -> impl Fn(u32, u32) -> u32 + use<> {
        let (n, numbers) = (self.n, self.numbers[t].clone());
        move |i, j| numbers[row_start(n, j) + i as usize]
    }
}

/// Position of row j in the numbers of a triangle.
fn row_start(n: u32, j: u32) -> usize {
    (j * (n + 1) - j * (j.max(1) - 1) / 2) as usize
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
    for (v, room) in room.into_iter().enumerate().filter(|(_, room)| *room > 0.0) {
        for (value, moved) in mesh.coordinates[2 * v..2 * v + 2].iter_mut().zip(axes) {
            let by = amplitude * room * signed_unit(&mut state);
            *value += if moved { by } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BoundaryEdge, triangulate};

    fn l_shape() -> Arc<Coarse> {
        let vertices = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let triangles = triangulate(&vertices).unwrap();
        let edges = (0..6).map(|i| BoundaryEdge { ends: [i, (i + 1) % 6], side: i }).collect();
        let coarse = Coarse {
            region: (0..triangles.len() as u32).collect(),
            regions: (0..triangles.len()).map(|t| format!("r{t}")).collect(),
            vertices,
            triangles,
            edges,
            sides: (1..7).map(|i| format!("s{i}")).collect(),
        };
        Arc::new(coarse.checked().unwrap())
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
                let mesh = refined(&l_shape(), n, family);
                let areas: Vec<f64> = (0..mesh.cell_count()).map(|c| area(&mesh, c)).collect();
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
        let mesh = refined(&coarse, 4, Family::Structured);
        for c in 0..mesh.cell_count() {
            let expected = coarse.area(c / 16) / 16.0;
            assert!((area(&mesh, c) - expected).abs() < 1e-15);
        }
        assert_eq!(mesh.h(), coarse.longest_edge() / 4.0);
        assert!((mesh.quality().longest - mesh.h()).abs() < 1e-14);
    }

    #[test]
    fn normals_point_outward_and_facets_follow_their_edge() {
        let mesh = refined(&l_shape(), 3, Family::Structured);
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
