//! Symmetric fourth-order tensors, constant on each region of the body: 𝒜, and the ℬ_i of ℬ(t) = Σ b_i(t) ℬ_i.

use nalgebra::DMatrix;

use super::Isotropic;
use algebra::tensor::Symmetric;

/// A symmetric fourth-order tensor on S^d (a stress).
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a body has few, and copies need no memory")]
pub enum FourthOrder {
    Isotropic(Isotropic),
    /// By its symmetric S×S matrix in Mandel notation, the leading block of this one.
    Full([[f64; 6]; 6]),
}

impl FourthOrder {
    /// 𝒜ε.
    #[inline]
    pub fn apply<const S: usize>(&self, strain: &Symmetric<S>) -> Symmetric<S> {
        match self {
            Self::Isotropic(law) => law.apply(strain),
            Self::Full(matrix) => std::array::from_fn(|i| {
                matrix[i].iter().zip(strain).map(|(entry, e)| entry * e).sum()
            }),
        }
    }

    /// The S×S matrix in Mandel notation.
    pub fn matrix<const S: usize>(&self) -> [[f64; S]; S] {
        match self {
            Self::Isotropic(law) => law.matrix(),
            Self::Full(matrix) => std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j])),
        }
    }

    /// The S×S matrix as the leading block of a 6×6 one, S = d(d+1)/2.
    fn block(&self, d: usize) -> [[f64; 6]; 6] {
        let mut block = [[0.0; 6]; 6];
        match (self, d) {
            (Self::Full(matrix), _) => block = *matrix,
            (Self::Isotropic(law), 2) => {
                for (row, values) in block.iter_mut().zip(law.matrix::<3>()) {
                    row[..3].copy_from_slice(&values);
                }
            }
            (Self::Isotropic(law), _) => block = law.matrix::<6>(),
        }
        block
    }

    /// Smallest and largest eigenvalue on S^d.
    pub fn eigenvalues(&self, d: usize) -> (f64, f64) {
        let matrix = match self {
            Self::Isotropic(law) => return law.eigenvalues(d),
            Self::Full(matrix) => matrix,
        };
        let order = d * (d + 1) / 2;
        let dense = DMatrix::from_fn(order, order, |i, j| matrix[i][j]);
        // NaN in the matrix leaves (∞, -∞), which no check accepts.
        let values = dense.symmetric_eigenvalues();
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| {
            (low.min(value), high.max(value))
        })
    }

    /// Σ |E_ijkl| over all d⁴ entries: a Mandel entry stands for 1, 2 or 4 of them, divided by 1, √2, 2.
    pub(crate) fn entry_sum(&self, d: usize) -> f64 {
        let matrix = match self {
            Self::Isotropic(law) => return law.entry_sum(d),
            Self::Full(matrix) => matrix,
        };
        let weight = |i: usize| if i < d { 1.0 } else { std::f64::consts::SQRT_2 };
        let order = d * (d + 1) / 2;
        let entry = |m: usize| {
            let (i, j) = (m / order, m % order);
            weight(i) * weight(j) * matrix[i][j].abs()
        };
        (0..order * order).map(entry).sum()
    }

    fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Isotropic(law) => {
                let (lambda, mu) = (factor * law.lambda, factor * law.mu);
                Self::Isotropic(Isotropic { lambda, mu })
            }
            Self::Full(matrix) => Self::Full(matrix.map(|row| row.map(|entry| factor * entry))),
        }
    }

    /// self + scale·other on S^d.
    pub fn plus(&self, scale: f64, other: &Self, d: usize) -> Self {
        if let (Self::Isotropic(a), Self::Isotropic(b)) = (self, other) {
            let (lambda, mu) = (a.lambda + scale * b.lambda, a.mu + scale * b.mu);
            return Self::Isotropic(Isotropic { lambda, mu });
        }
        let mut sum = Self::Full(self.block(d));
        sum.add(scale, other, d);
        sum
    }

    /// `self` ← self + scale·other on S^d; one that is full stays so.
    fn add(&mut self, scale: f64, other: &Self, d: usize) {
        let Self::Full(matrix) = self else {
            *self = self.plus(scale, other, d);
            return;
        };
        for (row, other_row) in matrix.iter_mut().zip(other.block(d)) {
            row.iter_mut().zip(other_row).for_each(|(value, entry)| *value += scale * entry);
        }
    }

    /// β with `self` = β·`other` up to rounding, both isotropic, if there is one.
    fn multiple_of(&self, other: &Self) -> Option<f64> {
        match (self, other) {
            (Self::Isotropic(a), Self::Isotropic(b)) => a.multiple_of(b),
            _ => None,
        }
    }
}

