//! Stability at the extremes: ladders of one parameter each, from the ordinary to where floating point or the
//! theory ends. Every rung states beforehand what it must show, an error bound that is derived beside it or the
//! refusal it must meet, and is measured; nothing may be lost, and nothing may be silently wrong.

mod bodies;
mod rung;
mod scalars;
mod units;

pub use rung::{
    Climb, Ladder, Largest, Measured, Prepare, Rung, SceneAnswer, Unanswered, UnderTest, admit,
    claims, climb, found, solve,
};
pub use units::{Unitless, Units};

/// All ladders. The largest meshes are climbed only where `long` says so.
pub fn catalogue(long: bool) -> Vec<Ladder> {
    let others = [
        bodies::locking(),
        bodies::projection(),
        bodies::yield_limit(),
        bodies::through_zero(),
        bodies::body_step(),
        bodies::long_march(if long { 5 } else { 4 }),
        scalars::smallness(),
        scalars::falling_memory(),
        scalars::rising_memory(),
        scalars::fixed_point(),
        bodies::load(),
        bodies::gap(),
        bodies::one_vertex(),
        bodies::short_clamp(),
        bodies::mesh_size(if long { 512 } else { 64 }),
        bodies::aspect_ratio(),
        bodies::sliver(),
        bodies::subnormal(),
    ];
    units::ladders().into_iter().chain(others).collect()
}
