//! Eight inequalities of the proofs of Theorems 10 and 11 at every t_n of real runs, on the numbers of the solver and of the
//! truth: u^{kh}, its history and pressures and the forces that they leave; ε(u), σ, ξ + λ and F of the exact side.
//!
//! v^h is the nodal interpolant of u. ε(u) and σ enter by their L² projections onto the strains of V^h, which test functions
//! see: what they leave out adds as much to the left of (4.9) as to its right, and no more to the left of (4.7), (4.14) and
//! (4.17) than to the right. What the scheme's rule on Γ3 and its load add to (4.9) is a term of its own there, E_q.

mod constants;
mod level;
mod scene;

pub use constants::AuditConstants;
pub use level::{AuditError, Auditor};
pub use scene::{audit, audit_case, audit_runs, audit_under};
