//! Families of meshes.

/// How the vertices of a generated mesh are placed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Family {
    /// The regular grid.
    Structured,
    /// Interior vertices moved by at most `amplitude`·h along each of the `axes`, by a seeded generator; in
    /// a refined mesh by that part of the smallest altitude around.
    Perturbed { amplitude: f64, seed: u64, axes: [bool; 3] },
    /// Vertices gathered at a corner: distances s from it become s^exponent. Plane meshes only.
    Graded { corner: [f64; 2], exponent: f64 },
}
