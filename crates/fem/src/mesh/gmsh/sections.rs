//! The parts of a `.msh` file that are read.

use std::collections::BTreeMap;
use std::ops::Range;

use super::tokens::{Tokens, short};
use super::{Fault, GmshError};

/// A vertex.
pub(super) struct Node {
    pub tag: u64,
    pub at: [f64; 3],
    pub span: Range<usize>,
}

/// A line, a triangle or a tetrahedron.
pub(super) struct Element {
    pub dimension: u64,
    pub group: Option<i64>,
    pub nodes: Vec<u64>,
    pub span: Range<usize>,
}

/// All that is read.
#[derive(Default)]
pub(super) struct Sections {
    pub nodes: Vec<Node>,
    pub elements: Vec<Element>,
    /// The header of the elements.
    pub elements_at: Range<usize>,
    /// Names by dimension and physical tag.
    pub names: BTreeMap<(u64, i64), String>,
    /// The physical group of an entity, by dimension and tag (4.1).
    groups: BTreeMap<(u64, i64), Option<i64>>,
}

/// The parts that are read, with their ends.
const PARTS: [(&str, &str); 4] = [
    ("PhysicalNames", "$EndPhysicalNames"),
    ("Entities", "$EndEntities"),
    ("Nodes", "$EndNodes"),
    ("Elements", "$EndElements"),
];

#[derive(Clone, Copy, PartialEq)]
enum Version {
    Two,
    Four,
}

impl Sections {
    pub(crate) fn read(tokens: &mut Tokens<'_>) -> Result<Self, GmshError> {
        tokens.skip_comments()?;
        tokens.expect("$MeshFormat")?;
        let version = version(tokens)?;
        let mut sections = Self::default();
        let mut seen: Vec<&'static str> = Vec::new();
        while let Some((span, word)) = tokens.word() {
            let Some(name) = word.strip_prefix('$') else {
                let found = short(word);
                return Err(tokens.at(span, Fault::Unexpected { found, wanted: "a $part" }));
            };
            if name == "PartitionedEntities" {
                return Err(tokens.at(span, Fault::Partitioned));
            }
            let Some((part, end)) = PARTS.into_iter().find(|(part, _)| *part == name) else {
                tokens.skip_to(&format!("$End{name}"))?;
                continue;
            };
            if seen.contains(&part) {
                return Err(tokens.at(span, Fault::Twice { part }));
            }
            seen.push(part);
            match (part, version) {
                ("PhysicalNames", _) => sections.physical_names(tokens)?,
                ("Entities", _) => sections.entities(tokens)?,
                ("Nodes", Version::Two) => sections.nodes_2(tokens)?,
                ("Nodes", Version::Four) => sections.nodes_4(tokens)?,
                (_, Version::Two) => sections.elements_2(tokens, span)?,
                (_, Version::Four) => sections.elements_4(tokens, span)?,
            }
            tokens.expect(end)?;
        }
        let needed: &[&'static str] = match version {
            Version::Two => &["Nodes", "Elements"],
            Version::Four => &["Entities", "Nodes", "Elements"],
        };
        match needed.iter().find(|part| !seen.contains(part)) {
            Some(part) => Err(tokens.at(0..0, Fault::Missing { part })),
            None => Ok(sections),
        }
    }

    fn physical_names(&mut self, tokens: &mut Tokens<'_>) -> Result<(), GmshError> {
        let count: u64 = tokens.number("the number of names")?;
        for _ in 0..count {
            let dimension = tokens.number("the dimension of a group")?;
            let tag: i64 = tokens.number("the tag of a group")?;
            let (span, name) = tokens.some("the name of a group")?;
            let same =
                |((of, _), known): &(&(u64, i64), &String)| *of == dimension && *known == name;
            if let Some((&(_, first), _)) = self.names.iter().find(same) {
                let name = name.to_owned();
                return Err(tokens.at(span, Fault::SameName { name, first, second: tag }));
            }
            if self.names.insert((dimension, tag), name.to_string()).is_some() {
                let fault = Fault::Defined { what: "physical group", tag: tag.unsigned_abs() };
                return Err(tokens.at(span, fault));
            }
        }
        Ok(())
    }

