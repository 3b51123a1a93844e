//! Source: a plan per scene that costs what its terms cost, and a step loop that allocates nothing.
//! Goal: the counters of a run are zero for terms that a scene does not have; a march of twice the steps makes no more
//!   allocations than what it keeps on purpose; runs on one mesh share its factors. Each check fails where it has to.
//! Mesh: the coarsest that a scene has for the counters, 16 × 16 and more for allocations.

mod absent;
mod allocations;
mod counters;
mod factors;
#[path = "../shipped/mod.rs"]
mod shipped;
