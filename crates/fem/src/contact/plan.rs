//! The cheapest exact way to march a scene, from the terms it has.

use super::{Discretization, LinearSolver, Model};
use vhi::history::TimeGrid;
use vhi::law::Projection;

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
    pub fn of(space: &Discretization, model: &Model, steps: usize, newton: bool) -> Self {
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
    pub(crate) fn foreseen(model: &Model, dimension: usize) -> Self {
        if model.is_linear() {
            if Self::changes_factor(model) { Self::Linear } else { Self::Recursion }
        } else if dimension == 2 && model.projection.limit().is_none() && model.friction.is_none() {
            Self::Condensed
        } else {
            Self::Newton
        }
    }

    /// Matrices that the levels of a run on `grid` take, one after the other; `None` where the run decides.
    pub fn matrices(self, model: &Model, grid: &TimeGrid) -> Option<u32> {
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
        let slots: Vec<Vec<f64>> =
            (0..=grid.steps()).map(|n| model.last_weights(grid, n).collect()).collect();
        Some(1 + slots.windows(2).filter(|pair| pair[0] != pair[1]).count() as u32)
    }

    /// Whether the matrix of a level depends on the weight of its last slot by more than a factor.
    pub fn changes_factor(model: &Model) -> bool {
        model.memory_multiple().is_none()
    }
}

/// Unknowns from which on a run in three dimensions takes multigrid, if a factor serves a single step or so. Less than half
/// of them are enough for `punch-box`, but 1.2 to 1.9 times in a tenth of a second are not worth the iterations of
/// materials that are nearly incompressible.
///
/// `sweep solve punch-box --steps 4` with every term, CPU seconds (least of two runs, one at n = 24) and peak resident
/// memory, on a machine with other work:
///
/// | n | unknowns | direct | multigrid |
/// |---|---|---|---|
/// | 8 | 1,944 | 0.10 s, 18 MB | 0.08 s, 16 MB |
/// | 12 | 6,084 | 0.32 s, 31 MB | 0.19 s, 20 MB |
/// | 16 | 13,872 | 1.5 s, 66 MB | 0.48 s, 34 MB |
/// | 20 | 26,460 | 3.7 s, 134 MB | 0.98 s, 55 MB |
/// | 24 | 45,000 | 10 s, 251 MB | 1.9 s, 88 MB |
///
/// Multigrid alone, with start values of three levels: 4.7 s and 86 MB at n = 24 with 16 steps, 4.6 s and 189 MB at n = 32
/// (104,544 unknowns) with 4, 3.2 s and 351 MB at n = 40 (201,720) with one. With λ/μ_L = 1000 a solve takes 58 iterations
/// in place of 5, and n = 16 took 2.8 s against 5.2 s with factors that had the unknowns of Γ3 last, which cost twice those
/// of today. In the plane factors are cheaper at any size that fits in memory.
const MULTIGRID_FROM: usize = 5_000;
/// Unknowns a solve from which on the factor that serves all solves costs more than they do without one: about 15
/// solves at 104,544 unknowns; a factor in three dimensions grows with the square of the unknowns, a solve in
/// proportion to them.
const UNKNOWNS_A_SOLVE: usize = 7_000;
/// M/m of the elasticity from which on conjugate gradients take longer than factors at 45,000 unknowns: iterations grow
/// like its root. `yielding-box`, n = 24, one step: 88 iterations with λ/μ_L = 1, 303 with 100, 848 with 1,000 (3.7 s
/// against 2.8 s with factors), 2,862 with 10⁴.
const RATIO_OF_SPEED: f64 = 1e3;
/// M/m up to which sweeps in single precision, with a unit roundoff of 2⁻²⁴, are right to a thousandth. At 60 times this
/// their rounding makes the cycle indefinite.
pub const MULTIGRID_RATIO: f64 = 1e-3 * 16_777_216.0;

impl LinearSolver {
    /// The solver of a run of `steps` steps: the one that `space` names, or the cheaper one by size and number of
    /// solves with one matrix. Factors where the mesh has no levels, or the elasticity is too stiff one way.
    pub fn of(space: &Discretization, model: &Model, steps: usize) -> Self {
        // Linear runs and condensed ones have one matrix; a step of the others factorizes anew about once.
        let one =
            model.is_linear() || Plan::foreseen(model, space.mesh.dimension) == Plan::Condensed;
        let least = if one { UNKNOWNS_A_SOLVE * (steps + 1) } else { MULTIGRID_FROM };
        let (d, ratio) = (space.mesh.dimension, model.elasticity.ratio(space.mesh.dimension));
        let faster = d == 3 && space.dofs() >= least && ratio <= RATIO_OF_SPEED;
        let of_least_cost = if faster { Self::Multigrid } else { Self::Direct };
        match space.linear_solver.unwrap_or(of_least_cost) {
            Self::Multigrid if ratio <= MULTIGRID_RATIO && space.levels().is_some() => {
                Self::Multigrid
            }
            _ => Self::Direct,
        }
    }
}

/// Whether Γ3 has one graph an unknown, and a full matrix there is no dearer to factorize than the volume's.
fn is_small(space: &Discretization) -> bool {
    let free = space.trace.points.iter().filter(|point| point.carries()).count();
    free == space.trace.unknowns().len()
        && (free as f64).powi(3) <= 3.0 * space.factor_size()[1].max(1e5)
}
