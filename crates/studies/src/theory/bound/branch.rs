//! The solution of the open level followed in k: where factors reach one, and where it ends.
//!
//! With J the tangent of the step and J_0 that of the frozen level, J = J_0 (I - DΛ): the tangent is
//! singular exactly where DΛ has the eigenvalue one. So the step loses its solution where Λ does not
//! contract any more because of a positive eigenvalue; where the eigenvalues are negative, as for
//! ℬ(0) ≥ 0, Λ stops converging and the step stays solvable.

use super::crossing::{Crossing, crossing};
use super::factor::{self, eigenvalues, operator_norm};
use super::ladder::BoundError;
use vhi::{FrozenDerivative, StepError, StepState};

/// Where the followed solution ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Loss {
    /// The last k that continues it, and the first that does not.
    pub bracket: (f64, f64),
    /// The largest real eigenvalue of DΛ at the last k: one where the tangent is singular.
    pub rightmost: f64,
    /// What is seen beyond it.
    pub reason: Reason,
}

/// How the solution ends.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    NoSolution(StepError),
    /// It finds one at this distance, relative to the size of the last one: another one.
    Jump(f64),
    Singular,
    /// Nothing: it changes so fast with k that it was not followed further.
    NotFollowed,
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoSolution(StepError::Factor { .. }) => {
                write!(f, "the tangent is not positive definite beyond it")
            }
            Self::NoSolution(StepError::NotConverged { .. }) => {
                write!(f, "Newton's method finds no solution beyond it")
            }
            Self::NoSolution(error) => write!(f, "{error}"),
            Self::Jump(size) => {
                write!(f, "the solution ends; Newton's method jumps by {:.1} %", 100.0 * size)
            }
            Self::Singular => write!(f, "the tangent is singular"),
            Self::NotFollowed => write!(f, "not followed further: it changes too fast with k"),
        }
    }
}

/// What following the solution found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Branch {
    /// The k at which ‖DΛ‖ reaches one; none if Λ does not depend on η.
    pub norm: Option<Crossing>,
    /// The k at which the spectral radius of DΛ reaches one; none if Λ does not depend on η.
    pub radius: Option<Crossing>,
    /// Where the solution ends, if it does.
    pub loss: Option<Loss>,
}

/// Steps in k grow by at most this factor, and the solution may move by at most this share in one;
/// else the step is halved.
const LONGEST: f64 = 1.05;
const LARGEST_MOVE: f64 = 0.25;
/// A relative step in k below which no continuation is an end.
const SHORTEST: f64 = 1e-7;
/// Steps after which the solution is not followed further.
const STEPS: usize = 300;

/// The tolerance of Newton's method shrinks with the tangent where that becomes singular, rounding does
/// not: a residual that stalls at this multiple of it is a solution.
const STALLED: f64 = 64.0;
/// A largest eigenvalue above this at the end of the solution says that the tangent is singular there.
const NEARLY_ONE: f64 = 0.99;

/// A solution on the branch with the factors there.
#[derive(Clone)]
struct At {
    k: f64,
    state: StepState,
    norm: f64,
    radius: f64,
    rightmost: f64,
}

