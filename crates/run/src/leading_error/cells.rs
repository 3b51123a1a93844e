//! Strains and nodal forces at the strain points of cells (one per cell for P1), in Mandel notation: S = 3 numbers in
//! the plane (xx, yy, √2 xy), 6 in space (xx, yy, zz, √2 yz, √2 xz, √2 xy).

use algebra::in_dimension;
use std::f64::consts::FRAC_1_SQRT_2;

use fem::contact::Discretization;
use fem::space::StrainPoint;

pub(super) type Mandel<const S: usize> = [f64; S];

/// Most unknowns of a cell: ten nodes in space.
const MOST: usize = 30;

pub(super) const fn dimension(numbers: usize) -> usize {
    if numbers == 3 { 2 } else { 3 }
}

/// The rows of ε at a point, ε(v) = Σ_a B_a v_a: in the plane B_a is [[g_x, 0], [0, g_y], [g_y, g_x]/√2].
fn rows<const S: usize>(at: &StrainPoint<'_>) -> [[f64; MOST]; S] {
    let mut rows = [[0.0; MOST]; S];
    let d = dimension(S);
    for (a, g) in at.gradients.chunks_exact(d).enumerate() {
        for i in 0..d {
            rows[i][d * a + i] = g[i];
        }
        // The shears: xy in the plane; yz, xz, xy in space, each given by the axis that it leaves out.
        for row in d..S {
            let (i, j) = if d == 2 { (0, 1) } else { ((row + 1) % 3, (row + 2) % 3) };
            rows[row][d * a + i] = FRAC_1_SQRT_2 * g[j];
            rows[row][d * a + j] = FRAC_1_SQRT_2 * g[i];
        }
    }
    rows
}

pub(super) fn product<const S: usize>(a: &Mandel<S>, b: &Mandel<S>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn strains<const S: usize>(space: &Discretization, nodal: &[f64]) -> Vec<Mandel<S>> {
    let d = dimension(S);
    let strain = |at: StrainPoint<'_>| {
        rows::<S>(&at).map(|row| {
            let term = |i: usize| row[i] * nodal[d * at.nodes[i / d] as usize + i % d];
            (0..d * at.nodes.len()).map(term).sum()
        })
    };
    space.points().map(strain).collect()
}

/// (a, b)_ℋ of tensors at the points.
pub(super) fn inner<const S: usize>(
    space: &Discretization,
    a: &[Mandel<S>],
    b: &[Mandel<S>],
) -> f64 {
    space.points().zip(a.iter().zip(b)).map(|(at, (a, b))| at.weight * product(a, b)).sum()
}

/// Adds the contribution of a point to v ↦ ∫ τ:ε(v).
pub(super) fn add_force<const S: usize>(
    at: &StrainPoint<'_>,
    tensor: &Mandel<S>,
    force: &mut [f64],
) {
    let (rows, d) = (rows::<S>(at), dimension(S));
    for i in 0..d * at.nodes.len() {
        let sum: f64 = (0..S).map(|m| rows[m][i] * tensor[m]).sum();
        force[d * at.nodes[i / d] as usize + i % d] += at.weight * sum;
    }
}

/// Adds the contribution of a point to the symmetric matrix of (w, v) ↦ ∫ D ε(w):ε(v).
pub(super) fn add_stiffness<const S: usize>(
    space: &Discretization,
    at: &StrainPoint<'_>,
    tangent: &[Mandel<S>; S],
    values: &mut [f64],
) {
    let rows = rows::<S>(at);
    let order = dimension(S) * at.nodes.len();
    let mut local = [0.0; MOST * MOST];
    for j in 0..order {
        let column: Mandel<S> = std::array::from_fn(|m| rows[m][j]);
        let stress: Mandel<S> = std::array::from_fn(|m| product(&tangent[m], &column));
        for i in 0..order {
            let sum: f64 = (0..S).map(|m| rows[m][i] * stress[m]).sum();
            local[order * i + j] = at.weight * sum;
        }
    }
    let local = &local[..order * order];
    in_dimension!(dimension(S), D => space.pattern.scatter::<D>(at.cell, at.nodes, local, values))
}
