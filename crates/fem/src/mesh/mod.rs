//! Simplex meshes: vertices, cells, boundary facets with named sides.

mod coarse;
mod coarse_mesh;
mod cuboid;
mod edgewise;
mod family;
mod geometry;
mod gmsh;
mod grading;
mod hierarchy;
mod quality;
mod rectangle;
mod simplices;
mod solid;
mod subdivision;
mod triangulation;

// For the side of the truth, which sees of the solver meshes and spaces alone.
pub use algebra::in_dimension;
pub use coarse::{BoundaryEdge, Coarse, CoarseError};
pub use coarse_mesh::{CoarseMesh, Piece};
pub use cuboid::cuboid;
pub use family::Family;
pub use gmsh::{Fault, GmshError, read_gmsh, write_gmsh};
pub use grading::vertex_at;
pub use hierarchy::Nesting;
pub use quality::Quality;
pub use rectangle::rectangle;
pub use simplices::{Mesh, PlanePart, WHOLE};
pub use solid::{At, BoundaryFace, Solid, SolidError};
pub use subdivision::{Parents, refined};
pub use triangulation::{PolygonError, triangulate};
