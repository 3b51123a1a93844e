//! σ of (5.1) from ε, the memory integrals H_i = ∫ b_i(t-s) ε ds and κ, on full D×D tensors.

use super::exact::MaterialNumbers;

/// A full second-order tensor.
pub type Tensor<const D: usize> = [[f64; D]; D];

/// σ = 𝒜ε + μ(ε - P_κ ε) + Σ_i (2 μ_i H_i + λ_i tr H_i I) (a stress); 𝒜ε = 2μ_L ε + λ tr ε I unless 𝒜 is
/// given in full. `memory` holds one H_i a term.
pub fn stress<const D: usize>(
    material: &MaterialNumbers,
    strain: &Tensor<D>,
    memory: &[Tensor<D>],
    kappa: f64,
) -> Tensor<D> {
    let trace = |tensor: &Tensor<D>| (0..D).map(|i| tensor[i][i]).sum::<f64>();
    let trace_strain = trace(strain);
    let mut out = match &material.full {
        Some(mandel) => contracted(mandel, strain),
        None => isotropic(material.lambda, material.mu_l, strain, trace_strain),
    };
    for (&(lambda, mu), history) in material.memory.iter().zip(memory) {
        let part = isotropic(lambda, mu, history, trace(history));
        for i in 0..D {
            for j in 0..D {
                out[i][j] += part[i][j];
            }
        }
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

/// 2 μ τ + λ tr τ I.
fn isotropic<const D: usize>(lambda: f64, mu: f64, tensor: &Tensor<D>, trace: f64) -> Tensor<D> {
    let mut out = tensor.map(|row| row.map(|entry| 2.0 * mu * entry));
    for (i, row) in out.iter_mut().enumerate() {
        row[i] += lambda * trace;
    }
    out
}

/// 𝒜_ijkl of a matrix in Mandel notation: an index pair i ≠ j carries √2.
pub fn component(mandel: &[[f64; 6]; 6], d: usize, [i, j, k, l]: [usize; 4]) -> f64 {
    let place = |i: usize, j: usize| match (i == j, d) {
        (true, _) => (i, 1.0),
        (false, 2) => (2, std::f64::consts::FRAC_1_SQRT_2),
        // yz, xz, xy: the pair without axis m stands at 3 + m.
        (false, _) => (6 - i - j, std::f64::consts::FRAC_1_SQRT_2),
    };
    let ((row, first), (column, second)) = (place(i, j), place(k, l));
    mandel[row][column] * first * second
}

/// σ_ij = Σ_kl 𝒜_ijkl ε_kl.
fn contracted<const D: usize>(mandel: &[[f64; 6]; 6], strain: &Tensor<D>) -> Tensor<D> {
    let mut out = [[0.0; D]; D];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            for (k, line) in strain.iter().enumerate() {
                for (l, entry) in line.iter().enumerate() {
                    *value += component(mandel, D, [i, j, k, l]) * entry;
                }
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
        let material = MaterialNumbers {
            lambda: 0.0,
            mu_l: 0.0,
            full: None,
            memory: vec![],
            projection: Some(1.0),
        };
        let strain = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 6.0]];
        let sigma = stress(&material, &strain, &[], 0.5 * 14f64.sqrt());
        assert!((0..3).all(|i| (sigma[i][i] - [-1.0, -0.5, 1.5][i]).abs() < 1e-15), "{sigma:?}");
        let plane = stress(&material, &[[1.0, 0.0], [0.0, 2.0]], &[], 0.5 * 0.5f64.sqrt());
        assert!((plane[0][0] + 0.25).abs() < 1e-15 && (plane[1][1] - 0.25).abs() < 1e-15);
    }
}
