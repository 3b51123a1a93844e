//! What is wrong with a `.msh` file.

use std::ops::Range;

use crate::mesh::CoarseError;

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
    #[error("version {found} of the format is not supported: export as version 4.1 or 2.2")]
    Version { found: String },
    #[error("a binary file: export as ASCII")]
    Binary,
    #[error("the file has no part ${part}")]
    Missing { part: &'static str },
    #[error("the part ${part} comes twice")]
    Twice { part: &'static str },
    /// Two nodes, groups or entities with one number.
    #[error("{what} {tag} is defined twice")]
    Defined { what: &'static str, tag: u64 },
    #[error("there is no {what} {tag}")]
    Unknown { what: &'static str, tag: u64 },
    #[error(
        "elements of type {kind} ({name}) are not read: a plane mesh has lines (1) and triangles (2), a body triangles and tetrahedra (4)"
    )]
    Type { kind: u64, name: &'static str },
    #[error("node {tag} has z = {z}: the mesh is not in the plane z = 0")]
    OffPlane { tag: u64, z: f64 },
    /// An element that would belong to two sides or regions.
    #[error("{what} {tag} belongs to the physical groups {first} and {second}")]
    TwoGroups { what: &'static str, tag: u64, first: i64, second: i64 },
    /// Nothing to compute on.
    #[error("the file has neither triangles nor tetrahedra")]
    NoCells,
    /// Elements that make no domain.
    #[error("{0}")]
    Domain(Box<CoarseError>),
}
