//! Simplex meshes: vertices, cells, boundary facets with named sides.

mod bisection;
mod coarse;
mod edgewise;
mod face;
mod family;
pub(crate) mod geometry;
mod gmsh;
mod grading;
mod lattice;
mod quality;
mod simplices;
mod subdivision;
mod triangulation;

// For the side of the truth, which sees of the solver meshes and spaces alone.
pub use algebra::in_dimension;
pub use coarse::{At, BoundaryFacet, CoarseError, CoarseFault, CoarseMesh, Piece};
pub use face::Face;
pub use family::Family;
pub use gmsh::{Fault, GmshError, REST, read_gmsh, write_gmsh};
pub use grading::vertex_at;
pub use lattice::lattice;
pub use quality::Quality;
pub use simplices::{Mesh, PlanePart, WHOLE};
pub use triangulation::{PolygonError, triangulate};
