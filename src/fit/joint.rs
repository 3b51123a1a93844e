//! Both orders from a grid of meshes and time steps.

use nalgebra::{DMatrix, DVector};

use super::identifiable::{check_bends, check_grid, check_terms, clipped};
use super::levenberg_marquardt::{Minimum, minimise};
use super::model::{Extra, LogTable};
use super::{FitError, Interval, Model, NotIdentifiable, Point, screen, student_quantile};

/// Orders to start from; each pair is tried and the best minimum kept.
const STARTS: [(f64, f64); 6] =
    [(1.0, 2.0), (1.0, 1.0), (0.5, 2.0), (2.0, 2.0), (2.0, 1.0), (0.5, 1.0)];

/// A model whose residual is at most so many times that of the better one is not refuted by
/// it: the ratio 4 of their squares is below the 95 % quantile of F up to 6 and 6 degrees.
const COMPARABLE: f64 = 2.0;

/// A fitted number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Value at the minimum.
    pub value: f64,
    /// Its interval.
    pub interval: Interval,
}

/// One model fitted to a grid, on logarithms.
#[derive(Debug, Clone)]
pub struct JointFit {
    /// How the terms combine.
    pub model: Model,
    /// Order p in h with its Student interval.
    pub order_h: Estimate,
    /// Order q in k with its Student interval.
    pub order_k: Estimate,
    /// C_h.
    pub constant_h: f64,
    /// C_k.
    pub constant_k: f64,
    /// F, if it was fitted.
    pub floor: Option<f64>,
    /// ‖log E − log e‖, Euclidean over the points.
    pub residual_norm: f64,
    /// Condition of the Jacobian with columns scaled to length 1.
    pub condition: f64,
}

impl JointFit {
    /// The error of the model at (h, k).
    pub fn error(&self, h: f64, k: f64) -> f64 {
        self.combined(h, k).0.exp()
    }

    /// Weights of space and time in the local slope at (h, k).
    pub fn weights(&self, h: f64, k: f64) -> [f64; 2] {
        let (_, [space, time, _]) = self.combined(h, k);
        [space, time]
    }

    fn combined(&self, h: f64, k: f64) -> (f64, [f64; 3]) {
        let space = self.constant_h.ln() + self.order_h.value * h.ln();
        let time = self.constant_k.ln() + self.order_k.value * k.ln();
        self.model.combine([space, time, self.floor.map_or(f64::NEG_INFINITY, f64::ln)])
    }
}

/// Both models on one grid.
#[derive(Debug, Clone)]
pub struct JointFits {
    /// The model with the smaller residual; its intervals are the hull of its Student
    /// intervals, the order p' of the grid without its coarsest h (or k) ± 2 |p' − p|, from
    /// four levels on the Student intervals with the next term of each expansion fitted as well,
    /// and the other model's orders where its residual is comparable.
    pub best: JointFit,
    /// The other model, with Student intervals alone; none if its fit did not end.
    pub other: Option<JointFit>,
}

/// Fits E = F + C_h h^p + C_k k^q and its root-sum-square form to the points above the floor.
///
/// # Errors
/// [`NotIdentifiable`] if the points do not determine both orders.
pub fn joint_fits(points: &[Point], with_floor: bool) -> Result<JointFits, NotIdentifiable> {
    let usable = usable(points);
    let extra = Extra { floor: with_floor, bends: false };
    check_grid(&usable, extra.parameters())?;
    let mut fits: Vec<JointFit> = [Model::Sum, Model::RootSumSquare]
        .into_iter()
        .filter_map(|model| fit_model(&usable, model, extra))
        .collect();
    fits.sort_by(|a, b| a.residual_norm.total_cmp(&b.residual_norm));
    let mut fits = fits.into_iter();
    let best = fits.next().ok_or_else(NotIdentifiable::no_minimum)?;
    let other = fits.next();
    check_terms(&best, &usable)?;
    Ok(JointFits { best: widened(best, other.as_ref(), &usable), other })
}

/// The constants C_h and C_k under given orders (p, q), each with its 95 % Student interval.
///
/// # Errors
/// [`FitError::TooFew`] for fewer than three points, [`FitError::Singular`] without a minimum.
pub fn fit_constants(
    points: &[Point],
    model: Model,
    orders: (f64, f64),
) -> Result<[Estimate; 2], FitError> {
    let usable = usable(points);
    let found = usable.len();
    let freedom = found.checked_sub(3).ok_or(FitError::TooFew { found, needed: 3 })? + 1;
    let table = LogTable::new(&usable);
    let start = DVector::from_element(2, half_level(&table));
    let singular = FitError::Singular { points: found };
    let minimum = minimise(start, |x| {
        let full = DVector::from_vec(vec![x[0], x[1], orders.0, orders.1]);
        let (residuals, jacobian) =
            table.residuals(model, Extra { floor: false, bends: false }, &full);
        (residuals, jacobian.columns(0, 2).into_owned())
    })
    .ok_or(singular)?;
    let deviations = deviations(&minimum, freedom).ok_or(singular)?;
    let quantile = student_quantile(freedom).ok_or(singular)?;
    let constant = |i: usize, order: f64| {
        let log = minimum.x[i] - order * table.centre[i];
        let interval = Interval::around(log, quantile * deviations[i]).exp();
        Estimate { value: log.exp(), interval }
    };
    Ok([constant(0, orders.0), constant(1, orders.1)])
}

