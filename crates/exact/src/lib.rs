//! Exact solutions from formulas: fields, loads, contact state, and their verification.
//!
//! Independence: the stress is a formula, of interpolants computed from full tensors by [`constitutive`], at the accuracy
//! of formulas and adaptive quadrature, and turned into nodal forces by [`nodal_force`], without `law`, `history` or `vhi`. What both sides
//! share contains no law and no integral of the problem; `tests/commands/house.rs` lists it:
//! - of `contact`: `Discretization`, for the mesh, the node numbers of a load vector, cell areas and the order of the
//!   facets of Γ3 (a wrong one moves forces to wrong nodes, which no formula repeats); `LoadError`, a message;
//! - of `norms`: what errors are measured against, [`fem::norms::Moments`] and how it is filled. Both sides of an error
//!   must mean the same quantity there, by definition;
//! - `formula`, `mesh`, and the points and weights of `space::quadrature`, which are tested against external values.

mod accumulated;
mod check;
pub mod constitutive;
mod contact_samples;
mod curve;
mod cuts;
mod densities;
mod double_exponential;
mod edge_compliance;
mod exact;
mod facet_group;
mod fields;
mod finite_exact;
mod friction;
mod interpolated;
pub mod linear;
pub mod nodal_force;
mod nodal_strain;
pub mod number;
mod on_mesh;
mod onto;
mod remainders;
mod running_integral;
mod sampled;
mod shapes;
mod shared_program;
mod side_points;
mod sign_changes;
mod simplex_points;
mod strips;
mod symbolic;
mod truth;
mod zeta_domain;

pub use accumulated::AccumulatedStrain;
pub use check::{
    BodyFace, Finding, Status, check, regularity_in_space, regularity_in_time, second_difference,
};
pub use curve::CurveNumbers;
pub use densities::{Densities, point_by_point};
pub use edge_compliance::ComplianceRule;
pub use exact::{
    BoundaryFormulas, ContactFormulas, Exact, ExactData, LawNumbers, LoadForm, MaterialNumbers,
    RegionNumbers,
};
pub use finite_exact::{
    FiniteData, FiniteExact, FiniteState, FiniteTrace, KernelFormulas, Unresolved,
};
pub use friction::{FrictionBound, FrictionFormulas, FrictionOnSide, Sliding};
pub use interpolated::{InterpolatedOnMesh, points_of_nodes};
pub use nodal_strain::NodalStrain;
pub use on_mesh::ExactOnMesh;
pub use shapes::Shapes;
pub use sign_changes::sign_changes;
pub use truth::{ByTime, Truth};