    fn entities(&mut self, tokens: &mut Tokens<'_>) -> Result<(), GmshError> {
        let mut counts = [0u64; 4];
        for count in &mut counts {
            *count = tokens.number("the number of entities")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let (span, tag) = tokens.placed::<i64>("the tag of an entity")?;
                tokens.pass(if dimension == 0 { 3 } else { 6 }, "a coordinate")?;
                let groups: u64 = tokens.number("the number of physical groups")?;
                let mut group = None;
                for _ in 0..groups {
                    let second: i64 = tokens.number("a physical group")?;
                    // Gmsh marks a reversed orientation by the sign.
                    let second = second.saturating_abs();
                    match group {
                        Some(first) if dimension > 0 => {
                            let what = ["point", "curve", "surface", "volume"][dimension];
                            let groups = [first, second].map(|group| {
                                let name = self.names.get(&(dimension as u64, group)).cloned();
                                name.unwrap_or_else(|| group.to_string())
                            });
                            let fault = Fault::TwoGroups { what, tag: tag.unsigned_abs(), groups };
                            return Err(tokens.at(span, fault));
                        }
                        _ => group = Some(second),
                    }
                }
                if dimension > 0 {
                    let bounding: u64 = tokens.number("the number of bounding entities")?;
                    tokens.pass(bounding, "a bounding entity")?;
                }
                if self.groups.insert((dimension as u64, tag), group).is_some() {
                    let fault = Fault::Defined { what: "entity", tag: tag.unsigned_abs() };
                    return Err(tokens.at(span, fault));
                }
            }
        }
        Ok(())
    }

    fn nodes_2(&mut self, tokens: &mut Tokens<'_>) -> Result<(), GmshError> {
        let count: u64 = tokens.number("the number of nodes")?;
        for _ in 0..count {
            let (span, tag) = tokens.placed("the tag of a node")?;
            let at = coordinates(tokens)?;
            self.nodes.push(Node { tag, at, span });
        }
        Ok(())
    }

    fn nodes_4(&mut self, tokens: &mut Tokens<'_>) -> Result<(), GmshError> {
        let blocks: u64 = tokens.number("the number of blocks")?;
        tokens.pass(3, "the number of nodes and their range")?;
        for _ in 0..blocks {
            let dimension: u64 = tokens.number("the dimension of a block")?;
            tokens.pass(1, "the entity of a block")?;
            let parametric: u64 = tokens.number("whether coordinates are parametric")?;
            let count: u64 = tokens.number("the number of nodes in a block")?;
            let mut tags = Vec::new();
            for _ in 0..count {
                tags.push(tokens.placed("the tag of a node")?);
            }
            for (span, tag) in tags {
                let at = coordinates(tokens)?;
                if parametric != 0 {
                    tokens.pass(dimension.min(3), "a parametric coordinate")?;
                }
                self.nodes.push(Node { tag, at, span });
            }
        }
        Ok(())
    }

    fn elements_2(&mut self, tokens: &mut Tokens<'_>, at: Range<usize>) -> Result<(), GmshError> {
        self.elements_at = at;
        let count: u64 = tokens.number("the number of elements")?;
        for _ in 0..count {
            let (span, _) = tokens.placed::<u64>("the tag of an element")?;
            let (at, kind) = tokens.placed("the type of an element")?;
            let (dimension, corners) = shape(tokens, at, kind)?;
            let tags: u64 = tokens.number("the number of tags")?;
            let mut group = None;
            for i in 0..tags {
                let tag: i64 = tokens.number("a tag")?;
                if i == 0 && tag != 0 {
                    group = Some(tag.saturating_abs());
                }
            }
            self.element(tokens, span, dimension, corners, group)?;
        }
        Ok(())
    }

    fn elements_4(&mut self, tokens: &mut Tokens<'_>, at: Range<usize>) -> Result<(), GmshError> {
        if self.groups.is_empty() {
            return Err(tokens.at(at, Fault::Missing { part: "Entities" }));
        }
        self.elements_at = at;
        let blocks: u64 = tokens.number("the number of blocks")?;
        tokens.pass(3, "the number of elements and their range")?;
        for _ in 0..blocks {
            let of: u64 = tokens.number("the dimension of a block")?;
            let (span, word) = tokens.some("the entity of a block")?;
            let entity: Option<i64> = word.parse().ok();
            let known = entity.and_then(|entity| self.groups.get(&(of, entity)).copied());
            let Some(group) = known else {
                let tag = entity.unwrap_or(0).unsigned_abs();
                return Err(tokens.at(span, Fault::Unknown { what: "entity", tag }));
            };
            let (at, kind) = tokens.placed("the type of the elements")?;
            let (dimension, corners) = shape(tokens, at, kind)?;
            let count: u64 = tokens.number("the number of elements in a block")?;
            for _ in 0..count {
                let (span, _) = tokens.placed::<u64>("the tag of an element")?;
                self.element(tokens, span, dimension, corners, group)?;
            }
        }
        Ok(())
    }

    fn element(
        &mut self,
        tokens: &mut Tokens<'_>,
        span: Range<usize>,
        dimension: u64,
        corners: usize,
        group: Option<i64>,
    ) -> Result<(), GmshError> {
        let mut nodes = Vec::with_capacity(corners);
        let mut end = span.end;
        for _ in 0..corners {
            let (at, node) = tokens.placed("a node of an element")?;
            end = at.end;
            nodes.push(node);
        }
        self.elements.push(Element { dimension, group, nodes, span: span.start..end });
        Ok(())
    }
}

fn version(tokens: &mut Tokens<'_>) -> Result<Version, GmshError> {
    let (span, word) = tokens.some("the version of the format")?;
    let version = match word {
        "2" | "2.0" | "2.1" | "2.2" => Version::Two,
        "4.1" => Version::Four,
        _ => return Err(tokens.at(span, Fault::Version { found: short(word) })),
    };
    let (span, word) = tokens.some("0 for ASCII")?;
    if word == "1" {
        return Err(tokens.at(span, Fault::Binary));
    }
    if word != "0" {
        let fault = Fault::Unexpected { found: short(word), wanted: "0 for ASCII" };
        return Err(tokens.at(span, fault));
    }
    tokens.pass(1, "the size of a number")?;
    tokens.expect("$EndMeshFormat")?;
    Ok(version)
}

fn coordinates(tokens: &mut Tokens<'_>) -> Result<[f64; 3], GmshError> {
    let mut one = || tokens.finite("a coordinate");
    Ok([one()?, one()?, one()?])
}

/// Dimension and number of nodes of an element type.
fn shape(tokens: &Tokens<'_>, span: Range<usize>, kind: u64) -> Result<(u64, usize), GmshError> {
    let name = match kind {
        15 => return Ok((0, 1)),
        1 => return Ok((1, 2)),
        2 => return Ok((2, 3)),
        4 => return Ok((3, 4)),
        3 => "quadrangle",
        5 => "hexahedron",
        6 => "prism",
        7 => "pyramid",
        8 => "line of order 2",
        9 => "triangle of order 2",
        11 => "tetrahedron of order 2",
        _ => "not a simplex of order 1",
    };
    Err(tokens.at(span, Fault::Type { kind, name }))
}
