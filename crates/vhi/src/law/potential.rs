//! Normal compliance ∂j_ν as a (possibly set-valued, nonmonotone) graph r ↦ ∂j_ν(r).

/// A normal compliance law by its Clarke subdifferential.
///
/// Between jumps ∂j_ν(r) is one number with a slope; at a jump r_k it is an interval [lo, hi]. Relaxed monotonicity
/// (2.8c): (∂j_ν(r) - ∂j_ν(s))(r - s) ≥ -α_ν |r - s|².
pub trait Potential: Send + Sync {
    /// The interval ∂j_ν(r) = [lo, hi] (a pressure); lo = hi away from jumps.
    fn subdifferential(&self, r: f64) -> (f64, f64);

    /// Value and an element of the generalized derivative at r, which is not a jump.
    fn value_and_slope(&self, r: f64) -> (f64, f64);

    /// Abscissae of the upward jumps, increasing.
    fn jumps(&self) -> &[f64];

    /// Abscissae at which value or slope change, increasing: between them ∂j_ν is smooth.
    fn kinks(&self) -> &[f64];

    /// α_ν of (2.8c) (a stiffness): the steepest descent slope.
    fn alpha(&self) -> f64;

    /// (c0, c1) with |ξ| ≤ c0 + c1 |r| for all ξ ∈ ∂j_ν(r) (a pressure and a stiffness): c1 the least possible, and c0
    /// the least for it.
    fn growth(&self) -> (f64, f64);

    /// Length in r on which, between kinks, 8 Gauss points integrate ∂j_ν times a linear function to rounding; infinite
    /// for piecewise linear laws, where 2 points do.
    fn resolution(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether ∂j_ν vanishes everywhere and need not be computed.
    fn is_absent(&self) -> bool {
        false
    }
}

/// Distance of (r, ξ) from the graph of ∂j_ν as a force: `stiffness` times a displacement error or `weight` times a
/// pressure error, whichever is larger, to the nearest of the points (r, ·) and of the jumps. Rounding that puts r
/// beside a jump counts as that much displacement, not as the jump.
pub fn graph_distance(
    potential: &dyn Potential,
    [r, xi]: [f64; 2],
    weight: f64,
    stiffness: f64,
) -> f64 {
    let missed = |at: f64| {
        let (lo, hi) = potential.subdifferential(at);
        (lo - xi).max(xi - hi).max(0.0) * weight
    };
    let jumps = potential.jumps().iter();
    jumps.map(|&at| missed(at).max((r - at).abs() * stiffness)).fold(missed(r), f64::min)
}

/// j_ν ≡ 0.
#[derive(Debug, Clone, Copy)]
pub struct NoPotential;

impl Potential for NoPotential {
    fn subdifferential(&self, _: f64) -> (f64, f64) {
        (0.0, 0.0)
    }

    fn value_and_slope(&self, _: f64) -> (f64, f64) {
        (0.0, 0.0)
    }

    fn jumps(&self) -> &[f64] {
        &[]
    }

    fn kinks(&self) -> &[f64] {
        &[]
    }

    fn alpha(&self) -> f64 {
        0.0
    }

    fn growth(&self) -> (f64, f64) {
        (0.0, 0.0)
    }

    fn is_absent(&self) -> bool {
        true
    }
}

/// Why points do not define a piecewise linear graph.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PotentialError {
    #[error("the points of the law must be sorted, but {0} comes after {1}")]
    Unsorted(f64, f64),
    /// A downward jump violates (2.8c) for every α_ν.
    #[error("downward jump of ∂j_ν from {from} to {to} at {at}: (2.8c) fails for every α_ν")]
    DownwardJump { at: f64, from: f64, to: f64 },
    /// At least one point is needed, all of them finite.
    #[error("the law needs at least one point, and finite numbers only")]
    Empty,
}

/// A piecewise linear graph through points (r, p), with slopes before the first and after the last point; a repeated
/// abscissa is an upward jump.
///
/// α_ν is the steepest descent slope: between neighbouring points the difference quotient is at least the smallest
/// slope, across an upward jump it only grows, and quotients over several pieces are weighted means of those of the
/// pieces; so (∂j_ν(r) - ∂j_ν(s))(r - s) ≥ min(slope)·|r - s|².
#[derive(Debug, Clone, PartialEq)]
pub struct PiecewiseLinear {
    points: Vec<(f64, f64)>,
    slope_before: f64,
    slope_after: f64,
    jumps: Vec<f64>,
    kinks: Vec<f64>,
    alpha: f64,
}

