//! Where a quantity that grows with k reaches one.

use serde::Serialize;

/// The k at which a factor reaches one; as JSON the bracket, whose upper end is null where it is infinite.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(into = "[f64; 2]")]
pub enum Crossing {
    Between(f64, f64),
    /// It stays below one up to this k.
    Beyond(f64),
    /// It is one or more already at this k, the smallest that was tried.
    Before(f64),
}

impl From<Crossing> for [f64; 2] {
    fn from(crossing: Crossing) -> Self {
        [crossing.lower(), crossing.upper()]
    }
}

impl Crossing {
    /// The largest k known to be below the crossing.
    pub fn lower(self) -> f64 {
        match self {
            Self::Between(low, _) | Self::Beyond(low) => low,
            Self::Before(_) => 0.0,
        }
    }

    /// The smallest k known to be beyond it, infinite if none is.
    pub(crate) fn upper(self) -> f64 {
        match self {
            Self::Between(_, high) | Self::Before(high) => high,
            Self::Beyond(_) => f64::INFINITY,
        }
    }
}

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
        return Ok(Some(Crossing::Before(first.0)));
    }
    let Some(pair) = ladder.windows(2).find(|pair| reached(pair[1].1)) else {
        return Ok(Some(Crossing::Beyond(last.0)));
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
    Ok(Some(Crossing::Between(low, high)))
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
            let Crossing::Between(low, high) = found(&factor) else { panic!("not bracketed") };
            assert!(low <= exact * (1.0 + 1e-15) && exact <= high * (1.0 + 1e-15));
            assert!(high - low <= 1e-8 * exact, "{low} {high}");
        }
    }

    #[test]
    fn ends_are_said_and_a_missing_value_is_no_success() {
        assert_eq!(found(|_| 0.5), Crossing::Beyond(512.0));
        assert_eq!(found(|_| 2.0), Crossing::Before(0.25));
        assert_eq!(found(|_| f64::NAN), Crossing::Before(0.25));
        let nan = found(|k| if k < 6.0 { 0.1 * k } else { f64::NAN });
        assert!((nan.lower() - 6.0).abs() < 1e-6, "{nan:?}");
    }
}
