//! All that depends on the mesh alone and is shared by the cases on it.

use std::sync::OnceLock;

use crate::mesh::{Mesh, Nesting};
use crate::space::{Element, Geometry, Nodes, StrainPoint, StrainPoints};
use algebra::linalg::{
    Analysis, BlockPattern, FactorError, Levels, MultigridSequence, NodeFrame, Precision,
    SequenceSolver, TangentSolver, nested_dissection,
};

use super::held_factors::StiffnessFactors;
use super::{ContactTrace, Frames, LinearSolver};

/// Levels are added until this many unknowns are left: their factor costs less than a sweep of the next level.
const COARSEST: usize = 1_000;
/// With more unknowns than this on the coarsest level its factor is no small matter, and a mesh has no use for levels.
const LARGEST_COARSEST: usize = 8_000;

/// V^h on one mesh: nodes, geometry, matrix pattern, the trace on Γ3. What is dear and not always asked for, such as the
/// symbolic factorization, is made at its first use.
#[derive(Debug)]
pub struct Discretization {
    /// The element of displacements.
    pub element: Element,
    /// The mesh.
    pub mesh: Mesh,
    /// Node numbers, clamped nodes last.
    pub nodes: Nodes,
    /// Shape gradients at the points of strains, and measures.
    pub geometry: Geometry,
    /// Pattern of the tangent.
    pub pattern: BlockPattern,
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
    /// The precision of factors that serve several Jacobians, where it is not left to their size.
    pub precision: Option<Precision>,
    analysis: OnceLock<Result<Analysis, FactorError>>,
    levels: OnceLock<Result<Option<Levels>, FactorError>>,
    condensing: OnceLock<Result<Analysis, FactorError>>,
    pub(super) factors: StiffnessFactors,
}

impl Discretization {
    /// Discretizes `mesh` by linear elements, with displacements fixed on the sides `clamped` and Γ3 on `contact`.
    pub fn new(mesh: Mesh, clamped: &[u32], contact: &[u32]) -> Self {
        Self::of(Element::P1, mesh, clamped, contact)
    }

    /// Discretizes `mesh` by any element.
    pub fn of(element: Element, mut mesh: Mesh, clamped: &[u32], contact: &[u32]) -> Self {
        let nodes = Nodes::new(&mut mesh, element, clamped);
        let geometry = Geometry::new(&mesh, element);
        let pattern = BlockPattern::new(&nodes.cells, nodes.a_cell, mesh.dimension, nodes.free);
        let (trace, frames) = ContactTrace::new(&mesh, element, &nodes, contact);
        Self {
            element,
            mesh,
            nodes,
            geometry,
            pattern,
            trace,
            frames,
            regions: Vec::new(),
            nesting: Nesting::Unknown,
            linear_solver: None,
            precision: None,
            analysis: OnceLock::new(),
            levels: OnceLock::new(),
            condensing: OnceLock::new(),
            factors: StiffnessFactors::default(),
        }
    }

    /// The symbolic factorization of the pattern, in the order of nested dissection.
    ///
    /// # Errors
    /// Memory or the range of indices does not reach.
    pub fn analysis(&self) -> Result<&Analysis, FactorError> {
        let known = self.analysis.get_or_init(|| self.analysis_with_last(&[]));
        known.as_ref().map_err(Clone::clone)
    }

    /// The symbolic factorization with the unknowns of Γ3 last, whose factors condense onto them. In the plane it has
    /// some 8 % more fill than [`Self::analysis`].
    ///
    /// # Errors
    /// As [`Self::analysis`].
    pub(crate) fn condensing(&self) -> Result<&Analysis, FactorError> {
        let last = || self.analysis_with_last(&self.trace.unknowns());
        self.condensing.get_or_init(last).as_ref().map_err(Clone::clone)
    }

    /// The analysis of the pattern with the unknowns `last` behind all others.
    fn analysis_with_last(&self, last: &[u32]) -> Result<Analysis, FactorError> {
        let coordinates = self.coordinates();
        Analysis::new(&self.pattern, &nested_dissection(&self.pattern, &coordinates, last))
    }

