//! The cheapest exact way to march a scene, from the terms it has.

use super::{Discretization, LinearSolver, MemoryTerm, Model};
use vhi::history::TimeGrid;
use vhi::law::{Convolution, Projection};

/// How the levels of a scene are solved. All ways that apply have the same discrete solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plan {
    /// Linear, memory a multiple of the elasticity or absent: one matrix, solves that ask for no past; where the load
    /// separates in time a solve a part of it, and coefficient vectors.
    Recursion,
    /// Linear, with any other memory: one matrix for each weight of the last slot, a solve per level.
    Linear,
    /// Contact without projection and friction: a matrix as in linear scenes, a small full problem on Γ3 per level.
    Condensed,
    /// Newton's method in the volume.
    Newton,
}

impl Plan {
    /// Its name in output.
    pub fn name(self) -> &'static str {
        match self {
            Self::Recursion => "recursion",
            Self::Linear => "linear",
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
            Self::Condensed if !(is_small(space) && direct()) => Self::Newton,
            plan if newton => plan,
            _ => Self::Newton,
        }
    }

    /// The plan where Γ3 is small beside the body. That is so in the plane: in space a factor with Γ3 last costs a
    /// multiple of one without, and a full matrix on n² unknowns is no small problem.
    pub(crate) fn foreseen<P: Projection>(model: &Model<P>, dimension: usize) -> Self {
        if model.is_linear() {
            if Self::changes_factor(model) { Self::Linear } else { Self::Recursion }
        } else if dimension == 2 && model.projection.limit().is_none() && model.friction.is_none() {
            Self::Condensed
        } else {
            Self::Newton
        }
    }

    /// Matrices that the levels of a run on `grid` take, one after the other; `None` where the run decides.
    pub fn matrices<P: Projection>(self, model: &Model<P>, grid: &TimeGrid) -> Option<u32> {
        if self == Self::Newton {
            return None;
        }
        if !Self::changes_factor(model) {
            return Some(1);
        }
        // An old matrix serves on other grids, as long as it pays.
        if !grid.is_uniform() {
            return None;
        }
        let weight = |n: usize, term: &MemoryTerm| {
            model.time_rule.kernel_weight(&Convolution(&*term.kernel), grid, n, n)
        };
        let slot = |n: usize| model.memory.iter().map(|term| weight(n, term)).collect::<Vec<_>>();
        let slots: Vec<Vec<f64>> = (0..=grid.steps()).map(slot).collect();
        Some(1 + slots.windows(2).filter(|pair| pair[0] != pair[1]).count() as u32)
    }

    /// Whether the matrix of a level depends on the weight of its last slot by more than a factor.
    pub fn changes_factor<P: Projection>(model: &Model<P>) -> bool {
        model.memory_multiple().is_none()
    }
}

/// Whether Γ3 has one graph an unknown, and a full matrix there is no dearer to factorize than the volume's.
fn is_small(space: &Discretization) -> bool {
    let free = space.trace.points.iter().filter(|point| point.carries()).count();
    free == space.trace.unknowns().len()
        && (free as f64).powi(3) <= 3.0 * space.factor_size()[1].max(1e5)
}
