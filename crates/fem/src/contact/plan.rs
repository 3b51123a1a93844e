//! How the levels of a scene are solved, from the terms it has.

use super::{Discretization, Model};
use vhi::law::Projection;

/// How levels are solved. Where several ways apply they have the same discrete solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plan {
    /// Nothing is nonlinear: one solve.
    Linear,
    /// Contact is all that is nonlinear: a small full problem on Γ3, and one solve.
    Condensed,
    /// Newton's method in the volume.
    Newton,
}

impl Plan {
    /// Its name in output.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Condensed => "condensed",
            Self::Newton => "newton",
        }
    }

    /// The plan of runs of `model` on `space`.
    pub fn of(space: &Discretization, model: &Model) -> Self {
        let linear = model.projection.limit().is_none() && model.friction.is_none();
        match model.boundary.is_empty() {
            true if linear => Self::Linear,
            false if linear && is_small(space) => Self::Condensed,
            _ => Self::Newton,
        }
    }

    /// Whether the matrix of a level depends on the weight of its last slot by more than a factor.
    pub fn changes_factor(model: &Model) -> bool {
        model.memory_multiple().is_none()
    }
}

/// True if each unknown on Γ3 carries one graph and factorizing the dense matrix on Γ3 costs no more than factorizing the
/// volume's. That holds in the plane; in space a factor with Γ3 last costs several times one without.
fn is_small(space: &Discretization) -> bool {
    let free = space.trace.points.iter().filter(|point| point.carries()).count();
    space.mesh.dimension == 2
        && free == space.trace.unknowns().len()
        && (free as f64).powi(3) <= 3.0 * space.factor_size()[1].max(1e5)
}
