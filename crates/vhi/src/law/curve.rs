//! Curved compliance laws: rational, exponential, and a power continued by its tangent.

use super::{PiecewiseLinear, Potential};

/// The smooth part of a compliance law, p(r) for r > 0; p = 0 for r ≤ 0. All constants are positive.
///
/// With q = r/r0. By the mean value theorem bounds of p' give (2.8c), since p is continuous and differentiable except
/// at finitely many points:
///
/// - *rational*, p = c r/(1 + q²): p' = c (1 - q²)/(1 + q²)². Its derivative in x = q² has the sign of x - 3, so p' ≥
///   -c/8, attained at q = √3: α = c/8. p ≤ c r0/2, attained at q = 1: c1 = 0, c0 = c r0/2.
/// - *exponential*, p = c r e^{-q}: p' = c (1 - q) e^{-q}, whose derivative has the sign of q - 2, so p' ≥ -c e⁻²,
///   attained at q = 2: α = c e⁻². p ≤ c r0/e, attained at q = 1: c1 = 0, c0 = c r0/e.
/// - *power*, p = c r^m up to r1 and its tangent beyond, m ≥ 1: p' ≥ 0, so α = 0. p is convex with p(0) = 0 and final
///   slope c1 = c m r1^{m-1}, so p ≤ c1 r and c0 = 0; no smaller c1 bounds the tangent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    /// c r/(1 + (r/r0)²).
    Rational {
        /// c (a stiffness).
        stiffness: f64,
        /// r0 (a length).
        length: f64,
    },
    /// c r exp(-r/r0).
    Exponential {
        /// c (a stiffness).
        stiffness: f64,
        /// r0 (a length).
        length: f64,
    },
    /// c r^m for r ≤ r1, c r1^m + c m r1^{m-1} (r - r1) beyond: linear growth, as (2.8b) requires.
    Power {
        /// c (a pressure over a length to the m).
        coefficient: f64,
        /// m ≥ 1.
        exponent: f64,
        /// r1 (a length).
        until: f64,
    },
}

impl Curve {
    /// p(r) and p'(r); at r = 0 the slope from the left.
    pub(crate) fn value_and_slope(&self, r: f64) -> (f64, f64) {
        // NaN is passed on.
        if r <= 0.0 {
            return (0.0, 0.0);
        }
        match *self {
            Self::Rational { stiffness, length } => {
                let square = (r / length).powi(2);
                let below = 1.0 / (1.0 + square);
                (stiffness * r * below, stiffness * (1.0 - square) * below * below)
            }
            Self::Exponential { stiffness, length } => {
                let decay = stiffness * (-r / length).exp();
                (r * decay, (1.0 - r / length) * decay)
            }
            Self::Power { coefficient, exponent, until } => {
                let place = r.min(until);
                let slope = coefficient * exponent * place.powf(exponent - 1.0);
                (place * slope / exponent + slope * (r - place), slope)
            }
        }
    }

    /// α of (2.8c) (a stiffness), see [`Curve`].
    pub fn alpha(&self) -> f64 {
        match *self {
            Self::Rational { stiffness, .. } => stiffness / 8.0,
            Self::Exponential { stiffness, .. } => stiffness * (-2.0f64).exp(),
            Self::Power { .. } => 0.0,
        }
    }

    /// (c0, c1) of (2.8b), see [`Curve`].
    pub(crate) fn growth(&self) -> (f64, f64) {
        match *self {
            Self::Rational { stiffness, length } => (0.5 * stiffness * length, 0.0),
            Self::Exponential { stiffness, length } => (stiffness * length * (-1.0f64).exp(), 0.0),
            Self::Power { coefficient, exponent, until } => {
                (0.0, coefficient * exponent * until.powf(exponent - 1.0))
            }
        }
    }

    fn kinks(&self) -> Vec<f64> {
        match *self {
            Self::Rational { .. } | Self::Exponential { .. } => vec![0.0],
            Self::Power { until, .. } => vec![0.0, until],
        }
    }

