//! Numbering of the nodes of V^h: free nodes first, clamped nodes (Γ1) last, so that a vector of
//! unknowns is a prefix of a nodal vector whose tail stays zero.

use crate::mesh::Mesh;

/// Node numbers of the vertices of a mesh.
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
    /// Cells by node numbers, d + 1 per cell.
    pub cells: Vec<u32>,
}

impl Nodes {
    /// Numbers the vertices of `mesh`; those of a facet on a side in `clamped` come last.
    pub(crate) fn new(mesh: &Mesh, clamped: &[u32]) -> Self {
        let mut is_clamped = vec![false; mesh.vertices()];
        for f in mesh.facets_on(clamped) {
            for &v in mesh.facet(f) {
                is_clamped[v as usize] = true;
            }
        }
        let vertices = 0..mesh.vertices() as u32;
        let mut vertex: Vec<u32> = vertices.clone().filter(|&v| !is_clamped[v as usize]).collect();
        let free = vertex.len();
        vertex.extend(vertices.filter(|&v| is_clamped[v as usize]));
        let mut of_vertex = vec![0; vertex.len()];
        for (node, &v) in vertex.iter().enumerate() {
            of_vertex[v as usize] = node as u32;
        }
        let cells = mesh.cells.iter().map(|&v| of_vertex[v as usize]).collect();
        Self { dimension: mesh.dimension, free, of_vertex, vertex, cells }
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
