//! P1 finite elements on simplices: meshes, spaces, quadrature, the contact problem (5.1)-(5.5) assembled and marched in time, and norms
//! of its errors. Knows laws, histories and the abstract inequality; no formula and no exact solution.

pub mod contact;
pub mod mesh;
pub mod norms;
pub mod space;