    /// Those of the free nodes.
    fn coordinates(&self) -> Vec<f64> {
        let free = self.nodes.vertex[..self.nodes.free].iter();
        free.flat_map(|&v| self.mesh.vertex(v)).copied().collect()
    }

    /// Entries of a factor in the order of [`Self::analysis`], and multiplications that it takes; infinite where the
    /// pattern cannot be analysed.
    pub fn factor_size(&self) -> [f64; 2] {
        let size =
            |analysis: &Analysis| [analysis.factor_entries() as f64, analysis.multiplications()];
        self.analysis().map_or([f64::INFINITY; 2], size)
    }

    /// Patterns and transfers of coarser meshes, made when they are first asked for; none where the mesh refines
    /// nothing that is known, its element is not linear, or their analysis fails.
    pub fn levels(&self) -> Option<&Levels> {
        self.levels.get_or_init(|| self.find_levels()).as_ref().ok()?.as_ref()
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
        self.nodes.of_cell(c)
    }

    /// The values of a nodal vector at the vertices of the mesh, d numbers each.
    pub fn at_vertices(&self, v: &[f64]) -> Vec<f64> {
        let d = self.mesh.dimension;
        let of_node = |&node: &u32| &v[d * node as usize..d * (node as usize + 1)];
        self.nodes.of_vertex.iter().flat_map(of_node).copied().collect()
    }

    /// The points where strain, stress and projection live.
    #[inline]
    pub fn points(&self) -> StrainPoints<'_> {
        StrainPoints::new(&self.geometry, &self.nodes)
    }

    /// The strain points of cell c.
    pub fn points_of(&self, c: usize) -> impl Iterator<Item = StrainPoint<'_>> {
        StrainPoints::from_cell(&self.geometry, &self.nodes, c).take(self.geometry.shares.len())
    }

    /// A solver of Jacobians of runs by `solver`: factors where the mesh has no levels.
    ///
    /// # Errors
    /// The pattern cannot be analysed.
    pub(crate) fn tangent_solver(
        &self,
        solver: LinearSolver,
    ) -> Result<Box<dyn TangentSolver + '_>, FactorError> {
        Ok(match self.levels_of(solver) {
            Some(levels) => Box::new(MultigridSequence::new(levels, &self.pattern)),
            None => {
                let solver = SequenceSolver::new(self.analysis()?, &self.pattern);
                Box::new(solver.in_precision(self.precision))
            }
        })
    }

    pub(super) fn levels_of(&self, solver: LinearSolver) -> Option<&Levels> {
        match solver {
            LinearSolver::Multigrid => self.levels(),
            LinearSolver::Direct => None,
        }
    }

    /// The levels below the mesh; none where it refines nothing, or not often enough.
    ///
    /// # Errors
    /// The analysis of the coarsest matrix.
    fn find_levels(&self) -> Result<Option<Levels>, FactorError> {
        // Transfers are those of linear functions.
        if self.element != Element::P1 {
            return Ok(None);
        }
        let d = self.mesh.dimension;
        let (mut parents, mut nesting) = (Vec::new(), self.nesting.clone());
        let mut unknowns = self.dofs();
        while unknowns > COARSEST
            && let Some((next, coarser)) = nesting.coarsened()
        {
            unknowns = d * next.iter().flatten().max().map_or(0, |&last| last as usize + 1);
            parents.push(next);
            nesting = coarser;
        }
        let coordinates = self.coordinates();
        let frames = self.frames.rows();
        let frames = frames.map(|(node, rows)| NodeFrame { node, rows }).collect();
        let levels =
            Levels::new(&self.pattern, &self.nodes.of_vertex, &parents, &coordinates, frames)?;
        Ok(levels.filter(|levels| levels.coarsest_unknowns() <= LARGEST_COARSEST))
    }
}
