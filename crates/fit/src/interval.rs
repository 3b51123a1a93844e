//! Closed intervals of orders and constants.

/// A closed interval `[lo, hi]`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(into = "[f64; 2]")]
pub struct Interval {
    pub lo: f64,
    pub hi: f64,
}

impl Interval {
    /// `[centre - radius, centre + radius]`.
    pub fn around(centre: f64, radius: f64) -> Self {
        Self { lo: centre - radius, hi: centre + radius }
    }

    /// The smallest interval that contains all values; none without values.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let points = values.into_iter().map(|value| Self { lo: value, hi: value });
        points.reduce(Self::hull)
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Half of its length.
    pub fn half_width(self) -> f64 {
        0.5 * (self.hi - self.lo)
    }

    /// Whether it holds `value`.
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    #[must_use]
    pub(crate) fn exp(self) -> Self {
        Self { lo: self.lo.exp(), hi: self.hi.exp() }
    }
}

impl From<Interval> for [f64; 2] {
    fn from(interval: Interval) -> Self {
        [interval.lo, interval.hi]
    }
}

impl std::fmt::Display for Interval {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "[{:.3}, {:.3}]", self.lo, self.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_and_widths() {
        let hull = Interval::of([2.0, -1.0, 0.5]).unwrap();
        assert_eq!(hull, Interval { lo: -1.0, hi: 2.0 });
        assert_eq!(hull.half_width(), 1.5);
        assert!(hull.contains(2.0) && !hull.contains(2.1));
        assert!(hull.contains(-1.0) && !hull.contains(-1.1));
        let exp = Interval { lo: 0.0, hi: 1.0 }.exp();
        assert_eq!(exp, Interval { lo: 1.0, hi: std::f64::consts::E });
        assert!(Interval::of([]).is_none());
        assert_eq!(Interval::around(1.0, 0.5).to_string(), "[0.500, 1.500]");
    }
}
