//! Stability at the extremes: ladders of one parameter each, from the ordinary to where floating point or the
//! theory ends. Every rung states beforehand what it must show, an error bound that is derived beside it or the
//! refusal it must meet, and is measured; nothing may be lost, and nothing may be silently wrong.

mod answer;
mod climb;
mod degenerate;
mod history;
mod invariance;
mod material;
mod memory;
mod rung;
mod scene_text;
mod small;
mod space_error;
mod touching;
mod under_test;
mod units;

pub use answer::{Prepare, SceneAnswer, Unanswered, solve};
pub use climb::{Climbed, claims, climb, found};
pub use memory::admit;
pub use rung::{Ladder, Largest, Measured, Run, Rung};
pub use under_test::{UnderTest, by_recursion};
pub use units::{Unitless, Units};

/// All ladders. The largest meshes are climbed only where `long` says so.
pub fn catalogue(long: bool) -> Vec<Ladder> {
    vec![
        invariance::length(),
        invariance::stiffness(),
        invariance::time(),
        invariance::displacement(),
        invariance::together(),
        space_error::locking(),
        space_error::locking_order(if long { 256 } else { 64 }),
        material::projection(),
        material::yield_limit(),
        material::through_zero(),
        material::body_step(),
        material::long_march(if long { 5 } else { 4 }),
        small::smallness(),
        small::falling_memory(),
        small::rising_memory(),
        small::fixed_point(),
        history::relaxation(),
        history::steps(),
        history::accumulated(),
        degenerate::sign_change(),
        touching::load(),
        touching::gap(),
        touching::one_vertex(),
        touching::short_clamp(),
        space_error::mesh_size(if long { 512 } else { 64 }),
        space_error::aspect_ratio(),
        degenerate::sliver(),
        degenerate::subnormal(),
    ]
}
