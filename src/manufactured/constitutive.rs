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

/// The symmetric tensor whose upper components, row by row, are the first fields of `values` at point p.
#[inline]
pub fn full<const D: usize>(values: &[Vec<f64>], p: usize) -> Tensor<D> {
    let mut tensor = [[0.0; D]; D];
    let mut fields = values.iter();
    for i in 0..D {
        for j in i..D {
            // A missing field would be a wrong number of outputs: NaN shows it in every norm.
            tensor[i][j] = fields.next().map_or(f64::NAN, |field| field[p]);
            tensor[j][i] = tensor[i][j];
        }
    }
    tensor
}

/// Appends a symmetric tensor in the notation of moments: the diagonal, then √2 times yz, xz, xy (in the
/// plane xy).
#[inline]
pub fn mandel<const D: usize>(tensor: &Tensor<D>, out: &mut Vec<f64>) {
    out.extend((0..D).map(|i| tensor[i][i]));
    let off: &[(usize, usize)] = if D == 2 { &[(0, 1)] } else { &[(1, 2), (0, 2), (0, 1)] };
    out.extend(off.iter().map(|&(i, j)| std::f64::consts::SQRT_2 * tensor[i][j]));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_keep_the_frobenius_product() {
        let list = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|value| vec![0.0, value]);
        let tensor: Tensor<3> = full(&list, 1);
        assert_eq!(tensor, [[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [3.0, 5.0, 6.0]]);
        let mut numbers = Vec::new();
        mandel(&tensor, &mut numbers);
        assert_eq!(numbers[..3], [1.0, 4.0, 6.0]);
        assert!((numbers[3] / numbers[5] - 2.5).abs() < 1e-15 && numbers.len() == 6);
        let squares: f64 = tensor.as_flattened().iter().map(|s| s * s).sum();
        assert!((numbers.iter().map(|s| s * s).sum::<f64>() - squares).abs() < 1e-12);
        // One shear component dropped is a wrong number of fields.
        assert!(full::<3>(&list[..5], 1)[2][2].is_nan());
    }

    /// diag(1, 2, 6) in ℝ³: tr/3 = 3, so the deviator is diag(-2, -1, 3), of length √14. Its plane part alone,
    /// diag(1, 2) in ℝ², has the deviator diag(-½, ½).
    #[test]
    fn the_projection_takes_the_trace_of_its_dimension() {
        let material =
            MaterialNumbers { lambda: 0.0, mu_l: 0.0, memory: None, projection: Some(1.0) };
        let strain = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 6.0]];
        let sigma = stress(&material, &strain, &[[0.0; 3]; 3], 0.5 * 14f64.sqrt());
        assert!((0..3).all(|i| (sigma[i][i] - [-1.0, -0.5, 1.5][i]).abs() < 1e-15), "{sigma:?}");
        let plane =
            stress(&material, &[[1.0, 0.0], [0.0, 2.0]], &[[0.0; 2]; 2], 0.5 * 0.5f64.sqrt());
        assert!((plane[0][0] + 0.25).abs() < 1e-15 && (plane[1][1] - 0.25).abs() < 1e-15);
    }
}
