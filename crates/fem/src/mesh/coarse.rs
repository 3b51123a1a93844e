//! The coarse simplices of a domain in the plane or in space, which all its meshes refine.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use super::WHOLE;
use super::geometry::{cross, dot, extent, longest_edge, minus, norm};

/// A facet of the boundary: an edge with the domain on its left, or a triangle seen counter-clockwise from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryFacet {
    /// Its d vertices.
    pub corners: Vec<u32>,
    /// Its side: index into `sides`.
    pub side: u32,
    /// Outward unit normal, padded with zeros; facets of one side in one plane have the same to the bit.
    pub normal: [f64; 3],
}

/// Triangles or tetrahedra, regions and named sides.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarseMesh {
    /// d.
    pub dimension: usize,
    /// Coordinates, padded with zeros.
    pub vertices: Vec<[f64; 3]>,
    /// The d + 1 vertices of each cell, positively oriented.
    pub cells: Vec<Vec<u32>>,
    /// The region of each cell: index into `regions`.
    pub region: Vec<u32>,
    /// Names of the regions.
    pub regions: Vec<String>,
    /// The whole boundary.
    pub facets: Vec<BoundaryFacet>,
    /// Names of the sides; a side may have many facets.
    pub sides: Vec<String>,
    /// Groups of facets in the file that bound nothing, and are no sides.
    pub inner: Vec<String>,
}

/// A boundary facet with its places.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// The side.
    pub side: u32,
    /// Its two or three corners, padded with zeros.
    pub corners: Vec<[f64; 3]>,
    /// Outward unit normal, padded with zeros.
    pub normal: [f64; 3],
}

/// An element, by its position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum At {
    Cell(usize),
    Facet(usize),
}

type Places = Vec<Vec<f64>>;

/// Why cells and facets make no domain.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarseError {
    pub dimension: usize,
    /// The element at fault.
    pub at: At,
    pub fault: CoarseFault,
}

#[derive(Debug, Clone, PartialEq)]
pub enum CoarseFault {
    /// A cell of no measure, to rounding.
    Flat { corners: Places },
    /// A vertex number beyond the list.
    NoVertex { vertex: u32, count: usize },
    /// A facet with cells on one side twice, or three of them.
    Overlap { corners: Places },
    /// A vertex inside a facet or on its edges.
    Hanging { vertex: Vec<f64>, corners: Places },
    /// A facet of one cell that no side names.
    Unnamed { corners: Places },
    /// A facet of the boundary on another one: a crack between cells that share no facet there.
    Crack { corners: Places },
    /// A named facet that is no facet of one cell.
    NotOnBoundary { side: String, corners: Places },
    /// A facet with two names, or twice with one.
    Twice { sides: [String; 2], corners: Places },
    /// Parts that no facet joins.
    Apart { from: Vec<f64>, to: Vec<f64> },
}

impl fmt::Display for CoarseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [cell, facet, measure, flat] = match self.dimension {
            2 => ["triangle", "edge", "area", "line"],
            _ => ["tetrahedron", "face", "volume", "plane"],
        };
        match &self.fault {
            CoarseFault::Flat { corners } => {
                write!(f, "the {cell} has no {measure}: its corners {corners:?} lie in a {flat}")
            }
            CoarseFault::NoVertex { vertex, count } => {
                write!(f, "an element names vertex {vertex}, and there are {count}")
            }
            CoarseFault::Overlap { corners } => {
                write!(
                    f,
                    "the {facet} {corners:?} of the {cell} belongs to another one on the same side"
                )
            }
            CoarseFault::Hanging { vertex, corners } => write!(
                f,
                "the vertex {vertex:?} hangs on the {facet} {corners:?} of the {cell}: cells must meet {facet} to {facet}"
            ),
            CoarseFault::Unnamed { corners } => {
                write!(f, "the {facet} {corners:?} bounds the domain and belongs to no side")
            }
            CoarseFault::Crack { corners } => write!(
                f,
                "the {facet} {corners:?} of the {cell} lies on another one of the boundary: cells must meet {facet} to {facet}"
            ),
            CoarseFault::NotOnBoundary { side, corners } => write!(
                f,
                "the side `{side}` has the {facet} {corners:?}, which does not bound the domain"
            ),
            CoarseFault::Twice { sides: [first, second], corners } => {
                write!(f, "the {facet} {corners:?} is named twice, by `{first}` and by `{second}`")
            }
            CoarseFault::Apart { from, to } => write!(
                f,
                "the domain is not connected: no chain of common {facet}s leads from {from:?} to {to:?}"
            ),
        }
    }
}

