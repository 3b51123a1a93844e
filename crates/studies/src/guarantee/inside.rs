//! What balances the linear part of a load inside a triangle: a stress of degree 2 on each of its three parts that has
//! no traction on its edges. To the stresses of [`super::triangle`], whose divergence is constant on each part, it adds
//! what lets f0 be linear.

use nalgebra::{SMatrix, SVector};

use super::triangle::{Stress, Triangle, add_traction};

/// Numbers of a stress of degree 2: `18 part + 3 node + component`, the nodes being the corners of a part and then the
/// middles opposite to them.
const SIZE: usize = 54;
/// f0 at the three corners, then Div σ on the three parts, two components each.
pub(super) type Unbalanced = SVector<f64, 12>;

/// ∫ of products of functions of degree 2 on a part, over area/180.
const MASS: [[f64; 6]; 6] = [
    [6.0, -1.0, -1.0, -4.0, 0.0, 0.0],
    [-1.0, 6.0, -1.0, 0.0, -4.0, 0.0],
    [-1.0, -1.0, 6.0, 0.0, 0.0, -4.0],
    [-4.0, 0.0, 0.0, 32.0, 16.0, 16.0],
    [0.0, -4.0, 0.0, 16.0, 32.0, 16.0],
    [0.0, 0.0, -4.0, 16.0, 16.0, 32.0],
];
/// Conditions of zero traction depend on each other: their matrix is inverted with this part of its diagonal added, and
/// the solution refined, which leaves a millionth of a millionth.
const ADDED: f64 = 1e-10;
const REFINEMENTS: usize = 3;

/// The energies of the smallest such stress.
pub(super) struct Inside {
    /// ∫ 𝒜⁻¹τ:τ of τ for given [`Unbalanced`] loads.
    square: SMatrix<f64, 12, 12>,
    /// ∫ 𝒜⁻¹σ:τ with a [`Stress`].
    product: SMatrix<f64, 27, 12>,
    /// How far the conditions are off, relative to what is asked.
    pub(super) missed: f64,
}

impl Inside {
    /// `None` for a degenerate triangle.
    pub(super) fn new(triangle: &Triangle) -> Option<Self> {
        // Cells are balanced in force and moment before: what is not would be rounding, and nothing balances it.
        let (conditions, asked) = conditions(triangle);
        let asked = asked * without_rigid_forces(triangle);
        let inverse = SMatrix::<f64, 6, 6>::from_fn(|i, j| MASS[i][j]).try_inverse()?;
        let scale = triangle.area / 540.0;
        let part =
            |matrix: &dyn Fn(usize, usize) -> f64, tensor: &[[f64; 3]; 3], i: usize, j: usize| {
                match i / 18 == j / 18 {
                    true => matrix(i % 18 / 3, j % 18 / 3) * tensor[i % 3][j % 3],
                    false => 0.0,
                }
            };
        let mass = SMatrix::<f64, SIZE, SIZE>::from_fn(|i, j| {
            scale * part(&|k, l| MASS[k][l], &triangle.compliance, i, j)
        });
        let raised = SMatrix::<f64, SIZE, SIZE>::from_fn(|i, j| {
            part(&|k, l| inverse[(k, l)], &triangle.elasticity, i, j) / scale
        }) * conditions.transpose();
        let inner = conditions * raised;
        let added = ADDED * inner.diagonal().amax();
        let factor = (inner + SMatrix::<f64, SIZE, SIZE>::identity() * added).cholesky()?;
        let mut multipliers = factor.solve(&asked);
        for _ in 0..REFINEMENTS {
            multipliers += factor.solve(&(asked - inner * multipliers));
        }
        let of_load = raised * multipliers;
        let missed = (conditions * of_load - asked).amax() / asked.amax();
        let weighted = mass * of_load;
        let embedding = embedding();
        Some(Self {
            square: of_load.transpose() * weighted,
            product: embedding.transpose() * weighted,
            missed,
        })
    }

    /// ∫ 𝒜⁻¹(σ + τ):(σ + τ) less that of σ.
    pub(super) fn added_energy(&self, stress: &Stress, load: &Unbalanced) -> f64 {
        2.0 * (stress.transpose() * self.product * load)[0]
            + (load.transpose() * self.square * load)[0]
    }
}