/// Follows the solution from `start`, the state at step size `from`, up to `to`.
///
/// # Errors
/// A frozen level that cannot be solved, an eigenvalue that does not settle.
pub(crate) fn follow<L: FrozenDerivative>(
    level: &mut L,
    start: &StepState,
    from: f64,
    to: f64,
) -> Result<Branch, BoundError> {
    let first = solve(level, from, start)
        .map_err(|source| BoundError::Frozen { k: from, source })
        .and_then(|state| measure(level, from, state, 0.0))?;
    let mut path = vec![first];
    let (mut ratio, mut loss) = (LONGEST, None);
    loop {
        let here = path[path.len() - 1].clone();
        if here.k >= to {
            break;
        }
        if path.len() >= STEPS {
            let (bracket, rightmost) = ((here.k, to), here.rightmost);
            loss = Some(Loss { bracket, rightmost, reason: Reason::NotFollowed });
            break;
        }
        let k = (here.k * ratio).min(to);
        match advance(level, &here, k)? {
            Ok(next) => {
                path.push(next);
                ratio = ratio.powi(2).min(LONGEST);
            }
            Err(_) if ratio - 1.0 > SHORTEST => ratio = ratio.sqrt(),
            Err(reason) => {
                loss = Some(Loss { bracket: (here.k, k), rightmost: here.rightmost, reason });
                break;
            }
        }
    }
    let mut reaches = |of: fn(&At) -> f64, exact: Exact<L>| -> Result<_, BoundError> {
        if path.iter().all(|at| of(at) == 0.0) {
            return Ok(None);
        }
        let ladder: Vec<(f64, f64)> = path.iter().map(|at| (at.k, of(at))).collect();
        crossing(&ladder, |k| {
            // From the last solution below k: the branch was followed with steps this large.
            let below = path.partition_point(|at| at.k <= k).max(1) - 1;
            let state = solve(level, k, &path[below].state)
                .map_err(|source| BoundError::Frozen { k, source })?;
            exact(level, &state).map_err(|source| BoundError::Factor { k, source })
        })
    };
    let norm = reaches(|at| at.norm, |level, s| operator_norm(level, &s.u, s).map(|n| n.0))?;
    let radius = reaches(|at| at.radius, |level, s| eigenvalues(level, &s.u, s).map(|e| e.radius))?;
    // At a singular tangent DΛ has the eigenvalue one, so norm and radius reach it there at the latest.
    let singular = loss.as_ref().filter(|loss| loss.rightmost > NEARLY_ONE);
    let singular = singular.map(|loss| (loss.bracket.0, loss.bracket.1.max(continued(&path))));
    let ended = |crossing: Option<Crossing>| match (crossing, singular) {
        (Some([_, f64::INFINITY]), Some((low, high))) => Some([low, high]),
        _ => crossing,
    };
    let (norm, radius) = (ended(norm), ended(radius));
    Ok(Branch { norm, radius, loss })
}

/// Where the line through the last two largest eigenvalues reaches one: the k of a singular tangent
/// that the solution approaches without reaching it, as in a linear scene.
fn continued(path: &[At]) -> f64 {
    let [.., a, b] = path else { return 0.0 };
    let slope = (b.rightmost - a.rightmost) / (b.k - a.k);
    if slope > 0.0 { b.k + (1.0 - b.rightmost) / slope } else { 0.0 }
}

/// A factor at a solution.
type Exact<L> = fn(&mut L, &StepState) -> Result<f64, algebra::linalg::EigenError>;

/// The solution at step size k by Newton's method from `start`.
fn solve<L: FrozenDerivative>(
    level: &mut L,
    k: f64,
    start: &StepState,
) -> Result<StepState, StepError> {
    level.set_step(k);
    let mut state = start.clone();
    match factor::solve(level, None, &mut state) {
        Ok(_) => Ok(state),
        Err(StepError::NotConverged { residual, tolerance, .. })
            if residual <= STALLED * tolerance =>
        {
            Ok(state)
        }
        Err(error) => Err(error),
    }
}

/// The factors at a solution; a norm that was one or more before, `norm`, is not asked for again.
fn measure<L: FrozenDerivative>(
    level: &mut L,
    k: f64,
    state: StepState,
    norm: f64,
) -> Result<At, BoundError> {
    let failed = |source| BoundError::Factor { k, source };
    let spectrum = eigenvalues(level, &state.u, &state).map_err(failed)?;
    let norm = match norm >= 1.0 {
        true => norm,
        false => operator_norm(level, &state.u, &state).map_err(failed)?.0,
    };
    Ok(At { k, state, norm, radius: spectrum.radius, rightmost: spectrum.rightmost })
}

/// The solution at k, if it continues that at `here`.
fn advance<L: FrozenDerivative>(
    level: &mut L,
    here: &At,
    k: f64,
) -> Result<Result<At, Reason>, BoundError> {
    let state = match solve(level, k, &here.state) {
        Ok(state) => state,
        Err(error) => return Ok(Err(Reason::NoSolution(error))),
    };
    let off: Vec<f64> = state.u.iter().zip(&here.state.u).map(|(a, b)| a - b).collect();
    let moved = level.norm(&off) / level.norm(&here.state.u).max(f64::MIN_POSITIVE);
    if moved.is_nan() || moved > LARGEST_MOVE {
        return Ok(Err(Reason::Jump(moved)));
    }
    let next = measure(level, k, state, here.norm)?;
    Ok(if next.rightmost < 1.0 { Ok(next) } else { Err(Reason::Singular) })
}