impl std::error::Error for CoarseError {}

/// A cell whose measure is below this part of its longest edge to the power d has none.
const FLAT: f64 = 1e-10;
/// Normals that differ by less belong to one plane, and a vertex as close to a facet lies on it: files carry 16 digits, or
/// fewer where a kernel of geometry put the vertices on a facet.
const SAME: f64 = 1e-9;

/// The cell and the facet as it sees it, by the facet's vertices in order.
type Owners = BTreeMap<Vec<u32>, Vec<(usize, Vec<u32>)>>;

impl CoarseMesh {
    /// A polygon whose boundary runs over the first vertices, edge i from vertex i to the next on the side `of_edge[i]`.
    ///
    /// # Errors
    /// As [`Self::checked`].
    pub fn polygon(
        vertices: &[[f64; 2]],
        triangles: &[[u32; 3]],
        of_edge: &[u32],
        sides: Vec<String>,
    ) -> Result<Self, CoarseError> {
        let count = of_edge.len() as u32;
        let edge = |(i, &side): (u32, &u32)| BoundaryFacet {
            corners: vec![i, (i + 1) % count],
            side,
            normal: [0.0; 3],
        };
        let polygon = Self {
            dimension: 2,
            vertices: vertices.iter().map(|&[x, y]| [x, y, 0.0]).collect(),
            cells: triangles.iter().map(|triangle| triangle.to_vec()).collect(),
            region: vec![0; triangles.len()],
            regions: vec![WHOLE.to_string()],
            facets: (0..).zip(of_edge).map(edge).collect(),
            sides,
            inner: Vec::new(),
        };
        polygon.checked()
    }

    /// Orients every cell positively and every facet outward, drops vertices that no cell uses, computes the normals,
    /// and checks that the facets are the boundary of the cells.
    ///
    /// # Errors
    /// [`CoarseError`].
    pub fn checked(self) -> Result<Self, CoarseError> {
        self.checked_with_rest(None)
    }

    /// [`Self::checked`], with the facets of the boundary that no side names on a side of the name `rest`.
    ///
    /// # Errors
    /// [`CoarseError`].
    pub fn checked_with_rest(mut self, rest: Option<&str>) -> Result<Self, CoarseError> {
        let (count, d) = (self.vertices.len(), self.dimension);
        let mut owners = Owners::new();
        for c in 0..self.cells.len() {
            let refused = |fault| Err(CoarseError { dimension: d, at: At::Cell(c), fault });
            if let Some(&vertex) = self.cells[c].iter().find(|&&v| v as usize >= count) {
                return refused(CoarseFault::NoVertex { vertex, count });
            }
            let (measure, longest) = (self.measure_of(c), longest_edge(&self.corners(c)));
            if measure.is_nan() || measure.abs() <= FLAT * longest.powi(d as i32) {
                return refused(CoarseFault::Flat { corners: self.places(&self.cells[c]) });
            }
            if measure < 0.0 {
                self.cells[c].swap(d - 1, d);
            }
            for facet in facets_of(&self.cells[c]) {
                let here = owners.entry(sorted(&facet)).or_default();
                if here.iter().any(|(_, other)| from_lowest(other) == from_lowest(&facet)) {
                    return refused(CoarseFault::Overlap { corners: self.places(&facet) });
                }
                here.push((c, facet));
            }
        }
        self.name_facets(&owners, rest)?;
        self.connected(&owners)?;
        self.drop_unused();
        self.set_normals();
        Ok(self)
    }

