//! Strain error of linear interpolation of a quadratic field on one simplex.

use exact::linear::gradient_of;

/// A simplex, prepared for many fields.
///
/// With corners v_a relative to the centroid c, q - Iq has the gradient m + H(x - c), where m = -½ Σ_a (v_aᵀ H v_a)
/// ∇λ_a, and the mean of (x - c)(x - c)ᵀ is Σ_a v_a v_aᵀ/((D + 1)(D + 2)).
pub(crate) struct QuadraticError<const D: usize> {
    corners: Vec<[f64; D]>,
    gradients: Vec<[f64; D]>,
    spread: [[f64; D]; D],
}

impl<const D: usize> QuadraticError<D> {
    pub(crate) fn new(corners: &[[f64; D]]) -> Self {
        let count = corners.len() as f64;
        let centre: [f64; D] =
            std::array::from_fn(|i| corners.iter().map(|v| v[i]).sum::<f64>() / count);
        let relative = |v: &[f64; D]| -> [f64; D] { std::array::from_fn(|i| v[i] - centre[i]) };
        let edges: [[f64; D]; D] =
            std::array::from_fn(|a| std::array::from_fn(|i| corners[a + 1][i] - corners[0][i]));
        // λ_0 falls by one along every edge, λ_a rises along the a-th.
        let mut gradients = vec![gradient_of(&edges, &[-1.0; D])];
        let along = |a: usize| std::array::from_fn(|b| f64::from(u8::from(a == b)));
        gradients.extend((0..D).map(|a| gradient_of(&edges, &along(a))));
        let corners: Vec<[f64; D]> = corners.iter().map(relative).collect();
        let product = |i: usize, j: usize| corners.iter().map(|v| v[i] * v[j]).sum::<f64>();
        let spread = |i, j| product(i, j) / (count * (count + 1.0));
        let spread = std::array::from_fn(|i| std::array::from_fn(|j| spread(i, j)));
        Self { corners, gradients, spread }
    }

    /// Mean over the simplex of |ε(q - I q)|² for the field whose component i has the Hessian `hessians[i]`.
    pub(crate) fn mean_square(&self, hessians: &[[[f64; D]; D]; D]) -> f64 {
        let mean = hessians.map(|hessian| self.mean_gradient(&hessian));
        let mut sum = 0.0;
        for i in 0..D {
            for j in 0..D {
                let shift = 0.5 * (mean[i][j] + mean[j][i]);
                let slope: [f64; D] =
                    std::array::from_fn(|l| 0.5 * (hessians[i][j][l] + hessians[j][i][l]));
                sum += shift * shift + form(&self.spread, &slope);
            }
        }
        sum
    }

    /// m of one component.
    fn mean_gradient(&self, hessian: &[[f64; D]; D]) -> [f64; D] {
        let mut mean = [0.0; D];
        for (corner, gradient) in self.corners.iter().zip(&self.gradients) {
            let value = 0.5 * form(hessian, corner);
            mean.iter_mut().zip(gradient).for_each(|(m, g)| *m -= value * g);
        }
        mean
    }
}

fn form<const D: usize>(matrix: &[[f64; D]; D], v: &[f64; D]) -> f64 {
    let row = |i: usize| (0..D).map(|j| matrix[i][j] * v[j]).sum::<f64>();
    (0..D).map(|i| v[i] * row(i)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand on the triangle (0,0), (1,0), (1,1) for u = (x²/2, 0): ∇(q - Iq) = (x - ½, 0), whose square has the mean
    /// ½ - ⅔ + ¼ = 1/12.
    #[test]
    fn one_second_derivative_in_the_plane() {
        let triangle = QuadraticError::new(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
        let (zero, bent) = ([[0.0; 2]; 2], [[1.0, 0.0], [0.0, 0.0]]);
        assert!((triangle.mean_square(&[bent, zero]) - 1.0 / 12.0).abs() < 1e-15);
        // u = (0, x²/2): the shear ½(x - ½), twice its square.
        assert!((triangle.mean_square(&[zero, bent]) - 1.0 / 24.0).abs() < 1e-15);
        // The triangle turned by 180°.
        let turned = QuadraticError::new(&[[0.0, 0.0], [-1.0, 0.0], [-1.0, -1.0]]);
        let field = [[[0.3, -0.2], [-0.2, 0.7]], [[0.1, 0.5], [0.5, -0.4]]];
        assert!((turned.mean_square(&field) - triangle.mean_square(&field)).abs() < 1e-15);
    }

    /// The tetrahedron 1 ≥ x ≥ y ≥ z ≥ 0 and u = (x²/2, 0, 0): again x - ½, with x of density 3x²: 3/5 - 3/4 + 1/4 =
    /// 1/10. For u = (0, 0, xz): Iq = z, so ∇(q - Iq) = (z, 0, x - 1) and |ε|² = ½z² + (x - 1)², where z has the
    /// density 3(1 - z)²: ½·1/10 + 1/10.
    #[test]
    fn one_second_derivative_in_space() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
        let tetrahedron = QuadraticError::new(&corners);
        let zero = [[0.0; 3]; 3];
        let mut bent = zero;
        bent[0][0] = 1.0;
        assert!((tetrahedron.mean_square(&[bent, zero, zero]) - 0.1).abs() < 1e-15);
        let mut twisted = zero;
        (twisted[0][2], twisted[2][0]) = (1.0, 1.0);
        assert!((tetrahedron.mean_square(&[zero, zero, twisted]) - 0.15).abs() < 1e-15);
    }
}
