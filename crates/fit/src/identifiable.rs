//! Whether a grid of cases determines an order in h and one in k.

use super::{Direction, JointFit, Point, same_level};
use files::counted;

/// Levels per direction: two give an order, the third its uncertainty.
pub(super) const LEVELS: usize = 3;

/// Beyond this correlation of log h and log k the two terms are interchangeable, as on a path k = h.
const LARGEST_CORRELATION: f64 = 0.999;

/// Each term must reach this share of the error somewhere: below it, dropping the term bends log e by less than 0.11,
/// as much as the bias of the other term does.
const SMALLEST_SHARE: f64 = 0.1;

/// Bound of the scaled condition: beyond it, a bias of 1 in 1000 of the errors changes an order by its size.
const LARGEST_CONDITION: f64 = 1e3;

/// The points do not determine both orders; what to run instead.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not identifiable: {reason}; {suggestion}")]
pub struct NotIdentifiable {
    pub reason: String,
    pub suggestion: String,
    /// The direction whose term is too small to be seen, if that is the reason.
    pub hidden: Option<Direction>,
}

impl NotIdentifiable {
    fn new(reason: impl Into<String>, suggestion: impl Into<String>) -> Self {
        Self { reason: reason.into(), suggestion: suggestion.into(), hidden: None }
    }

    /// Numbers that are none.
    pub(super) fn refused(error: impl std::fmt::Display) -> Self {
        Self::new(error.to_string(), "run what is broken again, or leave it out")
    }

    pub(super) fn no_minimum() -> Self {
        Self::new("the fit of two power laws finds no minimum", "run one more level of h and of k")
    }
}

