//! The proofs of Theorems 10 and 11 as a checklist: every line with both sides computed, at every t_n
//! of real runs.
//!
//! u is known, u^{kh} is a run's, v^h is the nodal interpolant of u. A, φ, S and j⁰ are evaluated here,
//! apart from the solver; of a run only u_j^{kh} and the multipliers are read. The load of the truth
//! enters in strong form (f0 by differentiation), so that the two forms of E_n, over the body and on the
//! contact side, are two computations. What the quadrature of a run (boundary rule, load vector) adds to
//! (4.9) is a separate term there, E_q.

mod case;
mod constants;
mod contact;
mod discrete;
mod document;
mod edges;
mod fields;
mod in_space;
mod integrals;
mod law;
mod level;
mod lines;
mod memory;
mod place;
mod pointwise;
mod scene;
mod sides;
mod smooth;
mod strips;

pub use case::{AuditError, Auditor, CaseAudit, CaseLine, audit_case};
pub use constants::AuditConstants;
pub use lines::{Line, LineStanding, Relation, Statement};
pub use memory::audit_runs;
pub use scene::{SceneAudit, SceneLine};
