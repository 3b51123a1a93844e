//! All that depends on the mesh alone and is shared by the cases on it.

use std::sync::OnceLock;

use crate::law::Stiffness;
use crate::linalg::{Analysis, BlockPattern, FactorError, Levels, nested_dissection};
use crate::mesh::{Mesh, Nesting};
use crate::space::{Geometry, Nodes};

use super::linear_solver::levels;
use super::{ContactTrace, Frames, LinearSolver, stiffness_of};

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
    /// The coarser mesh that the mesh refines, if it is known.
    pub nesting: Nesting,
    /// The linear solver of runs on this mesh, where it is not left to [`LinearSolver::of`].
    pub linear_solver: Option<LinearSolver>,
    levels: OnceLock<Result<Option<Levels>, FactorError>>,
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
        let (regions, nesting, linear_solver) = (Vec::new(), Nesting::Unknown, None);
        let levels = OnceLock::new();
        Ok(Self {
            mesh,
            nodes,
            geometry,
            pattern,
            analysis,
            trace,
            frames,
            regions,
            nesting,
            linear_solver,
            levels,
        })
    }

    /// Patterns and transfers of coarser meshes, made when they are first asked for; none where the mesh refines
    /// nothing that is known, or their analysis fails.
    pub fn levels(&self) -> Option<&Levels> {
        self.levels.get_or_init(|| levels(self, &self.nesting)).as_ref().ok()?.as_ref()
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
