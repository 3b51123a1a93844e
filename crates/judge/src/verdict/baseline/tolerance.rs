//! How far an error may be from its recorded value, and changes in words.

/// Relative difference of an error between machines: elementary functions and fused products differ by 1e-16, amplified
/// by the condition of the system (1e5 on the finest meshes) and by cancellation in errors of 1e-5 of the solution.
pub(super) const REPEATED_WITHIN: f64 = 1e-6;
/// Floors by which two runs may differ near the floor: one each, and a factor of safety …
const FLOORS_APART: f64 = 4.0;
/// … but a deviation of one percent never passes.
const LOOSEST: f64 = 5e-3;

/// … and only the part of a floor that is rounding, on errors of size one and on larger ones in proportion. The rest is
/// quadrature and the error of a reference, which repeat: a change within it is a change of the program.
const ROUNDING: f64 = 1e-12;

/// The relative deviation that is allowed of an error with this floor; `largest` is the largest of the norm in the scene.
pub(super) fn allowed(error: f64, floor: f64, largest: f64) -> f64 {
    let rounding = floor.min(ROUNDING * largest.max(1.0));
    (FLOORS_APART * rounding / error).clamp(REPEATED_WITHIN, LOOSEST)
}

/// That of a distance or measure of contact sets: on a tie a set gains or loses a sample of a facet, of which an edge has
/// eight, the edge of a triangle four.
pub(super) fn of_sets(error: f64, h: f64, dimension: u32) -> f64 {
    let samples = if dimension == 3 { 4.0 } else { 8.0 };
    (h / samples / error).max(REPEATED_WITHIN)
}

/// A relative change in percent, with enough digits to show it.
pub(super) fn in_percent(change: f64) -> String {
    let percent = 100.0 * change;
    if percent.abs() < 0.1 { format!("{percent:+.1e} %") } else { format!("{percent:+.1} %") }
}
