//! A mesh of simplices in flat lists, of any dimension d: cell c has the vertices `cells[c(d+1)..(c+1)(d+1)]`.

use super::geometry::extent;

/// The region of a mesh that has only one.
pub const WHOLE: &str = "body";

/// A conforming simplex mesh of a polygonal or polyhedral domain.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Space dimension d.
    pub dimension: usize,
    /// Cells per unit length of a rectangle or box, parts of a coarse edge elsewhere.
    pub n: u32,
    /// The reported mesh size h: 1/n, or the longest coarse edge over n.
    pub h: f64,
    /// Vertex coordinates, d numbers per vertex.
    pub coordinates: Vec<f64>,
    /// Vertex numbers, d + 1 per cell.
    pub cells: Vec<u32>,
    /// Boundary facets, d vertex numbers each.
    pub facets: Vec<u32>,
    /// The side a facet lies on: index into `sides`.
    pub facet_side: Vec<u32>,
    /// Names of the sides.
    pub sides: Vec<String>,
    /// Outward unit normal of each facet, d numbers a facet: a side may bend.
    pub facet_normal: Vec<f64>,
    /// The region a cell belongs to: index into `regions`.
    pub cell_region: Vec<u32>,
    /// Names of the regions; generated meshes have one, [`WHOLE`].
    pub regions: Vec<String>,
}

/// Facets of one side with one normal.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanePart {
    /// The side.
    pub side: u32,
    /// Their outward unit normal, padded with zeros.
    pub normal: [f64; 3],
    /// Positions in the list of facets that was divided.
    pub members: Vec<usize>,
}

impl Mesh {
    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.coordinates.len() / self.dimension
    }

    /// Number of vertices of cells, which come first: the points behind them are midpoints of edges.
    pub fn corners(&self) -> usize {
        self.cells.iter().max().map_or(0, |&last| last as usize + 1)
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len() / (self.dimension + 1)
    }

    /// Mesh size h by the convention of this project: a rectangle's or box's squares have the side 1/n,
    /// other cells the longest edge h if they are congruent.
    pub fn h(&self) -> f64 {
        self.h
    }

    /// Coordinates of a vertex.
    #[inline]
    pub fn vertex(&self, v: u32) -> &[f64] {
        let d = self.dimension;
        &self.coordinates[d * v as usize..d * (v as usize + 1)]
    }

    /// Vertices of a cell.
    pub fn cell(&self, c: usize) -> &[u32] {
        let stride = self.dimension + 1;
        &self.cells[stride * c..stride * (c + 1)]
    }

    /// Vertices of a boundary facet.
    pub fn facet(&self, f: usize) -> &[u32] {
        &self.facets[self.dimension * f..self.dimension * (f + 1)]
    }

    /// Outward unit normal of a boundary facet, padded with zeros to three numbers.
    pub fn normal(&self, f: usize) -> [f64; 3] {
        let d = self.dimension;
        let mut normal = [0.0; 3];
        normal[..d].copy_from_slice(&self.facet_normal[d * f..d * (f + 1)]);
        normal
    }

    /// Index of a side by its name.
    pub fn side(&self, name: &str) -> Option<u32> {
        self.sides.iter().position(|s| *s == name).map(|s| s as u32)
    }

    /// The facets that lie on one of `sides`, in mesh order.
    pub fn facets_on<'a>(&'a self, sides: &'a [u32]) -> impl Iterator<Item = usize> + 'a {
        (0..self.facet_side.len()).filter(move |&f| sides.contains(&self.facet_side[f]))
    }

    /// Positions in a list of facets, grouped by side and, within one, by normal, in the order in which
    /// they come: the parts of a boundary that are plane.
    pub fn plane_parts(&self, facets: &[u32]) -> Vec<PlanePart> {
        let mut parts: Vec<PlanePart> = Vec::new();
        for (position, &f) in facets.iter().enumerate() {
            let (side, normal) = (self.facet_side[f as usize], self.normal(f as usize));
            let same_plane = |part: &&mut PlanePart| part.side == side && part.normal == normal;
            match parts.iter_mut().find(same_plane) {
                Some(part) => part.members.push(position),
                None => parts.push(PlanePart { side, normal, members: vec![position] }),
            }
        }
        parts.sort_by_key(|part| part.side);
        parts
    }

    /// Point with the given barycentric coordinates on a simplex of vertices (cell or facet),
    /// padded with zeros to three numbers.
    #[inline]
    pub fn point(&self, simplex: &[u32], barycentric: &[f64]) -> [f64; 3] {
        let mut x = [0.0; 3];
        for (&v, &b) in simplex.iter().zip(barycentric) {
            for (component, value) in x.iter_mut().zip(self.vertex(v)) {
                *component += b * value;
            }
        }
        x
    }

    /// The places of the same barycentric coordinates in some simplices, one simplex after another.
    pub fn points_of(&self, simplices: &[&[u32]], coordinates: &[Vec<f64>]) -> Vec<[f64; 3]> {
        let of = |simplex| coordinates.iter().map(move |b| self.point(simplex, b));
        simplices.iter().copied().flat_map(of).collect()
    }

    /// The vertices of each cell.
    pub fn cells(&self) -> Vec<&[u32]> {
        (0..self.cell_count()).map(|c| self.cell(c)).collect()
    }

    /// Length of an edge or area of a triangle with these corners.
    pub fn measure_of(&self, corners: &[u32]) -> f64 {
        let places = corners.iter().map(|&v| self.point(&[v], &[1.0]));
        extent(&places.collect::<Vec<_>>())
    }
}
