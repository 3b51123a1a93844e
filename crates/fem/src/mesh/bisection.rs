//! Coarse meshes made finer where it is asked for, by bisection of longest edges (M. C. Rivara, Int. J. Numer. Meth. Eng. 20
//! (1984)): no angle becomes smaller than half of the smallest one before, and slivers become less so.

use std::collections::BTreeMap;

use super::geometry::{minus, norm};
use super::{BoundaryFacet, CoarseMesh};

type Edge = [u32; 2];

fn edge(a: u32, b: u32) -> Edge {
    [a.min(b), a.max(b)]
}

impl CoarseMesh {
    /// The mesh with the marked triangles bisected, and as many around them as it takes to meet edge to edge.
    #[must_use]
    pub fn bisected(&self, marked: &[bool]) -> Self {
        let mut middle: BTreeMap<Edge, u32> = BTreeMap::new();
        loop {
            let before = middle.len();
            for (cell, marked) in self.cells.iter().zip(marked) {
                if *marked || edges(cell).iter().any(|of| middle.contains_key(of)) {
                    middle.insert(self.longest_of(edges(cell)), 0);
                }
            }
            if middle.len() == before {
                break;
            }
        }
        let (cells, facets) = (Vec::new(), Vec::new());
        let mut finer = Self { cells, facets, region: Vec::new(), ..self.clone() };
        for (&[a, b], number) in &mut middle {
            *number = finer.vertices.len() as u32;
            let [p, q] = [a, b].map(|v| self.vertices[v as usize]);
            finer.vertices.push([0, 1, 2].map(|i| 0.5 * (p[i] + q[i])));
        }
        for (cell, &region) in self.cells.iter().zip(&self.region) {
            let mut whole = vec![cell.clone()];
            while let Some(cell) = whole.pop() {
                let cut: Vec<Edge> =
                    edges(&cell).into_iter().filter(|of| middle.contains_key(of)).collect();
                if cut.is_empty() {
                    finer.cells.push(cell);
                    finer.region.push(region);
                    continue;
                }
                let longest = self.longest_of(cut);
                // A half has the middle in place of one end.
                whole.extend(longest.map(|end| {
                    let half = |&v: &u32| if v == end { middle[&longest] } else { v };
                    cell.iter().map(half).collect()
                }));
            }
        }
        for facet in &self.facets {
            let [a, b] = [facet.corners[0], facet.corners[1]];
            let parts = match middle.get(&edge(a, b)) {
                Some(&m) => vec![vec![a, m], vec![m, b]],
                None => vec![vec![a, b]],
            };
            let part = |corners| BoundaryFacet { corners, ..facet.clone() };
            finer.facets.extend(parts.into_iter().map(part));
        }
        finer
    }

    /// Of equally long edges the first by its vertices, whichever cell asks.
    fn longest_of(&self, edges: impl IntoIterator<Item = Edge>) -> Edge {
        let length =
            |[a, b]: Edge| norm(minus(self.vertices[a as usize], self.vertices[b as usize]));
        let longer = |p: &Edge, q: &Edge| length(*p).total_cmp(&length(*q)).then(q.cmp(p));
        edges.into_iter().max_by(longer).unwrap_or_default()
    }
}

fn edges(cell: &[u32]) -> [Edge; 3] {
    [edge(cell[0], cell[1]), edge(cell[1], cell[2]), edge(cell[2], cell[0])]
}

#[cfg(test)]
mod tests {
    use super::super::geometry::longest_edge;
    use super::super::triangulate;
    use super::*;

    /// A strip a hundred times as long as high, bisected towards a corner: it stays the strip, edge to edge, and its
    /// triangles do not become slivers.
    #[test]
    fn a_bisected_mesh_is_a_mesh_of_the_same_domain() {
        let vertices = [[0.0, 0.0], [100.0, 0.0], [100.0, 1.0], [0.0, 1.0]];
        let sides = ["bottom", "right", "top", "left"].map(str::to_string).into();
        let triangles = triangulate(&vertices).unwrap();
        let mut mesh = CoarseMesh::polygon(&vertices, &triangles, &[0, 1, 2, 3], sides).unwrap();
        for _ in 0..40 {
            let at_corner = |cell: &Vec<u32>| cell.contains(&2);
            let marked: Vec<bool> = mesh.cells.iter().map(at_corner).collect();
            mesh = mesh.bisected(&marked);
        }
        assert!((mesh.measure() - 100.0).abs() < 1e-11, "{}", mesh.measure());
        let count = mesh.count();
        let lengths = |side: u32| {
            let of_side = mesh.pieces().into_iter().filter(move |piece| piece.side == side);
            of_side.map(|piece| norm(minus(piece.corners[0], piece.corners[1]))).sum::<f64>()
        };
        assert!(
            [100.0, 1.0, 100.0, 1.0].iter().zip(0..).all(|(l, s)| (lengths(s) - l).abs() < 1e-11)
        );
        // No hanging vertex, no overlap, the boundary named as it was.
        let mesh = mesh.checked().unwrap();
        assert_eq!(mesh.count(), count);
        for c in 0..count {
            let longest = longest_edge(&mesh.corners(c));
            // 0.01 of the first triangles, whose angles are halved at most.
            assert!(mesh.measure_of(c) > 0.5 * 0.25 * 0.01 * longest * longest, "{longest}");
            assert!(longest < 1e-3 || !mesh.cells[c].contains(&2), "{longest}");
        }
    }
}
