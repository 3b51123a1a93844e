//! What an answer has to hold, and the names of its files.

/// (N + 1) × vertices × d.
pub(crate) const DISPLACEMENT: &str = "displacement.npy";
/// A table with columns n, vertex, ux, uy (and uz).
pub(crate) const DISPLACEMENT_TABLE: &str = "displacement.csv";
/// ξ + λ at the rows of contact.csv, (N + 1) × rows.
pub(crate) const PRESSURE: &str = "pressure.npy";
/// ParaView's index of a series: time and file of each level.
pub(crate) const COLLECTION: &str = "displacement.pvd";

/// What an answer has to hold.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// t_0 … t_N.
    pub times: &'a [f64],
    /// All vertices of the mesh; z = 0 in the plane.
    pub vertices: &'a [[f64; 3]],
    pub dimension: usize,
}
