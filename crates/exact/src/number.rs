//! Numbers that a law takes.

use std::ops::{Add, Div, Mul, Sub};

use num_dual::{Dual64, DualNum};

/// A real number, or one with its derivative.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + From<f64>
{
    fn sqrt(self) -> Self;

    /// `then` if at most `limit`, else `otherwise`.
    fn at_most(self, limit: Self, then: Self, otherwise: Self) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn at_most(self, limit: Self, then: Self, otherwise: Self) -> Self {
        if self <= limit { then } else { otherwise }
    }
}

impl Number for Dual64 {
    fn sqrt(self) -> Self {
        DualNum::sqrt(&self)
    }

    fn at_most(self, limit: Self, then: Self, otherwise: Self) -> Self {
        if self.re <= limit.re { then } else { otherwise }
    }
}
