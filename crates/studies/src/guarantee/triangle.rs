//! Stresses of Johnson and Mercier (Numer. Math. 30, 1978) on one triangle: symmetric, linear on each of the three
//! parts into which the centroid divides it, with continuous tractions between the parts.
//!
//! A stress is 27 numbers, `9 part + 3 corner + component`: part s has the corners a_{s+1}, a_{s+2} and the centroid,
//! components are Mandel's. Tractions are 12 numbers, `4 edge + 2 end + component`: edge s runs from a_{s+1} to
//! a_{s+2}, its normal points outwards.

use nalgebra::{SMatrix, SVector};
use std::f64::consts::FRAC_1_SQRT_2;

pub(super) type Stress = SVector<f64, 27>;
pub(super) type Tractions = SVector<f64, 12>;
/// ∫ f_i ψ_a, `2 corner + component`.
pub(super) type Moments = SVector<f64, 6>;

/// Conditions on the 27 numbers: 12 of continuity between the parts, 6 moments of the divergence.
type Conditions = SMatrix<f64, 18, 27>;

/// What the smallest ‖σ‖ in 𝒜⁻¹ with given divergence needs of a triangle.
pub(super) struct Triangle {
    /// Counterclockwise.
    pub(super) corners: [[f64; 2]; 3],
    /// |T|.
    pub(super) area: f64,
    /// 𝒜⁻¹.
    pub(super) compliance: [[f64; 3]; 3],
    /// 𝒜.
    pub(super) elasticity: [[f64; 3]; 3],
    /// N: the tractions of a stress on the edges.
    pub(super) to_tractions: SMatrix<f64, 12, 27>,
    /// σ that displacements of the edges cause, all conditions being zero.
    pub(super) of_edges: SMatrix<f64, 27, 12>,
    /// The smallest σ with given moments of Div σ.
    pub(super) of_moments: SMatrix<f64, 27, 6>,
}

