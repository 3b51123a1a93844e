//! The edges of a triangulation, as the nodes of CR: those on Γ1 come last and have no unknowns.

use algebra::linalg::BlockPattern;
use fem::contact::Discretization;
use fem::mesh::Mesh;
use fem::space::{Element, Nodes};

/// Edges, four unknowns each: two components at each of its ends, that with the smaller number first.
pub(super) struct Edges {
    /// With the middles of edges among its vertices.
    mesh: Mesh,
    nodes: Nodes,
}

/// The edges of a triangle in the order of the nodes of CR, by the corners opposite to them.
const OPPOSITE: [usize; 3] = [2, 0, 1];

impl Edges {
    /// The edges of a mesh of triangles; those on the sides `clamped` have no unknowns.
    pub(super) fn new(space: &Discretization, clamped: &[u32]) -> Self {
        let mut mesh = space.mesh.clone();
        let nodes = Nodes::new(&mut mesh, Element::CR, clamped);
        Self { mesh, nodes }
    }

    /// How many are not on Γ1.
    pub(super) fn free(&self) -> usize {
        self.nodes.free
    }

    /// The free edges of a cell, each with the corner opposite to it.
    pub(super) fn of_cell(&self, c: usize) -> impl Iterator<Item = (usize, u32)> {
        let all = OPPOSITE.into_iter().zip(self.nodes.of_cell(c).iter().copied());
        all.filter(|(_, edge)| (*edge as usize) < self.nodes.free)
    }

    /// The free edge on a boundary facet, with its ends in the order of its unknowns.
    pub(super) fn on_facet(&self, facet: usize) -> Option<(u32, [u32; 2])> {
        let middle = self.nodes.on_facet(facet)[0];
        let edge = self.nodes.of_vertex[middle as usize];
        let ends = self.mesh.facet(facet);
        let sorted = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        ((edge as usize) < self.nodes.free).then_some((edge, sorted))
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
        BlockPattern::new(&self.nodes.cells, 3, 4, self.nodes.free)
    }

    /// A place of each free edge, in as many numbers as it has unknowns.
    pub(super) fn places(&self) -> Vec<f64> {
        let free = &self.nodes.vertex[..self.nodes.free];
        free.iter().flat_map(|&v| [self.mesh.vertex(v), &[0.0; 2]].concat()).collect()
    }
}
