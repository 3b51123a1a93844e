//! σ of (5.1) from ε, the memory integrals H_i = ∫ b_i(t-s) ε ds and κ, on full D×D tensors.

use super::exact::MaterialNumbers;
use super::number::Number;

/// A full second-order tensor.
pub type Tensor<const D: usize, T = f64> = [[T; D]; D];

/// σ = 𝒜ε + μ(ε - P_κ ε) + Σ_i (2 μ_i H_i + λ_i tr H_i I) (a stress); 𝒜ε = 2μ_L ε + λ tr ε I unless 𝒜 is given in full.
/// `memory` holds one H_i per term.
#[inline(always)]
pub fn stress<const D: usize, T: Number>(
    material: &MaterialNumbers,
    strain: &Tensor<D, T>,
    memory: &[Tensor<D, T>],
    kappa: impl Into<T>,
) -> Tensor<D, T> {
    let trace_strain = trace(strain);
    let mut out = match &material.full {
        Some(mandel) => contracted(mandel, strain),
        None => isotropic(material.lambda, material.mu_l, strain, trace_strain),
    };
    for (&(lambda, mu), history) in material.memory.iter().zip(memory) {
        let part = isotropic(lambda, mu, history, trace(history));
        for i in 0..D {
            for j in 0..D {
                out[i][j] = out[i][j] + part[i][j];
            }
        }
    }
    if let Some(mu) = material.projection {
        let excess = projected_excess(strain, trace_strain, kappa.into());
        for i in 0..D {
            for j in 0..D {
                out[i][j] = out[i][j] + T::from(mu) * excess[i][j];
            }
        }
    }
    out
}

#[inline(always)]
fn trace<const D: usize, T: Number>(tensor: &Tensor<D, T>) -> T {
    let mut sum = tensor[0][0];
    for i in 1..D {
        sum = sum + tensor[i][i];
    }
    sum
}

#[inline(always)]
fn isotropic<const D: usize, T: Number>(
    lambda: f64,
    mu: f64,
    tensor: &Tensor<D, T>,
    trace: T,
) -> Tensor<D, T> {
    let mut out = *tensor;
    for (i, row) in out.iter_mut().enumerate() {
        for entry in row.iter_mut() {
            *entry = T::from(2.0 * mu) * *entry;
        }
        row[i] = row[i] + T::from(lambda) * trace;
    }
    out
}

/// 𝒜_ijkl of a matrix in Mandel notation: an index pair i ≠ j carries √2.
pub(crate) fn component(mandel: &[[f64; 6]; 6], d: usize, [i, j, k, l]: [usize; 4]) -> f64 {
    let place = |i: usize, j: usize| match (i == j, d) {
        (true, _) => (i, 1.0),
        (false, 2) => (2, std::f64::consts::FRAC_1_SQRT_2),
        // yz, xz, xy: the pair without axis m is at 3 + m.
        (false, _) => (6 - i - j, std::f64::consts::FRAC_1_SQRT_2),
    };
    let ((row, first), (column, second)) = (place(i, j), place(k, l));
    mandel[row][column] * first * second
}

/// σ_ij = Σ_kl 𝒜_ijkl ε_kl.
#[inline(always)]
fn contracted<const D: usize, T: Number>(
    mandel: &[[f64; 6]; 6],
    strain: &Tensor<D, T>,
) -> Tensor<D, T> {
    let mut out = [[T::from(0.0); D]; D];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            for (k, line) in strain.iter().enumerate() {
                for (l, entry) in line.iter().enumerate() {
                    *value = *value + T::from(component(mandel, D, [i, j, k, l])) * *entry;
                }
            }
        }
    }
    out
}

/// ε - P ε, where P ε = (tr ε/D) I + κ ε^D/‖ε^D‖ beyond the ball and ε inside.
#[inline(always)]
fn projected_excess<const D: usize, T: Number>(
    strain: &Tensor<D, T>,
    trace: T,
    kappa: T,
) -> Tensor<D, T> {
    let mut deviator = *strain;
    let mut squares = T::from(0.0);
    for i in 0..D {
        deviator[i][i] = deviator[i][i] - trace / T::from(D as f64);
        let row = &deviator[i];
        let mut of_row = row[0] * row[0];
        for entry in &row[1..] {
            of_row = of_row + *entry * *entry;
        }
        squares = squares + of_row;
    }
    let length = squares.sqrt();
    for row in &mut deviator {
        for entry in row {
            let outside = *entry - kappa * *entry / length;
            *entry = length.at_most(kappa, T::from(0.0), outside);
        }
    }
    deviator
}

/// The symmetric tensor of its upper components, row by row; `component` gives the k-th.
#[inline(always)]
pub fn full<const D: usize, T: Number>(component: impl Fn(usize) -> T) -> Tensor<D, T> {
    let mut tensor = [[T::from(0.0); D]; D];
    let mut k = 0;
    for i in 0..D {
        for j in i..D {
            tensor[i][j] = component(k);
            tensor[j][i] = tensor[i][j];
            k += 1;
        }
    }
    tensor
}

/// The N = D(D + 1)/2 numbers of a symmetric tensor in the notation of moments: the diagonal, then √2 times yz, xz, xy
/// (in the plane xy).
#[inline(always)]
pub fn mandel<const D: usize, const N: usize, T: Number>(tensor: &Tensor<D, T>) -> [T; N] {
    let mut numbers = [T::from(0.0); N];
    for i in 0..D {
        numbers[i] = tensor[i][i];
    }
    for (k, &(i, j)) in off_diagonal(D).iter().enumerate() {
        numbers[D + k] = T::from(std::f64::consts::SQRT_2) * tensor[i][j];
    }
    numbers
}