impl Triangle {
    /// The triangle with these corners, counterclockwise, and 𝒜 as a Mandel matrix; `None` where 𝒜 or the triangle
    /// is degenerate.
    pub(super) fn new(corners: [[f64; 2]; 3], elasticity: [[f64; 3]; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        let inverse = SMatrix::<f64, 3, 3>::from_fn(|i, j| elasticity[i][j]).try_inverse()?;
        let compliance = std::array::from_fn(|i| std::array::from_fn(|j| inverse[(i, j)]));
        let (of_edges, of_moments) = (SMatrix::zeros(), SMatrix::zeros());
        let to_tractions = SMatrix::zeros();
        let mut triangle =
            Self { corners, area, compliance, elasticity, to_tractions, of_edges, of_moments };
        triangle.to_tractions = triangle.traction_matrix();
        let conditions = triangle.conditions();
        // M⁻¹Gᵀ and (G M⁻¹ Gᵀ)⁻¹.
        let raised = triangle.inverse_mass(conditions.transpose());
        let inner = (conditions * raised).cholesky()?.inverse();
        let free = triangle.inverse_mass(triangle.to_tractions.transpose());
        triangle.of_edges = free - raised * (inner * (conditions * free));
        triangle.of_moments = (raised * inner).fixed_columns::<6>(12).into();
        Some(triangle)
    }

    fn traction_matrix(&self) -> SMatrix<f64, 12, 27> {
        let mut matrix = SMatrix::zeros();
        for edge in 0..3 {
            for end in 0..2 {
                let at = 9 * edge + 3 * end;
                add_traction(&mut matrix, 4 * edge + 2 * end, at, self.outward(edge));
            }
        }
        matrix
    }

    pub(super) fn constant(stress: &[f64; 3]) -> Stress {
        Stress::from_fn(|i, _| stress[i % 3])
    }

    /// A stress that is linear on the whole triangle, by its values at barycentric coordinates.
    pub(super) fn linear(at: impl Fn(&[f64]) -> [f64; 3]) -> Stress {
        let corner =
            |a: usize| std::array::from_fn::<f64, 3, _>(|b| if a == b { 1.0 } else { 0.0 });
        let corners = [0, 1, 2].map(|a| at(&corner(a)));
        let centroid = at(&[1.0 / 3.0; 3]);
        Stress::from_fn(|i, _| match (i / 9, i % 9 / 3) {
            (_, 2) => centroid[i % 3],
            (part, corner) => corners[(part + 1 + corner) % 3][i % 3],
        })
    }

    /// The conditions: jumps of tractions across the lines from corners to the centroid, then ∫ Div σ·ψ.
    fn conditions(&self) -> Conditions {
        let mut matrix = Conditions::zeros();
        self.add_jumps(&mut matrix, 9, &[[1, 0], [2, 2]]);
        for part in 0..3 {
            let gradients = self.part_gradients(part);
            for corner in 0..3 {
                // ∫ψ over a part is its area times ψ at its centroid.
                let mean = if corner == part { 1.0 / 9.0 } else { 4.0 / 9.0 };
                let weight = self.area / 3.0 * mean;
                for (local, [gx, gy]) in gradients.into_iter().enumerate() {
                    let at = 9 * part + 3 * local;
                    let row = 12 + 2 * corner;
                    add_traction(&mut matrix, row, at, [weight * gx, weight * gy]);
                }
            }
        }
        matrix
    }

    /// Adds, in the first rows, the jumps of tractions across the lines from corners to the centroid, at nodes of the part
    /// before and of the part after: corner v is the second corner of the one and the first of the other. A part has so
    /// many `numbers`.
    pub(super) fn add_jumps<const R: usize, const C: usize>(
        &self,
        matrix: &mut SMatrix<f64, R, C>,
        numbers: usize,
        nodes: &[[usize; 2]],
    ) {
        for v in 0..3 {
            let normal = self.normal(v);
            let (before, after) = ((v + 1) % 3, (v + 2) % 3);
            for (at, [node, other]) in nodes.iter().enumerate() {
                let row = 2 * (nodes.len() * v + at);
                add_traction(matrix, row, numbers * before + 3 * node, normal);
                add_traction(matrix, row, numbers * after + 3 * other, normal.map(|n| -n));
            }
        }
    }

    /// The outward normal of the edge opposite to a corner.
    pub(super) fn outward(&self, edge: usize) -> [f64; 2] {
        right_of(self.corners[(edge + 1) % 3], self.corners[(edge + 2) % 3])
    }

    /// A normal of the line from a corner to the centroid.
    pub(super) fn normal(&self, corner: usize) -> [f64; 2] {
        right_of(self.corners[corner], self.centroid())
    }

    pub(super) fn centroid(&self) -> [f64; 2] {
        std::array::from_fn(|i| self.corners.iter().map(|corner| corner[i]).sum::<f64>() / 3.0)
    }

    /// Gradients of the three linear functions of a part.
    pub(super) fn part_gradients(&self, part: usize) -> [[f64; 2]; 3] {
        let at = [self.corners[(part + 1) % 3], self.corners[(part + 2) % 3], self.centroid()];
        let twice = 2.0 * self.area / 3.0;
        std::array::from_fn(|l| {
            let (p, q) = (at[(l + 1) % 3], at[(l + 2) % 3]);
            [(p[1] - q[1]) / twice, (q[0] - p[0]) / twice]
        })
    }

    /// Div σ on each part.
    pub(super) fn divergence(&self, stress: &Stress) -> [[f64; 2]; 3] {
        std::array::from_fn(|part| {
            let mut sum = [0.0; 2];
            for (local, [gx, gy]) in self.part_gradients(part).into_iter().enumerate() {
                let at = 9 * part + 3 * local;
                let shear = FRAC_1_SQRT_2 * stress[at + 2];
                sum[0] += gx * stress[at] + gy * shear;
                sum[1] += gx * shear + gy * stress[at + 1];
            }
            sum
        })
    }

    /// M⁻¹ of columns, M being ∫ 𝒜⁻¹σ:τ: |T|/36 (1 + δ) on the corners of a part, times 𝒜⁻¹.
    fn inverse_mass<const C: usize>(&self, columns: SMatrix<f64, 27, C>) -> SMatrix<f64, 27, C> {
        let mut out = SMatrix::zeros();
        for c in 0..C {
            for part in 0..3 {
                let value = |l: usize, i: usize| columns[(9 * part + 3 * l + i, c)];
                let sums: [f64; 3] =
                    std::array::from_fn(|i| (0..3).map(|l| value(l, i)).sum::<f64>() / 4.0);
                for l in 0..3 {
                    for i in 0..3 {
                        let row = self.elasticity[i].iter().enumerate();
                        let sum: f64 = row.map(|(j, a)| a * (value(l, j) - sums[j])).sum();
                        out[(9 * part + 3 * l + i, c)] = 36.0 / self.area * sum;
                    }
                }
            }
        }
        out
    }

    /// ∫ 𝒜⁻¹σ:σ.
    pub(super) fn energy(&self, stress: &Stress) -> f64 {
        let product = |a: &[f64; 3], b: &[f64; 3]| -> f64 {
            (0..3).map(|i| (0..3).map(|j| a[i] * self.compliance[i][j] * b[j]).sum::<f64>()).sum()
        };
        let mut sum = 0.0;
        for part in 0..3 {
            let at: [[f64; 3]; 3] =
                std::array::from_fn(|l| std::array::from_fn(|i| stress[9 * part + 3 * l + i]));
            let total: [f64; 3] = std::array::from_fn(|i| at.iter().map(|stress| stress[i]).sum());
            sum += product(&total, &total)
                + at.iter().map(|stress| product(stress, stress)).sum::<f64>();
        }
        self.area / 36.0 * sum
    }
}

/// The unit vector to the right of a line.
fn right_of(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    [(to[1] - from[1]) / length, (from[0] - to[0]) / length]
}

/// Adds σν, σ being the three numbers from column `at`, to two rows; the slopes of a function in place of ν give Div σ.
pub(super) fn add_traction<const R: usize, const C: usize>(
    matrix: &mut SMatrix<f64, R, C>,
    row: usize,
    at: usize,
    [nx, ny]: [f64; 2],
) {
    matrix[(row, at)] += nx;
    matrix[(row, at + 2)] += ny * FRAC_1_SQRT_2;
    matrix[(row + 1, at + 1)] += ny;
    matrix[(row + 1, at + 2)] += nx * FRAC_1_SQRT_2;
}
