//! Meshes from gmsh's `.msh` files, ASCII, versions 2.2 and 4.1.
//!
//! Without tetrahedra the triangles become the coarse triangulation, physical groups of curves its sides, those of
//! surfaces its regions; with tetrahedra these are the coarse mesh, groups of surfaces the sides, those of volumes the
//! regions. A group without a name is called by its number. Groups that bound nothing are no sides, and facets of the
//! boundary without a group are the side `rest`. Everything else in the file is left out.
//! Source: the gmsh reference manual, "MSH file format".

mod fault;
mod sections;
mod tokens;
mod write;

use std::collections::{BTreeMap, BTreeSet};

pub use self::fault::{Fault, GmshError};
use self::sections::{Element, Sections};
use self::tokens::Tokens;
pub use self::write::write_gmsh;
use super::coarse::{facets_of, sorted};
use super::{At, BoundaryFacet, CoarseMesh, WHOLE};

/// Share of the extent by which a plane mesh may leave its plane z = const: files carry some ten digits.
const PLANE: f64 = 1e-9;
/// The side of the facets without a group.
pub const REST: &str = "rest";

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
        Some(dimension @ 2..) => file.domain(dimension),
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

    fn corners(&self, element: &Element) -> Result<Vec<u32>, GmshError> {
        let corner = |&tag: &u64| {
            let unknown = Fault::Unknown { what: "node", tag };
            let known = self.number.get(&tag).copied();
            known.ok_or_else(|| self.tokens.at(element.span.clone(), unknown))
        };
        element.nodes.iter().map(corner).collect()
    }

    /// The domain of the cells of this dimension.
    fn domain(&self, dimension: u64) -> Result<CoarseMesh, GmshError> {
        let Sections { nodes, names, elements_at, .. } = &self.sections;
        let (mut sides, mut regions) = (Groups::default(), Groups::default());
        let (mut cells, mut region, mut facets) = (Vec::new(), Vec::new(), Vec::new());
        for element in self.elements(dimension) {
            cells.push(self.corners(element)?);
            region.push(regions.number(element.group, names, dimension));
        }
        let mut owners: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
        for facet in cells.iter().flat_map(|cell| facets_of(cell)) {
            *owners.entry(sorted(&facet)).or_default() += 1;
        }
        // A group with no facet of one cell is no side: interfaces, lines of construction.
        let mut bounding: BTreeSet<Option<i64>> = BTreeSet::new();
        let mut grouped = Vec::new();
        for element in self.elements(dimension - 1).filter(|element| element.group.is_some()) {
            let corners = self.corners(element)?;
            if owners.get(&sorted(&corners)) == Some(&1) {
                bounding.insert(element.group);
            }
            grouped.push((element, corners));
        }
        let mut inner = Groups::default();
        let mut kept = Vec::new();
        for (element, corners) in grouped {
            if bounding.contains(&element.group) {
                let side = sides.number(element.group, names, dimension - 1);
                facets.push(BoundaryFacet { corners, side, normal: [0.0; 3] });
                kept.push(element);
            } else {
                inner.number(element.group, names, dimension - 1);
            }
        }
        let mut vertices: Vec<[f64; 3]> = nodes.iter().map(|node| node.at).collect();
        if dimension == 2 {
            let used: BTreeSet<u32> = cells.iter().flatten().copied().collect();
            let extent = vertices.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
            let plane = used.first().map_or(0.0, |&v| vertices[v as usize][2]);
            let off = |v: &&u32| (vertices[**v as usize][2] - plane).abs() > PLANE * extent;
            if let Some(&v) = used.iter().find(off) {
                let node = &nodes[v as usize];
                let fault = Fault::OffPlane { tag: node.tag, z: node.at[2], plane };
                return Err(self.tokens.at(node.span.clone(), fault));
            }
            vertices.iter_mut().for_each(|place| place[2] = 0.0);
        }
        let rest = Some(REST).filter(|rest| !sides.names.iter().any(|name| name == rest));
        let (sides, regions, dimension) = (sides.names, regions.names, dimension as usize);
        let coarse = CoarseMesh {
            dimension,
            vertices,
            cells,
            region,
            regions,
            facets,
            sides,
            inner: inner.names,
        };
        coarse.checked_with_rest(rest).map_err(|error| {
            let element = match error.at {
                At::Cell(cell) => self.elements(dimension as u64).nth(cell),
                At::Facet(facet) => kept.get(facet).copied(),
            };
            let span = element.map_or(elements_at, |element| &element.span).clone();
            self.tokens.at(span, Fault::Domain(Box::new(error)))
        })
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
