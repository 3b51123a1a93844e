//! Stability at the extremes: ladders of one parameter each, from the ordinary to where floating point or the
//! theory ends. Every rung states beforehand what it must show, an error bound that is derived beside it or the
//! refusal it must meet, and is measured; nothing may be lost, and nothing may be silently wrong.

mod climb;
mod ladders;
mod measure;
mod rung;
mod units;

pub use climb::{admit, claims, climb, found};
pub use ladders::catalogue;
pub use rung::{Ladder, Measured, Rung, SceneAnswer, Unanswered, UnderTest, solve};
pub use units::{Unitless, Units};
