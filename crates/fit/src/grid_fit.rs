//! One error model fitted to a grid of meshes and time steps.

use nalgebra::{DMatrix, DVector};

use super::identifiable::{LEVELS, check_levels};
use super::levenberg_marquardt::minimise;
use super::log_table::{LogTable, Parameters, Shape};
use super::{ErrorCombination, FittedValue, Interval, Point, student_quantile};

/// Start orders; all pairs are tried and the best minimum kept.
const STARTS: [(f64, f64); 6] =
    [(1.0, 2.0), (1.0, 1.0), (0.5, 2.0), (2.0, 2.0), (2.0, 1.0), (0.5, 1.0)];

/// Points of a larger table on which the starts are compared; the full table then refines the best.
const SCOUTS: usize = 64;

#[derive(Debug, Clone)]
pub(super) struct GridFit {
    pub(super) model: ErrorCombination,
    pub(super) shape: Shape,
    /// ‖log E − log e‖, Euclidean over the points.
    pub(super) residual_norm: f64,
    /// Condition of the Jacobian with columns scaled to length 1.
    pub(super) condition: f64,
    at: Parameters,
    centre: [f64; 2],
    deviations: DVector<f64>,
    quantile: f64,
}

impl GridFit {
    /// The best minimum from all starts, or from the given orders.
    pub(super) fn of(
        points: &[Point],
        model: ErrorCombination,
        shape: Shape,
        orders: Option<(f64, f64)>,
    ) -> Option<Self> {
        let scouts = scouts(points);
        let table = LogTable::new(&scouts);
        let starts = orders.map_or(STARTS.to_vec(), |given| vec![given]);
        let best = starts
            .into_iter()
            .filter_map(|orders| Self::from_start(&table, model, shape, start(&table, orders)))
            .min_by(|a, b| a.residual_norm.total_cmp(&b.residual_norm))?;
        if scouts.len() == points.len() { Some(best) } else { best.again(points, shape) }
    }

    /// Refit of other points or another shape, started from this minimum.
    pub(super) fn again(&self, points: &[Point], shape: Shape) -> Option<Self> {
        let table = LogTable::new(points);
        let mut start = self.at;
        for i in 0..2 {
            start[i] += start[2 + i] * (table.centre[i] - self.centre[i]);
        }
        Self::from_start(&table, self.model, shape, start)
    }

    /// Fit with the next term of each expansion, if there are enough levels.
    pub(super) fn bent(&self, points: &[Point]) -> Option<Self> {
        let shape = Shape { bends: true, ..self.shape };
        check_levels(points, shape.parameters(), LEVELS + 1).ok()?;
        self.again(points, shape)
    }

    fn from_start(
        table: &LogTable,
        model: ErrorCombination,
        shape: Shape,
        mut at: Parameters,
    ) -> Option<Self> {
        if !shape.floor {
            at[4] = f64::NEG_INFINITY;
        }
        let free = shape.free();
        let placed = |x: &DVector<f64>| {
            let mut placed = at;
            free.iter().zip(x.iter()).for_each(|(place, value)| placed[*place] = *value);
            placed
        };
        let start = DVector::from_iterator(free.len(), free.iter().map(|place| at[*place]));
        let minimum = minimise(start, |x| table.residuals(model, placed(x), &free))?;
        let freedom = table.rows.len().checked_sub(free.len())?;
        Some(Self {
            model,
            shape,
            residual_norm: minimum.residuals.norm(),
            condition: condition(&minimum.jacobian),
            at: placed(&minimum.x),
            centre: table.centre,
            deviations: minimum.deviations(freedom)?,
            quantile: student_quantile(freedom)?,
        })
    }

    /// Student estimates of both orders, or of both log C where the orders are given.
    pub(super) fn estimates(&self) -> [FittedValue; 2] {
        let (first, values) = match self.shape.orders {
            true => (2, [self.at[2], self.at[3]]),
            false => (0, self.log_constants()),
        };
        [0, 1].map(|i| {
            let radius = self.quantile * self.deviations[first + i];
            FittedValue { value: values[i], interval: Interval::around(values[i], radius) }
        })
    }

    pub(super) fn log_constants(&self) -> [f64; 2] {
        [0, 1].map(|i| self.at[i] - self.at[2 + i] * self.centre[i])
    }

    pub(super) fn floor(&self) -> Option<f64> {
        self.shape.floor.then(|| self.at[4].exp())
    }
}

