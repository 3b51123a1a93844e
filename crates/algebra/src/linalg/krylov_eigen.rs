//! Extreme eigenvalues of matrix-free linear maps in a given inner product.
//!
//! Lanczos for self-adjoint maps, Arnoldi for others. The basis is orthogonalised twice against all of itself, so no
//! spurious copies of an eigenvalue appear.

use faer::Mat;
use nalgebra::{DMatrix, SymmetricEigen};

use super::{FactorError, axpy, dot};

/// A linear map T on ℝ^m with the inner product (x, y) = x·Gy.
pub trait LinearMap {
    /// `out` ← T x.
    ///
    /// # Errors
    /// A linear solve within T fails.
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError>;

    /// `out` ← G x.
    fn gram(&mut self, x: &[f64], out: &mut [f64]);
}

/// An eigenvalue with what is known of its accuracy.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Extreme {
    pub value: f64,
    /// An eigenvector of length 1 in the inner product.
    pub vector: Vec<f64>,
    pub iterations: u32,
    /// ‖T x - θ x‖.
    pub residual: f64,
}

/// Why an eigenvalue was not found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EigenError {
    #[error(transparent)]
    Factor(#[from] FactorError),
    #[error("the eigenvalues of a projected matrix of order {order} did not converge")]
    NotConverged { order: usize },
    #[error(
        "an eigenvalue did not settle: {value} after {iterations} applications, still changing by {change:e}"
    )]
    NotSettled { value: f64, iterations: u32, change: f64 },
}

/// Vectors after which an iteration is given up.
const LIMIT: usize = 600;
/// Relative change at which a value is accepted: rounding in T and G is some 1e-14.
const SETTLED: f64 = 1e-13;
/// Relative bound of ‖Tx - θx‖; the error of θ is of the order of its square.
const RESIDUAL: f64 = 1e-6;
/// Accuracy for maps that are not self-adjoint, whose errors are not squared.
const SETTLED_RADIUS: f64 = 1e-9;
/// Accuracy still accepted at the limit, when many eigenvalues are close to the largest: factors are printed to six
/// digits.
const SETTLED_AT_LIMIT: f64 = 1e-7;
/// A smaller imaginary part, relative to the radius, is rounding of a nearly double real eigenvalue.
const REAL: f64 = 1e-6;
/// Below this, the next vector is rounding: the subspace is invariant.
const INVARIANT: f64 = 1e-12;

/// The largest eigenvalue of a self-adjoint, positive semidefinite map; 0 for the zero map.
pub fn largest_eigenvalue(map: &mut dyn LinearMap, start: &[f64]) -> Result<Extreme, EigenError> {
    let mut basis = Basis::new(map, start);
    let mut last = f64::NAN;
    loop {
        let invariant = basis.extend(map)?;
        let m = basis.columns.len();
        if !invariant && !look(m) && m < LIMIT {
            continue;
        }
        let projected = DMatrix::from_fn(m, m, |i, j| {
            let entry = |i: usize, j: usize| basis.columns[j].get(i).copied().unwrap_or(0.0);
            0.5 * (entry(i, j) + entry(j, i))
        });
        let eigen = SymmetricEigen::new(projected);
        let top = (0..m).max_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let top = top.unwrap_or(0);
        let value = eigen.eigenvalues[top];
        let coefficients = eigen.eigenvectors.column(top);
        let residual = if invariant { 0.0 } else { (basis.next * coefficients[m - 1]).abs() };
        let change = ((value - last) / value).abs();
        let settled = change <= SETTLED && residual <= RESIDUAL * value;
        let accepted = m >= LIMIT && change <= SETTLED_AT_LIMIT;
        if invariant || settled || accepted || value == 0.0 {
            let vector = basis.combine(coefficients.as_slice());
            return Ok(Extreme { value, vector, iterations: m as u32, residual });
        }
        if m >= LIMIT || value.is_nan() {
            return Err(EigenError::NotSettled { value, iterations: m as u32, change });
        }
        last = value;
    }
}