    /// [`Potential::resolution`].
    ///
    /// *Rational*: on an interval of length r0/2, with its half as unit, the poles ± i r0 are at a distance of at least
    /// 4, on an ellipse with sum of semiaxes 4 + √17 > 8; 8 points leave 8⁻¹⁶ = 4e-15. *Exponential*: entire; on an
    /// interval of length r0 the remainder is below 1e-20. *Power*: a polynomial of degree m + 1 ≤ 15 for integer m (no
    /// exact rule otherwise).
    fn resolution(&self) -> f64 {
        match *self {
            Self::Rational { length, .. } => 0.5 * length,
            Self::Exponential { length, .. } => length,
            Self::Power { until, .. } => until,
        }
    }
}

/// A curved law plus an optional piecewise linear one: ∂j_ν(r) = G(r) + p(r).
///
/// α, c0 and c1 are the sums of both, which is sufficient for any G. They are optimal if G is a jump at r = 0, as
/// scenes state it: then G adds nothing to quotients within r > 0, and p0 to every value there.
#[derive(Debug, Clone, PartialEq)]
pub struct Curved {
    graph: PiecewiseLinear,
    curve: Curve,
    kinks: Vec<f64>,
}

impl Curved {
    /// The sum of `graph` and `curve`.
    pub fn new(graph: PiecewiseLinear, curve: Curve) -> Self {
        let mut kinks = curve.kinks();
        kinks.extend(graph.kinks());
        kinks.sort_by(f64::total_cmp);
        kinks.dedup();
        Self { graph, curve, kinks }
    }
}

impl Potential for Curved {
    fn subdifferential(&self, r: f64) -> (f64, f64) {
        let (lo, hi) = self.graph.subdifferential(r);
        let p = self.curve.value_and_slope(r).0;
        (lo + p, hi + p)
    }

    fn value_and_slope(&self, r: f64) -> (f64, f64) {
        let (value, slope) = self.graph.value_and_slope(r);
        let (p, rise) = self.curve.value_and_slope(r);
        (value + p, slope + rise)
    }

    fn jumps(&self) -> &[f64] {
        self.graph.jumps()
    }

    fn kinks(&self) -> &[f64] {
        &self.kinks
    }

    fn alpha(&self) -> f64 {
        self.graph.alpha() + self.curve.alpha()
    }

    fn growth(&self) -> (f64, f64) {
        let (graph, curve) = (self.graph.growth(), self.curve.growth());
        (graph.0 + curve.0, graph.1 + curve.1)
    }