impl PiecewiseLinear {
    /// # Errors
    /// # Errors
    /// Unsorted points, no points, numbers that are not finite, a downward jump.
    pub fn new(
        points: Vec<(f64, f64)>,
        slope_before: f64,
        slope_after: f64,
    ) -> Result<Self, PotentialError> {
        let finite = points.iter().all(|(r, p)| r.is_finite() && p.is_finite());
        if points.is_empty() || !finite || !slope_before.is_finite() || !slope_after.is_finite() {
            return Err(PotentialError::Empty);
        }
        let mut steepest = slope_before.min(slope_after);
        let mut jumps = Vec::new();
        for pair in points.windows(2) {
            let ((r0, p0), (r1, p1)) = (pair[0], pair[1]);
            if r1 < r0 {
                return Err(PotentialError::Unsorted(r1, r0));
            }
            if r1 > r0 {
                steepest = steepest.min((p1 - p0) / (r1 - r0));
            } else if p1 < p0 {
                return Err(PotentialError::DownwardJump { at: r0, from: p0, to: p1 });
            } else if p1 > p0 {
                jumps.push(r0);
            }
        }
        jumps.dedup();
        let mut kinks: Vec<f64> = points.iter().map(|point| point.0).collect();
        kinks.dedup();
        Ok(Self { kinks, points, slope_before, slope_after, jumps, alpha: (-steepest).max(0.0) })
    }

    /// Value and slope on the piece that ends at point `i` (0: before the first point).
    fn on_piece(&self, i: usize, r: f64) -> (f64, f64) {
        if i == 0 {
            let (r0, p0) = self.points[0];
            return (p0 + self.slope_before * (r - r0), self.slope_before);
        }
        let (r0, p0) = self.points[i - 1];
        let slope = match self.points.get(i) {
            Some(&(r1, p1)) => (p1 - p0) / (r1 - r0),
            None => self.slope_after,
        };
        (p0 + slope * (r - r0), slope)
    }
}

impl Potential for PiecewiseLinear {
    fn subdifferential(&self, r: f64) -> (f64, f64) {
        let first = self.points.partition_point(|p| p.0 < r);
        let last = self.points.partition_point(|p| p.0 <= r);
        if first == last {
            let value = self.on_piece(first, r).0;
            (value, value)
        } else {
            (self.points[first].1, self.points[last - 1].1)
        }
    }

    fn value_and_slope(&self, r: f64) -> (f64, f64) {
        // At a kink the slope of the piece before it: any element of the generalized derivative.
        self.on_piece(self.points.partition_point(|p| p.0 < r), r)
    }

    fn jumps(&self) -> &[f64] {
        &self.jumps
    }

    fn kinks(&self) -> &[f64] {
        &self.kinks
    }

    fn alpha(&self) -> f64 {
        self.alpha
    }

