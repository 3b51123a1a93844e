//! Which linear solver a run uses: a factor of each Jacobian, or conjugate gradients with multigrid.

use super::{Discretization, Model, Plan};
use crate::mesh::Nesting;
use crate::space::Element;
use algebra::linalg::{
    FactorError, Levels, MultigridSequence, NodeFrame, SequenceSolver, TangentSolver,
};
use vhi::law::Projection;

/// A solver of the linear systems of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinearSolver {
    /// Sparse Cholesky factors.
    Direct,
    /// Conjugate gradients with a multigrid cycle; meshes that refine a coarser one.
    Multigrid,
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
/// Levels are added until this many unknowns are left: their factor costs less than a sweep of the next level.
const COARSEST: usize = 1_000;
/// With more unknowns than this on the coarsest level its factor is no small matter, and a mesh has no use for levels.
const LARGEST_COARSEST: usize = 8_000;

impl LinearSolver {
    /// The solver of a run of `steps` steps: the one that `space` names, or the cheaper one by size and number of
    /// solves with one matrix. Factors where the mesh has no levels.
    pub fn of<P: Projection>(space: &Discretization, model: &Model<P>, steps: usize) -> Self {
        // Linear runs and condensed ones have one matrix; a step of the others factorizes anew about once.
        let one =
            model.is_linear() || Plan::foreseen(model, space.mesh.dimension) == Plan::Condensed;
        let least = if one { UNKNOWNS_A_SOLVE * (steps + 1) } else { MULTIGRID_FROM };
        let large = space.mesh.dimension == 3 && space.dofs() >= least;
        let by_size = if large { Self::Multigrid } else { Self::Direct };
        match space.linear_solver.unwrap_or(by_size) {
            Self::Multigrid if space.levels().is_some() => Self::Multigrid,
            _ => Self::Direct,
        }
    }

    /// A solver of Jacobians on `space`: factors where the mesh has no levels.
    ///
    /// # Errors
    /// The pattern cannot be analysed.
    pub(crate) fn on(self, space: &Discretization) -> Result<TangentSolver<'_>, FactorError> {
        Ok(match self.levels(space) {
            Some(levels) => {
                TangentSolver::Multigrid(MultigridSequence::new(levels, &space.pattern).into())
            }
            None => {
                let solver = SequenceSolver::new(space.analysis()?, &space.pattern);
                TangentSolver::Direct(solver.in_precision(space.precision).into())
            }
        })
    }

    /// The levels it works on.
    pub(super) fn levels(self, space: &Discretization) -> Option<&Levels> {
        match self {
            Self::Multigrid => space.levels(),
            Self::Direct => None,
        }
    }

    /// The name by which a command takes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Multigrid => "multigrid",
        }
    }
}

/// The levels below a space whose mesh refines as `nesting` says; none where it refines nothing, or not often enough.
///
/// # Errors
/// The analysis of the coarsest matrix.
pub(super) fn levels(
    space: &Discretization,
    nesting: &Nesting,
) -> Result<Option<Levels>, FactorError> {
    // Transfers are those of linear functions.
    if space.element != Element::P1 {
        return Ok(None);
    }
    let d = space.mesh.dimension;
    let (mut parents, mut nesting) = (Vec::new(), nesting.clone());
    let mut unknowns = space.dofs();
    while unknowns > COARSEST
        && let Some((next, coarser)) = nesting.coarsened()
    {
        unknowns = d * next.iter().flatten().max().map_or(0, |&last| last as usize + 1);
        parents.push(next);
        nesting = coarser;
    }
    let free = &space.nodes.vertex[..space.nodes.free];
    let coordinates: Vec<f64> = free.iter().flat_map(|&v| space.mesh.vertex(v).to_vec()).collect();
    let frames = space.frames.rows();
    let frames = frames.map(|(node, rows)| NodeFrame { node, rows }).collect();
    let levels =
        Levels::new(&space.pattern, &space.nodes.of_vertex, &parents, &coordinates, frames)?;
    Ok(levels.filter(|levels| levels.coarsest_unknowns() <= LARGEST_COARSEST))
}
