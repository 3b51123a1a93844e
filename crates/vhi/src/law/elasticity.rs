//! Isotropic tensors 𝒜ε = 2 μ ε + λ tr(ε) I; also the spatial part of ℬ.

use algebra::tensor::{Symmetric, dimension, trace};

/// An isotropic fourth-order tensor; Lamé numbers are stresses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Isotropic {
    pub lambda: f64,
    pub mu: f64,
}

impl Isotropic {
    #[inline]
    pub(crate) fn apply<const S: usize>(&self, strain: &Symmetric<S>) -> Symmetric<S> {
        let volumetric = self.lambda * trace(strain);
        let mut stress = strain.map(|e| 2.0 * self.mu * e);
        for value in &mut stress[..dimension::<S>()] {
            *value += volumetric;
        }
        stress
    }

    /// The S×S matrix of 𝒜 in Mandel notation.
    pub fn matrix<const S: usize>(&self) -> [[f64; S]; S] {
        let mut matrix = [[0.0; S]; S];
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] = 2.0 * self.mu;
            if i < dimension::<S>() {
                for value in &mut row[..dimension::<S>()] {
                    *value += self.lambda;
                }
            }
        }
        matrix
    }

    /// Smallest and largest eigenvalue on S^d: 2μ on deviators, 2μ + dλ on spheres.
    pub(crate) fn eigenvalues(&self, d: usize) -> (f64, f64) {
        let (deviators, spheres) = (2.0 * self.mu, 2.0 * self.mu + d as f64 * self.lambda);
        (deviators.min(spheres), deviators.max(spheres))
    }

    /// Σ |E_ijkl| over all d⁴ entries E_ijkl = λ δ_ij δ_kl + μ(δ_ik δ_jl + δ_il δ_jk).
    pub(crate) fn entry_sum(&self, d: usize) -> f64 {
        let (d, pairs) = (d as f64, (d * (d - 1)) as f64);
        let normal = (self.lambda + 2.0 * self.mu).abs();
        d * normal + pairs * (self.lambda.abs() + 2.0 * self.mu.abs())
    }

    /// β with `self` = β·`other` up to rounding, if there is one.
    pub(crate) fn multiple_of(&self, other: &Isotropic) -> Option<f64> {
        let beta = self.mu / other.mu;
        let matches = (self.lambda - beta * other.lambda).abs()
            <= 4.0 * f64::EPSILON * self.lambda.abs().max((beta * other.lambda).abs());
        (beta.is_finite() && matches).then_some(beta)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apply_and_matrix_agree_in_both_dimensions() {
        let law = Isotropic { lambda: 1.3, mu: 0.7 };
        let strain = [0.1, -0.4, 0.25, 0.3, 0.2, -0.1];
        let matrix = law.matrix::<6>();
        let stress = law.apply(&strain);
        for i in 0..6 {
            let row: f64 = (0..6).map(|j| matrix[i][j] * strain[j]).sum();
            assert!((row - stress[i]).abs() < 1e-15);
        }
        let plane = law.apply(&[1.0, 0.0, 0.0]);
        assert!((plane[0] - 2.7).abs() < 1e-15 && (plane[1] - 1.3).abs() < 1e-15);
    }

    #[test]
    fn the_sum_over_entries_is_the_sum_over_entries() {
        let law = Isotropic { lambda: -0.3, mu: 0.7 };
        for d in [2, 3] {
            let delta = |i: usize, j: usize| f64::from(u8::from(i == j));
            let mut sum = 0.0;
            for m in 0..d * d * d * d {
                let (i, j, k, l) = (m % d, m / d % d, m / d / d % d, m / d / d / d);
                let shear = delta(i, k) * delta(j, l) + delta(i, l) * delta(j, k);
                sum += (law.lambda * delta(i, j) * delta(k, l) + law.mu * shear).abs();
            }
            assert!((law.entry_sum(d) - sum).abs() < 1e-14);
        }
    }

    #[test]
    fn multiples_are_recognised() {
        let one = Isotropic { lambda: 1.0, mu: 1.0 };
        assert_eq!(Isotropic { lambda: 0.25, mu: 0.25 }.multiple_of(&one), Some(0.25));
        assert_eq!(Isotropic { lambda: 0.25, mu: 0.3 }.multiple_of(&one), None);
    }

    /// By hand: 2μ on deviators, 2μ + dλ on spheres, whichever is larger.
    #[test]
    fn eigenvalues_of_both_signs_of_lambda() {
        let close = |(a, b): (f64, f64), (c, d): (f64, f64)| {
            assert!((a - c).abs() < 1e-15 && (b - d).abs() < 1e-15, "{a} {b}");
        };
        let stiff = Isotropic { lambda: 1.3, mu: 0.7 };
        close(stiff.eigenvalues(2), (1.4, 4.0));
        close(stiff.eigenvalues(3), (1.4, 5.3));
        close(Isotropic { lambda: -0.3, mu: 0.7 }.eigenvalues(2), (0.8, 1.4));
    }

    /// μ ≠ 1, so that products and quotients differ; the last digit is within tolerance, 1e-13 is not.
    #[test]
    fn a_multiple_is_one_to_rounding() {
        let other = Isotropic { lambda: 1e-3, mu: 0.4 };
        let near = |share: f64| Isotropic { lambda: 0.05 * (1.0 + share), mu: 20.0 };
        let beta = near(f64::EPSILON).multiple_of(&other).expect("a multiple");
        assert!((beta - 50.0).abs() < 1e-13, "{beta}");
        assert_eq!(near(1e-13).multiple_of(&other), None);
        assert_eq!(near(-1e-13).multiple_of(&other), None);
        let shear = |mu: f64| Isotropic { lambda: 0.0, mu };
        assert_eq!(shear(3.0).multiple_of(&shear(1.5)), Some(2.0));
        // β = ∞ would match any λ.
        assert_eq!(other.multiple_of(&Isotropic { lambda: 1.0, mu: 0.0 }), None);
    }
}