/// Checks points for a fit of so many parameters that needs so many levels in each direction.
pub(super) fn check_levels(
    points: &[Point],
    parameters: usize,
    needed: usize,
) -> Result<(), NotIdentifiable> {
    for direction in Direction::BOTH {
        let name = direction.name();
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

pub(super) fn check_terms(fit: &JointFit, points: &[Point]) -> Result<(), NotIdentifiable> {
    let hints = [
        ("space", "run fewer cells n, or more steps", Direction::Space),
        ("time", "run fewer steps, or more cells n, or judge k on V_time_max", Direction::Time),
    ];
    for (name, suggestion, direction) in hints {
        let share = points.iter().map(|point| fit.share(direction, point)).fold(0.0, f64::max);
        if share < SMALLEST_SHARE {
            let percent = 100.0 * share;
            let reason = format!("the {name} term is at most {percent:.1} % of the error");
            let hidden = Some(direction);
            return Err(NotIdentifiable { hidden, ..NotIdentifiable::new(reason, suggestion) });
        }
    }
    // NaN fails as well.
    if fit.condition <= LARGEST_CONDITION {
        return Ok(());
    }
    let reason = format!("the condition of the fit is {:.0e}", fit.condition);
    Err(NotIdentifiable::new(reason, "run one more level of h and of k"))
}

pub(super) fn clipped(points: &[Point]) -> [Vec<Point>; 2] {
    Direction::BOTH.map(|direction| {
        let coarsest = levels(points, direction).first().copied().unwrap_or(f64::INFINITY);
        let finer = |point: &&Point| !same_level(direction.step(point), coarsest);
        points.iter().filter(finer).copied().collect()
    })
}

fn levels(points: &[Point], direction: Direction) -> Vec<f64> {
    distinct(points.iter().map(|point| direction.step(point)).collect())
}

fn distinct(mut steps: Vec<f64>) -> Vec<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ErrorCombination, FittedValue, Interval};

    fn on(pairs: &[(f64, f64)]) -> Vec<Point> {
        pairs.iter().map(|&(h, k)| Point { h, k, error: 1.0, floor: 0.0 }).collect()
    }

    /// Three levels of each in five points off any path: the minimum for four parameters.
    const FIVE: [(f64, f64); 5] =
        [(0.5, 0.5), (0.25, 0.5), (0.125, 0.5), (0.5, 0.25), (0.5, 0.125)];

    #[test]
    fn three_levels_and_a_spare_point_are_enough() {
        assert_eq!(check_levels(&on(&FIVE), 4, LEVELS), Ok(()));
        let refused = check_levels(&on(&FIVE), 5, LEVELS).unwrap_err();
        assert_eq!(refused.reason, "5 points for 5 parameters");
        let two = check_levels(&on(&FIVE[..4]), 3, LEVELS).unwrap_err();
        assert_eq!(
            (two.reason.as_str(), two.suggestion.as_str()),
            ("2 levels of k above the floor, 3 are needed", "run 1 more of k")
        );
        let bends = check_levels(&on(&FIVE), 4, LEVELS + 1).unwrap_err();
        assert_eq!(bends.reason, "3 levels of h above the floor, 4 are needed");
        assert_eq!(check_levels(&on(&FIVE[..4]), 2, 2), Ok(()));
        assert_eq!(two.hidden, None);
    }

    /// (log h, log k) = (0, 0), (1, 0), (0, 1), (1, 1): independent; (0, 0), (1, 1), (2, 1): covariance 1/3, variances
    /// 2/3 and 2/9, correlation √3/2.
    #[test]
    fn correlations_by_hand() {
        let logs = |pairs: &[(f64, f64)]| -> Vec<Point> {
            on(&pairs.iter().map(|(h, k)| (h.exp(), k.exp())).collect::<Vec<_>>())
        };
        let square = logs(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]);
        assert!(correlation(&square).abs() < 1e-15);
        let bent = logs(&[(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)]);
        assert!((correlation(&bent) - 0.75f64.sqrt()).abs() < 1e-15);
        let falling = logs(&[(0.0, 3.0), (1.0, 2.0), (2.0, 1.0), (3.0, 0.0), (1.0, 2.0)]);
        assert!((correlation(&falling) + 1.0).abs() < 1e-15);
        let refused = check_levels(&falling, 2, LEVELS).unwrap_err();
        assert!(refused.reason.contains("refined together"), "{refused}");
    }

    #[test]
    fn clips_lose_their_coarsest_level_alone() {
        let mut points = on(&FIVE);
        points.push(Point { h: 0.5 * (1.0 - 1e-15), ..points[4] });
        let [without_h, without_k] = clipped(&points);
        assert_eq!(without_h, points[1..3]);
        assert_eq!(without_k, points[3..]);
        assert_eq!(clipped(&[]), [vec![], vec![]]);
        assert_eq!(levels(&points, Direction::Space), [0.5, 0.25, 0.125]);
    }

    fn fit(constant_h: f64, constant_k: f64, condition: f64) -> JointFit {
        let interval = Interval { lo: 1.0, hi: 1.0 };
        let order = FittedValue { value: 1.0, interval };
        JointFit {
            model: ErrorCombination::Sum,
            order_h: order,
            order_k: order,
            student: [interval; 2],
            constant_h,
            constant_k,
            floor: None,
            residual_norm: 0.0,
            condition,
        }
    }

    #[test]
    fn a_term_counts_from_a_tenth_of_the_error_on() {
        let here = on(&[(1.0, 1.0)]);
        assert_eq!(check_terms(&fit(1.0, 8.9, 1e3), &here), Ok(()));
        let space = check_terms(&fit(1.0, 9.1, 1.0), &here).unwrap_err();
        assert!(space.reason.contains("the space term is at most 9.9 %"), "{space}");
        assert_eq!(space.hidden, Some(Direction::Space));
        let time = check_terms(&fit(9.1, 1.0, 1.0), &here).unwrap_err();
        assert!(time.reason.contains("the time term"), "{time}");
        assert_eq!(time.hidden, Some(Direction::Time));
        let two = on(&[(1.0, 1.0), (1.0, 1e-6)]);
        assert_eq!(check_terms(&fit(1.0, 1.0, 1.0), &two), Ok(()));
        for condition in [1.1e3, f64::INFINITY, f64::NAN] {
            let refused = check_terms(&fit(1.0, 1.0, condition), &here).unwrap_err();
            assert!(refused.reason.contains("condition"), "{refused}");
        }
    }
}
