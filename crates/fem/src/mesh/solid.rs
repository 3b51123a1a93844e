//! The coarse tetrahedra of a body, which all its meshes refine.

use std::collections::{BTreeMap, BTreeSet};

use super::geometry::{cross, dot, minus, norm};

/// A triangle of the boundary, seen counter-clockwise from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryFace {
    /// Its vertices.
    pub corners: [u32; 3],
    /// Its side: index into `sides`.
    pub side: u32,
    /// Outward unit normal; faces of one side in one plane have the same to the bit.
    pub normal: [f64; 3],
}

/// Tetrahedra, regions and named sides of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Coordinates.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex numbers, positively oriented.
    pub cells: Vec<[u32; 4]>,
    /// The region of each cell: index into `regions`.
    pub region: Vec<u32>,
    /// Names of the regions.
    pub regions: Vec<String>,
    /// The whole boundary.
    pub faces: Vec<BoundaryFace>,
    /// Names of the sides; a side may have many faces.
    pub sides: Vec<String>,
}

/// The element at fault, by its position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum At {
    /// A tetrahedron.
    Cell(usize),
    /// A boundary face.
    Face(usize),
}

/// Why tetrahedra and faces make no body.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolidError {
    /// A tetrahedron of no volume, to rounding.
    #[error("the tetrahedron has no volume: its corners {corners:?} lie in a plane")]
    Flat { cell: usize, corners: [[f64; 3]; 4] },
    /// A vertex number beyond the list.
    #[error("an element names vertex {vertex}, and there are {count}")]
    NoVertex { at: At, vertex: u32, count: usize },
    /// A face with tetrahedra on one side twice, or three of them.
    #[error("the face {corners:?} of the tetrahedron belongs to another one on the same side")]
    Overlap { cell: usize, corners: [[f64; 3]; 3] },
    /// A vertex in the middle of a face or of its edges.
    #[error(
        "the vertex {vertex:?} hangs on the face {corners:?} of the tetrahedron: tetrahedra must meet face to face"
    )]
    Hanging { cell: usize, vertex: [f64; 3], corners: [[f64; 3]; 3] },
    /// A face of one tetrahedron that no side names.
    #[error("the face {corners:?} bounds the body and belongs to no side")]
    Unnamed { cell: usize, corners: [[f64; 3]; 3] },
    /// A named face that is no face of one tetrahedron.
    #[error("the side `{side}` has the face {corners:?}, which does not bound the body")]
    NotOnBoundary { face: usize, side: String, corners: [[f64; 3]; 3] },
    /// A face with two names, or twice with one.
    #[error("the face {corners:?} of the side `{side}` is named twice")]
    Twice { face: usize, side: String, corners: [[f64; 3]; 3] },
    /// Parts that no face joins.
    #[error("the body falls apart: no chain of common faces leads from {from:?} to {to:?}")]
    Apart { cell: usize, from: [f64; 3], to: [f64; 3] },
}

impl SolidError {
    /// The element at fault.
    pub(crate) fn at(&self) -> At {
        match self {
            Self::NoVertex { at, .. } => *at,
            Self::NotOnBoundary { face, .. } | Self::Twice { face, .. } => At::Face(*face),
            Self::Flat { cell, .. }
            | Self::Overlap { cell, .. }
            | Self::Hanging { cell, .. }
            | Self::Unnamed { cell, .. }
            | Self::Apart { cell, .. } => At::Cell(*cell),
        }
    }
}

/// A tetrahedron whose volume is below this part of its longest edge cubed has none; a vertex closer to a face than
/// this part of the face's longest edge lies on it.
const FLAT: f64 = 1e-10;

/// Normals that differ by less belong to one plane: files carry 16 digits, or fewer where a kernel of geometry put the
/// vertices on a face.
const SAME_NORMAL: f64 = 1e-9;

/// The faces of a tetrahedron, seen counter-clockwise from outside where it is positively oriented.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// The cell and the face as it sees it, by the face's vertices in order.
type Owners = BTreeMap<[u32; 3], Vec<(usize, [u32; 3])>>;

