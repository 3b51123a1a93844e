//! Coarse simplices in the plane or in space.

use std::sync::Arc;

use super::{Coarse, Family, Mesh, Solid, edgewise, subdivision};

/// The simplices that all meshes of a domain refine.
#[derive(Debug, Clone, PartialEq)]
pub enum CoarseMesh {
    Plane(Arc<Coarse>),
    Space(Arc<Solid>),
}

/// A boundary edge or face.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// The side.
    pub side: u32,
    /// Its two or three corners, padded with zeros.
    pub corners: Vec<[f64; 3]>,
    /// Outward unit normal, padded with zeros.
    pub normal: [f64; 3],
}

impl CoarseMesh {
    /// d.
    pub fn dimension(&self) -> usize {
        match self {
            Self::Plane(_) => 2,
            Self::Space(_) => 3,
        }
    }

    /// Number of simplices.
    pub fn count(&self) -> usize {
        match self {
            Self::Plane(coarse) => coarse.triangles.len(),
            Self::Space(solid) => solid.cells.len(),
        }
    }

    /// The corners of a simplex, padded with zeros.
    pub fn corners(&self, simplex: usize) -> Vec<[f64; 3]> {
        match self {
            Self::Plane(coarse) => coarse.corners(simplex).map(|[x, y]| [x, y, 0.0]).to_vec(),
            Self::Space(solid) => solid.corners(simplex).to_vec(),
        }
    }

    /// Area or volume of a simplex.
    pub fn measure_of(&self, simplex: usize) -> f64 {
        match self {
            Self::Plane(coarse) => coarse.area(simplex),
            Self::Space(solid) => solid.volume(simplex),
        }
    }

    /// |Ω|.
    pub fn measure(&self) -> f64 {
        (0..self.count()).map(|simplex| self.measure_of(simplex)).sum()
    }

    /// All vertices, padded with zeros.
    pub fn vertices(&self) -> Vec<[f64; 3]> {
        match self {
            Self::Plane(coarse) => coarse.vertices.iter().map(|&[x, y]| [x, y, 0.0]).collect(),
            Self::Space(solid) => solid.vertices.clone(),
        }
    }

    /// Smallest and largest coordinates, padded with zeros.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        self.vertices().iter().fold(start, |[low, high], v| {
            [[0, 1, 2].map(|i| low[i].min(v[i])), [0, 1, 2].map(|i| high[i].max(v[i]))]
        })
    }

    /// The longest edge: h of the mesh n is this over n.
    pub fn longest_edge(&self) -> f64 {
        match self {
            Self::Plane(coarse) => coarse.longest_edge(),
            Self::Space(solid) => solid.longest_edge(),
        }
    }

    /// Names of the sides.
    pub fn sides(&self) -> &[String] {
        match self {
            Self::Plane(coarse) => &coarse.sides,
            Self::Space(solid) => &solid.sides,
        }
    }

    /// Names of the regions.
    pub fn regions(&self) -> &[String] {
        match self {
            Self::Plane(coarse) => &coarse.regions,
            Self::Space(solid) => &solid.regions,
        }
    }

    /// The region of a simplex: index into [`Self::regions`].
    pub fn region_of(&self, simplex: usize) -> u32 {
        match self {
            Self::Plane(coarse) => coarse.region[simplex],
            Self::Space(solid) => solid.region[simplex],
        }
    }

    /// The boundary in plane pieces.
    pub fn pieces(&self) -> Vec<Piece> {
        match self {
            Self::Plane(coarse) => {
                let one = |edge| {
                    let (ends, [x, y]) = coarse.segment(edge);
                    let corners = ends.map(|[x, y]| [x, y, 0.0]).to_vec();
                    Piece { side: edge.side, corners, normal: [x, y, 0.0] }
                };
                coarse.edges.iter().map(one).collect()
            }
            Self::Space(solid) => {
                let faces = solid.faces.iter().map(|face| Piece {
                    side: face.side,
                    corners: solid.places(face.corners).to_vec(),
                    normal: face.normal,
                });
                faces.collect()
            }
        }
    }

    /// The mesh with n parts of every coarse edge. In space there is the structured family alone, which scenes
    /// validate.
    pub fn refined(&self, n: u32, family: Family) -> Mesh {
        match self {
            Self::Plane(coarse) => subdivision::refined(coarse, n, family),
            Self::Space(solid) => edgewise::refined(solid, n),
        }
    }
}

impl From<Coarse> for CoarseMesh {
    fn from(coarse: Coarse) -> Self {
        Self::Plane(Arc::new(coarse))
    }
}

impl From<Solid> for CoarseMesh {
    fn from(solid: Solid) -> Self {
        Self::Space(Arc::new(solid))
    }
}