    /// |p| - c1 |r| does not grow beyond the outer points, so its maximum is at a point or at r = 0.
    fn growth(&self) -> (f64, f64) {
        let c1 = self.slope_before.abs().max(self.slope_after.abs());
        let (lo, hi) = self.subdifferential(0.0);
        let excess = self.points.iter().map(|(r, p)| p.abs() - c1 * r.abs());
        let c0 = excess.chain([lo.abs(), hi.abs()]).fold(0.0, f64::max);
        (c0, c1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law() -> PiecewiseLinear {
        let points = vec![(0.0, 0.0), (0.04, 0.08), (0.10, 0.05)];
        PiecewiseLinear::new(points, 0.0, 0.0).unwrap()
    }

    #[test]
    fn pieces_are_resolved_by_any_rule() {
        assert_eq!(law().resolution(), f64::INFINITY);
        assert_eq!(NoPotential.resolution(), f64::INFINITY);
        assert!(NoPotential.jumps().is_empty() && NoPotential.kinks().is_empty());
        assert_eq!(law().value_and_slope(0.04).1, 2.0);
    }

    #[test]
    fn values_and_slopes_on_every_branch() {
        let law = law();
        for (r, value, slope) in
            [(-1.0, 0.0, 0.0), (0.02, 0.04, 2.0), (0.07, 0.065, -0.5), (0.3, 0.05, 0.0)]
        {
            let (p, s) = law.value_and_slope(r);
            assert!((p - value).abs() < 1e-15 && (s - slope).abs() < 1e-13, "{r}: {p} {s}");
        }
        assert!((law.alpha() - 0.5).abs() < 1e-13);
        assert_eq!(law.subdifferential(0.04), (0.08, 0.08));
    }

    #[test]
    fn jumps_up_are_intervals_and_jumps_down_are_refused() {
        let layer = PiecewiseLinear::new(vec![(0.0, 0.0), (0.0, 1.0)], 0.0, -0.2).unwrap();
        assert_eq!(layer.subdifferential(0.0), (0.0, 1.0));
        assert_eq!(layer.jumps(), &[0.0]);
        assert!((layer.value_and_slope(0.5).0 - 0.9).abs() < 1e-15);
        let down = PiecewiseLinear::new(vec![(0.1, 1.0), (0.1, 0.5)], 0.0, 0.0);
        assert_eq!(down, Err(PotentialError::DownwardJump { at: 0.1, from: 1.0, to: 0.5 }));
    }

    #[test]
    fn distance_from_the_graph_is_small_beside_a_jump_and_large_away_from_it() {
        let layer = PiecewiseLinear::new(vec![(0.1, 0.0), (0.1, 1.0)], 0.0, -0.2).unwrap();
        let distance = |r: f64, xi: f64| graph_distance(&layer, [r, xi], 2.0, 10.0);
        for r in [0.1 - 1e-15, 0.1, 0.1 + 1e-15] {
            assert!([0.0, 0.5, 1.0].iter().all(|&xi| distance(r, xi) < 2e-14));
            assert!((distance(r, 1.2) - 0.4).abs() < 1e-13 && distance(r, -0.1) > 0.19);
        }
        assert!((distance(0.11, 0.5) - 0.1).abs() < 1e-13);
        assert!((distance(0.0, 0.3) - 0.6).abs() < 1e-13);
        assert!((distance(1.0, 0.82)).abs() < 1e-15);
    }

    #[test]
    fn growth_holds_and_is_attained() {
        let steep =
            PiecewiseLinear::new(vec![(0.1, -1.0), (0.1, 0.5), (0.3, 2.0)], 3.0, 1.0).unwrap();
        // |p| - c1 |r| is largest at the point (0.2, 1).
        let bent =
            PiecewiseLinear::new(vec![(-0.1, 0.0), (0.2, 1.0), (0.4, 1.0)], 1.0, 1.0).unwrap();
        for law in [law(), steep, bent] {
            let (c0, c1) = law.growth();
            let mut worst = f64::NEG_INFINITY;
            for i in -4000..4000 {
                let r = f64::from(i) * 1e-3;
                let (lo, hi) = law.subdifferential(r);
                worst = worst.max(lo.abs().max(hi.abs()) - c1 * r.abs());
            }
            assert!(worst <= c0 + 1e-12 && worst > c0 - 1e-9, "{worst} {c0} {c1}");
        }
    }

    #[test]
    fn relaxed_monotonicity_holds_with_alpha_and_fails_below_it() {
        let law = law();
        let mut worst = f64::INFINITY;
        for i in -20..80 {
            for j in -20..80 {
                let (r, s) = (f64::from(i) * 0.002, f64::from(j) * 0.002);
                if r != s {
                    let gap = law.subdifferential(r).0 - law.subdifferential(s).0;
                    worst = worst.min(gap / (r - s));
                }
            }
        }
        assert!(worst >= -law.alpha() - 1e-12 && worst <= -law.alpha() + 1e-12);
    }

    #[test]
    fn no_potential_is_zero_and_absent() {
        for r in [-1.0, 0.0, 0.3] {
            assert_eq!(NoPotential.subdifferential(r), (0.0, 0.0));
            assert_eq!(NoPotential.value_and_slope(r), (0.0, 0.0));
        }
        assert!(NoPotential.jumps().is_empty() && NoPotential.kinks().is_empty());
        assert_eq!((NoPotential.alpha(), NoPotential.growth()), (0.0, (0.0, 0.0)));
        assert!(NoPotential.is_absent() && !law().is_absent());
    }

    #[test]
    fn outer_slopes_reach_outwards_and_kinks_are_listed_once() {
        let points = vec![(0.1, 1.0), (0.1, 1.5), (0.1, 2.0), (0.3, 2.0), (0.3, 2.0)];
        let law = PiecewiseLinear::new(points, 3.0, -2.0).unwrap();
        let close = |(p, s): (f64, f64), (value, slope): (f64, f64)| {
            assert!((p - value).abs() < 1e-15 && s == slope, "{p} {s}");
        };
        close(law.value_and_slope(-0.4), (-0.5, 3.0));
        close(law.value_and_slope(0.2), (2.0, 0.0));
        close(law.value_and_slope(0.8), (1.0, -2.0));
        assert_eq!(law.subdifferential(0.1), (1.0, 2.0));
        // A point given twice is not a jump.
        assert_eq!((law.jumps(), law.kinks()), (&[0.1][..], &[0.1, 0.3][..]));
        assert_eq!(law.alpha(), 2.0);
        let rising = PiecewiseLinear::new(vec![(0.0, 0.0), (1.0, 2.0)], 1.0, 3.0).unwrap();
        assert_eq!(rising.alpha(), 0.0);
    }

    #[test]
    fn numbers_that_are_none_and_points_out_of_order_are_refused() {
        let new = PiecewiseLinear::new;
        let bad = f64::INFINITY;
        for refused in [
            new(vec![], 0.0, 0.0),
            new(vec![(bad, 0.0)], 0.0, 0.0),
            new(vec![(0.0, f64::NAN)], 0.0, 0.0),
            new(vec![(0.0, 0.0)], bad, 0.0),
            new(vec![(0.0, 0.0)], 0.0, bad),
        ] {
            assert_eq!(refused, Err(PotentialError::Empty));
        }
        let unsorted = new(vec![(0.2, 0.0), (0.1, 0.0)], 0.0, 0.0);
        assert_eq!(unsorted, Err(PotentialError::Unsorted(0.1, 0.2)));
    }
}