    /// Turns the named facets outward and compares them with the facets of one cell.
    fn name_facets(&mut self, owners: &Owners, rest: Option<&str>) -> Result<(), CoarseError> {
        let (count, dimension) = (self.vertices.len(), self.dimension);
        let mut named: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
        for f in 0..self.facets.len() {
            let BoundaryFacet { corners, side, .. } = &self.facets[f];
            let refused = |fault| Err(CoarseError { dimension, at: At::Facet(f), fault });
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= count) {
                return refused(CoarseFault::NoVertex { vertex, count });
            }
            let (name, places) =
                (|side: u32| self.sides[side as usize].clone(), self.places(corners));
            let Some([(_, seen)]) = owners.get(&sorted(corners)).map(Vec::as_slice) else {
                let side = name(*side);
                return refused(CoarseFault::NotOnBoundary { side, corners: places });
            };
            if let Some(first) = named.insert(sorted(corners), *side) {
                let sides = [name(first), name(*side)];
                return refused(CoarseFault::Twice { sides, corners: places });
            }
            self.facets[f].corners.clone_from(seen);
        }
        let outer = || owners.iter().filter(|(_, here)| here.len() == 1).map(|(_, here)| &here[0]);
        let unnamed: Vec<&(usize, Vec<u32>)> =
            outer().filter(|(_, facet)| !named.contains_key(&sorted(facet))).collect();
        let Some((cell, first)) = unnamed.first() else { return Ok(()) };
        let refused = |cell, fault| Err(CoarseError { dimension, at: At::Cell(cell), fault });
        // Where cells do not meet, the larger facet has the smaller one's vertex on it, or they cross.
        let used: BTreeSet<u32> = self.cells.iter().flatten().copied().collect();
        for (cell, facet) in &unnamed {
            let near = self.near(facet);
            let mut others = used.iter().filter(|v| !facet.contains(*v));
            let hangs = |v: &&u32| {
                near(self.vertices[**v as usize])
                    && self.lies_on(self.vertices[**v as usize], facet)
            };
            if let Some(v) = others.find(hangs) {
                let vertex = self.places(&[*v]).swap_remove(0);
                let corners = self.places(facet);
                return refused(*cell, CoarseFault::Hanging { vertex, corners });
            }
        }
        let Some(rest) = rest else {
            return refused(*cell, CoarseFault::Unnamed { corners: self.places(first) });
        };
        let middles: Vec<(&Vec<u32>, [f64; 3])> =
            outer().map(|(_, facet)| (facet, self.middle(facet))).collect();
        for (cell, facet) in &unnamed {
            let near = self.near(facet);
            let on = |(other, middle): &&(&Vec<u32>, [f64; 3])| {
                *other != facet && near(*middle) && self.lies_on(*middle, facet)
            };
            if middles.iter().any(|other| on(&other)) {
                return refused(*cell, CoarseFault::Crack { corners: self.places(facet) });
            }
        }
        let side = self.sides.len() as u32;
        self.sides.push(rest.to_owned());
        let facet = |(_, facet): &&(usize, Vec<u32>)| BoundaryFacet {
            corners: facet.clone(),
            side,
            normal: [0.0; 3],
        };
        self.facets.extend(unnamed.iter().map(facet));
        Ok(())
    }

    /// The middle of a facet.
    fn middle(&self, facet: &[u32]) -> [f64; 3] {
        let share = 1.0 / facet.len() as f64;
        let sum = |i: usize| facet.iter().map(|&v| share * self.vertices[v as usize][i]).sum();
        [sum(0), sum(1), sum(2)]
    }

    /// Whether a place is in the ball around a facet: quick, where few places are.
    fn near(&self, facet: &[u32]) -> impl Fn([f64; 3]) -> bool {
        let middle = self.middle(facet);
        let radius = |&v: &u32| norm(minus(self.vertices[v as usize], middle));
        let radius = (1.0 + SAME) * facet.iter().map(radius).fold(0.0, f64::max);
        move |place| norm(minus(place, middle)) <= radius
    }

    /// Whether a place lies on a facet, its ends and edges included: the parts seen from there add up to the facet.
    fn lies_on(&self, place: [f64; 3], facet: &[u32]) -> bool {
        let corners = facet.iter().map(|&corner| self.vertices[corner as usize]);
        let corners: Vec<[f64; 3]> = corners.collect();
        let part = |a: usize| {
            let mut part = corners.clone();
            part[a] = place;
            extent(&part)
        };
        (0..corners.len()).map(part).sum::<f64>() <= (1.0 + SAME) * extent(&corners)
    }

    /// Refuses cells that cannot be reached over common facets: a detached part of the body.
    fn connected(&self, owners: &Owners) -> Result<(), CoarseError> {
        let mut reached = vec![false; self.cells.len()];
        let mut next: Vec<usize> = (0..reached.len().min(1)).collect();
        while let Some(c) = next.pop() {
            if !std::mem::replace(&mut reached[c], true) {
                let around = facets_of(&self.cells[c]);
                next.extend(around.flat_map(|facet| &owners[&sorted(&facet)]).map(|(c, _)| *c));
            }
        }
        let Some(cell) = reached.iter().position(|reached| !reached) else { return Ok(()) };
        let [from, to] = [0, cell].map(|c| self.places(&self.cells[c]).swap_remove(0));
        let fault = CoarseFault::Apart { from, to };
        Err(CoarseError { dimension: self.dimension, at: At::Cell(cell), fault })
    }

    fn drop_unused(&mut self) {
        let used: BTreeSet<u32> = self.cells.iter().flatten().copied().collect();
        let mut number = vec![u32::MAX; self.vertices.len()];
        used.iter().zip(0..).for_each(|(&v, new)| number[v as usize] = new);
        self.vertices = used.iter().map(|&v| self.vertices[v as usize]).collect();
        let of_facets = self.facets.iter_mut().flat_map(|facet| &mut facet.corners);
        self.cells.iter_mut().flatten().chain(of_facets).for_each(|v| *v = number[*v as usize]);
    }

    fn set_normals(&mut self) {
        let mut known: Vec<(u32, [f64; 3])> = Vec::new();
        for f in 0..self.facets.len() {
            let Piece { side, corners, .. } = self.piece(&self.facets[f]);
            let across = match corners[..] {
                [a, b] => [b[1] - a[1], a[0] - b[0], 0.0],
                _ => cross(minus(corners[1], corners[0]), minus(corners[2], corners[0])),
            };
            // Adding zero turns -0 into 0.
            let exact = across.map(|x| x / norm(across) + 0.0);
            let close = |normal: &[f64; 3]| norm(minus(*normal, exact)) < SAME;
            let of_side = known.iter().filter(|(of, _)| *of == side).map(|(_, normal)| *normal);
            let found = axes().into_iter().chain(of_side).find(close);
            self.facets[f].normal = found.unwrap_or_else(|| {
                known.push((side, exact));
                exact
            });
        }
    }

    /// The d coordinates of some vertices.
    fn places(&self, vertices: &[u32]) -> Places {
        let place = |&v: &u32| self.vertices[v as usize][..self.dimension].to_vec();
        vertices.iter().map(place).collect()
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.cells.len()
    }

    /// The corners of a cell, padded with zeros.
    pub fn corners(&self, c: usize) -> Vec<[f64; 3]> {
        self.cells[c].iter().map(|&v| self.vertices[v as usize]).collect()
    }

    /// Area or volume of a cell.
    pub fn measure_of(&self, c: usize) -> f64 {
        let corners = self.corners(c);
        let edge = |a: usize| minus(corners[a], corners[0]);
        match self.dimension {
            2 => 0.5 * cross(edge(1), edge(2))[2],
            _ => dot(edge(1), cross(edge(2), edge(3))) / 6.0,
        }
    }

    /// |Ω|.
    pub fn measure(&self) -> f64 {
        (0..self.count()).map(|c| self.measure_of(c)).sum()
    }

    /// Smallest and largest coordinates, padded with zeros.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        self.vertices.iter().fold(start, |[low, high], v| {
            [[0, 1, 2].map(|i| low[i].min(v[i])), [0, 1, 2].map(|i| high[i].max(v[i]))]
        })
    }

    /// The longest edge: h of the mesh n is this over n.
    pub fn longest_edge(&self) -> f64 {
        (0..self.count()).map(|c| longest_edge(&self.corners(c))).fold(0.0, f64::max)
    }

    /// A boundary facet with its places.
    pub fn piece(&self, facet: &BoundaryFacet) -> Piece {
        let corners = facet.corners.iter().map(|&v| self.vertices[v as usize]).collect();
        Piece { side: facet.side, corners, normal: facet.normal }
    }

    /// The boundary in plane pieces.
    pub fn pieces(&self) -> Vec<Piece> {
        self.facets.iter().map(|facet| self.piece(facet)).collect()
    }
}

