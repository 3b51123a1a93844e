//! How far an error may be from its recorded value, and changes in words.

/// Relative difference of an error between machines: elementary functions and fused products differ by 1e-16, amplified
/// by the condition of the system (1e5 on the finest meshes) and by cancellation in errors of 1e-5 of the solution.
pub const REPEATED_WITHIN: f64 = 1e-6;
/// Floors by which two runs may differ near the floor: one each, and a factor of safety …
const FLOORS_APART: f64 = 4.0;
/// … but a deviation of one percent never passes.
const LOOSEST: f64 = 5e-3;

pub(super) fn allowed(error: f64, floor: f64) -> f64 {
    (FLOORS_APART * floor / error).clamp(REPEATED_WITHIN, LOOSEST)
}

/// A relative change in percent, with enough digits to show it.
pub(super) fn in_percent(change: f64) -> String {
    let percent = 100.0 * change;
    if percent.abs() < 0.1 { format!("{percent:+.1e} %") } else { format!("{percent:+.1} %") }
}
