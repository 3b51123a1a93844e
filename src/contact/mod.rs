//! Problem 14: the contact problem in P1 elements as an instance of `vhi`.

mod assembly;
mod boundary;
mod compliance;
mod discretization;
mod evolution;
mod floor;
mod frames;
mod kkt;
mod kkt_compliance;
mod linear;
mod load;
mod march;
mod model;
mod open_level;
mod pieces;
mod problem;
mod trace;
mod trace_constant;

pub use assembly::{stiffness_of, stress_force};
pub use discretization::Discretization;
pub use evolution::Evolution;
pub use floor::{Floors, LevelFields, strain_distance};
pub use frames::Frames;
pub use kkt::kkt_residual;
pub use linear::strain_norm;
pub use load::{Load, LoadError};
pub use march::{CaseError, CaseInfo, KKT_ALLOWED, Observer, StepView, march};
pub use model::{Boundary, BoundaryRule, MemoryTerm, Model, OnContact, relaxation};
pub use open_level::OpenLevel;
pub use problem::{ContactProblem, LastSlot};
pub use trace::{ContactTrace, TracePoint, facet_measure};
pub use trace_constant::{TraceMass, trace_constant};
