//! What one case leaves behind for people and other programs: named quantities, VTU files.

mod final_state;
mod pressed_zone;
mod series;
mod vtu;

pub use final_state::FinalState;
pub use pressed_zone::PressedZone;
pub use series::VtuSeries;
pub use vtu::{Field, VtuGrid, write_pvd, write_vtu};
