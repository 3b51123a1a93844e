//! The derivative of the manufactured side's stress (5.1) in the strain and in κ.

use super::cells::{Mandel, dimension, product};
use exact::MaterialNumbers;
use exact::constitutive::{Tensor, from_mandel, mandel, stress};

fn trace<const S: usize>() -> Mandel<S> {
    std::array::from_fn(|i| f64::from(u8::from(i < dimension(S))))
}

/// The i-th of the orthonormal tensors.
pub(super) fn unit<const S: usize>(i: usize) -> Mandel<S> {
    std::array::from_fn(|j| f64::from(u8::from(i == j)))
}

pub(super) fn isotropic<const S: usize>(lambda: f64, mu: f64, tensor: &Mandel<S>) -> Mandel<S> {
    let trace = trace::<S>();
    let volume = lambda * product(&trace, tensor);
    std::array::from_fn(|i| 2.0 * mu * tensor[i] + volume * trace[i])
}

/// Dσ/Dε at a strain: 𝒜 + μ[(1 - κ/‖e‖) I_dev + κ e⊗e/‖e‖³] beyond ‖e‖ = ‖ε^D‖ = κ.
pub(super) fn by_strain<const S: usize>(
    material: &MaterialNumbers,
    strain: &Mandel<S>,
    kappa: f64,
) -> [Mandel<S>; S] {
    let mut tangent: [Mandel<S>; S] = match &material.full {
        Some(mandel) => std::array::from_fn(|i| std::array::from_fn(|j| mandel[i][j])),
        None => std::array::from_fn(|i| isotropic(material.lambda, material.mu_l, &unit(i))),
    };
    let Some((mu, direction, length)) = beyond(material, strain, kappa) else { return tangent };
    let (trace, share) = (trace::<S>(), 1.0 / dimension(S) as f64);
    for i in 0..S {
        for j in 0..S {
            let deviator = unit::<S>(i)[j] - share * trace[i] * trace[j];
            let along = direction[i] * direction[j];
            tangent[i][j] += mu * (deviator - kappa / length * (deviator - along));
        }
    }
    tangent
}

/// ∂σ/∂κ = -μ e/‖e‖ beyond the ball.
pub(super) fn by_kappa<const S: usize>(
    material: &MaterialNumbers,
    strain: &Mandel<S>,
    kappa: f64,
) -> Mandel<S> {
    match beyond(material, strain, kappa) {
        Some((mu, direction, _)) => direction.map(|e| -mu * e),
        None => [0.0; S],
    }
}

/// μ, e/‖e‖ and ‖e‖ where the deviator is longer than κ.
fn beyond<const S: usize>(
    material: &MaterialNumbers,
    strain: &Mandel<S>,
    kappa: f64,
) -> Option<(f64, Mandel<S>, f64)> {
    let trace = trace::<S>();
    let mean = product(&trace, strain) / dimension(S) as f64;
    let deviator: Mandel<S> = std::array::from_fn(|i| strain[i] - mean * trace[i]);
    let length = product(&deviator, &deviator).sqrt();
    let mu = material.projection.filter(|_| length > kappa)?;
    Some((mu, deviator.map(|e| e / length), length))
}

/// σ of strain and memory integrals, one per term, by [`stress`].
pub(super) fn stress_of<const S: usize>(
    material: &MaterialNumbers,
    strain: &Mandel<S>,
    memory: &[Mandel<S>],
    kappa: f64,
) -> Mandel<S> {
    match S {
        3 => stress_in::<2, S>(material, strain, memory, kappa),
        _ => stress_in::<3, S>(material, strain, memory, kappa),
    }
}

fn stress_in<const D: usize, const S: usize>(
    material: &MaterialNumbers,
    strain: &Mandel<S>,
    memory: &[Mandel<S>],
    kappa: f64,
) -> Mandel<S> {
    let memory: Vec<Tensor<D>> = memory.iter().map(|tensor| from_mandel(tensor)).collect();
    mandel(&stress(material, &from_mandel(strain), &memory, kappa))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central differences of the stress itself, inside the ball and beyond it.
    fn against_differences<const S: usize>(strain: Mandel<S>) {
        let material = MaterialNumbers {
            lambda: 0.7,
            mu_l: 1.3,
            full: None,
            memory: vec![(0.25, 0.4)],
            projection: Some(0.9),
        };
        let size = |difference: Mandel<S>| difference.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        for kappa in [0.05, 0.1, 0.5] {
            let tangent = by_strain(&material, &strain, kappa);
            let at = |strain: &Mandel<S>, kappa: f64| stress_of(&material, strain, &[], kappa);
            let slope = |up: Mandel<S>, down: Mandel<S>| -> Mandel<S> {
                std::array::from_fn(|i| (up[i] - down[i]) / 2e-6)
            };
            for j in 0..S {
                let moved = |d: f64| -> Mandel<S> {
                    std::array::from_fn(|i| strain[i] + if i == j { d } else { 0.0 })
                };
                let column = slope(at(&moved(1e-6), kappa), at(&moved(-1e-6), kappa));
                // Truncation (1e-6/0.1)², rounding 1e-16/1e-6.
                assert!(size(std::array::from_fn(|i| column[i] - tangent[i][j])) < 1e-8, "{kappa}");
            }
            let column = slope(at(&strain, kappa + 1e-6), at(&strain, kappa - 1e-6));
            let by_limit = by_kappa(&material, &strain, kappa);
            assert!(size(std::array::from_fn(|i| column[i] - by_limit[i])) < 1e-8, "{kappa}");
            let memory = stress_of(&material, &[0.0; S], &[strain], kappa);
            let elastic = isotropic(0.25, 0.4, &strain);
            assert!(size(std::array::from_fn(|i| memory[i] - elastic[i])) < 1e-15);
        }
    }

    #[test]
    fn derivatives_agree_with_differences_of_the_stress() {
        against_differences([0.11, -0.06, 0.08]);
        against_differences([0.11, -0.06, 0.03, 0.08, -0.05, 0.04]);
    }
}
