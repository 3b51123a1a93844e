//! The cheapest exact way to march a scene, from the terms it has.

use super::{BoundaryRule, Discretization, LinearSolver, Model, condensed};
use vhi::law::Projection;

/// How the levels of a scene are solved. All ways that apply have the same discrete solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plan {
    /// Linear, memory a multiple of the elasticity or absent: one factor, coefficient vectors.
    Recursion,
    /// Contact without projection: one factor, a small full problem on Γ3 a level.
    Condensed,
    /// Newton's method in the volume.
    Newton,
}

impl Plan {
    /// Its name in output.
    pub fn name(self) -> &'static str {
        match self {
            Self::Recursion => "recursion",
            Self::Condensed => "condensed",
            Self::Newton => "newton",
        }
    }

    /// The plan of a run of `steps` steps; only a solver that is Newton's method alone (`newton`) may be replaced.
    pub fn of<P: Projection>(
        space: &Discretization,
        model: &Model<P>,
        steps: usize,
        newton: bool,
    ) -> Self {
        // What is condensed is a factor.
        let direct = || LinearSolver::of(space, model, steps) == LinearSolver::Direct;
        match Self::foreseen(model, space.mesh.dimension) {
            Self::Condensed if !(condensed::applies(space, model) && direct()) => Self::Newton,
            plan if newton => plan,
            _ => Self::Newton,
        }
    }

    /// The plan where Γ3 is small beside the body. That is so in the plane: in space a factor with Γ3 last costs a
    /// multiple of one without, and a full matrix on n² unknowns is no small problem.
    pub fn foreseen<P: Projection>(model: &Model<P>, dimension: usize) -> Self {
        let at_vertices = model.boundary.as_ref().is_some_and(|boundary| {
            boundary.rule == BoundaryRule::Vertex || boundary.potential.is_absent()
        });
        if model.is_linear() && !Self::changes_factor(model) {
            Self::Recursion
        } else if dimension == 2 && model.projection.limit().is_none() && at_vertices {
            Self::Condensed
        } else {
            Self::Newton
        }
    }

    /// Whether the matrix of a level depends on the weight of its last slot by more than a factor.
    pub fn changes_factor<P: Projection>(model: &Model<P>) -> bool {
        model.memory_multiple().is_none()
    }
}