/// The index pairs off the diagonal, in the order of moments: behind the diagonal, with the factor √2.
#[inline(always)]
pub(crate) const fn off_diagonal(d: usize) -> &'static [(usize, usize)] {
    if d == 2 { &[(0, 1)] } else { &[(1, 2), (0, 2), (0, 1)] }
}

/// The symmetric tensor of its numbers in the notation of moments.
#[inline]
pub fn from_mandel<const D: usize, T: Number>(numbers: &[T]) -> Tensor<D, T> {
    let mut tensor = [[T::from(0.0); D]; D];
    (0..D).for_each(|i| tensor[i][i] = numbers[i]);
    for (&(i, j), number) in off_diagonal(D).iter().zip(&numbers[D..]) {
        tensor[i][j] = T::from(std::f64::consts::FRAC_1_SQRT_2) * *number;
        tensor[j][i] = tensor[i][j];
    }
    tensor
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{Exact, ExactData, RegionNumbers};
    use formula::{Graph, Scope, Variable};

    #[test]
    fn moments_keep_the_frobenius_product() {
        let tensor: Tensor<3> = full(|k| 1.0 + k as f64);
        assert_eq!(tensor, [[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [3.0, 5.0, 6.0]]);
        let numbers: [f64; 6] = mandel(&tensor);
        assert_eq!(numbers[..3], [1.0, 4.0, 6.0]);
        assert!((numbers[3] / numbers[5] - 2.5).abs() < 1e-15);
        let squares: f64 = tensor.as_flattened().iter().map(|s| s * s).sum();
        assert!((numbers.iter().map(|s| s * s).sum::<f64>() - squares).abs() < 1e-12);
        let back: Tensor<3> = from_mandel(&numbers);
        let pairs = back.as_flattened().iter().zip(tensor.as_flattened());
        // √2 and its inverse, rounded.
        pairs.for_each(|(a, b)| assert!((a / b - 1.0).abs() < 4e-16, "{back:?}"));
    }

    /// diag(1, 2, 6) in ℝ³: tr/3 = 3, so the deviator is diag(-2, -1, 3), of length √14. Its plane part, diag(1, 2) in
    /// ℝ², has the deviator diag(-½, ½).
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

    /// σ by formulas and by numbers, with memory, either elasticity, two materials and both sides of the yield surface;
    /// other numbers of the material show.
    #[test]
    fn formulas_and_numbers_have_one_stress() {
        let mut mandel = [[0.0; 6]; 6];
        mandel.iter_mut().enumerate().for_each(|(i, row)| row[i] = 2.0 + i as f64 / 3.0);
        let numbers = |lambda: f64, full| MaterialNumbers {
            lambda,
            mu_l: 0.7,
            full,
            memory: vec![(0.25, 0.1), (-0.3, 0.2)],
            projection: Some(0.9),
        };
        for full in [None, Some(mandel)] {
            let mut graph = Graph::new();
            let scope = Scope::new(&[Variable::X, Variable::Y, Variable::T, Variable::Zeta]);
            let mut node = |text| graph.parse(text, &scope).expect("a formula");
            let regions =
                vec![RegionNumbers { condition: node("x - 0.5"), material: numbers(2.3, None) }];
            let u = vec![node("x^2*y*(1 + t)"), node("0.4*x*t + y*sin(t*y)")];
            let kernels = vec![node("exp(-t)"), node("1/(1 + t)")];
            let kappa = Some(node("0.6 + 0.1*zeta"));
            let (material, polytope) = (numbers(1.1, full), None);
            let (horizon, size) = (1.0, vec![1.0, 1.0]);
            let exact = Exact::new(ExactData {
                graph,
                u,
                material,
                regions,
                kernels,
                kappa,
                contact: Vec::new(),
                inner: Vec::new(),
                horizon,
                size,
                polytope,
            });
            let (t, mut memory, mut beyond) = (0.8, Vec::new(), 0);
            let points: Vec<[f64; 3]> = (0..36)
                .map(|k| [0.1 + 0.15 * f64::from(k % 6), f64::from(k / 6) / 6.0, 0.0])
                .collect();
            let out = exact.interior.values(&points, t, 0.0);
            let formulas = exact.stress_at::<2>(&points, t);
            for (p, [x, ..]) in points.iter().enumerate() {
                let strain: Tensor<2> = exact.tensors(|k| out[k][p], &mut memory);
                let law = |material| stress(material, &strain, &memory, exact.kappa(t));
                let off = |sigma: Tensor<2>| {
                    let pairs = sigma.as_flattened().iter().zip(formulas[p].as_flattened());
                    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
                };
                let material = exact.material_in(usize::from(*x > 0.5));
                // Sums of some ten terms of up to ten.
                assert!(off(law(material)) < 1e-13, "{p}");
                let memory_of_another = vec![(0.25, 0.2), (-0.3, 0.2)];
                let other = MaterialNumbers { memory: memory_of_another, ..material.clone() };
                assert!(off(law(&other)) > 1e-4, "{p}");
                let excess = projected_excess(&strain, trace(&strain), exact.kappa(t));
                beyond += usize::from(excess != [[0.0; 2]; 2]);
            }
            assert!(beyond > 5 && beyond < 31, "{beyond}");
        }
    }
}
