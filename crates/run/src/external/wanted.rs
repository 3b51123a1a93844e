//! What an answer has to hold, and the names of its files.

/// (N + 1) × vertices × d.
pub(crate) const DISPLACEMENT: &str = "displacement.npy";
/// A table with columns n, vertex, ux, uy (and uz).
pub(crate) const DISPLACEMENT_TABLE: &str = "displacement.csv";
/// ξ + λ at the rows of contact.csv, (N + 1) × rows.
pub(crate) const PRESSURE: &str = "pressure.npy";
/// What an answer has to hold.
#[derive(Debug, Clone, Copy)]
pub struct Wanted {
    /// N + 1.
    pub levels: usize,
    /// Vertices of the mesh, further nodes included.
    pub vertices: usize,
    pub dimension: usize,
}