/// The outer eigenvalues of a linear map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// The largest modulus.
    pub radius: f64,
    /// The largest real eigenvalue; minus infinity if none is real.
    pub rightmost: f64,
    pub iterations: u32,
}

/// The outer eigenvalues of any linear map.
///
/// # Errors
/// [`EigenError`].
pub fn spectrum(map: &mut dyn LinearMap, start: &[f64]) -> Result<Spectrum, EigenError> {
    let mut basis = Basis::new(map, start);
    let mut last = (f64::NAN, f64::NAN);
    loop {
        let invariant = basis.extend(map)?;
        let m = basis.columns.len();
        if !invariant && !look(m) && m < LIMIT {
            continue;
        }
        let entry = |i: usize, j: usize| basis.columns[j].get(i).copied().unwrap_or(0.0);
        let values = Mat::from_fn(m, m, entry)
            .eigenvalues()
            .map_err(|_| EigenError::NotConverged { order: m })?;
        let radius = values.iter().map(|z| z.re.hypot(z.im)).fold(0.0, f64::max);
        let real = values.iter().filter(|z| z.im.abs() <= REAL * radius);
        let rightmost = real.map(|z| z.re).fold(f64::NEG_INFINITY, f64::max);
        let off = (radius - last.0).abs().max((rightmost - last.1).abs());
        let (change, iterations) = (off / radius, m as u32);
        let settled = if m < LIMIT { SETTLED_RADIUS } else { SETTLED_AT_LIMIT };
        if invariant || change <= settled || radius == 0.0 {
            return Ok(Spectrum { radius, rightmost, iterations });
        }
        if m >= LIMIT || radius.is_nan() {
            return Err(EigenError::NotSettled { value: radius, iterations, change });
        }
        last = (radius, rightmost);
    }
}

/// Whether to compute the eigenvalues of the projected matrix, which cost m³: every second step while small, later
/// after growth by a quarter.
fn look(m: usize) -> bool {
    let mut next = 20;
    while next < m {
        next += next / 4;
    }
    m == next || (m < 20 && m.is_multiple_of(2))
}

/// An orthonormal basis of the Krylov space, and T in it.
struct Basis {
    vectors: Vec<Vec<f64>>,
    /// G times each vector.
    images: Vec<Vec<f64>>,
    /// Column j: (v_i, T v_j) for i ≤ j + 1.
    columns: Vec<Vec<f64>>,
    /// Norm of the part of T v_j outside the basis.
    next: f64,
}

impl Basis {
    fn new(map: &mut dyn LinearMap, start: &[f64]) -> Self {
        let mut image = vec![0.0; start.len()];
        map.gram(start, &mut image);
        let length = dot(start, &image).sqrt();
        let unit = |x: &[f64]| x.iter().map(|x| x / length).collect::<Vec<f64>>();
        let (vectors, images) = (vec![unit(start)], vec![unit(&image)]);
        Self { vectors, images, columns: Vec::new(), next: 0.0 }
    }

    /// Applies T to the last vector; true if the result stays within the basis.
    fn extend(&mut self, map: &mut dyn LinearMap) -> Result<bool, FactorError> {
        let j = self.columns.len();
        let order = self.vectors[j].len();
        let (mut out, mut image) = (vec![0.0; order], vec![0.0; order]);
        map.apply(&self.vectors[j], &mut out)?;
        let mut column = vec![0.0; j + 2];
        for _ in 0..2 {
            for i in 0..=j {
                let part = dot(&self.images[i], &out);
                axpy(-part, &self.vectors[i], &mut out);
                column[i] += part;
            }
        }
        map.gram(&out, &mut image);
        let square = dot(&out, &image);
        if square.is_nan() {
            return Err(FactorError::NotFinite);
        }
        let length = square.max(0.0).sqrt();
        let size = column.iter().fold(length, |size, part| size.max(part.abs()));
        column[j + 1] = length;
        self.columns.push(column);
        self.next = length;
        if length <= INVARIANT * size || j + 1 == order {
            return Ok(true);
        }
        self.vectors.push(out.iter().map(|x| x / length).collect());
        self.images.push(image.iter().map(|x| x / length).collect());
        Ok(false)
    }

