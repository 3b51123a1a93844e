//! Places where guards change sign: the cuts of quadrature on piecewise smooth fields.

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
