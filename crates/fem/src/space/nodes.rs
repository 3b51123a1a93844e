//! Numbering of the nodes of V^h: free nodes first, clamped nodes (Γ1) last, so that a vector of
//! unknowns is a prefix of a nodal vector whose tail stays zero.

use super::element::{Element, Places};
use crate::mesh::Mesh;

/// Node numbers of the points of a mesh: its vertices, and midpoints of edges where the element has nodes there.
#[derive(Debug, Clone)]
pub struct Nodes {
    /// Components per node: the space dimension d.
    pub dimension: usize,
    /// Number of nodes that are not clamped.
    pub free: usize,
    /// Node of a vertex.
    pub of_vertex: Vec<u32>,
    /// Vertex of a node.
    pub vertex: Vec<u32>,
    /// Cells by node numbers.
    pub cells: Vec<u32>,
    /// Nodes a cell.
    pub a_cell: usize,
    /// Boundary facets by vertices, midpoints among them.
    facets: Vec<u32>,
    /// Nodes a boundary facet.
    pub a_facet: usize,
}

impl Nodes {
    /// Numbers the points of `mesh` at which the element has nodes; those of a facet on a side in `clamped` come last.
    pub fn new(mesh: &mut Mesh, element: Element, clamped: &[u32]) -> Self {
        let Places { cells, facets } = element.places(mesh);
        let d = mesh.dimension;
        let [a_cell, a_facet] = [d + 1, d].map(|corners| element.nodes(corners).len());
        let mut is_clamped = vec![false; mesh.vertices()];
        for f in mesh.facets_on(clamped) {
            for &v in &facets[a_facet * f..a_facet * (f + 1)] {
                is_clamped[v as usize] = true;
            }
        }
        let vertices = 0..mesh.vertices() as u32;
        let mut vertex: Vec<u32> = vertices.clone().filter(|&v| !is_clamped[v as usize]).collect();
        let free = vertex.len();
        vertex.extend(vertices.filter(|&v| is_clamped[v as usize]));
        let mut of_vertex = vec![0; mesh.vertices()];
        for (node, &v) in vertex.iter().enumerate() {
            of_vertex[v as usize] = node as u32;
        }
        let cells = cells.iter().map(|&v| of_vertex[v as usize]).collect();
        Self { dimension: d, free, of_vertex, vertex, cells, a_cell, facets, a_facet }
    }

    /// Nodes of cell c.
    #[inline]
    pub fn of_cell(&self, c: usize) -> &[u32] {
        &self.cells[self.a_cell * c..self.a_cell * (c + 1)]
    }

    /// The vertices of boundary facet f at which there are nodes.
    pub fn on_facet(&self, f: usize) -> &[u32] {
        &self.facets[self.a_facet * f..self.a_facet * (f + 1)]
    }

    /// Number of unknowns, d a free node.
    pub(crate) fn dofs(&self) -> usize {
        self.dimension * self.free
    }

    /// Length of a nodal vector, clamped nodes included.
    pub fn len(&self) -> usize {
        self.dimension * self.vertex.len()
    }

    /// True for a mesh without vertices.
    pub fn is_empty(&self) -> bool {
        self.vertex.is_empty()
    }
}
