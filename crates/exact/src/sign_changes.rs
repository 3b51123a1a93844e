//! Places where guards change sign: the cuts of quadrature on piecewise smooth fields.

use formula::{Graph, Node, Program};

/// Expressions whose signs decide the branches of fields.
pub(super) struct Guards {
    program: Program,
    count: usize,
}

impl Guards {
    pub(super) fn new(graph: &Graph, guards: &[Node], horizon: f64) -> Self {
        Self { program: Program::compile(graph, guards, horizon), count: guards.len() }
    }

    /// Their values at points, guard by guard.
    pub(super) fn at(&self, points: &[[f64; 3]], t: f64) -> Vec<Vec<f64>> {
        self.program.values(points, t, 0.0)
    }

    /// Where one changes sign on a line at time t, by the coordinate of which `point` is a function.
    pub(super) fn along(
        &self,
        [from, to]: [f64; 2],
        watches: usize,
        t: f64,
        point: impl Fn(f64) -> [f64; 3],
    ) -> Vec<f64> {
        if self.count == 0 {
            return Vec::new();
        }
        sign_changes(from, to, watches, |places| {
            self.at(&places.iter().map(|&place| point(place)).collect::<Vec<_>>(), t)
        })
    }

    /// When one changes sign at one of some points.
    pub(super) fn in_time(
        &self,
        [from, to]: [f64; 2],
        watches: usize,
        points: &[[f64; 3]],
    ) -> Vec<f64> {
        if self.count == 0 {
            return Vec::new();
        }
        sign_changes(from, to, watches, |times| {
            let mut bound = self.program.bind(points);
            let mut rows = vec![Vec::with_capacity(times.len()); points.len() * self.count];
            for &t in times {
                let values = bound.values_at(t, 0.0);
                let pairs = rows.iter_mut().zip(values.iter().flatten());
                pairs.for_each(|(row, value)| row.push(*value));
            }
            rows
        })
    }
}

/// Places in (from, to) where one of several functions changes sign, sorted, by simultaneous bisection to rounding.
/// `values` returns one list per function for a list of places.
pub fn sign_changes(
    from: f64,
    to: f64,
    watches: usize,
    values: impl Fn(&[f64]) -> Vec<Vec<f64>>,
) -> Vec<f64> {
    let places: Vec<f64> =
        (0..=watches).map(|i| from + (to - from) * i as f64 / watches as f64).collect();
    // Brackets as (function, low, high, negative at low).
    let mut brackets = Vec::new();
    for (g, list) in values(&places).iter().enumerate() {
        for i in 0..watches {
            if (list[i] < 0.0) != (list[i + 1] < 0.0) {
                brackets.push((g, places[i], places[i + 1], list[i] < 0.0));
            }
        }
    }
    // 52 halvings exhaust the digits of an f64.
    for _ in 0..if brackets.is_empty() { 0 } else { 52 } {
        let middles: Vec<f64> = brackets.iter().map(|b| 0.5 * (b.1 + b.2)).collect();
        let at = values(&middles);
        for (b, bracket) in brackets.iter_mut().enumerate() {
            if (at[bracket.0][b] < 0.0) == bracket.3 {
                bracket.1 = middles[b];
            } else {
                bracket.2 = middles[b];
            }
        }
    }
    let mut roots: Vec<f64> = brackets.iter().map(|b| 0.5 * (b.1 + b.2)).collect();
    roots.sort_by(f64::total_cmp);
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_several_functions_come_sorted_and_to_rounding() {
        let roots = sign_changes(0.0, 2.0, 16, |places| {
            let each = |f: fn(f64) -> f64| places.iter().map(|&x| f(x)).collect();
            vec![each(|x| x * x - 2.0), each(|x| (3.0 * x).cos()), each(|_| 1.0)]
        });
        let expected = [std::f64::consts::FRAC_PI_6, 2f64.sqrt(), std::f64::consts::FRAC_PI_2];
        assert_eq!(roots.len(), 3);
        assert!(roots.iter().zip(expected).all(|(r, e)| (r - e).abs() < 1e-15));
    }
}
