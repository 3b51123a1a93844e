//! Nodal forces of the exact stress and pressure, from vertex positions and outward normals alone.
//!
//! The solver multiplies σ by shape gradients in Mandel notation. Here the gradient is integrated over the
//! triangle's boundary: an error in the solver's assembly stays visible as a wrong solution.

use super::constitutive::Tensor;
use crate::mesh::Mesh;

/// Adds ∫_K σ:ε(φ_a e_i) for the three shape functions of cell c to the nodal vector `force`; `mean` is the mean of σ
/// over K, `nodes` are the nodes of its vertices.
///
/// σ is symmetric, so the integrand is Σ_j σ_ij ∂_jφ_a, and by the divergence theorem
/// ∫_K ∇φ_a = ∫_∂K φ_a n = -½ |E_a| n_a with E_a the edge opposite vertex a: cells are positively oriented.
#[inline]
pub fn add_stress(mesh: &Mesh, c: usize, nodes: &[u32], mean: &Tensor<2>, force: &mut [f64]) {
    let corner = mesh.cell(c);
    for a in 0..3 {
        let (p, q) = (mesh.vertex(corner[(a + 1) % 3]), mesh.vertex(corner[(a + 2) % 3]));
        let inward = [0.5 * (p[1] - q[1]), 0.5 * (q[0] - p[0])];
        for i in 0..2 {
            force[2 * nodes[a] as usize + i] += mean[i][0] * inward[0] + mean[i][1] * inward[1];
        }
    }
}

/// Length of a facet.
pub fn length(mesh: &Mesh, facet: usize) -> f64 {
    let ends = mesh.facet(facet);
    let (p, q) = (mesh.vertex(ends[0]), mesh.vertex(ends[1]));
    (p[0] - q[0]).hypot(p[1] - q[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, rectangle};

    /// Nodal forces of one stress on every cell of a perturbed mesh, nodes numbered as vertices.
    fn forces(mesh: &Mesh, stress: &Tensor<2>) -> Vec<f64> {
        let mut force = vec![0.0; 2 * mesh.vertices()];
        for c in 0..mesh.cell_count() {
            add_stress(mesh, c, mesh.cell(c), stress, &mut force);
        }
        force
    }

    /// The work of the forces on v = (2x + 3y, -x + 5y): ε(v) = (2, 1; 1, 5).
    fn work(mesh: &Mesh, force: &[f64]) -> f64 {
        (0..mesh.vertices())
            .map(|v| {
                let x = mesh.vertex(v as u32);
                force[2 * v] * (2.0 * x[0] + 3.0 * x[1]) + force[2 * v + 1] * (5.0 * x[1] - x[0])
            })
            .sum()
    }

    #[test]
    fn work_on_an_affine_field_is_stress_times_strain_times_area() {
        let mesh = rectangle(
            [2.0, 1.0],
            3,
            Family::Perturbed { amplitude: 0.2, seed: 5, axes: [true; 3] },
        );
        let stress = [[1.0, -0.7], [-0.7, 0.4]];
        let exact = 2.0 * (1.0 * 2.0 + 2.0 * -0.7 * 1.0 + 0.4 * 5.0);
        let force = forces(&mesh, &stress);
        // Sums of some 300 terms of size 1.
        assert!((work(&mesh, &force) - exact).abs() < 1e-12);
        // A constant stress is in balance at every inner vertex.
        let inside = |v: usize| {
            let x = mesh.vertex(v as u32);
            x[0] > 0.0 && x[0] < 2.0 && x[1] > 0.0 && x[1] < 1.0
        };
        for v in (0..mesh.vertices()).filter(|&v| inside(v)) {
            assert!(force[2 * v].abs() < 1e-13 && force[2 * v + 1].abs() < 1e-13);
        }
    }

    #[test]
    fn a_stress_without_its_shear_or_a_cell_turned_round_is_seen() {
        let mut mesh = rectangle([2.0, 1.0], 3, Family::Structured);
        let exact = 2.0 * (1.0 * 2.0 + 2.0 * -0.7 * 1.0 + 0.4 * 5.0);
        let half = forces(&mesh, &[[1.0, -0.7], [0.0, 0.4]]);
        assert!((work(&mesh, &half) - exact).abs() > 0.1);
        mesh.cells.swap(0, 1);
        let turned = forces(&mesh, &[[1.0, -0.7], [-0.7, 0.4]]);
        assert!((work(&mesh, &turned) - exact).abs() > 0.1);
    }
}