/// Continuity between the parts and no traction outside, three nodes an edge; then Div τ at the corners of the parts.
fn conditions(triangle: &Triangle) -> (SMatrix<f64, SIZE, SIZE>, SMatrix<f64, SIZE, 12>) {
    let mut matrix = SMatrix::zeros();
    let mut asked = SMatrix::zeros();
    // To the centroid: an end, the centroid and the middle of the part before, and those of the part after.
    triangle.add_jumps(&mut matrix, 18, &[[1, 0], [2, 2], [3, 4]]);
    let mut row = 18;
    for part in 0..3 {
        for node in [0, 1, 5] {
            add_traction(&mut matrix, row, 18 * part + 3 * node, triangle.outward(part));
            row += 2;
        }
    }
    // Of the size of the other rows.
    let length = triangle.area.sqrt();
    for part in 0..3 {
        let gradients = triangle.part_gradients(part);
        for corner in 0..3 {
            for (node, [gx, gy]) in slopes(&gradients, corner).into_iter().enumerate() {
                let slope = [length * gx, length * gy];
                add_traction(&mut matrix, row, 18 * part + 3 * node, slope);
            }
            for i in 0..2 {
                match corner {
                    2 => (0..3).for_each(|a| asked[(row + i, 2 * a + i)] = -length / 3.0),
                    _ => asked[(row + i, 2 * ((part + 1 + corner) % 3) + i)] = -length,
                }
                asked[(row + i, 6 + 2 * part + i)] = -length;
            }
            row += 2;
        }
    }
    (matrix, asked)
}

/// Gradients of the six functions of degree 2 at a corner.
fn slopes(gradients: &[[f64; 2]; 3], corner: usize) -> [[f64; 2]; 6] {
    let at = |l: usize| if l == corner { 1.0 } else { 0.0 };
    std::array::from_fn(|node| {
        if node < 3 {
            return gradients[node].map(|g| (4.0 * at(node) - 1.0) * g);
        }
        let (a, b) = ((node - 2) % 3, (node - 1) % 3);
        std::array::from_fn(|i| 4.0 * (at(a) * gradients[b][i] + at(b) * gradients[a][i]))
    })
}

/// A stress that is linear on each part as one of degree 2.
fn embedding() -> SMatrix<f64, SIZE, 27> {
    let mut matrix = SMatrix::zeros();
    for part in 0..3 {
        for i in 0..3 {
            for node in 0..6 {
                let corners =
                    if node < 3 { [node, node] } else { [(node - 2) % 3, (node - 1) % 3] };
                for corner in corners {
                    matrix[(18 * part + 3 * node + i, 9 * part + 3 * corner + i)] += 0.5;
                }
            }
        }
    }
    matrix
}

/// Takes the resultant force and moment from columns of [`Unbalanced`], by constants of Div σ and a rotation of f0.
fn without_rigid_forces(triangle: &Triangle) -> SMatrix<f64, 12, 12> {
    // Force and moment about the centroid of each unit load.
    let [a, b, c] = triangle.corners;
    let centre = triangle.centroid();
    let mut forces = SMatrix::<f64, 3, 12>::zeros();
    for (corner, x) in [a, b, c].iter().enumerate() {
        // ∫ψ_a = |T|/3, ∫ψ_a (x - x̄) = |T|/12 (x_a - x̄).
        let arm: [f64; 2] = std::array::from_fn(|i| (x[i] - centre[i]) / 12.0);
        (forces[(0, 2 * corner)], forces[(1, 2 * corner + 1)]) = (1.0 / 3.0, 1.0 / 3.0);
        (forces[(2, 2 * corner)], forces[(2, 2 * corner + 1)]) = (-arm[1], arm[0]);
        // The part opposite to the corner: its centroid lies at -(x_a - x̄)/3.
        let arm: [f64; 2] = std::array::from_fn(|i| -(x[i] - centre[i]) / 9.0);
        (forces[(0, 6 + 2 * corner)], forces[(1, 7 + 2 * corner)]) = (1.0 / 3.0, 1.0 / 3.0);
        (forces[(2, 6 + 2 * corner)], forces[(2, 7 + 2 * corner)]) = (-arm[1], arm[0]);
    }
    let gram = (forces * forces.transpose()).try_inverse().unwrap_or_else(SMatrix::zeros);
    SMatrix::identity() - forces.transpose() * gram * forces
}
