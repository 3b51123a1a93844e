//! Which h and k reach an error at least cost.
//!
//! With S = C_h h^p and T = C_k k^q the cost c h^-a k^-b is a multiple of S^(-a/p) T^(-b/q), least under a given error
//! where p S^m / a = q T^m / b, m = 1 for E = S + T and m = 2 for E² = S² + T² (Lagrange: the slopes of log cost and
//! of E^m in log h and log k are parallel). Hence S^m = E^m (a/p)/(a/p + b/q), T^m is the rest, k is a multiple of
//! h^(p/q), and the cost of an error grows like E^-(a/p + b/q). A constant t₀ changes none of it.

use super::{CostModel, ErrorModel, Term};

/// The cheapest h and k for an error.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct Optimum {
    /// Mesh size; none where the error does not depend on it.
    pub h: Option<f64>,
    /// Time step, likewise.
    pub k: Option<f64>,
}

/// The path k = c h^s of the optima of all errors.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub(crate) struct Coupling {
    /// s = p/q.
    pub exponent: f64,
    /// c.
    pub factor: f64,
    /// Part of E^m that is left to space, (a/p)/(a/p + b/q).
    pub space_share: f64,
    /// The cost of an error grows like E to minus this: a/p + b/q.
    pub cost_exponent: f64,
}

/// The coupling, where both terms are there and both exponents of the cost are positive.
pub(crate) fn coupling(error: &ErrorModel, cost: &CostModel) -> Option<Coupling> {
    let (space, time) = (error.space?, error.time?);
    let (a, b) = (cost.space.exponent, cost.time.exponent);
    let (alpha, beta) = (a / space.order, b / time.order);
    if !(alpha > 0.0 && beta > 0.0) {
        return None;
    }
    // T^m = S^m β/α.
    let ratio = (beta / alpha).powf(1.0 / error.model.exponent());
    let factor = (ratio * space.constant / time.constant).powf(1.0 / time.order);
    Some(Coupling {
        exponent: space.order / time.order,
        factor,
        space_share: alpha / (alpha + beta),
        cost_exponent: alpha + beta,
    })
}

/// The cheapest real h and k for the error `target`; none where a cost falls with a finer step, so that there is none.
pub(crate) fn optimum(error: &ErrorModel, cost: &CostModel, target: f64) -> Option<Optimum> {
    let step = |term: Term, share: f64| {
        let part = target * share.powf(1.0 / error.model.exponent());
        (part / term.constant).powf(1.0 / term.order)
    };
    match (error.space, error.time) {
        (Some(space), Some(time)) => {
            let share = coupling(error, cost)?.space_share;
            Some(Optimum { h: Some(step(space, share)), k: Some(step(time, 1.0 - share)) })
        }
        (space, time) => Some(Optimum {
            h: space.map(|term| step(term, 1.0)),
            k: time.map(|term| step(term, 1.0)),
        }),
    }
}

/// The exponent with which cost grows as the error falls along k = c h^s, and that of the error itself in h there: the
/// worse of p and s q.
pub(crate) fn along_path(error: &ErrorModel, cost: &CostModel, s: f64) -> Option<f64> {
    let (space, time) = (error.space?, error.time?);
    let order = space.order.min(s * time.order);
    Some((cost.space.exponent + s * cost.time.exponent) / order)
}

#[cfg(test)]
mod tests {
    use super::super::cost_model::Exponent;
    use super::*;
    use judge::fit::{ErrorCombination, Interval};

    fn error(model: ErrorCombination, [ch, p]: [f64; 2], [ck, q]: [f64; 2]) -> ErrorModel {
        let term = |constant, order| {
            Some(Term { constant, order, interval: Interval::around(order, 0.0) })
        };
        let source = String::new();
        ErrorModel { model, space: term(ch, p), time: term(ck, q), source, residual: 0.0 }
    }

    fn cost(a: f64, b: f64) -> CostModel {
        let estimate = |exponent| Exponent { exponent, interval: Interval::around(exponent, 0.0) };
        CostModel {
            base: 0.0,
            constant: 1e-6,
            space: estimate(a),
            time: estimate(b),
            residual: 0.0,
        }
    }

