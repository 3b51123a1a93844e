//! Kernels of the history operator (2.11): general q(t, s), and b(t - s) as in ℬ(t)ε = b(t)·ℬ₀ε.

use super::gauss::GAUSS;

/// A scalar kernel q(t, s) of the history operator (2.11), 0 ≤ s ≤ t (1/time).
pub trait HistoryKernel {
    fn at(&self, t: f64, s: f64) -> f64;

    /// q(t, s_j) for several s_j.
    fn row(&self, t: f64, s: &[f64]) -> Vec<f64> {
        s.iter().map(|&s| self.at(t, s)).collect()
    }

    /// The a of q(t, s) = (t - s)^{-a} b(t, s), 0 ≤ a < 1, with b finite at s = t.
    fn power(&self) -> f64 {
        0.0
    }

    /// b(t, s); required for a > 0.
    fn factor(&self, t: f64, s: f64) -> f64 {
        self.at(t, s)
    }
}

/// q(t, s) = b(t - s).
pub struct Convolution<'a>(pub &'a dyn MemoryKernel);

impl HistoryKernel for Convolution<'_> {
    fn at(&self, t: f64, s: f64) -> f64 {
        self.0.value(t - s)
    }

    fn power(&self) -> f64 {
        self.0.power()
    }

    fn factor(&self, t: f64, s: f64) -> f64 {
        self.0.factor(t - s)
    }
}

/// A scalar kernel of the memory term ∫_0^t b(t - s) ℬ₀ ε(u(s)) ds.
pub trait MemoryKernel: Send + Sync {
    /// b at a lag t - s ≥ 0 (1/time).
    fn value(&self, lag: f64) -> f64;

    /// The a of b(t) = t^{-a} c(t), 0 ≤ a < 1, with c finite at t = 0.
    fn power(&self) -> f64 {
        0.0
    }

    fn factor(&self, lag: f64) -> f64 {
        self.value(lag)
    }

    /// (a_i, c_i) with b(t) = Σ a_i exp(-c_i t), if the kernel has this form.
    fn exponentials(&self) -> Option<&[(f64, f64)]> {
        None
    }

    /// The q and r of b(t) = ∫_0^t q(t - s) r(s) ds, the kernel of a history of a history, which is summed by the repeated
    /// rule.
    fn nested(&self) -> Option<[&dyn MemoryKernel; 2]> {
        None
    }

    /// Error, relative to its largest value, to which sums over the past may interpolate a kernel that is not a sum of
    /// exponentials; None for direct sums.
    fn interpolated_to(&self) -> Option<f64> {
        Some(INTERPOLATED_TO)
    }
}

/// Far below the floors of solvers, 1e-12 and more.
pub const INTERPOLATED_TO: f64 = 1e-13;

/// A kernel with its exponentials hidden: sums over the past are direct, or interpolated to another error.
pub struct Summed {
    pub kernel: Box<dyn MemoryKernel>,
    /// See [`MemoryKernel::interpolated_to`].
    pub interpolated_to: Option<f64>,
}

impl dyn MemoryKernel + '_ {
    /// Of a history of a history the product of what `of` says of its two kernels; of another kernel what it says.
    pub fn product(&self, of: impl Fn(&dyn MemoryKernel) -> f64) -> f64 {
        match self.nested() {
            None => of(self),
            Some(kernels) => kernels.map(of).iter().product(),
        }
    }
}

impl MemoryKernel for Summed {
    fn value(&self, lag: f64) -> f64 {
        self.kernel.value(lag)
    }

    fn interpolated_to(&self) -> Option<f64> {
        self.interpolated_to
    }
}

/// The kernel of ∫_0^t q(t - s) v(s) ds, v(s) = ∫_0^s r(s - τ) u(τ) dτ.
pub struct Nested {
    /// q.
    pub outer: Box<dyn MemoryKernel>,
    /// r.
    pub inner: Box<dyn MemoryKernel>,
}

impl MemoryKernel for Nested {
    /// By Gauss's rule, to rounding for kernels that vary on the scale of the lag.
    fn value(&self, lag: f64) -> f64 {
        let of_node = |&(x, weight): &(f64, f64)| {
            weight * lag * self.outer.value(lag * (1.0 - x)) * self.inner.value(lag * x)
        };
        GAUSS.iter().map(of_node).sum()
    }

    fn interpolated_to(&self) -> Option<f64> {
        None
    }

    fn nested(&self) -> Option<[&dyn MemoryKernel; 2]> {
        Some([&*self.outer, &*self.inner])
    }
}

/// b(t) = t^{-a} c(t), infinite at t = 0 if c(0) ≠ 0.
pub struct Singular {
    /// 0 < a < 1.
    pub power: f64,
    pub factor: Box<dyn MemoryKernel>,
}

impl MemoryKernel for Singular {
    fn value(&self, lag: f64) -> f64 {
        lag.powf(-self.power) * self.factor.value(lag)
    }

    fn power(&self) -> f64 {
        self.power
    }

    fn factor(&self, lag: f64) -> f64 {
        self.factor.value(lag)
    }
}

/// b(t) = Σ a_i exp(-c_i t): Maxwell elements, also called a Prony series.
#[derive(Debug, Clone, PartialEq)]
pub struct ExponentialSum {
    pub terms: Vec<(f64, f64)>,
}

impl MemoryKernel for ExponentialSum {
    fn value(&self, lag: f64) -> f64 {
        self.terms.iter().map(|(a, c)| a * (-c * lag).exp()).sum()
    }

    fn exponentials(&self) -> Option<&[(f64, f64)]> {
        Some(&self.terms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Root;
    impl MemoryKernel for Root {
        fn value(&self, lag: f64) -> f64 {
            lag.sqrt()
        }
    }

    #[test]
    fn a_convolution_takes_the_lag() {
        let kernel = Convolution(&Root);
        assert_eq!(kernel.at(5.0, 1.0), 2.0);
        assert_eq!(kernel.row(5.0, &[1.0, 4.0, 5.0]), [2.0, 1.0, 0.0]);
    }

    #[test]
    fn a_singular_kernel_is_its_power_times_its_factor() {
        let kernel =
            Singular { power: 0.5, factor: Box::new(ExponentialSum { terms: vec![(3.0, 0.0)] }) };
        let convolution = Convolution(&kernel);
        assert_eq!((kernel.value(4.0), convolution.at(5.0, 1.0)), (1.5, 1.5));
        assert_eq!(
            (convolution.power(), convolution.factor(5.0, 5.0), convolution.at(5.0, 5.0)),
            (0.5, 3.0, f64::INFINITY)
        );
        assert_eq!(kernel.exponentials(), None);
        let plain = Convolution(&Root);
        assert_eq!((plain.power(), plain.factor(5.0, 1.0)), (0.0, 2.0));
    }

    #[test]
    fn only_sums_of_exponentials_have_exponentials() {
        assert_eq!(Root.exponentials(), None);
        let sum = ExponentialSum { terms: vec![(-2.0, 1.0), (0.5, 0.0)] };
        assert_eq!(sum.exponentials(), Some(&[(-2.0, 1.0), (0.5, 0.0)][..]));
        assert!((sum.value(2f64.ln()) - (-0.5)).abs() < 1e-15);
    }
}
