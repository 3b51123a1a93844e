//! Λ and Newton's method at one level over a ladder of step sizes.

use super::factor::{contraction, finite_factor, random_finite_factor, solve};
use super::starts::random_starts;
use algebra::linalg::EigenError;
use serde::{Serialize, Serializer};
use vhi::{FixedPoint, FrozenDerivative, Scratch, StepBounds, StepError, StepSolver, StepState};

/// The iterations in which a solver found a solution, or why it found none; as JSON the number, or the reason.
pub type StepOutcome = Result<u32, StepError>;

fn outcome<S: Serializer>(outcome: &StepOutcome, serializer: S) -> Result<S::Ok, S::Error> {
    match outcome {
        Ok(iterations) => serializer.serialize_u32(*iterations),
        Err(error) => serializer.collect_str(error),
    }
}

/// What was measured at one step size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepRung {
    /// k.
    pub k: f64,
    /// ‖DΛ‖ at η, the worst direction.
    pub norm: f64,
    /// Spectral radius of DΛ at η.
    pub radius: f64,
    /// Largest real eigenvalue of DΛ at η.
    pub rightmost: f64,
    /// ‖Λ(η + δd) - Λη‖/‖δd‖ in the worst direction of the derivative.
    pub finite_worst: f64,
    /// The largest such ratio of some random directions.
    pub finite_random: f64,
    /// True if η is the solution of the step; false where Newton's method found none, and η is the
    /// solution of the largest step that had one.
    pub at_solution: bool,
    /// Newton's method from the solution of the step size before.
    #[serde(serialize_with = "outcome")]
    pub newton: StepOutcome,
    /// The iteration η ← Λη from u_n of the run.
    #[serde(serialize_with = "outcome")]
    pub fixed_point: StepOutcome,
    /// Other solutions that Newton's method finds from random starts.
    pub distinct: u32,
    /// Bounds of `norm`: sharpened, (3.15), and (3.15) with the norms of the paper.
    pub sharpened: f64,
    /// (3.15) with operator norms.
    pub theorem: f64,
    /// (3.15) with the norms of the paper.
    #[serde(rename = "paper_norm")]
    pub paper: f64,
}

/// Random directions of finite perturbations, and random starts, at each step size.
const DIRECTIONS: u64 = 3;
const STARTS: u64 = 3;

/// Iterations of Λ after which a step size is not followed further: 400 reach 1e-13 for factors up
/// to 0.93.
const ITERATIONS: u32 = 400;

/// Λ at the open level, with solutions followed from one step size to the next.
pub struct StepLadder<'a, L> {
    level: &'a mut L,
    bounds: StepBounds,
    /// The solution of the level in the run.
    of_run: StepState,
    /// The last solution found.
    followed: StepState,
}

impl<'a, L: FrozenDerivative> StepLadder<'a, L> {
    /// The open `level` whose solution in the run is `of_run`.
    pub fn new(level: &'a mut L, bounds: StepBounds, of_run: StepState) -> Self {
        Self { level, bounds, followed: of_run.clone(), of_run }
    }

    /// The solution at step size k, from the last one found.
    fn follow(&mut self, k: f64) -> StepOutcome {
        self.level.set_step(k);
        let mut state = self.followed.clone();
        let info = solve(self.level, None, &mut state)?;
        self.followed = state;
        Ok(info.iterations)
    }

    /// Measures at one step size.
    ///
    /// # Errors
    /// A frozen level that cannot be solved, an eigenvalue that does not settle.
    pub fn rung(&mut self, k: f64) -> Result<StepRung, BoundError> {
        let newton = self.follow(k);
        let at = |source: StepError| BoundError::Frozen { k, source };
        // η: the solution at k where there is one; and Λη.
        let (eta, mut state) = (self.followed.u.clone(), self.followed.clone());
        solve(self.level, Some(&eta), &mut state).map_err(at)?;
        let found = contraction(self.level, &eta, &state)
            .map_err(|source| BoundError::Factor { k, source })?;
        let finite_worst = match found.norm {
            0.0 => 0.0,
            _ => finite_factor(self.level, &eta, &state, &found.direction).map_err(at)?,
        };
        let finite_random =
            random_finite_factor(self.level, &eta, &state, DIRECTIONS).map_err(at)?;
        Ok(StepRung {
            k,
            norm: found.norm,
            radius: found.radius,
            rightmost: found.rightmost,
            finite_worst,
            finite_random,
            at_solution: newton.is_ok(),
            newton,
            fixed_point: self.fixed_point(k),
            distinct: random_starts(self.level, &self.followed, STARTS).distinct,
            sharpened: self.bounds.sharpened_factor(k),
            theorem: self.bounds.factor(k),
            paper: self.bounds.paper_factor(k),
        })
    }

    /// The iteration from the solution of the run.
    fn fixed_point(&mut self, k: f64) -> StepOutcome {
        self.level.set_step(k);
        let solver = FixedPoint { max_iterations: ITERATIONS, ..FixedPoint::default() };
        let mut state = self.of_run.clone();
        let info = solver.solve_level(self.level, &mut state, &mut Scratch::default())?;
        Ok(info.fixed_point_iterations)
    }
}

/// Why a step-size study could not be made.
#[derive(Debug, thiserror::Error)]
pub enum BoundError {
    #[error("k = {k}: the level with frozen last slot was not solved: {source}")]
    Frozen { k: f64, source: StepError },
    #[error("k = {k}: the contraction factor was not found: {source}")]
    Factor { k: f64, source: EigenError },
    #[error(transparent)]
    Setup(#[from] scene::setup::SetupError),
    #[error("the run to the level: {0}")]
    Run(#[from] fem::contact::CaseError),
    /// A level of an abstract problem in ℝ^m failed.
    #[error("the run to the level: {0}")]
    Finite(#[from] vhi::finite::FiniteError),
    #[error("the run to the level: {0}")]
    Step(#[from] vhi::FailedStep),
    /// The rule gives the last slot no weight: Λ is constant.
    #[error("the time rule gives the last slot no weight: every k is within (3.4)")]
    NoLastSlot,
    /// A run without a step has no level with a last slot.
    #[error("a run with {steps} steps has no level to study")]
    NoLevel {
        /// N.
        steps: u32,
    },
    /// An eigenvalue of the mesh was not found.
    #[error("a constant of the mesh: {0}")]
    Constant(#[from] EigenError),
}
