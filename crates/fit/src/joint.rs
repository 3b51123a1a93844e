//! Both orders from a grid of meshes and time steps.

use super::grid_fit::GridFit;
use super::identifiable::{LEVELS, check_levels, check_terms, clipped};
use super::log_table::Shape;
use super::{
    ErrorCombination, FitError, FittedValue, Interval, JointFit, NotIdentifiable, Point, screen,
};

/// Residual ratio up to which the worse model is not refuted: 4 in squares is below the 95 % quantile of F up to 6 and
/// 6 degrees of freedom.
const COMPARABLE: f64 = 2.0;

/// To see order q = 2 within 0.1 beside order 1, the other term must stay below this share: a local slope is the
/// error-weighted mean of the orders.
pub const LARGEST_OTHER_SHARE: f64 = 0.053;

/// Both models on one grid.
#[derive(Debug, Clone)]
pub struct JointFits {
    /// The model of smaller residual. Its intervals are the hull of its Student intervals, of p' ± 2 |p' − p| with the
    /// order p' without the coarsest h (or k), from four levels on of the Student intervals with next terms, and of the
    /// other model's if its residual is comparable.
    pub best: JointFit,
    /// The other model, with Student intervals; none if its fit did not converge.
    pub other: Option<JointFit>,
}

/// Fits E = F + C_h h^p + C_k k^q and its root-sum-square form to the points above the floor.
///
/// # Errors
/// [`NotIdentifiable`] if the points do not determine both orders.
pub fn joint_fits(points: &[Point], with_floor: bool) -> Result<JointFits, NotIdentifiable> {
    let usable = usable(points);
    let shape = Shape { orders: true, floor: with_floor, bends: false };
    check_levels(&usable, shape.parameters(), LEVELS)?;
    let mut fits: Vec<GridFit> = ErrorCombination::BOTH
        .into_iter()
        .filter_map(|model| GridFit::of(&usable, model, shape, None))
        .collect();
    fits.sort_by(|a, b| a.residual_norm.total_cmp(&b.residual_norm));
    let [best, others @ ..] = &fits[..] else {
        return Err(NotIdentifiable::no_minimum());
    };
    let fit = joint_fit(best, widened(best, others, &usable));
    check_terms(&fit, &usable)?;
    Ok(JointFits { best: fit, other: others.first().map(|fit| joint_fit(fit, fit.estimates())) })
}

/// C_h and C_k for given orders (p, q), with intervals.
///
/// From four levels on the next term of each expansion is fitted: otherwise C_h carries the bias D h. The interval is
/// the hull of the Student interval, of the constant ± half of its change by the next terms, and of the other model's
/// if its residual is comparable. With fewer levels it is made as for an order in [`JointFits::best`].
///
/// # Errors
/// [`FitError::TooFew`] for fewer than three points, [`FitError::Singular`] without a minimum.
pub fn fit_constants(
    points: &[Point],
    model: ErrorCombination,
    orders: (f64, f64),
) -> Result<[FittedValue; 2], FitError> {
    let usable = usable(points);
    let found = usable.len();
    let shape = Shape { orders: false, floor: false, bends: false };
    if found <= shape.parameters() {
        return Err(FitError::TooFew { found, needed: shape.parameters() + 1 });
    }
    let fit = |model| GridFit::of(&usable, model, shape, Some(orders));
    let full = fit(model).ok_or(FitError::Singular { points: found })?;
    let rival = ErrorCombination::BOTH.into_iter().find(|other| *other != model).and_then(fit);
    let mut logs = widened(&full, rival.as_slice(), &usable);
    if let Some(bent) = full.bent(&usable) {
        let rival = rival.and_then(|rival| rival.bent(&usable));
        let mut parts = vec![both(&full, &bent, corrected)];
        parts.extend(comparable(&bent, rival.as_slice()));
        logs = hulls(bent.estimates(), &parts);
    }
    Ok(logs.map(|log| FittedValue { value: log.value.exp(), interval: log.interval.exp() }))
}

fn usable(points: &[Point]) -> Vec<Point> {
    let positive = |step: f64| step.is_finite() && step > 0.0;
    let serves = |p: &&Point| screen(p).is_ok() && positive(p.h) && positive(p.k);
    points.iter().filter(serves).copied().collect()
}

fn joint_fit(fit: &GridFit, [order_h, order_k]: [FittedValue; 2]) -> JointFit {
    let [constant_h, constant_k] = fit.log_constants().map(f64::exp);
    JointFit {
        model: fit.model,
        order_h,
        order_k,
        student: fit.estimates().map(|order| order.interval),
        constant_h,
        constant_k,
        floor: fit.floor(),
        residual_norm: fit.residual_norm,
        condition: fit.condition,
    }
}

/// Estimates with intervals widened for the choice of grid, the next terms and the choice of model.
fn widened(full: &GridFit, rivals: &[GridFit], points: &[Point]) -> [FittedValue; 2] {
    // Two levels suffice for given orders.
    let needed = if full.shape.orders { LEVELS } else { 2 };
    let serves = |clip: &Vec<Point>| check_levels(clip, full.shape.parameters(), needed).is_ok();
    let clips = clipped(points).into_iter().filter(serves);
    let clips = clips.filter_map(|clip| full.again(&clip, full.shape));
    let mut parts: Vec<[Interval; 2]> = clips.map(|clip| both(full, &clip, drift)).collect();
    parts.extend(full.bent(points).map(|bent| both(full, &bent, corrected)));
    parts.extend(comparable(full, rivals));
    hulls(full.estimates(), &parts)
}

/// Intervals of the other models that fit about as well.
fn comparable(fit: &GridFit, rivals: &[GridFit]) -> impl Iterator<Item = [Interval; 2]> {
    let most = COMPARABLE * fit.residual_norm;
    let rivals = rivals.iter().filter(move |rival| rival.residual_norm <= most);
    rivals.map(|rival| rival.estimates().map(|estimate| estimate.interval))
}

fn both(
    full: &GridFit,
    other: &GridFit,
    of: fn(FittedValue, FittedValue) -> Interval,
) -> [Interval; 2] {
    let (full, other) = (full.estimates(), other.estimates());
    [0, 1].map(|i| of(full[i], other[i]))
}

fn hulls(estimates: [FittedValue; 2], parts: &[[Interval; 2]]) -> [FittedValue; 2] {
    [0, 1].map(|i| {
        let interval = parts.iter().fold(estimates[i].interval, |hull, part| hull.hull(part[i]));
        FittedValue { interval, ..estimates[i] }
    })
}

/// Student interval with next terms, and the order ± half of its change by them, for the terms after those. By
/// simulation for |D| ≤ 4, h from 1/8, the interval of p covers 77-95 % of grids without the half and 96-100 % with it.
fn corrected(full: FittedValue, bent: FittedValue) -> Interval {
    bent.interval.hull(Interval::around(bent.value, 0.5 * (bent.value - full.value).abs()))
}

/// Order of the clipped grid ± 2 |change by clipping|.
fn drift(full: FittedValue, clip: FittedValue) -> Interval {
    Interval::around(clip.value, 2.0 * (clip.value - full.value).abs())
}

#[cfg(test)]
mod tests;
