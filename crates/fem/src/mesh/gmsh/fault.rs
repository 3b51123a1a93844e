//! What is wrong with a `.msh` file.

use std::ops::Range;

use crate::mesh::{CoarseError, CoarseFault};

/// What is wrong with a `.msh` file, and where.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {fault}")]
pub struct GmshError {
    /// Counted from 1.
    pub line: usize,
    /// Bytes of the text at fault.
    pub span: Range<usize>,
    /// What is wrong.
    pub fault: Fault,
}

/// A fault in a `.msh` file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Fault {
    #[error("the file ends where {wanted} is expected")]
    Ends { wanted: &'static str },
    #[error("`{found}` where {wanted} should stand")]
    Unexpected { found: String, wanted: &'static str },
    #[error("version {found} of the format is not read")]
    Version { found: String },
    #[error("the file is binary")]
    Binary,
    #[error("the file has no part ${part}")]
    Missing { part: &'static str },
    #[error("the part ${part} comes twice")]
    Twice { part: &'static str },
    /// Two nodes, groups or entities with one number.
    #[error("{what} {tag} is defined twice")]
    Defined { what: &'static str, tag: u64 },
    #[error("the name `{name}` stands for two groups, {first} and {second}")]
    SameName { name: String, first: i64, second: i64 },
    #[error("the mesh is cut into partitions")]
    Partitioned,
    #[error("there is no {what} {tag}")]
    Unknown { what: &'static str, tag: u64 },
    #[error(
        "elements of type {kind} ({name}) are not read: a plane mesh has lines (1) and triangles (2), a body triangles and tetrahedra (4)"
    )]
    Type { kind: u64, name: &'static str },
    #[error(
        "node {tag} has z = {z}, and the first one z = {plane}: the mesh is not in a plane z = const"
    )]
    OffPlane { tag: u64, z: f64, plane: f64 },
    /// An element that would belong to two sides or regions.
    #[error("the {what} {tag} belongs to two physical groups, `{}` and `{}`", groups[0], groups[1])]
    TwoGroups { what: &'static str, tag: u64, groups: [String; 2] },
    /// Nothing to compute on.
    #[error("the file has neither triangles nor tetrahedra")]
    NoCells,
    /// Elements that make no domain.
    #[error("{0}")]
    Domain(Box<CoarseError>),
}

impl Fault {
    /// The way out.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Version { .. }
            | Self::Unexpected { .. }
            | Self::Ends { .. }
            | Self::Twice { .. } => {
                "export it again: gmsh FILE -save -format msh41 -o NEW.msh, or gronwall.convert_mesh(FILE, NEW) in Python"
            }
            Self::Binary => {
                "save as ASCII: gmsh FILE -save -format msh41 -o NEW.msh, meshio with binary=False, or gronwall.convert_mesh(FILE, NEW) in Python"
            }
            Self::Missing { part: "Entities" } => {
                "version 4.1 has the groups there; meshio keeps them in version 2.2 alone: file_format=\"gmsh22\", binary=False"
            }
            Self::Missing { .. } => "export the whole mesh, nodes and elements, as ASCII",
            Self::Defined { .. } | Self::SameName { .. } => {
                "give each node, group and entity a number and a name of its own"
            }
            Self::Partitioned => "save it before it is cut, without -part",
            Self::Unknown { .. } => {
                "the file names a node or an entity that it does not define: export it again"
            }
            Self::Type { kind: 3 | 5..=7, .. } => {
                "mesh with simplices, in gmsh without Recombine and transfinite recombination"
            }
            Self::Type { .. } => {
                "mesh with order 1 (gmsh -order 1); element = \"P2\" of [discretization] makes its own midpoints, on straight edges"
            }
            Self::OffPlane { .. } => {
                "turn the mesh into a plane z = const, or write dimension = 3 and mesh the volume"
            }
            Self::TwoGroups { .. } => {
                "leave it in one group: sides of several curves or surfaces are listed together in clamped, traction or contact"
            }
            Self::NoCells => {
                "gmsh saves elements of physical groups alone: give the surface (in dimension 3 the volume) a group too"
            }
            Self::Domain(error) => match &error.fault {
                CoarseFault::Hanging { .. } | CoarseFault::Crack { .. } => {
                    "cells share nodes where they meet: remove duplicate nodes (gmsh: Coherence, or Mesh > Remove duplicate nodes) and mesh again"
                }
                CoarseFault::Unnamed { .. } => {
                    "give it a physical group; `rest` is the name of a group here, and cannot stand for what has none"
                }
                CoarseFault::NotOnBoundary { .. } => {
                    "take inner edges or faces out of the group: a group that is inside as a whole is passed over"
                }
                CoarseFault::Twice { .. } => "leave it in one group, and save it once",
                CoarseFault::Apart { .. } => {
                    "mesh one body: join the parts so that they share edges or faces, or leave one out"
                }
                CoarseFault::Overlap { .. } => {
                    "cells lie on each other, or one stands there twice: leave each surface in one group, and mesh again"
                }
                CoarseFault::Flat { .. } | CoarseFault::NoVertex { .. } => {
                    "mesh again: a cell has no size or no corner"
                }
            },
        }
    }
}
