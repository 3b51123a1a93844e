//! Nodal forces of the exact stress and pressure, from vertex positions and outward normals only.
//!
//! The solver multiplies σ by shape gradients in Mandel notation. Here the gradient is integrated over the boundary of
//! the cell, so that an error in the solver's assembly shows.

use std::ops::Range;

use super::constitutive::{Tensor, from_mandel};
use super::shapes::{MOST_STRAINS, Work};
use fem::contact::Discretization;
use fem::mesh::Mesh;

/// Adds ∫_K σ:ε(φ_a e_i) for the shape functions of cell c to the nodal vector `force`, by the `work` of its element;
/// `stress` is the projection of σ at its strain points (the mean over K for linear elements), and `nodes` are its nodes.
///
/// σ is symmetric, so the integrand is Σ_j σ_ij ∂_jφ_a, and by the divergence theorem ∫_K ∇λ_a = ∫_∂K λ_a n = -|F_a|
/// n_a/D with F_a the facet opposite vertex a: cells are positively oriented.
#[inline]
pub(crate) fn add_stress<const D: usize>(
    (mesh, work): (&Mesh, &Work),
    c: usize,
    nodes: &[u32],
    stress: &[Tensor<D>],
    force: &mut [f64],
) {
    let corner = mesh.cell(c);
    let mut inwards = [[0.0; D]; 4];
    for (a, opposite_corner) in inwards.iter_mut().enumerate().take(D + 1) {
        *opposite_corner = inward(mesh, corner, a);
    }
    work.each(stress, &inwards[..=D], |a, work: [f64; D]| {
        let target = &mut force[D * nodes[a] as usize..][..D];
        target.iter_mut().zip(work).for_each(|(target, w)| *target += w);
    });
}

/// Adds a force of given size along a unit vector at a point of the trace.
pub(super) fn add_force_along(
    space: &Discretization,
    point: usize,
    direction: [f64; 3],
    size: f64,
    force: &mut [f64],
) {
    let d = space.mesh.dimension;
    let vertex = space.trace.points[point].vertex;
    let node = space.nodes.of_vertex[vertex as usize] as usize;
    for (j, component) in direction[..d].iter().enumerate() {
        force[d * node + j] += size * component;
    }
}

/// Adds ∫ σ:ε(v) over some cells from the projection of σ at their strain points, in the notation of moments.
pub(super) fn add_means<const D: usize>(
    (space, work): (&Discretization, &Work),
    cells: Range<usize>,
    means: &[f64],
    force: &mut [f64],
) {
    let (numbers, points) = (D * (D + 1) / 2, work.points());
    let (at, mut stress) = ((&space.mesh, work), [[[0.0; D]; D]; MOST_STRAINS]);
    for (c, cell_means) in cells.zip(means.chunks_exact(numbers * points)) {
        let tensors = cell_means.chunks_exact(numbers).map(from_mandel::<D, f64>);
        stress.iter_mut().zip(tensors).for_each(|(stress, tensor)| *stress = tensor);
        add_stress(at, c, space.cell_nodes(c), &stress[..points], force);
    }
}

pub(super) fn force_of_means<const D: usize>(space: &Discretization, means: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; space.nodes.len()];
    let work = Work::new(space.element, D);
    add_means::<D>((space, &work), 0..space.mesh.cell_count(), means, &mut force);
    force
}

/// The other corners of a positively oriented tetrahedron, counter-clockwise from outside.
const OPPOSITE: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// -|F_a| n_a/D.
#[inline]
pub(super) fn inward<const D: usize>(mesh: &Mesh, corner: &[u32], a: usize) -> [f64; D] {
    if D == 2 {
        let (p, q) = (mesh.vertex(corner[(a + 1) % 3]), mesh.vertex(corner[(a + 2) % 3]));
        let normal = [0.5 * (p[1] - q[1]), 0.5 * (q[0] - p[0])];
        return std::array::from_fn(|i| normal[i]);
    }
    let twice = doubled_area(mesh, &OPPOSITE[a].map(|b| corner[b]));
    std::array::from_fn(|i| -twice[i] / 6.0)
}

/// (q - p) × (r - p) of a triangle in space.
fn doubled_area(mesh: &Mesh, corner: &[u32]) -> [f64; 3] {
    let [p, q, r] = [0, 1, 2].map(|a| mesh.vertex(corner[a]));
    let (e, f): ([f64; 3], [f64; 3]) =
        (std::array::from_fn(|i| q[i] - p[i]), std::array::from_fn(|i| r[i] - p[i]));
    [0, 1, 2].map(|i| e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3])
}

