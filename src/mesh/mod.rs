//! Simplex meshes: vertices, cells, boundary facets with named sides.
//!
//! Storage is flat and of any dimension d: cell c has vertices `cells[c(d+1)..(c+1)(d+1)]`.

mod cuboid;
mod rectangle;

pub use cuboid::cuboid;
pub use rectangle::{Family, rectangle};

/// A conforming simplex mesh of a polygonal or polyhedral domain.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Space dimension d.
    pub dimension: usize,
    /// Cells per unit length n, so that h = 1/n is the reported mesh size.
    pub n: u32,
    /// Vertex coordinates, d numbers a vertex.
    pub coordinates: Vec<f64>,
    /// Vertex numbers, d + 1 a cell.
    pub cells: Vec<u32>,
    /// Boundary facets, d vertex numbers each.
    pub facets: Vec<u32>,
    /// The side a facet lies on: index into `sides`.
    pub facet_side: Vec<u32>,
    /// Names of the sides.
    pub sides: Vec<&'static str>,
    /// Outward unit normal of each (plane) side, d numbers a side.
    pub side_normal: Vec<f64>,
}

impl Mesh {
    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.coordinates.len() / self.dimension
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len() / (self.dimension + 1)
    }

    /// Mesh size h = 1/n by the convention of this project.
    pub fn h(&self) -> f64 {
        1.0 / f64::from(self.n)
    }

    /// Coordinates of a vertex.
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

    /// Index of a side by its name.
    pub fn side(&self, name: &str) -> Option<u32> {
        self.sides.iter().position(|s| *s == name).map(|s| s as u32)
    }

    /// The facets that lie on one of `sides`, in mesh order.
    pub fn facets_on<'a>(&'a self, sides: &'a [u32]) -> impl Iterator<Item = usize> + 'a {
        (0..self.facet_side.len()).filter(move |&f| sides.contains(&self.facet_side[f]))
    }

    /// Point with the given barycentric coordinates on a simplex of vertices (cell or facet),
    /// padded with zeros to three numbers.
    pub fn point(&self, simplex: &[u32], barycentric: &[f64]) -> [f64; 3] {
        let mut x = [0.0; 3];
        for (&v, &b) in simplex.iter().zip(barycentric) {
            for (component, value) in x.iter_mut().zip(self.vertex(v)) {
                *component += b * value;
            }
        }
        x
    }
}