impl Solid {
    /// Orients every tetrahedron positively and every face outward, drops vertices that no tetrahedron uses, and checks
    /// that the faces are the boundary of the tetrahedra. Normals are computed here.
    ///
    /// # Errors
    /// [`SolidError`].
    pub(crate) fn checked(mut self) -> Result<Self, SolidError> {
        let count = self.vertices.len();
        let mut owners = Owners::new();
        for c in 0..self.cells.len() {
            if let Some(&vertex) = self.cells[c].iter().find(|&&v| v as usize >= count) {
                return Err(SolidError::NoVertex { at: At::Cell(c), vertex, count });
            }
            let (volume, longest) = (self.volume(c), self.longest_edge_of(c));
            if volume.is_nan() || volume.abs() <= FLAT * longest.powi(3) {
                return Err(SolidError::Flat { cell: c, corners: self.corners(c) });
            }
            if volume < 0.0 {
                self.cells[c].swap(2, 3);
            }
            for face in FACES.map(|face| face.map(|a| self.cells[c][a])) {
                let here = owners.entry(sorted(face)).or_default();
                if here.iter().any(|(_, other)| same_sense(*other, face)) {
                    return Err(SolidError::Overlap { cell: c, corners: self.places(face) });
                }
                here.push((c, face));
            }
        }
        self.name_faces(&owners)?;
        self.connected(&owners)?;
        self.drop_unused();
        self.set_normals();
        Ok(self)
    }

