//! Problem 14: the contact problem in P1 elements as an instance of `vhi`.

mod assembly;
mod boundary;
mod case;
mod compliance;
mod condensed;
mod discretization;
mod evolution;
mod floor;
mod force_at_points;
mod frames;
mod friction;
mod friction_force;
mod histories;
mod kkt;
mod kkt_compliance;
mod last_slot;
mod level_fields;
mod load;
mod march;
mod model;
mod nodal_norms;
mod pieces;
mod plan;
mod problem;
mod stiffness;
mod trace;
mod trace_constant;

pub use assembly::stress_force;
pub use case::{CaseError, CaseInfo, KKT_ALLOWED, Observer, StepView, Work};
pub use discretization::Discretization;
pub use evolution::Evolution;
pub use floor::Floors;
pub use force_at_points::ForceAtPoints;
pub use frames::Frames;
pub use friction::{Friction, OnContactInTime};
pub use histories::Histories;
pub use kkt::{kkt_residual, out_of_balance};
pub use last_slot::LastSlot;
pub use level_fields::LevelFields;
pub use load::{Load, LoadError};
pub use march::march;
pub use model::{
    Boundary, BoundaryRule, MemoryTerm, Model, OnContact, relaxation, weighted_memory,
};
pub use nodal_norms::{strain_distance, strain_norm};
pub use plan::Plan;
pub use problem::ContactProblem;
pub use stiffness::StiffnessInverse;
pub use trace::{ContactTrace, Support, TracePoint, facet_measure};
pub use trace_constant::{TraceMass, TracePart, trace_constants, weighted_trace_constants};
