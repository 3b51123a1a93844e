//! Meshes from gmsh's `.msh` files, ASCII, versions 2.2 and 4.1.
//!
//! Without tetrahedra the triangles become the coarse triangulation, physical groups of curves its sides, those of
//! surfaces its regions; with tetrahedra these are the coarse mesh, groups of surfaces the sides, those of volumes the
//! regions. A group without a name is called by its number. Everything else in the file is left out.
//! Source: the gmsh reference manual, "MSH file format".

mod fault;
mod sections;
mod tokens;
mod write;

use std::collections::BTreeMap;

pub use self::fault::{Fault, GmshError};
use self::sections::{Element, Sections};
use self::tokens::Tokens;
pub use self::write::write_gmsh;
use super::{At, BoundaryEdge, BoundaryFace, Coarse, CoarseError, CoarseMesh, Solid, WHOLE};

/// Lines of a file that stand for coordinates off the plane by rounding of the mesh generator.
const PLANE: f64 = 1e-12;

/// The coarse mesh in the text of a `.msh` file.
///
/// # Errors
/// [`GmshError`].
pub fn read_gmsh(text: &str) -> Result<CoarseMesh, GmshError> {
    let mut tokens = Tokens::new(text);
    let sections = Sections::read(&mut tokens)?;
    let mut number = BTreeMap::new();
    for (at, node) in (0..).zip(&sections.nodes) {
        if number.insert(node.tag, at).is_some() {
            let fault = Fault::Defined { what: "node", tag: node.tag };
            return Err(tokens.at(node.span.clone(), fault));
        }
    }
    let file = File { tokens, sections, number };
    match file.sections.elements.iter().map(|element| element.dimension).max() {
        Some(3) => file.solid().map(CoarseMesh::from),
        Some(2) => file.plane().map(CoarseMesh::from),
        _ => Err(file.tokens.at(file.sections.elements_at.clone(), Fault::NoCells)),
    }
}

/// A file with its nodes numbered from 0.
struct File<'t> {
    tokens: Tokens<'t>,
    sections: Sections,
    number: BTreeMap<u64, u32>,
}

impl File<'_> {
    /// Elements of one dimension, with or without group.
    fn elements(&self, dimension: u64) -> impl Iterator<Item = &Element> {
        self.sections.elements.iter().filter(move |element| element.dimension == dimension)
    }

    fn corners<const N: usize>(&self, element: &Element) -> Result<[u32; N], GmshError> {
        let mut corners = [0; N];
        for (vertex, &tag) in corners.iter_mut().zip(&element.nodes) {
            let unknown =
                || self.tokens.at(element.span.clone(), Fault::Unknown { what: "node", tag });
            *vertex = self.number.get(&tag).copied().ok_or_else(unknown)?;
        }
        Ok(corners)
    }

    fn plane(&self) -> Result<Coarse, GmshError> {
        let nodes = &self.sections.nodes;
        let extent = nodes.iter().flat_map(|node| node.at).fold(0.0, |m: f64, x| m.max(x.abs()));
        let (mut sides, mut regions) = (Groups::default(), Groups::default());
        let (mut triangles, mut region, mut edges) = (Vec::new(), Vec::new(), Vec::new());
        for element in self.elements(2) {
            triangles.push(self.corners(element)?);
            region.push(regions.number(element.group, &self.sections.names, 2));
        }
        for element in self.elements(1).filter(|element| element.group.is_some()) {
            let side = sides.number(element.group, &self.sections.names, 1);
            edges.push(BoundaryEdge { ends: self.corners(element)?, side });
        }
        if let Some(node) = nodes.iter().find(|node| node.at[2].abs() > PLANE * extent) {
            let fault = Fault::OffPlane { tag: node.tag, z: node.at[2] };
            return Err(self.tokens.at(node.span.clone(), fault));
        }
        let vertices = nodes.iter().map(|node| [node.at[0], node.at[1]]).collect();
        let (sides, regions) = (sides.names, regions.names);
        let coarse = Coarse { vertices, triangles, region, regions, edges, sides };
        coarse.checked().map_err(|error| {
            let triangle = match &error {
                CoarseError::Flat { triangle, .. } | CoarseError::NoVertex { triangle, .. } => {
                    self.elements(2).nth(*triangle)
                }
                _ => None,
            };
            self.fault(triangle, Fault::Domain(error))
        })
    }

    fn solid(&self) -> Result<Solid, GmshError> {
        let (mut sides, mut regions) = (Groups::default(), Groups::default());
        let (mut cells, mut region, mut faces) = (Vec::new(), Vec::new(), Vec::new());
        for element in self.elements(3) {
            cells.push(self.corners(element)?);
            region.push(regions.number(element.group, &self.sections.names, 3));
        }
        let named = || self.elements(2).filter(|element| element.group.is_some());
        for element in named() {
            let side = sides.number(element.group, &self.sections.names, 2);
            faces.push(BoundaryFace { corners: self.corners(element)?, side, normal: [0.0; 3] });
        }
        let vertices = self.sections.nodes.iter().map(|node| node.at).collect();
        let (sides, regions) = (sides.names, regions.names);
        let solid = Solid { vertices, cells, region, regions, faces, sides };
        solid.checked().map_err(|error| {
            let element = match error.at() {
                At::Cell(cell) => self.elements(3).nth(cell),
                At::Face(face) => named().nth(face),
            };
            self.fault(element, Fault::Body(Box::new(error)))
        })
    }

    /// A fault of an element, or of all of them.
    fn fault(&self, element: Option<&Element>, fault: Fault) -> GmshError {
        let all = &self.sections.elements_at;
        self.tokens.at(element.map_or(all, |element| &element.span).clone(), fault)
    }
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