fn usable(points: &[Point]) -> Vec<Point> {
    let positive = |step: f64| step.is_finite() && step > 0.0;
    let serves = |p: &&Point| screen(p).is_ok() && positive(p.h) && positive(p.k);
    points.iter().filter(serves).copied().collect()
}

/// Half of the mean error, as a logarithm: where both constants start.
fn half_level(table: &LogTable) -> f64 {
    let count = table.rows.len().max(1) as f64;
    table.rows.iter().map(|row| row.error).sum::<f64>() / count - std::f64::consts::LN_2
}

fn fit_model(points: &[Point], model: Model, extra: Extra) -> Option<JointFit> {
    let table = LogTable::new(points);
    let level = half_level(&table);
    let lowest = table.rows.iter().map(|row| row.error).fold(f64::INFINITY, f64::min);
    let minimum = STARTS
        .into_iter()
        .filter_map(|(p, q)| {
            let floor = extra.floor.then_some(lowest - 1.0);
            let start = [level, level, p, q].into_iter().chain(floor);
            let start = start.chain(std::iter::repeat(0.0)).take(extra.parameters());
            let start = DVector::from_vec(start.collect());
            minimise(start, |x| table.residuals(model, extra, x))
        })
        .min_by(|a, b| a.residuals.norm().total_cmp(&b.residuals.norm()))?;
    let freedom = points.len().checked_sub(minimum.x.len())?;
    let deviations = deviations(&minimum, freedom)?;
    let quantile = student_quantile(freedom)?;
    let order = |i: usize| Estimate {
        value: minimum.x[i],
        interval: Interval::around(minimum.x[i], quantile * deviations[i]),
    };
    let x = &minimum.x;
    Some(JointFit {
        model,
        order_h: order(2),
        order_k: order(3),
        constant_h: (x[0] - x[2] * table.centre[0]).exp(),
        constant_k: (x[1] - x[3] * table.centre[1]).exp(),
        floor: extra.floor.then(|| x[4].exp()),
        residual_norm: minimum.residuals.norm(),
        condition: condition(&minimum.jacobian),
    })
}

/// Roots of the diagonal of s² (JᵀJ)⁻¹.
fn deviations(minimum: &Minimum, freedom: usize) -> Option<DVector<f64>> {
    let variance = minimum.residuals.norm_squared() / freedom as f64;
    let inverse = minimum.jacobian.tr_mul(&minimum.jacobian).try_inverse()?;
    let squares = inverse.diagonal() * variance;
    squares.iter().all(|x| x.is_finite() && *x >= 0.0).then(|| squares.map(f64::sqrt))
}

fn condition(jacobian: &DMatrix<f64>) -> f64 {
    let mut scaled = jacobian.clone();
    for mut column in scaled.column_iter_mut() {
        let length = column.norm();
        if length == 0.0 {
            return f64::INFINITY;
        }
        column /= length;
    }
    let values = scaled.singular_values();
    values.max() / values.min()
}

/// The fit with its intervals widened by the choice of grid and of model.
fn widened(mut fit: JointFit, other: Option<&JointFit>, points: &[Point]) -> JointFit {
    let full = fit.clone();
    let extra = Extra { floor: full.floor.is_some(), bends: false };
    let clips = clipped(points).into_iter().filter(|clip| check_grid(clip, 4).is_ok());
    for clip in clips.filter_map(|clip| fit_model(&clip, full.model, extra)) {
        widen(&mut fit.order_h, drift(full.order_h, clip.order_h));
        widen(&mut fit.order_k, drift(full.order_k, clip.order_k));
    }
    let bent = Extra { bends: true, ..extra };
    if check_bends(points, bent.parameters()).is_ok()
        && let Some(bent) = fit_model(points, full.model, bent)
    {
        widen(&mut fit.order_h, corrected(full.order_h, bent.order_h));
        widen(&mut fit.order_k, corrected(full.order_k, bent.order_k));
    }
    if let Some(rival) = other.filter(|o| o.residual_norm <= COMPARABLE * full.residual_norm) {
        widen(&mut fit.order_h, Interval::around(rival.order_h.value, 0.0));
        widen(&mut fit.order_k, Interval::around(rival.order_k.value, 0.0));
    }
    fit
}

fn widen(order: &mut Estimate, part: Interval) {
    order.interval = order.interval.hull(part);
}

/// The Student interval with the next terms of the expansions, and the order ± half of the
/// change that they make: for the terms after them. The half is set by simulation: without it
/// the interval of p covers 77-95 % of grids with |D| ≤ 4, h from 1/8, with it 96-100 %.
fn corrected(full: Estimate, bent: Estimate) -> Interval {
    bent.interval.hull(Interval::around(bent.value, 0.5 * (bent.value - full.value).abs()))
}

/// The order of the clipped grid ± 2 |its change by clipping|.
fn drift(full: Estimate, clip: Estimate) -> Interval {
    Interval::around(clip.value, 2.0 * (clip.value - full.value).abs())
}

#[cfg(test)]
mod tests;
