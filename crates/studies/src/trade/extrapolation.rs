//! What Richardson's extrapolation is worth: errors with and without it, and the orders of both.

use super::Trial;
use super::bench::EXTRAPOLATED;
use super::study::plain;
use judge::fit::{Interval, Sample, local_slopes, order as infer_order};
use scene::setup::Setup;
use serde::Serialize;

/// Errors by step, with and without extrapolation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Extrapolated {
    /// What is extrapolated.
    pub what: String,
    /// k or h.
    pub step: &'static str,
    /// Step, error, error with the extrapolation from twice the step.
    pub rows: Vec<(f64, f64, Option<f64>)>,
    /// Orders of both: the last local one, and the interval from three points on.
    pub orders: [Option<LastOrder>; 2],
}

/// The order between the two finest rows, and what all of them say of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct LastOrder {
    /// Its value.
    pub last: f64,
    /// The interval of all rows, where there are enough.
    pub interval: Option<Interval>,
}

impl Extrapolated {
    fn new(what: String, step: &'static str, mut rows: Vec<(f64, f64, Option<f64>)>) -> Self {
        rows.sort_by(|a, b| b.0.total_cmp(&a.0));
        let plain: Vec<Sample> =
            rows.iter().map(|row| Sample { step: row.0, error: row.1 }).collect();
        let better = rows.iter().filter_map(|row| Some(Sample { step: row.0, error: row.2? }));
        let orders = [order(&plain), order(&better.collect::<Vec<_>>())];
        Self { what, step, rows, orders }
    }
}

fn order(samples: &[Sample]) -> Option<LastOrder> {
    let positive: Vec<Sample> = samples.iter().copied().filter(|s| s.error > 0.0).collect();
    let last = *local_slopes(&positive).last()?;
    let table: Vec<(f64, f64)> = positive.iter().map(|s| (s.step, s.error)).collect();
    let interval = infer_order(&table).ok().map(|found| found.interval);
    Some(LastOrder { last, interval })
}

/// (4 u_k - u_2k)/3 on the finest mesh, in the V norm.
pub(super) fn in_time(trials: &[Trial]) -> Option<Extrapolated> {
    let better = |t: &&Trial| t.change == EXTRAPOLATED;
    let n = trials.iter().filter(better).map(|t| t.n).max()?;
    let error = |trial: &Trial| trial.done().map(|run| run.error);
    let rows = plain(trials).filter(|trial| trial.n == n).filter_map(|plain| {
        let other = trials.iter().find(|t| better(t) && [t.n, t.steps] == [n, plain.steps]);
        Some((plain.k, error(plain)?, other.and_then(error)))
    });
    let what = format!("(4 u_k - u_2k)/3 on n = {n}, V_max");
    Some(Extrapolated::new(what, "k", rows.collect()))
}

/// ‖ε(u_h(T))‖ by (4^p Q_h - Q_2h)/(4^p - 1) with the most steps: the discrete solutions of nested meshes are nearly
/// orthogonal, so that Q has twice the degree p of the element as its order. The strain itself gains nothing: it is of
/// lower degree on cells. None where the data depend on the mesh.
pub(super) fn in_space(trials: &[Trial], setup: &Setup) -> Option<Extrapolated> {
    if setup.body.data.is_interpolated() {
        return None;
    }
    let steps = plain(trials).map(|trial| trial.steps).max()?;
    let runs =
        || plain(trials).filter(|t| t.steps == steps).filter_map(|t| Some((t, t.done()?.strain)));
    let gain = 4f64.powi(setup.body.element.degree() as i32);
    let row = |(trial, [fine, exact]): (&Trial, [f64; 2])| {
        let coarse = runs().find(|(other, _)| 2 * other.n == trial.n);
        let better =
            coarse.map(|(_, [coarse, _])| ((gain * fine - coarse) / (gain - 1.0) - exact).abs());
        (trial.h, (fine - exact).abs(), better)
    };
    let what = format!("({gain} Q_h - Q_2h)/{} of Q = |eps(u(T))|, N = {steps}", gain - 1.0);
    let rows: Vec<_> = runs().map(row).collect();
    (rows.len() > 1).then(|| Extrapolated::new(what, "h", rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extrapolated_values_have_a_higher_order() {
        let rows = [4, 8, 16, 32].map(|steps| {
            let k = 1.0 / f64::from(steps);
            (k, k * k, (steps > 4).then(|| 3.0 * k.powi(4)))
        });
        let found = Extrapolated::new("u".into(), "k", rows.to_vec());
        let [plain, better] = found.orders.map(|order| order.expect("an order"));
        // Roundings of logarithms.
        assert!((plain.last - 2.0).abs() < 1e-12 && (better.last - 4.0).abs() < 1e-12);
        assert!(better.interval.expect("an interval").contains(4.0));
        assert!(!better.interval.expect("an interval").contains(2.0));
        let one = Extrapolated::new("u".into(), "k", rows[..1].to_vec());
        assert_eq!(one.orders, [None, None]);
    }
}
