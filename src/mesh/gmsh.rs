//! Plane meshes from gmsh's `.msh` files, ASCII, versions 2.2 and 4.1.
//!
//! Triangles become the coarse triangulation, physical groups of curves its sides, those of surfaces its
//! regions; a group without a name is called by its number. Everything else in the file is left out.
//! Source: the gmsh reference manual, "MSH file format".

mod sections;
mod tokens;

use std::collections::BTreeMap;
use std::ops::Range;

use self::sections::{Element, Sections};
use self::tokens::Tokens;
use super::{BoundaryEdge, Coarse, CoarseError, WHOLE};

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
    /// The text ends too early.
    #[error("the file ends where {wanted} should stand")]
    Ends { wanted: &'static str },
    /// Something else stands there.
    #[error("`{found}` where {wanted} should stand")]
    Unexpected { found: String, wanted: &'static str },
    /// A version that is not read.
    #[error("version {found} of the format is not read: export as version 4.1 or 2.2")]
    Version { found: String },
    /// Binary data.
    #[error("a binary file: export as ASCII")]
    Binary,
    /// A part that must be there.
    #[error("the file has no part ${part}")]
    Missing { part: &'static str },
    /// A part that comes twice.
    #[error("the part ${part} comes twice")]
    Twice { part: &'static str },
    /// Two nodes, groups or entities with one number.
    #[error("{what} {tag} is defined twice")]
    Defined { what: &'static str, tag: u64 },
    /// A number that nothing has.
    #[error("there is no {what} {tag}")]
    Unknown { what: &'static str, tag: u64 },
    /// Elements of a type that is not read.
    #[error(
        "elements of type {kind} ({name}) are not read: a plane mesh has lines (1) and triangles (2)"
    )]
    Type { kind: u64, name: &'static str },
    /// A vertex off the plane.
    #[error("node {tag} has z = {z}: the mesh is not in the plane z = 0")]
    OffPlane { tag: u64, z: f64 },
    /// An element that would belong to two sides or regions.
    #[error("{what} {tag} belongs to the physical groups {first} and {second}")]
    TwoGroups { what: &'static str, tag: u64, first: i64, second: i64 },
    /// Nothing to compute on.
    #[error("the file has no triangles")]
    NoTriangles,
    /// Triangles and edges that make no domain.
    #[error("{0}")]
    Domain(CoarseError),
}

/// Lines of a file that stand for coordinates off the plane by rounding of the mesh generator.
const PLANE: f64 = 1e-12;

/// The plane domain in the text of a `.msh` file.
///
/// # Errors
/// [`GmshError`].
pub fn read_gmsh(text: &str) -> Result<Coarse, GmshError> {
    let mut tokens = Tokens::new(text);
    let sections = Sections::read(&mut tokens)?;
    let mut number = BTreeMap::new();
    let mut vertices = Vec::new();
    let extent =
        sections.nodes.iter().flat_map(|node| node.at).fold(0.0, |m: f64, x| m.max(x.abs()));
    let mut flat = Vec::new();
    for node in &sections.nodes {
        if node.at[2].abs() > PLANE * extent {
            flat.push((node.tag, node.at[2], node.span.clone()));
        }
        if number.insert(node.tag, vertices.len() as u32).is_some() {
            let fault = Fault::Defined { what: "node", tag: node.tag };
            return Err(tokens.at(node.span.clone(), fault));
        }
        vertices.push([node.at[0], node.at[1]]);
    }
    let vertex = |element: &Element, a: usize| {
        let tag = element.nodes[a];
        let unknown = || tokens.at(element.span.clone(), Fault::Unknown { what: "node", tag });
        number.get(&tag).copied().ok_or_else(unknown)
    };
    let (mut sides, mut regions) = (Groups::default(), Groups::default());
    let (mut triangles, mut region, mut spans, mut edges) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for element in &sections.elements {
        match (element.dimension, element.group) {
            (2, group) => {
                triangles.push([vertex(element, 0)?, vertex(element, 1)?, vertex(element, 2)?]);
                spans.push(element.span.clone());
                region.push(regions.number(group, &sections.names, 2));
            }
            (1, Some(group)) => {
                let ends = [vertex(element, 0)?, vertex(element, 1)?];
                let side = sides.number(Some(group), &sections.names, 1);
                edges.push(BoundaryEdge { ends, side });
            }
            _ => {}
        }
    }
    if triangles.is_empty() {
        return Err(tokens.at(sections.elements_at, Fault::NoTriangles));
    }
    if let Some((tag, z, span)) = flat.into_iter().next() {
        return Err(tokens.at(span, Fault::OffPlane { tag, z }));
    }
    let (sides, regions) = (sides.names, regions.names);
    let coarse = Coarse { vertices, triangles, region, regions, edges, sides };
    coarse.checked().map_err(|error| {
        let at = match &error {
            CoarseError::Flat { triangle, .. } | CoarseError::NoVertex { triangle, .. } => {
                spans[*triangle].clone()
            }
            _ => sections.elements_at.clone(),
        };
        tokens.at(at, Fault::Domain(error))
    })
}

/// Physical groups of one dimension in order of appearance.
#[derive(Default)]
struct Groups {
    tags: Vec<Option<i64>>,
    names: Vec<String>,
}

impl Groups {
    fn number(
        &mut self,
        group: Option<i64>,
        names: &BTreeMap<(u64, i64), String>,
        dimension: u64,
    ) -> u32 {
        let known = self.tags.iter().position(|tag| *tag == group);
        let at = known.unwrap_or_else(|| {
            let name = match group {
                None => WHOLE.to_string(),
                Some(tag) => {
                    names.get(&(dimension, tag)).cloned().unwrap_or_else(|| tag.to_string())
                }
            };
            self.tags.push(group);
            self.names.push(name);
            self.tags.len() - 1
        });
        at as u32
    }
}

#[cfg(test)]
mod tests;
