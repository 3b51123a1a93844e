//! Gronwall verifies error estimates of history-dependent variational-hemivariational inequalities.
//!
//! # The problem
//! Find u(t) ∈ U with, for all v ∈ U = {v ∈ V : v_ν ≤ g on Γ3},
//!
//! ```text
//! σ = 𝒜ε(u) + μ(ε(u) - P_{M(κ(ζ))} ε(u)) + ∫_0^t ℬ(t-s) ε(u(s)) ds,  ζ(t) = ∫_0^t ‖ε(u(s))‖ ds   (5.1)
//! (σ, ε(v-u)) + ∫_{Γ3} j_ν⁰(u_ν; v_ν-u_ν) ≥ F(v-u)
//! ```
//!
//! a viscoelastic body in frictionless contact with a nonmonotone layer over a rigid one. P1 elements
//! in space and the trapezoidal rule in time give errors of order h + k² (5.26). Beyond the paper there are friction,
//! quadratic elements, other rules in time and singular kernels. Equation numbers are
//! those of W. Xu, Z. Huang, W. Han, W. Chen, C. Wang, J. Comput. Appl. Math. (2019),
//! doi 10.1016/j.cam.2018.08.046.
//!
//! # Notation
//! | symbol | name here | shape | unit |
//! |---|---|---|---|
//! | u_n^{kh} | `u` | d numbers per node, free nodes first | length |
//! | ε(u) | `strain` | d(d+1)/2 numbers per cell, Mandel ([`algebra::tensor`]) | 1 |
//! | σ | `stress` | like ε | stress |
//! | 𝒜, ℬ_i | [`law::TensorField`] | a tensor per region, two Lamé numbers or S×S | stress |
//! | b_i(t) | [`law::MemoryKernel`] | ℝ₊ → ℝ, ℬ(t) = Σ b_i(t) ℬ_i | 1/time |
//! | μ, κ(ζ) | [`law::VonMises`], [`law::YieldLimit`] | | stress, strain |
//! | ζ | `zeta` ([`history::Accumulated`]) | one number per time | length^{d/2} time |
//! | ∂j_ν, α_ν | [`law::Potential`] | interval a vertex of Γ3 | pressure, pressure/length |
//! | g | `gap` | a number per vertex of Γ3, ∞ without | length |
//! | ξ, λ | `compliance`, `multiplier` | a number per vertex of Γ3 | pressure |
//! | h = 1/n, k = T/N | `n`, `steps` | | length, time |
//!
//! # The house
//! Eleven crates, each of which knows those named beside it and no other; this one is the program `sweep`, and shows
//! of the others what its users call. `tests/commands/house.rs` holds the table.
//!
//! | crate | knows | holds |
//! |---|---|---|
//! | `algebra` | | [`algebra::tensor`]: symmetric tensors in Mandel notation; [`algebra::linalg`]: sparse matrices on node blocks, Cholesky factorization, solves with nearby matrices, eigenvalues |
//! | `vhi` | `algebra` | [`law`]: elasticity, projection, memory kernels, contact potentials; [`history`]: time grids and rules, the sums Σ' over the past; `vhi`: Problem 9 as a trait, semismooth Newton, fixed point Λ, march; `finite`: Problem 9 in ℝ^m |
//! | `fem` | `algebra`, `vhi` | [`fem::mesh`]; [`fem::space`]: elements, node numbering, quadrature; [`fem::contact`]: Problem 14 assembled and marched in time, KKT residual; [`fem::norms`]: errors against moments of the truth |
//! | `formula` | | [`formula`]: parsing, exact derivatives, hereditary integrals, evaluation in blocks |
//! | `exact` | `formula`, `fem` without its laws and assembly | [`exact`]: exact fields and loads from formulas, and their verification |
//! | `files` | | [`files`]: bounded reading, replacement that is whole or not at all |
//! | `fit` | `files` | [`fit`]: orders with intervals |
//! | `judge` | `files`, `fit` | [`record`]: what one case produced, the waist between computing and judging; [`verdict`]: predictions judged |
//! | `report` | `judge`, `files` | [`report`]: pictures, page, PDF, LaTeX, JUnit |
//! | `scene` | all above but `judge` and `report` | [`scene`]: scene files, as written and as validated; [`setup`]: a scene made computable, constants and hypotheses |
//! | `guarantee` | all above but `judge` and `report` | [`studies::guarantee`]: a guaranteed bound of the error in space |
//! | `leading_error` | all above but the solver's laws, assembly and march | [`run::leading_error`]: the error of a sound scheme to leading order, from the exact solution alone |
//! | `run` | all above | [`run::external`]: a solver in another program as a scheme; [`run::sweep`]: cases, threads, records, resume; [`run::merge`]: a sweep in many processes |
//! | `studies` | all above | [`studies::solution`]: named quantities and VTU files of a case; [`studies::trade`]: speed against accuracy; [`studies::theory`]: the theorems' constants, bounds and inequalities as runs; [`studies::diagnose`]: variants of a scene that name the term at fault; [`studies::extremes`]: ladders of one parameter each |
//! | `gronwall` | all | [`cli`]: the commands |
#![doc = include_str!("../docs/LIBRARY.md")]

pub mod cli;
pub mod shipped;

#[cfg(doctest)]
#[doc = include_str!("../docs/EXTENDING.md")]
#[doc = "```rust"]
#[doc = include_str!("../docs/elements/cubic.rs")]
#[doc = "```"]
mod extending {}

// The front door, and what its users need.
#[doc(inline)]
pub use judge::{
    fit::{Claim, Decision, Posterior},
    record::CaseRecord,
    verdict::Verdict,
};
#[doc(inline)]
pub use run::{FrontError, Sweep, Swept, sweep::Progress};
#[doc(inline)]
pub use scene::{Scene, setup::Scheme};

// Judging, scenes, laws and rules, and what stands in the signatures of what takes their place. All else is in the crates
// behind it.
pub use ::scene;
pub use ::vhi::{history, law};
pub use judge::{fit, record, verdict};
pub use scene::setup;

/// A case: what a scheme is given and returns.
pub mod contact {
    pub use fem::contact::{
        Boundary, BoundaryRule, CaseError, CaseInfo, Friction, MemoryTerm, Model, Observer,
        StepView, strain_distance, strain_norm,
    };
}

/// Elements.
pub mod space {
    pub use fem::space::quadrature;
    pub use fem::space::{Element, FiniteElement};
}

/// Newton's method of a level.
pub mod vhi {
    pub use ::vhi::Newton;
}
