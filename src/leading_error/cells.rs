//! Strains and nodal forces of P1 functions on the cells of a plane mesh, in Mandel notation (xx, yy, √2 xy).

use std::f64::consts::FRAC_1_SQRT_2;

use crate::contact::Discretization;

/// A symmetric tensor of the plane.
pub(super) type Mandel = [f64; 3];

/// The rows of ε on a cell: ε(v) = Σ_a B_a v_a with B_a = [[g_x, 0], [0, g_y], [g_y, g_x]/√2].
fn rows(space: &Discretization, c: usize) -> [[f64; 6]; 3] {
    let gradients = space.geometry.gradients(c);
    let mut rows = [[0.0; 6]; 3];
    for a in 0..3 {
        let (x, y) = (gradients[2 * a], gradients[2 * a + 1]);
        rows[0][2 * a] = x;
        rows[1][2 * a + 1] = y;
        rows[2][2 * a] = FRAC_1_SQRT_2 * y;
        rows[2][2 * a + 1] = FRAC_1_SQRT_2 * x;
    }
    rows
}

/// Σ_i a_i b_i.
pub(super) fn product(a: &Mandel, b: &Mandel) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// ε of a nodal vector, one tensor a cell.
pub(super) fn strains(space: &Discretization, nodal: &[f64]) -> Vec<Mandel> {
    let strain = |c: usize| {
        let nodes = space.cell_nodes(c);
        rows(space, c).map(|row| {
            let term = |i: usize| row[i] * nodal[2 * nodes[i / 2] as usize + i % 2];
            (0..6).map(term).sum()
        })
    };
    (0..space.mesh.cell_count()).map(strain).collect()
}

/// (a, b)_ℋ of tensors constant on cells.
pub(super) fn inner(space: &Discretization, a: &[Mandel], b: &[Mandel]) -> f64 {
    let cells = space.geometry.measure.iter().zip(a.iter().zip(b));
    cells.map(|(measure, (a, b))| measure * product(a, b)).sum()
}

/// Adds v ↦ ∫ τ:ε(v) on a cell to a nodal vector.
pub(super) fn add_force(space: &Discretization, c: usize, tensor: &Mandel, force: &mut [f64]) {
    let (nodes, measure) = (space.cell_nodes(c), space.geometry.measure[c]);
    let rows = rows(space, c);
    for i in 0..6 {
        let sum: f64 = (0..3).map(|m| rows[m][i] * tensor[m]).sum();
        force[2 * nodes[i / 2] as usize + i % 2] += measure * sum;
    }
}

/// Adds (w, v) ↦ ∫ D ε(w):ε(v) on a cell to the values of a symmetric matrix.
pub(super) fn add_stiffness(
    space: &Discretization,
    c: usize,
    tangent: &[Mandel; 3],
    values: &mut [f64],
) {
    let rows = rows(space, c);
    let measure = space.geometry.measure[c];
    let mut local = [0.0; 36];
    for j in 0..6 {
        let column = [0, 1, 2].map(|m| rows[m][j]);
        let stress = tangent.map(|row| product(&row, &column));
        for i in 0..6 {
            let sum: f64 = (0..3).map(|m| rows[m][i] * stress[m]).sum();
            local[6 * i + j] = measure * sum;
        }
    }
    space.pattern.scatter::<2>(c, space.cell_nodes(c), &local, values);
}
