//! Source: a plan per scene that costs what its terms cost, and a step loop that allocates nothing.
//! Goal: the counters of a run are zero for terms that a scene does not have, and nobody asks the components of such a
//!   term; a march of twice the steps makes no more allocations than what it keeps on purpose, one vector a level and
//!   term for sums over the past; runs on one mesh share its factors, and whole runs take no more work than recorded.
//!   Each check fails where it has to.
//! Mesh: the coarsest that a scene has for the counters; 16 × 16 for allocations, 4 × 4 and 6 × 6 where
//!   vectors are kept, 4 × 4 × 4 in space; 8 × 8 for shared factors, 32 × 32 and 48 × 48 for whole runs.

mod absent;
mod allocations;
mod counters;
mod factors;
#[path = "../shipped/mod.rs"]
mod shipped;