    /// The least cost under E(h, k) = target, by search over h alone: k is what the target leaves.
    fn searched(error: &ErrorModel, cost: &CostModel, target: f64) -> f64 {
        let time = error.time.expect("a term of k");
        let at = |log_h: f64| {
            let (m, space) =
                (error.model.exponent(), error.space.map_or(0.0, |s| s.at(log_h.exp())));
            let left = (target.powf(m) - space.powf(m)).max(0.0).powf(1.0 / m);
            let k = (left / time.constant).powf(1.0 / time.order);
            if k > 0.0 { cost.seconds(log_h.exp(), k) } else { f64::INFINITY }
        };
        (0..200_000).map(|i| at(-12.0 + 14.0 * f64::from(i) / 2e5)).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_optimum_is_the_least_cost_of_a_search() {
        for model in [ErrorCombination::Sum, ErrorCombination::RootSumSquare] {
            for (space, time, a, b) in [
                ([0.5, 1.0], [2.0, 2.0], 2.4, 0.9),
                ([3.0, 0.6], [0.1, 2.0], 3.0, 1.0),
                ([1.0, 2.0], [5.0, 1.0], 2.0, 1.7),
            ] {
                let (error, cost) = (error(model, space, time), cost(a, b));
                for target in [0.1, 0.003] {
                    let found = optimum(&error, &cost, target).expect("an optimum");
                    let (h, k) = (found.h.expect("h"), found.k.expect("k"));
                    // On the constraint, but for roundings of powers.
                    assert!((error.error(h, k) / target - 1.0).abs() < 1e-12);
                    let least = searched(&error, &cost, target);
                    let seconds = cost.seconds(h, k);
                    // The search looks at every 7e-5 of log h, where the cost is flat.
                    assert!((seconds / least - 1.0).abs() < 1e-6, "{seconds} {least}");
                    let path = coupling(&error, &cost).expect("a path");
                    assert!((path.factor * h.powf(path.exponent) / k - 1.0).abs() < 1e-12);
                    // The balance of the doc comment with a wrong exponent of the cost is dearer.
                    let four = Exponent { exponent: 4.0 * b, ..cost.time };
                    let wrong = CostModel { time: four, ..cost.clone() };
                    let off = optimum(&error, &wrong, target).expect("an optimum");
                    let dear = cost.seconds(off.h.expect("h"), off.k.expect("k"));
                    assert!(dear > 1.01 * least, "{dear} {least}");
                }
            }
        }
    }

    #[test]
    fn the_cost_of_an_error_grows_with_its_exponent() {
        let (error, cost) = (error(ErrorCombination::Sum, [0.5, 1.0], [2.0, 2.0]), cost(2.4, 0.9));
        let seconds = |target: f64| {
            let found = optimum(&error, &cost, target).expect("an optimum");
            cost.seconds(found.h.expect("h"), found.k.expect("k"))
        };
        let exponent = (seconds(0.001) / seconds(0.01)).log10();
        assert!((exponent - (2.4 + 0.45)).abs() < 1e-12);
        let path = coupling(&error, &cost).expect("a path");
        assert!((path.cost_exponent - exponent).abs() < 1e-12 && path.exponent == 0.5);
        // Another path has no smaller one.
        for s in [0.25, 0.4, 0.6, 1.0, 2.0] {
            assert!(along_path(&error, &cost, s).expect("an exponent") > exponent, "{s}");
        }
        assert!((along_path(&error, &cost, 0.5).expect("an exponent") - exponent).abs() < 1e-12);
    }

    #[test]
    fn a_term_that_is_not_there_asks_for_nothing() {
        let mut error = error(ErrorCombination::Sum, [0.5, 1.0], [2.0, 2.0]);
        error.space = None;
        let found = optimum(&error, &cost(2.0, 1.0), 0.02).expect("an optimum");
        assert!(found.h.is_none() && (found.k.expect("k") - 0.1).abs() < 1e-15);
        assert!(coupling(&error, &cost(2.0, 1.0)).is_none());
        // Cost that falls with a finer step has no least.
        error.space = error.time;
        assert!(optimum(&error, &cost(2.0, -0.1), 0.02).is_none());
    }
}
