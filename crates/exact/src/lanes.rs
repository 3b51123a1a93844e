//! Several cells in parallel, on vector registers.

use std::ops::{Add, Div, Mul, Sub};

/// Cells in parallel: a register of most processors.
pub const WIDTH: usize = 4;

/// A real number, or several on which each operation acts and rounds separately.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + From<f64>
{
    fn sqrt(self) -> Self;

    /// `then` if at most `limit`, else `otherwise`.
    fn at_most(self, limit: f64, then: Self, otherwise: Self) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn at_most(self, limit: f64, then: Self, otherwise: Self) -> Self {
        if self <= limit { then } else { otherwise }
    }
}

/// The numbers of [`WIDTH`] cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lanes(pub [f64; WIDTH]);

impl Lanes {
    /// The first numbers of a nonempty slice, padded with its first one.
    #[inline(always)]
    pub(crate) fn load(values: &[f64]) -> Self {
        match values.first_chunk() {
            Some(lanes) => Self(*lanes),
            None => Self(std::array::from_fn(|l| *values.get(l).unwrap_or(&values[0]))),
        }
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|l| f(self.0[l], other.0[l])))
    }
}

impl Number for Lanes {
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(std::array::from_fn(|l| self.0[l].sqrt()))
    }

    #[inline(always)]
    fn at_most(self, limit: f64, then: Self, otherwise: Self) -> Self {
        Self(std::array::from_fn(|l| self.0[l].at_most(limit, then.0[l], otherwise.0[l])))
    }
}

impl From<f64> for Lanes {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Self([value; WIDTH])
    }
}

impl Add for Lanes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Div for Lanes {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_end_of_a_run_is_filled_with_its_first_number() {
        assert_eq!(Lanes::load(&[1.0, 2.0, 3.0, 4.0, 5.0]).0, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(Lanes::load(&[1.0, 2.0]).0, [1.0, 2.0, 1.0, 1.0]);
    }
}
