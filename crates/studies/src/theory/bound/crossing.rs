//! Where a quantity that grows with k reaches one.

/// Between which k a factor reaches one: the first is 0 where it is one or more already at the smallest k that was
/// tried, the second infinite where it stays below one up to the largest.
pub type Crossing = [f64; 2];

const WIDTH: f64 = 1e-8;
/// Evaluations within one bracket: bisection alone would need 30 from a factor of two.
const EVALUATIONS: u32 = 60;

/// The first crossing of `factor` - 1 along the increasing sequence `ladder` of (k, factor), narrowed
/// by the Illinois method (a bracket is kept, so a jump is found as well).
///
/// # Errors
/// `factor` fails.
pub(crate) fn crossing<E>(
    ladder: &[(f64, f64)],
    mut factor: impl FnMut(f64) -> Result<f64, E>,
) -> Result<Option<Crossing>, E> {
    let (Some(first), Some(last)) = (ladder.first(), ladder.last()) else { return Ok(None) };
    let reached = |value: f64| value.is_nan() || value >= 1.0;
    if reached(first.1) {
        return Ok(Some([0.0, first.0]));
    }
    let Some(pair) = ladder.windows(2).find(|pair| reached(pair[1].1)) else {
        return Ok(Some([last.0, f64::INFINITY]));
    };
    let ((mut low, mut below), (mut high, mut above)) =
        ((pair[0].0, pair[0].1 - 1.0), (pair[1].0, pair[1].1 - 1.0));
    let mut side = 0;
    for evaluation in 0..EVALUATIONS {
        if high - low <= WIDTH * high {
            break;
        }
        let secant = low - below * (high - low) / (above - below);
        // Every third point bisects: an end that does not move must not stay far away.
        let inside = secant > low && secant < high && evaluation % 3 != 2;
        let middle = if inside { secant } else { 0.5 * (low + high) };
        let value = factor(middle)? - 1.0;
        if value.is_nan() || value >= 0.0 {
            below *= if side == 1 { 0.5 } else { 1.0 };
            (high, above, side) = (middle, value, 1);
        } else {
            above *= if side == -1 { 0.5 } else { 1.0 };
            (low, below, side) = (middle, value, -1);
        }
    }
    Ok(Some([low, high]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(factor: impl Fn(f64) -> f64) -> Crossing {
        let ladder: Vec<(f64, f64)> =
            (0..12).map(|i| 0.25 * 2f64.powi(i)).map(|k| (k, factor(k))).collect();
        crossing(&ladder, |k| Ok::<_, ()>(factor(k))).unwrap().unwrap()
    }

    #[test]
    fn lines_curves_and_jumps_are_bracketed() {
        for (factor, exact) in [
            (Box::new(|k: f64| k / 3.0) as Box<dyn Fn(f64) -> f64>, 3.0),
            (Box::new(|k: f64| (k / 5.0).powi(4)), 5.0),
            (Box::new(|k: f64| if k < 7.3 { 0.2 } else { 4.0 }), 7.3),
        ] {
            let [low, high] = found(&factor);
            assert!(low <= exact * (1.0 + 1e-15) && exact <= high * (1.0 + 1e-15));
            assert!(high - low <= 1e-8 * exact, "{low} {high}");
        }
    }

    #[test]
    fn ends_are_said_and_a_missing_value_is_no_success() {
        assert_eq!(found(|_| 0.5), [512.0, f64::INFINITY]);
        assert_eq!(found(|_| 2.0), [0.0, 0.25]);
        assert_eq!(found(|_| f64::NAN), [0.0, 0.25]);
        let nan = found(|k| if k < 6.0 { 0.1 * k } else { f64::NAN });
        assert!((nan[0] - 6.0).abs() < 1e-6, "{nan:?}");
    }
}
