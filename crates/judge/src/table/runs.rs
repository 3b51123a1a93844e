//! Several runs at one level (random meshes) merged into one point with a standard deviation.

use super::{Measurement, Quantity, Row};
use crate::fit::{Point, same_level};

/// Levels in the order of their first rows. Errors are averaged on logarithms; the deviation of that mean is pooled
/// over all levels, because two runs alone would leave it open by a factor of ten. Values are averaged.
pub(super) fn merged<'a>(
    quantity: Quantity,
    rows: impl Iterator<Item = &'a Row>,
) -> Vec<Measurement> {
    let mut levels: Vec<Vec<&Row>> = Vec::new();
    let mut rows: Vec<(usize, &Row)> = rows.enumerate().collect();
    rows.sort_by(|(i, a), (j, b)| {
        (a.point.h.total_cmp(&b.point.h)).then(a.point.k.total_cmp(&b.point.k)).then(i.cmp(j))
    });
    for (_, row) in rows {
        match levels.last_mut() {
            Some(level) if same(&level[0].point, &row.point) => level.push(row),
            _ => levels.push(vec![row]),
        }
    }
    levels.sort_by_key(|level| level.iter().map(|row| row.line).min());
    let spread = spread(&levels).filter(|_| quantity == Quantity::Error);
    levels.iter().map(|level| one(quantity, level, spread)).collect()
}

fn same(a: &Point, b: &Point) -> bool {
    let equal = |a: f64, b: f64| same_level(a, b) || a.is_nan() && b.is_nan();
    equal(a.h, b.h) && equal(a.k, b.k)
}

/// Pooled standard deviation of log error; none if no runs differ.
fn spread(levels: &[Vec<&Row>]) -> Option<f64> {
    let (mut squares, mut freedom) = (0.0, 0usize);
    for level in levels.iter().filter(|level| level.len() > 1) {
        let logs: Vec<f64> = level.iter().map(|row| row.point.error.ln()).collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        squares += logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>();
        freedom += logs.len() - 1;
    }
    let spread = (squares / freedom as f64).sqrt();
    (spread > 0.0 && spread.is_finite()).then_some(spread)
}

fn one(quantity: Quantity, level: &[&Row], spread: Option<f64>) -> Measurement {
    let runs = level.len() as f64;
    let mean = |f: &dyn Fn(&Row) -> f64| level.iter().map(|row| f(row)).sum::<f64>() / runs;
    let first = level[0].point;
    // A zero error stays zero and is dropped later as below any floor.
    let error = match quantity {
        _ if level.len() == 1 => first.error,
        Quantity::Error => mean(&|row| row.point.error.ln()).exp(),
        Quantity::Value => mean(&|row| row.point.error),
    };
    let floor = level.iter().map(|row| row.point.floor).fold(0.0, f64::max);
    let given: Option<Vec<f64>> =
        level.iter().map(|row| row.sigma.map(|sigma| sigma / row.point.error)).collect();
    let given = given.map(|all| (all.iter().map(|s| s * s).sum::<f64>()).sqrt() / runs);
    let sigma = given.or(spread.map(|spread| spread / runs.sqrt()));
    (Point { error, floor, ..first }, sigma.filter(|sigma| sigma.is_finite()))
}
