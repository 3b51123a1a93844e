//! Exact solutions from formulas: fields, loads, contact state, and their verification.
//!
//! Independence: the stress here is computed from full tensors by [`constitutive`], at the accuracy
//! of formulas and adaptive quadrature. Nothing is taken from `law`, `history` or the solver.

mod accumulated;
mod check;
pub mod constitutive;
mod double_exponential;
mod exact;
mod finite_exact;
mod interpolated;
mod on_mesh;
mod reduction;
mod running_integral;
mod sign_changes;
mod symbolic;
mod truth;

pub use accumulated::AccumulatedStrain;
pub use check::{
    Finding, SideOfRectangle, Status, check, regularity_in_space, regularity_in_time,
    second_difference,
};
pub use exact::{
    BoundaryFormulas, ContactFormulas, Exact, ExactData, LawNumbers, LoadForm, MaterialNumbers,
};
pub use finite_exact::{FiniteData, FiniteExact, FiniteState, FiniteTrace, Unresolved};
pub use interpolated::InterpolatedOnMesh;
pub use on_mesh::ExactOnMesh;
pub use truth::Truth;
