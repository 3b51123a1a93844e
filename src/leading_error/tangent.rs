//! The derivative of the manufactured side's stress (5.1) in the strain and in κ.

use std::f64::consts::FRAC_1_SQRT_2;

use super::cells::{Mandel, product};
use crate::manufactured::MaterialNumbers;
use crate::manufactured::constitutive::{Tensor, stress};

/// The trace as a Mandel vector.
const TRACE: Mandel = [1.0, 1.0, 0.0];

/// 2 μ τ + λ tr τ I.
pub(super) fn isotropic(lambda: f64, mu: f64, tensor: &Mandel) -> Mandel {
    let volume = lambda * product(&TRACE, tensor);
    [0, 1, 2].map(|i| 2.0 * mu * tensor[i] + volume * TRACE[i])
}

/// Dσ/Dε at a strain: 𝒜 + μ[(1 - κ/‖e‖) I_dev + κ e⊗e/‖e‖³] beyond ‖e‖ = ‖ε^D‖ = κ.
pub(super) fn by_strain(material: &MaterialNumbers, strain: &Mandel, kappa: f64) -> [Mandel; 3] {
    let unit = |i: usize| [0, 1, 2].map(|j| f64::from(u8::from(i == j)));
    let mut tangent = match &material.full {
        Some(mandel) => [0, 1, 2].map(|i| [mandel[i][0], mandel[i][1], mandel[i][2]]),
        None => [0, 1, 2].map(|i| isotropic(material.lambda, material.mu_l, &unit(i))),
    };
    let Some((mu, direction, length)) = beyond(material, strain, kappa) else { return tangent };
    for i in 0..3 {
        for j in 0..3 {
            let deviator = unit(i)[j] - 0.5 * TRACE[i] * TRACE[j];
            let along = direction[i] * direction[j];
            tangent[i][j] += mu * (deviator - kappa / length * (deviator - along));
        }
    }
    tangent
}

/// ∂σ/∂κ = -μ e/‖e‖ beyond the ball.
pub(super) fn by_kappa(material: &MaterialNumbers, strain: &Mandel, kappa: f64) -> Mandel {
    match beyond(material, strain, kappa) {
        Some((mu, direction, _)) => direction.map(|e| -mu * e),
        None => [0.0; 3],
    }
}

/// μ, e/‖e‖ and ‖e‖ where the deviator is longer than κ.
fn beyond(material: &MaterialNumbers, strain: &Mandel, kappa: f64) -> Option<(f64, Mandel, f64)> {
    let mean = 0.5 * product(&TRACE, strain);
    let deviator = [strain[0] - mean, strain[1] - mean, strain[2]];
    let length = product(&deviator, &deviator).sqrt();
    let mu = material.projection.filter(|_| length > kappa)?;
    Some((mu, deviator.map(|e| e / length), length))
}

/// σ of strain and memory integrals, one a term, by [`stress`].
pub(super) fn stress_of(
    material: &MaterialNumbers,
    strain: &Mandel,
    memory: &[Mandel],
    kappa: f64,
) -> Mandel {
    let full = |[xx, yy, xy]: Mandel| -> Tensor<2> {
        [[xx, FRAC_1_SQRT_2 * xy], [FRAC_1_SQRT_2 * xy, yy]]
    };
    let memory: Vec<Tensor<2>> = memory.iter().map(|history| full(*history)).collect();
    let [[xx, xy], [yx, yy]] = stress(material, &full(*strain), &memory, kappa);
    [xx, yy, FRAC_1_SQRT_2 * (xy + yx)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central differences of the stress itself, inside the ball and beyond it.
    #[test]
    fn derivatives_agree_with_differences_of_the_stress() {
        let material = MaterialNumbers {
            lambda: 0.7,
            mu_l: 1.3,
            full: None,
            memory: vec![(0.25, 0.4)],
            projection: Some(0.9),
        };
        let strain = [0.11, -0.06, 0.08];
        for kappa in [0.05, 0.1, 0.5] {
            let tangent = by_strain(&material, &strain, kappa);
            let at = |strain: &Mandel, kappa: f64| stress_of(&material, strain, &[], kappa);
            let slope = |up: Mandel, down: Mandel| [0, 1, 2].map(|i| (up[i] - down[i]) / 2e-6);
            for j in 0..3 {
                let moved = |d: f64| [0, 1, 2].map(|i| strain[i] + if i == j { d } else { 0.0 });
                let column = slope(at(&moved(1e-6), kappa), at(&moved(-1e-6), kappa));
                // Truncation (1e-6/0.1)², rounding 1e-16/1e-6.
                assert!((0..3).all(|i| (column[i] - tangent[i][j]).abs() < 1e-8), "{kappa} {j}");
            }
            let column = slope(at(&strain, kappa + 1e-6), at(&strain, kappa - 1e-6));
            let own = by_kappa(&material, &strain, kappa);
            assert!((0..3).all(|i| (column[i] - own[i]).abs() < 1e-8), "{kappa}");
            let memory = stress_of(&material, &[0.0; 3], &[strain], kappa);
            let own = isotropic(0.25, 0.4, &strain);
            assert!((0..3).all(|i| (memory[i] - own[i]).abs() < 1e-15));
        }
    }
}
