//! The edges of a triangulation: those on Γ1 come last and have no unknowns.

use std::collections::HashMap;

use algebra::linalg::BlockPattern;
use fem::contact::Discretization;
use fem::mesh::Mesh;

/// Edges, four unknowns each: two components at each of its ends, that with the smaller number first.
pub(super) struct Edges {
    mesh: Mesh,
    /// The ends of each edge, the smaller number first.
    ends: Vec<[u32; 2]>,
    /// The edges of each cell, in the order of [`OPPOSITE`].
    cells: Vec<u32>,
    facets: Vec<u32>,
    free: usize,
}

/// The corners opposite to the edges 01, 12, 20 of a triangle.
const OPPOSITE: [usize; 3] = [2, 0, 1];

impl Edges {
    /// The edges of a mesh of triangles; those on the sides `clamped` have no unknowns.
    pub(super) fn new(space: &Discretization, clamped: &[u32]) -> Self {
        let mesh = space.mesh.clone();
        let (mut ends, mut known) = (Vec::new(), HashMap::new());
        let mut edge = |a: u32, b: u32| {
            let sorted = [a.min(b), a.max(b)];
            *known.entry(sorted).or_insert_with(|| {
                ends.push(sorted);
                ends.len() - 1
            })
        };
        let sides = |cell: &[u32]| [0, 1, 2].map(|a| [cell[a], cell[(a + 1) % 3]]);
        let cells: Vec<usize> = (0..mesh.cell_count())
            .flat_map(|c| sides(mesh.cell(c)))
            .map(|[a, b]| edge(a, b))
            .collect();
        let facets: Vec<usize> =
            mesh.facets.chunks_exact(2).map(|ends| edge(ends[0], ends[1])).collect();
        let mut is_clamped = vec![false; ends.len()];
        mesh.facets_on(clamped).for_each(|f| is_clamped[facets[f]] = true);
        let (free, held): (Vec<usize>, Vec<usize>) =
            (0..ends.len()).partition(|&edge| !is_clamped[edge]);
        let mut number = vec![0; ends.len()];
        let order = free.iter().chain(&held).copied();
        order.clone().enumerate().for_each(|(new, old)| number[old] = new as u32);
        Self {
            ends: order.map(|old| ends[old]).collect(),
            cells: cells.into_iter().map(|old| number[old]).collect(),
            facets: facets.into_iter().map(|old| number[old]).collect(),
            free: free.len(),
            mesh,
        }
    }

    /// How many are not on Γ1.
    pub(super) fn free(&self) -> usize {
        self.free
    }

    /// The free edges of a cell, each with the corner opposite to it.
    pub(super) fn of_cell(&self, c: usize) -> impl Iterator<Item = (usize, u32)> {
        let all = OPPOSITE.into_iter().zip(self.cells[3 * c..3 * (c + 1)].iter().copied());
        all.filter(|(_, edge)| (*edge as usize) < self.free)
    }

    /// The free edge on a boundary facet, with its ends in the order of its unknowns.
    pub(super) fn on_facet(&self, facet: usize) -> Option<(u32, [u32; 2])> {
        let edge = self.facets[facet];
        ((edge as usize) < self.free).then(|| (edge, self.ends[edge as usize]))
    }

    /// The unknowns of a cell's 12 tractions, `None` on Γ1: four for each edge, two at each of its ends.
    pub(super) fn unknowns(&self, c: usize) -> [Option<usize>; 12] {
        let (mut unknowns, cell) = ([None; 12], self.mesh.cell(c));
        for (s, edge) in self.of_cell(c) {
            let ends = [cell[(s + 1) % 3], cell[(s + 2) % 3]];
            for end in 0..2 {
                let second = usize::from(ends[end] > ends[1 - end]);
                for i in 0..2 {
                    unknowns[4 * s + 2 * end + i] = Some(4 * edge as usize + 2 * second + i);
                }
            }
        }
        unknowns
    }

    /// Edges of a cell couple.
    pub(super) fn pattern(&self) -> BlockPattern {
        BlockPattern::new(&self.cells, 3, 4, self.free)
    }

    /// The middle of each free edge, in as many numbers as it has unknowns.
    pub(super) fn places(&self) -> Vec<f64> {
        let middle = |ends: &[u32; 2]| {
            let [x, y, _] = self.mesh.point(ends, &[0.5, 0.5]);
            [x, y, 0.0, 0.0]
        };
        self.ends[..self.free].iter().flat_map(middle).collect()
    }
}
