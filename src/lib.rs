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
//! in space and the trapezoidal rule in time give errors of order h + k² (5.26). Equation numbers are
//! those of W. Xu, Z. Huang, W. Han, W. Chen, C. Wang, J. Comput. Appl. Math. (2019),
//! doi 10.1016/j.cam.2018.08.046.
//!
//! # Notation
//! | symbol | name here | shape | unit |
//! |---|---|---|---|
//! | u_n^{kh} | `u` | d numbers a node, free nodes first | length |
//! | ε(u) | `strain` | d(d+1)/2 numbers a cell, Mandel ([`tensor`]) | 1 |
//! | σ | `stress` | like ε | stress |
//! | 𝒜, ℬ_i | [`law::TensorField`] | a tensor a region, two Lamé numbers or S×S | stress |
//! | b_i(t) | [`law::MemoryKernel`] | ℝ₊ → ℝ, ℬ(t) = Σ b_i(t) ℬ_i | 1/time |
//! | μ, κ(ζ) | [`law::VonMises`], [`law::YieldLimit`] | | stress, strain |
//! | ζ | `zeta` ([`history::Accumulated`]) | one number a time | time |
//! | ∂j_ν, α_ν | [`law::Potential`] | interval a vertex of Γ3 | pressure, pressure/length |
//! | g | `gap` | a number a vertex of Γ3, ∞ without | length |
//! | ξ, λ | `compliance`, `multiplier` | a number a vertex of Γ3 | pressure |
//! | h = 1/n, k = T/N | `n`, `steps` | | length, time |
//!
//! # The house
//! Each module imports only those above it in this list; `tests/house.rs` enforces it.
//!
//! | module | holds |
//! |---|---|
//! | [`tensor`] | symmetric tensors in Mandel notation |
//! | [`record`] | what one case produced; the waist between computing and judging |
//! | [`linalg`] | sparse matrices on node blocks, Cholesky factorization, GMRES, multigrid |
//! | [`mesh`] | simplex meshes and their sides |
//! | [`space`] | P1 geometry, node numbering, quadrature |
//! | [`law`] | elasticity, projection, memory kernels, contact potentials |
//! | [`history`] | time grids and rules, the sums Σ' over the past |
//! | [`vhi`] | Problem 9 as a trait: constraint graphs, semismooth Newton, fixed point Λ, march |
//! | [`finite`] | Problem 9 in ℝ^m, an instance of `vhi` without a mesh |
//! | [`contact`] | Problem 14: assembly, contact trace, march in time, KKT residual |
//! | [`formula`] | formulas: parsing, exact derivatives, blocked evaluation |
//! | [`norms`] | errors against moments of the truth, reference runs |
//! | [`manufactured`] | exact fields and loads from formulas, and their verification |
//! | [`scene`] | scene files, as written and as validated |
//! | [`setup`] | a scene made computable; constants and hypotheses |
//! | [`external`] | a solver in another program as a scheme: cases as files, displacements read back |
//! | [`leading_error`] | the error of a sound scheme to leading order, from the exact solution alone |
//! | [`solution`] | named quantities and VTU files of a case |
//! | [`fit`], [`verdict`] | orders with intervals; predictions judged |
//! | [`report`] | pictures, page, JUnit |
//! | [`sweep`] | cases, threads, records, resume |
//! | [`distributed`] | a sweep in many processes: plan, jobs, records merged and judged |
//! | [`trade`] | speed against accuracy: knobs, cost and error models, optima; the error of a run from coarser ones |
//! | [`theory`] | the theorems' constants, bounds and inequalities as runs |
//! | [`diagnose`] | variants of a scene that name the term at fault |
//! | [`extremes`] | ladders of one parameter each, and what every rung must answer |
//! | [`cli`] | the commands |
#![doc = include_str!("../docs/LIBRARY.md")]

pub mod cli;
pub mod contact;
pub mod diagnose;
pub mod distributed;
pub mod external;
pub mod extremes;
pub mod finite;
pub mod fit;
pub mod formula;
pub mod history;
pub mod law;
pub mod leading_error;
pub mod linalg;
pub mod manufactured;
pub mod mesh;
pub mod norms;
pub mod record;
pub mod report;
pub mod scene;
pub mod setup;
pub mod solution;
pub mod space;
pub mod sweep;
pub mod tensor;
pub mod theory;
pub mod trade;
pub mod verdict;
pub mod vhi;
