//! Strains and nodal forces of P1 functions on the cells of a mesh, in Mandel notation: S = 3 numbers in the plane
//! (xx, yy, √2 xy), 6 in space (xx, yy, zz, √2 yz, √2 xz, √2 xy).

use std::f64::consts::FRAC_1_SQRT_2;

use fem::contact::Discretization;

/// A symmetric tensor.
pub(super) type Mandel<const S: usize> = [f64; S];

/// Unknowns of a cell: d(d + 1).
const fn unknowns(numbers: usize) -> usize {
    if numbers == 3 { 6 } else { 12 }
}

/// The rows of ε on a cell, ε(v) = Σ_a B_a v_a, as far as there are unknowns: in the plane B_a is
/// [[g_x, 0], [0, g_y], [g_y, g_x]/√2].
fn rows<const S: usize>(space: &Discretization, c: usize) -> [[f64; 12]; S] {
    let gradients = space.geometry.gradients(c);
    let mut rows = [[0.0; 12]; S];
    let d = space.mesh.dimension;
    for (a, g) in gradients.chunks_exact(d).enumerate() {
        for i in 0..d {
            rows[i][d * a + i] = g[i];
        }
        // The shears: xy in the plane; yz, xz, xy in space, each named by the axis that it leaves out.
        for row in d..S {
            let (i, j) = if d == 2 { (0, 1) } else { ((row + 1) % 3, (row + 2) % 3) };
            rows[row][d * a + i] = FRAC_1_SQRT_2 * g[j];
            rows[row][d * a + j] = FRAC_1_SQRT_2 * g[i];
        }
    }
    rows
}

/// Σ_i a_i b_i.
pub(super) fn product<const S: usize>(a: &Mandel<S>, b: &Mandel<S>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// ε of a nodal vector, one tensor per cell.
pub(super) fn strains<const S: usize>(space: &Discretization, nodal: &[f64]) -> Vec<Mandel<S>> {
    let d = space.mesh.dimension;
    let strain = |c: usize| {
        let nodes = space.cell_nodes(c);
        rows::<S>(space, c).map(|row| {
            let term = |i: usize| row[i] * nodal[d * nodes[i / d] as usize + i % d];
            (0..unknowns(S)).map(term).sum()
        })
    };
    (0..space.mesh.cell_count()).map(strain).collect()
}

/// (a, b)_ℋ of tensors constant on cells.
pub(super) fn inner<const S: usize>(
    space: &Discretization,
    a: &[Mandel<S>],
    b: &[Mandel<S>],
) -> f64 {
    let cells = space.geometry.measure.iter().zip(a.iter().zip(b));
    cells.map(|(measure, (a, b))| measure * product(a, b)).sum()
}

/// Adds v ↦ ∫ τ:ε(v) on a cell to a nodal vector.
pub(super) fn add_force<const S: usize>(
    space: &Discretization,
    c: usize,
    tensor: &Mandel<S>,
    force: &mut [f64],
) {
    let (nodes, measure) = (space.cell_nodes(c), space.geometry.measure[c]);
    let (rows, d) = (rows::<S>(space, c), space.mesh.dimension);
    for i in 0..unknowns(S) {
        let sum: f64 = (0..S).map(|m| rows[m][i] * tensor[m]).sum();
        force[d * nodes[i / d] as usize + i % d] += measure * sum;
    }
}

/// Adds (w, v) ↦ ∫ D ε(w):ε(v) on a cell to the values of a symmetric matrix.
pub(super) fn add_stiffness<const S: usize>(
    space: &Discretization,
    c: usize,
    tangent: &[Mandel<S>; S],
    values: &mut [f64],
) {
    let rows = rows::<S>(space, c);
    let measure = space.geometry.measure[c];
    let order = unknowns(S);
    let mut local = [0.0; 144];
    for j in 0..order {
        let column: Mandel<S> = std::array::from_fn(|m| rows[m][j]);
        let stress: Mandel<S> = std::array::from_fn(|m| product(&tangent[m], &column));
        for i in 0..order {
            let sum: f64 = (0..S).map(|m| rows[m][i] * stress[m]).sum();
            local[order * i + j] = measure * sum;
        }
    }
    let (nodes, local) = (space.cell_nodes(c), &local[..order * order]);
    match space.mesh.dimension {
        2 => space.pattern.scatter::<2>(c, nodes, local, values),
        _ => space.pattern.scatter::<3>(c, nodes, local, values),
    }
}