pub(crate) fn facet_measure(mesh: &Mesh, facet: usize) -> f64 {
    let corner = mesh.facet(facet);
    if corner.len() == 2 {
        let (p, q) = (mesh.vertex(corner[0]), mesh.vertex(corner[1]));
        return (p[0] - q[0]).hypot(p[1] - q[1]);
    }
    let [x, y, z] = doubled_area(mesh, corner);
    0.5 * x.hypot(y).hypot(z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::mesh::{Family, lattice};
    use fem::space::Element;

    /// Nodal forces of one stress on every cell of a perturbed mesh, nodes numbered as vertices.
    fn forces(mesh: &Mesh, stress: &Tensor<2>) -> Vec<f64> {
        let mut force = vec![0.0; 2 * mesh.vertices()];
        for c in 0..mesh.cell_count() {
            add_stress(
                (mesh, &Work::new(Element::P1, mesh.dimension)),
                c,
                mesh.cell(c),
                std::slice::from_ref(stress),
                &mut force,
            );
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
        let mesh =
            lattice([2.0, 1.0], 3, Family::Perturbed { amplitude: 0.2, seed: 5, axes: [true; 3] });
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
        let mut mesh = lattice([2.0, 1.0], 3, Family::Structured);
        let exact = 2.0 * (1.0 * 2.0 + 2.0 * -0.7 * 1.0 + 0.4 * 5.0);
        let half = forces(&mesh, &[[1.0, -0.7], [0.0, 0.4]]);
        assert!((work(&mesh, &half) - exact).abs() > 0.1);
        mesh.cells.swap(0, 1);
        let turned = forces(&mesh, &[[1.0, -0.7], [-0.7, 0.4]]);
        assert!((work(&mesh, &turned) - exact).abs() > 0.1);
    }

    const STRESS: Tensor<3> = [[1.0, -0.7, 0.3], [-0.7, 0.4, 0.6], [0.3, 0.6, -0.9]];

    /// Work on v = (2x + 3y - z, -x + 5y + 4z, 6x - 2y + 7z) over the volume: ε(v) has the diagonal (2, 5, 7) and the
    /// shears xy 1, xz 5/2, yz 1.
    fn work_in_space(mesh: &Mesh, stress: &Tensor<3>) -> f64 {
        let mut force = vec![0.0; 3 * mesh.vertices()];
        for c in 0..mesh.cell_count() {
            add_stress(
                (mesh, &Work::new(Element::P1, mesh.dimension)),
                c,
                mesh.cell(c),
                std::slice::from_ref(stress),
                &mut force,
            );
        }
        let at = |v: usize| {
            let [x, y, z] = mesh.point(&[v as u32], &[1.0]);
            [2.0 * x + 3.0 * y - z, -x + 5.0 * y + 4.0 * z, 6.0 * x - 2.0 * y + 7.0 * z]
        };
        (0..mesh.vertices()).map(|v| (0..3).map(|i| force[3 * v + i] * at(v)[i]).sum::<f64>()).sum()
    }

    #[test]
    fn tetrahedra_do_the_work_of_stress_on_strain() {
        let diagonal = 1.0 * 2.0 + 0.4 * 5.0 - 0.9 * 7.0;
        let exact = diagonal + 2.0 * (-0.7 * 1.0 + 0.3 * 2.5 + 0.6 * 1.0);
        let family = Family::Perturbed { amplitude: 0.15, seed: 5, axes: [true; 3] };
        let mut mesh = lattice([2.0, 1.0, 0.5], 2, family);
        // Sums of some 1000 terms of size 1.
        assert!((work_in_space(&mesh, &STRESS) - exact).abs() < 1e-12);
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let mut dropped = STRESS;
            (dropped[i][j], dropped[j][i]) = (0.0, 0.0);
            assert!((work_in_space(&mesh, &dropped) - exact).abs() > 0.1, "{i} {j}");
        }
        mesh.cells.swap(0, 1);
        assert!((work_in_space(&mesh, &STRESS) - exact).abs() > 1e-3);
    }

    #[test]
    fn facets_of_a_box_have_its_surface() {
        let mesh = lattice([2.0, 1.0, 0.5], 2, Family::Structured);
        let sum: f64 = (0..mesh.facet_side.len()).map(|f| facet_measure(&mesh, f)).sum();
        assert!((sum - 2.0 * (2.0 + 1.0 + 0.5)).abs() < 1e-13, "{sum}");
        assert!((facet_measure(&mesh, 0) - 0.125).abs() < 1e-16);
    }
}