    /// Turns the named faces outward and compares them with the faces of one tetrahedron.
    fn name_faces(&mut self, owners: &Owners) -> Result<(), SolidError> {
        let count = self.vertices.len();
        let mut named: BTreeMap<[u32; 3], usize> = BTreeMap::new();
        for f in 0..self.faces.len() {
            let corners = self.faces[f].corners;
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= count) {
                return Err(SolidError::NoVertex { at: At::Face(f), vertex, count });
            }
            let side = || self.sides[self.faces[f].side as usize].clone();
            let Some([(_, seen)]) = owners.get(&sorted(corners)).map(Vec::as_slice) else {
                let corners = self.places(corners);
                return Err(SolidError::NotOnBoundary { face: f, side: side(), corners });
            };
            if named.insert(sorted(corners), f).is_some() {
                let corners = self.places(corners);
                return Err(SolidError::Twice { face: f, side: side(), corners });
            }
            self.faces[f].corners = *seen;
        }
        let outer = owners.iter().filter(|(_, here)| here.len() == 1);
        let unnamed: Vec<(usize, [u32; 3])> =
            outer.filter(|(face, _)| !named.contains_key(*face)).map(|(_, here)| here[0]).collect();
        let Some(&(cell, first)) = unnamed.first() else { return Ok(()) };
        // Where tetrahedra do not meet, the larger face has the smaller one's vertex on it.
        let used: BTreeSet<u32> = self.cells.iter().flatten().copied().collect();
        let hanging = unnamed.iter().find_map(|&(cell, face)| {
            let corners = self.places(face);
            let mut others = used.iter().filter(|v| !face.contains(*v));
            let v = others.find(|v| lies_on(&self.vertices[**v as usize], &corners))?;
            Some(SolidError::Hanging { cell, vertex: self.vertices[*v as usize], corners })
        });
        Err(hanging.unwrap_or(SolidError::Unnamed { cell, corners: self.places(first) }))
    }

    /// Refuses tetrahedra that cannot be reached over common faces: a detached part of the body.
    fn connected(&self, owners: &Owners) -> Result<(), SolidError> {
        let mut reached = vec![false; self.cells.len()];
        let mut next: Vec<usize> = (0..reached.len().min(1)).collect();
        while let Some(c) = next.pop() {
            if std::mem::replace(&mut reached[c], true) {
                continue;
            }
            for face in FACES.map(|face| sorted(face.map(|a| self.cells[c][a]))) {
                next.extend(owners[&face].iter().map(|(cell, _)| *cell));
            }
        }
        match reached.iter().position(|reached| !reached) {
            None => Ok(()),
            Some(cell) => {
                let (from, to) = (self.corners(0)[0], self.corners(cell)[0]);
                Err(SolidError::Apart { cell, from, to })
            }
        }
    }

    fn drop_unused(&mut self) {
        let mut used: Vec<u32> = self.cells.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let mut number = vec![u32::MAX; self.vertices.len()];
        used.iter().zip(0..).for_each(|(&v, new)| number[v as usize] = new);
        self.vertices = used.iter().map(|&v| self.vertices[v as usize]).collect();
        self.cells.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
        self.faces.iter_mut().flat_map(|f| &mut f.corners).for_each(|v| *v = number[*v as usize]);
    }

    fn set_normals(&mut self) {
        let mut known: Vec<(u32, [f64; 3])> = Vec::new();
        for f in 0..self.faces.len() {
            let [a, b, c] = self.places(self.faces[f].corners);
            let doubled = cross(minus(b, a), minus(c, a));
            // Adding zero turns -0 into 0.
            let exact = doubled.map(|x| x / norm(doubled) + 0.0);
            let close = |axis: &[f64; 3]| norm(minus(*axis, exact)) < SAME_NORMAL;
            let side = self.faces[f].side;
            let normal = axes().into_iter().find(close).or_else(|| {
                let mut known = known.iter().filter(|(of, _)| *of == side);
                known.find(|(_, normal)| close(normal)).map(|(_, normal)| *normal)
            });
            let normal = normal.unwrap_or_else(|| {
                known.push((side, exact));
                exact
            });
            self.faces[f].normal = normal;
        }
    }

    /// The corners of some vertices.
    pub(crate) fn places<const N: usize>(&self, corners: [u32; N]) -> [[f64; 3]; N] {
        corners.map(|v| self.vertices[v as usize])
    }

    /// The corners of a tetrahedron.
    pub(crate) fn corners(&self, c: usize) -> [[f64; 3]; 4] {
        self.places(self.cells[c])
    }

    /// The volume of a tetrahedron.
    pub(crate) fn volume(&self, c: usize) -> f64 {
        let [a, p, q, r] = self.corners(c);
        dot(minus(p, a), cross(minus(q, a), minus(r, a))) / 6.0
    }

    fn longest_edge_of(&self, c: usize) -> f64 {
        let corners = self.corners(c);
        let pairs = (0..4).flat_map(|a| (0..a).map(move |b| (a, b)));
        pairs.map(|(a, b)| norm(minus(corners[a], corners[b]))).fold(0.0, f64::max)
    }

    /// The longest edge: h of the mesh n is this over n.
    pub(crate) fn longest_edge(&self) -> f64 {
        (0..self.cells.len()).map(|c| self.longest_edge_of(c)).fold(0.0, f64::max)
    }
}

fn axes() -> [[f64; 3]; 6] {
    std::array::from_fn(|i| {
        std::array::from_fn(|axis| match axis == i / 2 {
            true => 1.0 - 2.0 * (i % 2) as f64,
            false => 0.0,
        })
    })
}

fn sorted(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// True if two faces with the same vertices run around them in one sense.
fn same_sense(a: [u32; 3], b: [u32; 3]) -> bool {
    (0..3).any(|shift| (0..3).all(|i| a[i] == b[(i + shift) % 3]))
}

/// True if a point lies on a triangle, its edges included, to rounding.
fn lies_on(x: &[f64; 3], [a, b, c]: &[[f64; 3]; 3]) -> bool {
    let (p, q, to) = (minus(*b, *a), minus(*c, *a), minus(*x, *a));
    let doubled = cross(p, q);
    let square = dot(doubled, doubled);
    let longest = norm(p).max(norm(q)).max(norm(minus(p, q)));
    let weights = [dot(cross(to, q), doubled) / square, dot(cross(p, to), doubled) / square];
    let away = dot(to, doubled).abs() / square.sqrt();
    let rest = 1.0 - weights[0] - weights[1];
    away <= SAME_NORMAL * longest && weights.iter().chain([&rest]).all(|w| *w >= -SAME_NORMAL)
}

#[cfg(test)]
pub(super) mod tests;