/// The facets of a cell, seen from outside where it is positively oriented.
pub(super) fn facets_of(cell: &[u32]) -> impl Iterator<Item = Vec<u32>> + use<> {
    let facets: &[&[usize]] = match cell.len() {
        3 => &[&[1, 2], &[2, 0], &[0, 1]],
        _ => &[&[1, 2, 3], &[0, 3, 2], &[0, 1, 3], &[0, 2, 1]],
    };
    let cell = cell.to_vec();
    facets.iter().map(move |facet| facet.iter().map(|&a| cell[a]).collect())
}

fn axes() -> [[f64; 3]; 6] {
    std::array::from_fn(|i| {
        std::array::from_fn(|axis| match axis == i / 2 {
            true => 1.0 - 2.0 * (i % 2) as f64,
            false => 0.0,
        })
    })
}

pub(super) fn sorted(facet: &[u32]) -> Vec<u32> {
    let mut facet = facet.to_vec();
    facet.sort_unstable();
    facet
}

/// A facet as its sense tells it from its reverse: an edge as it is, a triangle from its lowest vertex on.
fn from_lowest(facet: &[u32]) -> Vec<u32> {
    let mut facet = facet.to_vec();
    if let [a, b, c] = facet[..] {
        facet.rotate_left(if a < b.min(c) { 0 } else { 1 + usize::from(c < b) });
    }
    facet
}

#[cfg(test)]
pub(super) mod tests;