    fn combine(&self, coefficients: &[f64]) -> Vec<f64> {
        let mut vector = vec![0.0; self.vectors[0].len()];
        for (coefficient, v) in coefficients.iter().zip(&self.vectors) {
            axpy(*coefficient, v, &mut vector);
        }
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Dense {
        map: DMatrix<f64>,
        weights: Vec<f64>,
    }

    impl LinearMap for Dense {
        fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
            for (i, value) in out.iter_mut().enumerate() {
                *value = self.map.row(i).iter().zip(x).map(|(a, x)| a * x).sum();
            }
            Ok(())
        }
        fn gram(&mut self, x: &[f64], out: &mut [f64]) {
            for ((value, x), w) in out.iter_mut().zip(x).zip(&self.weights) {
                *value = w * x;
            }
        }
    }

    /// T = G⁻¹S with S the second difference matrix: self-adjoint in G = 2I, eigenvalues 1 - cos(jπ/(m+1)), crowded at
    /// the top.
    fn second_differences(m: usize) -> Dense {
        let map = DMatrix::from_fn(m, m, |i, j| match i.abs_diff(j) {
            0 => 1.0,
            1 => -0.5,
            _ => 0.0,
        });
        Dense { map, weights: vec![2.0; m] }
    }

    fn start(m: usize) -> Vec<f64> {
        let mut seed = 3;
        (0..m).map(|_| super::super::signed_unit(&mut seed)).collect()
    }

    #[test]
    fn a_crowded_spectrum_is_resolved() {
        let m = 200;
        let found = largest_eigenvalue(&mut second_differences(m), &start(m)).unwrap();
        let exact = 1.0 - (m as f64 * std::f64::consts::PI / (m as f64 + 1.0)).cos();
        assert!((found.value - exact).abs() < 1e-12, "{found:?} {exact}");
        let mut out = vec![0.0; m];
        second_differences(m).apply(&found.vector, &mut out).unwrap();
        let off = out.iter().zip(&found.vector).map(|(y, x)| (y - exact * x).abs());
        assert!(off.fold(0.0, f64::max) < 1e-5);
    }

    #[test]
    fn multiples_of_the_identity_and_zero_end_at_once() {
        for factor in [0.0, 0.25] {
            let map = DMatrix::from_diagonal_element(5, 5, factor);
            let mut dense = Dense { map, weights: vec![1.0, 2.0, 3.0, 4.0, 5.0] };
            let found = largest_eigenvalue(&mut dense, &start(5)).unwrap();
            assert!((found.value - factor).abs() < 1e-15 && found.iterations <= 2);
            assert!((spectrum(&mut dense, &start(5)).unwrap().radius - factor).abs() < 1e-15);
        }
    }

    /// A rotation scaled by ½ plus a nilpotent part: the radius is ½, whatever the norm.
    #[test]
    fn the_radius_is_not_the_norm() {
        let map = DMatrix::from_row_slice(
            4,
            4,
            &[0., -0.5, 0., 9., 0.5, 0., 0., 0., 0., 0., 0.1, 7., 0., 0., 0., 0.1],
        );
        let mut dense = Dense { map, weights: vec![1.0; 4] };
        let found = spectrum(&mut dense, &start(4)).unwrap();
        // Eigenvalues ±i/2 and 0.1 twice in a Jordan block, which halves the digits.
        assert!((found.radius - 0.5).abs() < 1e-12, "{found:?}");
        assert!((found.rightmost - 0.1).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn a_map_that_is_not_a_number_is_an_error() {
        let mut dense = second_differences(4);
        dense.map[(1, 1)] = f64::NAN;
        assert!(largest_eigenvalue(&mut dense, &start(4)).is_err());
        assert!(spectrum(&mut dense, &start(4)).is_err());
    }
}