    fn resolution(&self) -> f64 {
        self.curve.resolution()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curves() -> [Curve; 4] {
        [
            Curve::Rational { stiffness: 2.0, length: 0.3 },
            Curve::Exponential { stiffness: 3.0, length: 0.2 },
            Curve::Power { coefficient: 4.0, exponent: 2.5, until: 0.6 },
            Curve::Power { coefficient: 0.5, exponent: 1.0, until: 0.1 },
        ]
    }

    #[test]
    fn slopes_are_derivatives_and_the_tangent_is_smooth() {
        for curve in curves() {
            for r in [-0.4, 0.02, 0.19, 0.3, 0.55, 0.7, 3.0] {
                let at = |r: f64| curve.value_and_slope(r).0;
                let difference = (at(r + 1e-6) - at(r - 1e-6)) / 2e-6;
                // Third derivatives below 1e3 times 1e-12, rounding 1e-16/1e-6.
                let off = (difference - curve.value_and_slope(r).1).abs();
                assert!(off < 1e-8, "{curve:?} at {r}: {off:e}");
            }
            assert!(curve.value_and_slope(f64::NAN).0.is_nan());
        }
        let power = curves()[2];
        let [before, after] = [0.6f64.next_down(), 0.6f64.next_up()];
        assert!((power.value_and_slope(before).0 - 4.0 * 0.6f64.powf(2.5)).abs() < 1e-14);
        let jump = power.value_and_slope(after).1 - power.value_and_slope(before).1;
        assert!(jump.abs() < 1e-13);
    }

    /// The constants are attained where the proof says, and not exceeded elsewhere.
    #[test]
    fn constants_hold_on_samples_and_are_attained() {
        for curve in curves() {
            let (c0, c1) = curve.growth();
            let (mut descent, mut excess) = (0.0f64, 0.0f64);
            for i in 1..40_000 {
                let r = f64::from(i) * 1e-4;
                let (p, slope) = curve.value_and_slope(r);
                descent = descent.max(-slope);
                excess = excess.max(p - c1 * r);
            }
            // Extremes of parabolas sampled within 5e-5: (5e-5/r0)² of them.
            assert!(descent <= curve.alpha() + 1e-13 && descent >= curve.alpha() * (1.0 - 1e-6));
            assert!(excess <= c0 + 1e-13 && excess >= c0 * (1.0 - 1e-6), "{curve:?}");
            let far = curve.value_and_slope(1e9).0 / 1e9;
            assert!((far - c1).abs() < 1e-7, "{curve:?}: {far} {c1}");
        }
    }

    #[test]
    fn a_jump_before_a_curve_is_an_interval() {
        let step = PiecewiseLinear::new(vec![(0.0, 0.0), (0.0, 0.7)], 0.0, 0.0).unwrap();
        let law = Curved::new(step, curves()[0]);
        assert_eq!(law.subdifferential(0.0), (0.0, 0.7));
        assert_eq!((law.jumps(), law.kinks()), (&[0.0][..], &[0.0][..]));
        // At r0 the curve has its maximum 2 · 0.3/2.
        assert!((law.subdifferential(0.3).0 - 1.0).abs() < 1e-15);
        assert_eq!((law.alpha(), law.growth()), (0.25, (1.0, 0.0)));
    }

    /// G with the slope 2, a jump from 0.2 to 0.5 at 0.1 and the slope -1 after it, and p = 4 r^2.5 up to 0.6.
    #[test]
    fn a_curve_is_added_to_what_the_graph_has() {
        let graph =
            PiecewiseLinear::new(vec![(0.0, 0.0), (0.1, 0.2), (0.1, 0.5)], 2.0, -1.0).unwrap();
        let law = Curved::new(graph.clone(), curves()[2]);
        let p = |r: f64| 4.0 * r.powf(2.5);
        let close = |(a, b): (f64, f64), (c, d): (f64, f64)| {
            assert!((a - c).abs() < 1e-14 && (b - d).abs() < 1e-14, "({a}, {b}) ({c}, {d})");
        };
        close(law.subdifferential(0.1), (0.2 + p(0.1), 0.5 + p(0.1)));
        close(law.value_and_slope(0.05), (0.1 + p(0.05), 2.0 + 10.0 * 0.05f64.powf(1.5)));
        close(law.value_and_slope(0.3), (0.3 + p(0.3), -1.0 + 10.0 * 0.3f64.powf(1.5)));
        assert_eq!(law.jumps(), &[0.1]);
        assert_eq!(law.kinks(), &[0.0, 0.1, 0.6]);
        let (by_graph, more) = (graph.growth(), curves()[2].growth());
        assert!(by_graph.0 > 0.0 && by_graph.1 > 0.0 && more.1 > 0.0);
        close(law.growth(), (by_graph.0 + more.0, by_graph.1 + more.1));
        assert_eq!(law.alpha(), graph.alpha());
    }

    /// The lengths in the docs of [`Curve::resolution`].
    #[test]
    fn edges_are_cut_where_a_rule_resolves_the_curve() {
        let lengths = curves().map(|curve| {
            let none = PiecewiseLinear::new(vec![(0.0, 0.0)], 0.0, 0.0).unwrap();
            Curved::new(none, curve).resolution()
        });
        assert_eq!(lengths, [0.15, 0.2, 0.6, 0.1]);
    }
}