/// A spread sample of the table: golden-ratio multiples avoid any rhythm with its rows.
fn scouts(points: &[Point]) -> Vec<Point> {
    if points.len() <= 2 * SCOUTS {
        return points.to_vec();
    }
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let place = |i: usize| (golden * i as f64).fract() * points.len() as f64;
    (0..SCOUTS).map(|i| points[place(i) as usize]).collect()
}

/// Both constants at half of the mean error, the floor below the smallest error.
fn start(table: &LogTable, (p, q): (f64, f64)) -> Parameters {
    let errors = || table.rows.iter().map(|row| row.error);
    let level = errors().sum::<f64>() / table.rows.len().max(1) as f64 - std::f64::consts::LN_2;
    [level, level, p, q, errors().fold(f64::INFINITY, f64::min) - 1.0, 0.0, 0.0]
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scouts_are_few_and_lie_everywhere() {
        let point = |i: usize| Point { h: i as f64, k: 1.0, error: 1.0, floor: 0.0 };
        let small: Vec<Point> = (0..128).map(point).collect();
        assert_eq!(scouts(&small), small);
        let large: Vec<Point> = (0..10_000).map(point).collect();
        let mut places: Vec<f64> = scouts(&large).iter().map(|point| point.h).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        assert_eq!(places.len(), 64);
        let widest = places.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        assert!(places[0] < 420.0 && places[63] > 9580.0 && widest < 420.0, "{widest}");
    }

    /// Columns (3, 0) and (1, 1): unit columns have cosine 1/√2, condition ((√2 + 1)/(√2 − 1))^½.
    #[test]
    fn the_condition_is_that_of_unit_columns() {
        let root = 2f64.sqrt();
        let jacobian = DMatrix::from_row_slice(2, 2, &[3.0, 1.0, 0.0, 1.0]);
        let expected = ((root + 1.0) / (root - 1.0)).sqrt();
        assert!((condition(&jacobian) - expected).abs() < 1e-14);
        assert_eq!(condition(&DMatrix::zeros(2, 2)), f64::INFINITY);
    }

    /// On 400 points the scouts start and the whole table decides: a fit from elsewhere agrees.
    #[test]
    fn large_tables_have_the_minimum_of_all_their_points() {
        let step = |i: i32| 0.125 * 0.8f64.powi(i);
        let shake = |i: i32, j: i32| 1.0 + 0.01 * f64::from((7 * i + 3 * j) % 5 - 2);
        let points: Vec<Point> = (0..20)
            .flat_map(|i| (0..20).map(move |j| (i, j)))
            .map(|(i, j)| {
                let (h, k) = (step(i), step(j));
                Point { h, k, error: (0.3 * h + 4.0 * k * k) * shake(i, j), floor: 0.0 }
            })
            .collect();
        let shape = Shape { orders: true, floor: false, bends: false };
        let found = GridFit::of(&points, ErrorCombination::Sum, shape, None).unwrap();
        let table = LogTable::new(&points);
        let start = [-3.0, -3.0, 1.1, 1.9, 0.0, 0.0, 0.0];
        let other = GridFit::from_start(&table, ErrorCombination::Sum, shape, start).unwrap();
        for (a, b) in found.estimates().into_iter().zip(other.estimates()) {
            assert!((a.value - b.value).abs() < 1e-7 && a.interval.contains(b.value));
            assert!((a.interval.half_width() - b.interval.half_width()).abs() < 1e-7);
        }
        assert_eq!(found.residual_norm.to_bits() >> 20, other.residual_norm.to_bits() >> 20);
        assert!(found.floor().is_none());
        // Orders are parameters three and four; constants at given orders are one and two.
        let radii = |fit: &GridFit| fit.estimates().map(|one| one.interval.half_width());
        let radius_by_deviation = |fit: &GridFit, at: usize| fit.quantile * fit.deviations[at];
        for (radius, at) in radii(&found).into_iter().zip([2, 3]) {
            assert!((radius - radius_by_deviation(&found, at)).abs() < 1e-12);
        }
        let given = Shape { orders: false, ..shape };
        let constants = found.again(&points, given).unwrap();
        for (radius, at) in radii(&constants).into_iter().zip([0, 1]) {
            assert!((radius - radius_by_deviation(&constants, at)).abs() < 1e-12);
        }
        assert!(found.deviations[2] != found.deviations[3]);
    }
}
