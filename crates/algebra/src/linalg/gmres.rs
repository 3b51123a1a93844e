//! Right-preconditioned GMRES without restart, for few iterations with a very good preconditioner.
//!
//! Saad and Schultz, SIAM J. Sci. Stat. Comput. 7 (1986). Preconditioned directions are kept, so that the solution
//! needs no further application of the preconditioner.

use super::{axpy, dot, norm};

/// Vectors of the Krylov space, kept between solves.
#[derive(Debug, Clone, Default)]
pub struct Krylov {
    basis: Vec<Vec<f64>>,
    /// z_j = P⁻¹ v_j.
    directions: Vec<Vec<f64>>,
    /// Columns of the triangular factor of the Hessenberg matrix; then rotations, rotated right side, weights of the
    /// directions.
    triangle: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    right: Vec<f64>,
    weights: Vec<f64>,
}

/// What a solve took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KrylovInfo {
    /// Iterations: applications of operator and preconditioner.
    pub iterations: u32,
    /// Residual norm relative to the right side.
    pub relative_residual: f64,
}

/// A linear operator with a preconditioner.
pub trait Preconditioned {
    /// `out` ← J x.
    fn apply(&mut self, x: &[f64], out: &mut [f64]);
    /// x ← P⁻¹ x in place.
    fn precondition(&mut self, x: &mut [f64]);
}

/// Solves J x = `rhs` in place until the residual is below `tolerance`·‖rhs‖, or for `limit` iterations; an unreached
/// tolerance is not an error here.
pub fn gmres(
    operator: &mut dyn Preconditioned,
    rhs: &mut [f64],
    tolerance: f64,
    limit: usize,
    krylov: &mut Krylov,
) -> KrylovInfo {
    let size = norm(rhs);
    if size == 0.0 || !size.is_finite() {
        let relative_residual = if size == 0.0 { 0.0 } else { f64::NAN };
        return KrylovInfo { iterations: 0, relative_residual };
    }
    krylov.resize(limit, rhs.len());
    for (v, r) in krylov.basis[0].iter_mut().zip(&*rhs) {
        *v = r / size;
    }
    krylov.right.push(size);
    let mut steps = 0;
    while steps < limit {
        let j = steps;
        krylov.extend(operator, j);
        let Krylov { triangle, rotations, right, .. } = krylov;
        let column = &mut triangle[j];
        for (i, (c, s)) in rotations.iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            (column[i], column[i + 1]) = (c * a + s * b, c * b - s * a);
        }
        let length = column[j].hypot(column[j + 1]);
        let rotation = (column[j] / length, column[j + 1] / length);
        column[j] = length;
        column.truncate(j + 1);
        rotations.push(rotation);
        right.push(-rotation.1 * right[j]);
        right[j] *= rotation.0;
        steps += 1;
        let residual = right[steps].abs();
        // A NaN stops the iteration.
        if residual.is_nan() || residual <= tolerance * size {
            break;
        }
    }
    let Krylov { triangle, right, weights, directions, .. } = krylov;
    rhs.fill(0.0);
    weights.resize(steps, 0.0);
    for i in (0..steps).rev() {
        let known: f64 = (i + 1..steps).map(|j| triangle[j][i] * weights[j]).sum();
        weights[i] = (right[i] - known) / triangle[i][i];
    }
    for (weight, direction) in weights.iter().zip(directions) {
        axpy(*weight, direction, rhs);
    }
    KrylovInfo { iterations: steps as u32, relative_residual: right[steps].abs() / size }
}

impl Krylov {
    fn resize(&mut self, limit: usize, length: usize) {
        self.basis.resize_with(limit + 1, Vec::new);
        self.directions.resize_with(limit, Vec::new);
        self.triangle.resize_with(limit, Vec::new);
        self.rotations.clear();
        self.right.clear();
        // Other vectors are allocated when first needed.
        self.basis[0].resize(length, 0.0);
    }

    /// Appends v_{j+1} and column j of the Hessenberg matrix (j + 2 numbers).
    fn extend(&mut self, operator: &mut dyn Preconditioned, j: usize) {
        let (known, rest) = self.basis.split_at_mut(j + 1);
        let (direction, next) = (&mut self.directions[j], &mut rest[0]);
        direction.clone_from(&known[j]);
        operator.precondition(direction);
        next.resize(direction.len(), 0.0);
        operator.apply(direction, next);
        let column = &mut self.triangle[j];
        column.clear();
        for v in known.iter() {
            let projection = dot(v, next);
            axpy(-projection, v, next);
            column.push(projection);
        }
        let length = norm(next);
        column.push(length);
        if length > 0.0 {
            for value in next.iter_mut() {
                *value /= length;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Small;
    const MATRIX: [[f64; 4]; 4] =
        [[4.0, 1.0, 0.0, 0.5], [-1.0, 3.0, 1.0, 0.0], [0.0, 0.3, 5.0, -2.0], [1.0, 0.0, 0.7, 2.0]];

    impl Preconditioned for Small {
        fn apply(&mut self, x: &[f64], out: &mut [f64]) {
            for (value, row) in out.iter_mut().zip(MATRIX) {
                *value = dot(&row, x);
            }
        }
        fn precondition(&mut self, x: &mut [f64]) {
            for (i, value) in x.iter_mut().enumerate() {
                *value /= MATRIX[i][i];
            }
        }
    }

    #[test]
    fn solves_to_the_tolerance_in_at_most_the_order() {
        let exact = [1.0, -2.0, 3.0, 0.5];
        let mut rhs = [0.0; 4];
        Small.apply(&exact, &mut rhs);
        let info = gmres(&mut Small, &mut rhs, 1e-13, 4, &mut Krylov::default());
        assert!(info.iterations <= 4 && info.relative_residual < 1e-12);
        assert!(rhs.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn an_unreached_tolerance_and_a_nan_are_reported() {
        let mut rhs = [1.0, 2.0, 3.0, 4.0];
        let info = gmres(&mut Small, &mut rhs, 1e-13, 2, &mut Krylov::default());
        assert!(info.iterations == 2 && info.relative_residual > 1e-6);
        let mut rhs = [f64::NAN, 0.0, 0.0, 0.0];
        let info = gmres(&mut Small, &mut rhs, 1e-13, 2, &mut Krylov::default());
        assert!(info.relative_residual.is_nan());
    }
}
