//! σ of (5.1) from ε, the memory integral H = ∫ b(t-s) ε ds and κ, on full D×D tensors.

use super::exact::MaterialNumbers;

/// A full second-order tensor.
pub type Tensor<const D: usize> = [[f64; D]; D];

/// σ = 2μ_L ε + λ tr ε I + μ(ε - P_κ ε) + 2 μ_ℬ H + λ_ℬ tr H I (a stress).
pub fn stress<const D: usize>(
    material: &MaterialNumbers,
    strain: &Tensor<D>,
    memory: &Tensor<D>,
    kappa: f64,
) -> Tensor<D> {
    let trace = |tensor: &Tensor<D>| (0..D).map(|i| tensor[i][i]).sum::<f64>();
    let (trace_strain, trace_memory) = (trace(strain), trace(memory));
    let mut out = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..D {
            out[i][j] = 2.0 * material.mu_l * strain[i][j];
            if let Some((lambda, mu)) = material.memory {
                out[i][j] += 2.0 * mu * memory[i][j];
                if i == j {
                    out[i][i] += lambda * trace_memory;
                }
            }
        }
        out[i][i] += material.lambda * trace_strain;
    }
    if let Some(mu) = material.projection {
        let excess = projected_excess(strain, trace_strain, kappa);
        for i in 0..D {
            for j in 0..D {
                out[i][j] += mu * excess[i][j];
            }
        }
    }
    out
}

/// ε - P ε, where P ε = (tr ε/D) I + κ ε^D/‖ε^D‖ beyond the ball and ε inside.
fn projected_excess<const D: usize>(strain: &Tensor<D>, trace: f64, kappa: f64) -> Tensor<D> {
    let mut deviator = *strain;
    let mut squares = 0.0;
    for i in 0..D {
        deviator[i][i] -= trace / D as f64;
        squares += deviator[i].iter().map(|e| e * e).sum::<f64>();
    }
    let length = squares.sqrt();
    if length <= kappa {
        return [[0.0; D]; D];
    }
    deviator.map(|row| row.map(|e| e - kappa * e / length))
}
