//! All that depends on the mesh alone and is shared by the cases on it.

use std::sync::OnceLock;

use crate::mesh::{Mesh, Nesting};
use crate::space::{Element, Geometry, Jump, Nodes, StrainPoint, StrainPoints, jumps};
use algebra::linalg::{Analysis, BlockPattern, FactorError, Levels, Precision, nested_dissection};
use vhi::law::TensorField;

use super::linear_solver::levels;
use super::stiffness::StiffnessFactors;
use super::{ContactTrace, Frames, LinearSolver, stiffness_of};

/// V^h on one mesh: nodes, geometry, matrix pattern with its analysis, the trace on Γ3.
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
    /// Where functions jump; empty for continuous elements.
    pub jumps: Vec<Jump>,
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
    /// The precision of factors that serve several Jacobians, where it is not left to their size.
    pub precision: Option<Precision>,
    levels: OnceLock<Result<Option<Levels>, FactorError>>,
    condensing: OnceLock<Result<Analysis, FactorError>>,
    pub(super) factors: StiffnessFactors,
}

impl Discretization {
    /// Discretizes `mesh` by linear elements, with displacements fixed on the sides `clamped` and Γ3 on `contact`.
    ///
    /// # Errors
    /// The symbolic factorization's.
    pub fn new(mesh: Mesh, clamped: &[u32], contact: &[u32]) -> Result<Self, FactorError> {
        Self::of(Element::P1, mesh, clamped, contact)
    }

    /// The same by any element.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of(
        element: Element,
        mut mesh: Mesh,
        clamped: &[u32],
        contact: &[u32],
    ) -> Result<Self, FactorError> {
        let nodes = Nodes::new(&mut mesh, element, clamped);
        let geometry = Geometry::new(&mesh, element);
        let jumps = jumps(&mesh, element, &nodes);
        let beside = jumps.iter().map(|jump| &jump.nodes[..]);
        let (d, free) = (mesh.dimension, nodes.free);
        let pattern = BlockPattern::coupled(&nodes.cells, nodes.a_cell, d, free, beside);
        let (trace, frames) = ContactTrace::new(&mesh, element, &nodes, contact);
        let analysis = analysis(&mesh, &nodes, &pattern, &[])?;
        let (regions, nesting, linear_solver) = (Vec::new(), Nesting::Unknown, None);
        let (levels, condensing) = (OnceLock::new(), OnceLock::new());
        Ok(Self {
            element,
            mesh,
            nodes,
            geometry,
            jumps,
            pattern,
            analysis,
            trace,
            frames,
            regions,
            nesting,
            linear_solver,
            precision: None,
            levels,
            condensing,
            factors: StiffnessFactors::default(),
        })
    }

    /// The symbolic factorization with the unknowns of Γ3 last, whose factors condense onto them; made when it is
    /// first asked for. In the plane it has some 8 % more fill than [`Self::analysis`].
    ///
    /// # Errors
    /// The matrix cannot be ordered.
    pub(crate) fn condensing(&self) -> Result<&Analysis, FactorError> {
        let last = || analysis(&self.mesh, &self.nodes, &self.pattern, &self.trace.unknowns());
        self.condensing.get_or_init(last).as_ref().map_err(Clone::clone)
    }

    /// Patterns and transfers of coarser meshes, made when they are first asked for; none where the mesh refines
    /// nothing that is known, its element is not linear, or their analysis fails.
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
        self.nodes.of_cell(c)
    }

    /// The values of a nodal vector at the vertices of the mesh, d numbers each: at a vertex without a node the mean of those
    /// that the cells around it have there.
    pub fn at_vertices(&self, v: &[f64]) -> Vec<f64> {
        let (d, mesh) = (self.mesh.dimension, &self.mesh);
        let (mut values, mut count) = (vec![0.0; d * mesh.vertices()], vec![0.0; mesh.vertices()]);
        for (vertex, &node) in self.nodes.of_vertex.iter().enumerate() {
            if node != Nodes::NONE {
                let own = &v[d * node as usize..d * (node as usize + 1)];
                values[d * vertex..d * (vertex + 1)].copy_from_slice(own);
            }
        }
        let bare = |vertex: usize| self.nodes.of_vertex[vertex] == Nodes::NONE;
        for (c, corner) in (0..mesh.cell_count()).flat_map(|c| (0..=d).map(move |a| (c, a))) {
            let vertex = mesh.cell(c)[corner] as usize;
            if !bare(vertex) {
                continue;
            }
            let b: Vec<f64> = (0..=d).map(|a| f64::from(u8::from(a == corner))).collect();
            count[vertex] += 1.0;
            for (&node, shape) in self.cell_nodes(c).iter().zip(self.element.values(&b)) {
                (0..d).for_each(|i| values[d * vertex + i] += shape * v[d * node as usize + i]);
            }
        }
        for vertex in (0..mesh.vertices()).filter(|&vertex| bare(vertex)) {
            (0..d).for_each(|i| values[d * vertex + i] /= count[vertex]);
        }
        values
    }

    /// The points where strain, stress and projection live.
    #[inline]
    pub fn points(&self) -> StrainPoints<'_> {
        StrainPoints::new(&self.geometry, &self.nodes)
    }

    /// Those of cell c.
    pub fn points_of(&self, c: usize) -> impl Iterator<Item = StrainPoint<'_>> {
        StrainPoints::from_cell(&self.geometry, &self.nodes, c).take(self.geometry.shares.len())
    }

    /// Lower-triangle values of the stiffness matrix of a tensor, in Cartesian components, with the penalty of jumps.
    pub fn stiffness(&self, law: &TensorField) -> Vec<f64> {
        self.stiffness_in(law, &Frames::default())
    }

    /// The same on the unknowns of the contact problem.
    pub(crate) fn stiffness_of_unknowns(&self, law: &TensorField) -> Vec<f64> {
        self.stiffness_in(law, &self.frames)
    }

    fn stiffness_in(&self, law: &TensorField, frames: &Frames) -> Vec<f64> {
        let mut values = vec![0.0; self.pattern.entries()];
        match self.mesh.dimension {
            2 => stiffness_of::<2, 3>(self, frames, law, &mut values),
            _ => stiffness_of::<3, 6>(self, frames, law, &mut values),
        }
        self.add_jump_stiffness(frames, law, &mut values);
        values
    }
}

/// The analysis of `pattern` in the order of nested dissection, the unknowns `last` behind all others.
fn analysis(
    mesh: &Mesh,
    nodes: &Nodes,
    pattern: &BlockPattern,
    last: &[u32],
) -> Result<Analysis, FactorError> {
    let free = nodes.vertex[..nodes.free].iter();
    let coordinates: Vec<f64> = free.flat_map(|&v| mesh.vertex(v).to_vec()).collect();
    Analysis::new(pattern, &nested_dissection(pattern, &coordinates, last))
}
