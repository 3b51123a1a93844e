//! Whether a grid of cases determines an order in h and one in k.

use super::log_table::Shape;
use super::{Direction, JointFit, Point, same_level};
use crate::record::counted;

/// Levels needed in each direction: two give an order, the third its uncertainty.
const LEVELS: usize = 3;

/// If log h and log k correlate beyond this, the two terms can trade places: on a path k = h
/// nothing tells them apart.
const LARGEST_CORRELATION: f64 = 0.999;

/// Each term must carry this share of the error somewhere: below it, leaving the term out
/// bends log e by less than 0.11, which the bias of the other term does as well.
const SMALLEST_SHARE: f64 = 0.1;

/// Bound of the scaled condition: beyond it, a bias of 1 in 1000 of the errors moves an order
/// by its own size.
const LARGEST_CONDITION: f64 = 1e3;

/// The points do not determine both orders; what to run instead.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not identifiable: {reason}; {suggestion}")]
pub struct NotIdentifiable {
    /// What is missing.
    pub reason: String,
    /// The cases to run.
    pub suggestion: String,
    /// The direction whose term is too small a part of the errors to be seen, if that is why: a
    /// line of cases in it shows the other term.
    pub hidden: Option<Direction>,
}

impl NotIdentifiable {
    fn new(reason: impl Into<String>, suggestion: impl Into<String>) -> Self {
        Self { reason: reason.into(), suggestion: suggestion.into(), hidden: None }
    }

    pub(super) fn no_minimum() -> Self {
        Self::new("the fit of two power laws finds no minimum", "run one more level of h and of k")
    }
}

/// Levels, number of points and independence of h and k.
pub(super) fn check_grid(points: &[Point], parameters: usize) -> Result<(), NotIdentifiable> {
    check_levels(points, parameters, LEVELS)
}

/// The grid without its coarsest level: of a fit with given orders two levels are enough.
pub(super) fn check_clip(points: &[Point], shape: Shape) -> Result<(), NotIdentifiable> {
    let needed = if shape.orders.is_some() { 2 } else { LEVELS };
    check_levels(points, shape.parameters(), needed)
}

/// The same where the next term of each expansion is fitted as well: one level more.
pub(super) fn check_bends(points: &[Point], parameters: usize) -> Result<(), NotIdentifiable> {
    check_levels(points, parameters, LEVELS + 1)
}

fn check_levels(points: &[Point], parameters: usize, needed: usize) -> Result<(), NotIdentifiable> {
    for (name, direction) in [("h", Direction::Space), ("k", Direction::Time)] {
        let found = levels(points, direction).len();
        if found < needed {
            return Err(NotIdentifiable::new(
                format!(
                    "{} of {name} above the floor, {needed} are needed",
                    counted(found, "level")
                ),
                format!("run {} more of {name}", needed - found),
            ));
        }
    }
    if correlation(points).abs() > LARGEST_CORRELATION {
        return Err(NotIdentifiable::new(
            "h and k are refined together, the two terms cannot be told apart",
            "run the grid, every n with every number of steps",
        ));
    }
    if points.len() <= parameters {
        return Err(NotIdentifiable::new(
            format!("{} for {parameters} parameters", counted(points.len(), "point")),
            "run the grid, every n with every number of steps",
        ));
    }
    Ok(())
}

/// Share of each term, and condition of the fit.
pub(super) fn check_terms(fit: &JointFit, points: &[Point]) -> Result<(), NotIdentifiable> {
    let largest = |term: usize| {
        points.iter().map(|point| fit.weights(point.h, point.k)[term]).fold(0.0, f64::max)
    };
    let hints = [
        ("space", "run fewer cells n, or more steps", Direction::Space),
        ("time", "run fewer steps, or more cells n, or judge k on V_time_max", Direction::Time),
    ];
    for (term, (name, suggestion, direction)) in hints.into_iter().enumerate() {
        let share = largest(term);
        if share < SMALLEST_SHARE {
            let percent = 100.0 * share;
            let reason = format!("the {name} term is at most {percent:.1} % of the error");
            let hidden = Some(direction);
            return Err(NotIdentifiable { hidden, ..NotIdentifiable::new(reason, suggestion) });
        }
    }
    // A condition that is no number fails as well.
    if fit.condition <= LARGEST_CONDITION {
        return Ok(());
    }
    let reason = format!("the condition of the fit is {:.0e}", fit.condition);
    Err(NotIdentifiable::new(reason, "run one more level of h and of k"))
}

/// The grids without the coarsest h, and without the coarsest k.
pub(super) fn clipped(points: &[Point]) -> [Vec<Point>; 2] {
    [Direction::Space, Direction::Time].map(|direction| {
        let coarsest = levels(points, direction).first().copied().unwrap_or(f64::INFINITY);
        let finer = |point: &&Point| !same_level(direction.step(point), coarsest);
        points.iter().filter(finer).copied().collect()
    })
}

/// Distinct steps, from the largest to the smallest.
fn levels(points: &[Point], direction: Direction) -> Vec<f64> {
    let mut steps: Vec<f64> = points.iter().map(|point| direction.step(point)).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup_by(|finer, coarser| same_level(*finer, *coarser));
    steps
}

fn correlation(points: &[Point]) -> f64 {
    let count = points.len() as f64;
    let mean = |f: &dyn Fn(&Point) -> f64| points.iter().map(f).sum::<f64>() / count;
    let (h, k) = (mean(&|p| p.h.ln()), mean(&|p| p.k.ln()));
    let mixed = mean(&|p| (p.h.ln() - h) * (p.k.ln() - k));
    let spread = mean(&|p| (p.h.ln() - h).powi(2)) * mean(&|p| (p.k.ln() - k).powi(2));
    mixed / spread.sqrt()
}