impl From<Isotropic> for FourthOrder {
    fn from(law: Isotropic) -> Self {
        Self::Isotropic(law)
    }
}

/// A tensor per region; region 0 is the rest of the body.
#[derive(Debug, PartialEq)]
pub struct TensorField {
    /// One entry for a homogeneous body.
    regions: Vec<FourthOrder>,
}

impl Clone for TensorField {
    fn clone(&self) -> Self {
        Self { regions: self.regions.clone() }
    }

    /// Reuses memory: a non-uniform grid has another tensor at every level.
    fn clone_from(&mut self, other: &Self) {
        self.regions.clone_from(&other.regions);
    }
}

impl<T: Into<FourthOrder>> From<T> for TensorField {
    fn from(tensor: T) -> Self {
        Self { regions: vec![tensor.into()] }
    }
}

impl TensorField {
    /// `base` on region 0, `others` on the following ones.
    pub fn new(base: FourthOrder, others: impl IntoIterator<Item = FourthOrder>) -> Self {
        Self { regions: std::iter::once(base).chain(others).collect() }
    }

    /// The identity of S^d, whose stiffness matrix has the energy ‖ε(v)‖².
    pub fn identity() -> Self {
        // 2 μ ε with μ = ½.
        Isotropic { lambda: 0.0, mu: 0.5 }.into()
    }

    /// True if it is the same on all regions.
    pub fn is_uniform(&self) -> bool {
        self.regions.len() == 1
    }

    /// The tensor on a region.
    #[inline]
    pub fn on(&self, region: usize) -> &FourthOrder {
        match &self.regions[..] {
            [everywhere] => everywhere,
            regions => &regions[region],
        }
    }

    /// The tensors, region 0 first; one where the body is homogeneous.
    pub fn regions(&self) -> &[FourthOrder] {
        &self.regions
    }

    /// Smallest and largest eigenvalue on S^d over all regions.
    pub fn eigenvalues(&self, d: usize) -> (f64, f64) {
        let each = self.regions.iter().map(|tensor| tensor.eigenvalues(d));
        each.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (a, b)| {
            (low.min(a), high.max(b))
        })
    }

    /// The largest operator norm on S^d over all regions.
    pub fn norm(&self, d: usize) -> f64 {
        let (low, high) = self.eigenvalues(d);
        low.abs().max(high.abs())
    }

    /// The largest Σ |E_ijkl| over all regions.
    pub fn entry_sum(&self, d: usize) -> f64 {
        self.regions.iter().map(|tensor| tensor.entry_sum(d)).fold(0.0, f64::max)
    }

    /// factor·self.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { regions: self.regions.iter().map(|tensor| tensor.scaled(factor)).collect() }
    }

    /// `self` ← self + scale·other on S^d, without allocation if `self` has the form of `other`.
    pub fn add(&mut self, scale: f64, other: &Self, d: usize) {
        if self.regions.len() < other.regions.len() {
            *self = self.plus(scale, other, d);
            return;
        }
        for (region, tensor) in self.regions.iter_mut().enumerate() {
            tensor.add(scale, other.on(region), d);
        }
    }

    /// self + scale·other on S^d, region by region.
    pub fn plus(&self, scale: f64, other: &Self, d: usize) -> Self {
        let count = self.regions.len().max(other.regions.len());
        let sum = |region| self.on(region).plus(scale, other.on(region), d);
        Self { regions: (0..count).map(sum).collect() }
    }

    /// β with `self` = β·`other` on every region up to rounding, if there is one.
    pub fn multiple_of(&self, other: &Self) -> Option<f64> {
        let count = self.regions.len().max(other.regions.len());
        let beta = self.on(0).multiple_of(other.on(0))?;
        // Other regions may round β differently in the last digit.
        let same = |region| {
            let of_region = self.on(region).multiple_of(other.on(region));
            of_region.is_some_and(|of_region| {
                (of_region - beta).abs() <= 4.0 * f64::EPSILON * beta.abs()
            })
        };
        (1..count).all(same).then_some(beta)
    }

    /// This field with `change` applied to every isotropic tensor.
    pub fn map(&self, change: impl Fn(Isotropic) -> Isotropic) -> Self {
        let each = self.regions.iter().map(|tensor| match tensor {
            FourthOrder::Isotropic(law) => FourthOrder::Isotropic(change(*law)),
            full => *full,
        });
        Self { regions: each.collect() }
    }
}

#[cfg(test)]
mod tests;
