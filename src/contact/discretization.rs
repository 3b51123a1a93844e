//! All that depends on the mesh alone and is shared by the cases on it.

use crate::law::Stiffness;
use crate::linalg::{Analysis, BlockPattern, FactorError, nested_dissection};
use crate::mesh::Mesh;
use crate::space::{Geometry, Nodes};

use super::{ContactTrace, Frames, stiffness_of};

/// V^h on one mesh: nodes, geometry, matrix pattern with its analysis, the trace on Γ3.
#[derive(Debug)]
pub struct Discretization {
    /// The mesh.
    pub mesh: Mesh,
    /// Node numbers, clamped nodes last.
    pub nodes: Nodes,
    /// Shape gradients and measures.
    pub geometry: Geometry,
    /// Pattern of the tangent.
    pub pattern: BlockPattern,
    /// Its symbolic factorization.
    pub analysis: Analysis,
    /// Γ3.
    pub trace: ContactTrace,
    /// Unknowns of the vertices of Γ3 whose normals are no axes.
    pub frames: Frames,
    /// The region of each cell, region 0 being what belongs to no named one; empty if there are none.
    pub regions: Vec<u8>,
}

impl Discretization {
    /// Discretizes `mesh` with displacements fixed on the sides `clamped` and Γ3 on `contact`.
    ///
    /// # Errors
    /// The symbolic factorization's.
    pub fn new(mesh: Mesh, clamped: &[u32], contact: &[u32]) -> Result<Self, FactorError> {
        let nodes = Nodes::new(&mesh, clamped);
        let geometry = Geometry::new(&mesh);
        let pattern = BlockPattern::new(&nodes.cells, mesh.dimension, nodes.free);
        let coordinates: Vec<f64> =
            nodes.vertex[..nodes.free].iter().flat_map(|&v| mesh.vertex(v).to_vec()).collect();
        let (trace, frames) = ContactTrace::new(&mesh, &nodes, contact);
        // The unknowns of Γ3 come last: a factor then condenses onto them.
        let order = nested_dissection(&pattern, &coordinates, &trace.unknowns());
        let analysis = Analysis::new(&pattern, &order)?;
        Ok(Self { mesh, nodes, geometry, pattern, analysis, trace, frames, regions: Vec::new() })
    }

    /// Number of unknowns.
    pub fn dofs(&self) -> usize {
        self.nodes.dofs()
    }

    /// The region of cell c.
    #[inline]
    pub fn region(&self, c: usize) -> usize {
        self.regions.get(c).map_or(0, |&region| usize::from(region))
    }

    /// Nodes of cell c.
    #[inline]
    pub fn cell_nodes(&self, c: usize) -> &[u32] {
        let stride = self.mesh.dimension + 1;
        &self.nodes.cells[stride * c..stride * (c + 1)]
    }

    /// Lower-triangle values of the stiffness matrix of a tensor, in Cartesian components.
    pub fn stiffness(&self, law: &impl Stiffness) -> Vec<f64> {
        self.stiffness_in(law, &Frames::default())
    }

    /// The same on the unknowns of the contact problem.
    pub fn stiffness_of_unknowns(&self, law: &impl Stiffness) -> Vec<f64> {
        self.stiffness_in(law, &self.frames)
    }

    fn stiffness_in(&self, law: &impl Stiffness, frames: &Frames) -> Vec<f64> {
        let mut values = vec![0.0; self.pattern.entries()];
        match self.mesh.dimension {
            2 => stiffness_of::<2, 3>(self, frames, law, &mut values),
            _ => stiffness_of::<3, 6>(self, frames, law, &mut values),
        }
        values
    }
}
