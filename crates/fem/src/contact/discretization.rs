//! All that depends on the mesh alone and is shared by the cases on it.

use std::sync::{Mutex, OnceLock};

use crate::mesh::Mesh;
use crate::space::{Element, Geometry, Nodes, StrainPoint};
use algebra::linalg::{Analysis, BlockPattern, FactorError, nested_dissection};

use super::stiffness::{Order, StiffnessFactors};
use super::trace::{Support, supports};
use super::{ContactTrace, Frames};

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
    /// The conditions u·ν = 0 on planes of symmetry and of bilateral contact.
    pub supports: Vec<Support>,
    /// Unknowns of the vertices of Γ3, and of planes of symmetry, that are no Cartesian components, or held.
    pub frames: Frames,
    /// The region of each cell, region 0 being what belongs to no named one; empty if there are none.
    pub regions: Vec<u8>,
    /// By [`Order`].
    analyses: [OnceLock<Result<Analysis, FactorError>>; 2],
    pub(super) factors: Mutex<StiffnessFactors>,
}

impl Discretization {
    /// Discretizes `mesh` by linear elements, with displacements fixed on the sides `clamped` and Γ3 on `contact`.
    pub fn new(mesh: Mesh, clamped: &[u32], contact: &[u32]) -> Self {
        Self::of(Element::P1, mesh, clamped, contact)
    }

    /// Discretizes `mesh` by any element.
    pub fn of(element: Element, mesh: Mesh, clamped: &[u32], contact: &[u32]) -> Self {
        Self::with_symmetry(element, mesh, [clamped, &[], contact])
    }

    /// Discretizes `mesh` with u = 0 on the first of the sides, u_ν = 0 on the second, and Γ3 on the third; where sides
    /// of the first two meet, u = 0. A side of the second and third is one of bilateral contact.
    pub fn with_symmetry(
        element: Element,
        mut mesh: Mesh,
        [clamped, symmetry, contact]: [&[u32]; 3],
    ) -> Self {
        let nodes = Nodes::new(&mut mesh, element, clamped);
        let geometry = Geometry::new(&mesh, element);
        let pattern = BlockPattern::new(&nodes.cells, nodes.a_cell, mesh.dimension, nodes.free);
        let supports = supports(&mesh, &nodes, symmetry);
        let (trace, frames) = ContactTrace::new(&mesh, element, &nodes, contact, &supports);
        Self {
            element,
            mesh,
            nodes,
            geometry,
            pattern,
            trace,
            supports,
            frames,
            regions: Vec::new(),
            analyses: Default::default(),
            factors: Mutex::default(),
        }
    }

    /// The symbolic factorization of the pattern, in the order of nested dissection.
    ///
    /// # Errors
    /// Memory or the range of indices does not reach.
    pub fn analysis(&self) -> Result<&Analysis, FactorError> {
        self.analysis_in(Order::Usual)
    }

    pub(super) fn analysis_in(&self, order: Order) -> Result<&Analysis, FactorError> {
        let make = || {
            let last = match order {
                Order::Usual => Vec::new(),
                Order::ContactLast => self.trace.unknowns(),
            };
            let free = self.nodes.vertex[..self.nodes.free].iter();
            let coordinates: Vec<f64> = free.flat_map(|&v| self.mesh.vertex(v)).copied().collect();
            Analysis::new(&self.pattern, &nested_dissection(&self.pattern, &coordinates, &last))
        };
        self.analyses[order as usize].get_or_init(make).as_ref().map_err(Clone::clone)
    }

    /// Entries of a factor in the order of [`Self::analysis`], and multiplications that it takes; infinite where the
    /// pattern cannot be analysed.
    pub fn factor_size(&self) -> [f64; 2] {
        let size =
            |analysis: &Analysis| [analysis.factor_entries() as f64, analysis.multiplications()];
        self.analysis().map_or([f64::INFINITY; 2], size)
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

    /// The side of facet f of the trace.
    #[inline]
    pub fn side(&self, f: usize) -> u32 {
        self.mesh.facet_side[self.trace.mesh_facet[f] as usize]
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

    /// The points where strain, stress and projection live, cell by cell.
    #[inline]
    pub fn points(&self) -> impl Iterator<Item = StrainPoint<'_>> + Clone {
        (0..self.geometry.measure.len()).flat_map(|c| self.points_of(c))
    }

    /// The strain points of cell c.
    #[inline]
    pub fn points_of(&self, c: usize) -> impl Iterator<Item = StrainPoint<'_>> + Clone {
        let (measure, nodes) = (self.geometry.measure[c], self.nodes.of_cell(c));
        let first = self.geometry.shares.len() * c;
        self.geometry.shares.iter().zip(first..).map(move |(share, index)| StrainPoint {
            index,
            cell: c,
            weight: measure * share,
            gradients: self.geometry.gradients(index),
            nodes,
        })
    }
}
