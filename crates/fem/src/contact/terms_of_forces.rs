//! How large the terms of nodal forces are before they cancel.

use super::assembly::strain_columns;
use super::case::StepView;
use super::{Discretization, Model};
use algebra::linalg::largest;
use vhi::law::{Projection, TensorField};

/// Unknowns of a cell, at most: a tetrahedron with 10 nodes has them.
const MOST_UNKNOWNS: usize = 30;

/// max_i Σ |B|ᵀ|C||B||v| over the points where strains live, with the penalty of jumps: over u with 𝒜 and the tangent of
/// the projection for C, and over each history with its ℬ_i. With v rounded to doubles the forces are off by half a unit of
/// rounding of it, whatever solves (Oettli and Prager 1964). A force.
pub(super) fn largest_terms<const D: usize, const S: usize>(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
) -> f64 {
    let mut sums = vec![0.0; space.nodes.len()];
    let bends = |strain: &[f64; S]| model.projection.response(strain, view.kappa);
    add_terms::<D, S>(space, &model.elasticity, view.u, &mut sums, |strain| {
        bends(strain).map(|response| response.tangent)
    });
    for (memory, history) in model.memory.iter().zip(view.history) {
        add_terms::<D, S>(space, &memory.tensor, history, &mut sums, |_| None);
    }
    largest(&sums)
}

/// Those of one tensor; `more` adds to its matrix at a strain.
fn add_terms<const D: usize, const S: usize>(
    space: &Discretization,
    law: &TensorField,
    v: &[f64],
    sums: &mut [f64],
    more: impl Fn(&[f64; S]) -> Option<[[f64; S]; S]>,
) {
    let mut columns = [[0.0; S]; MOST_UNKNOWNS];
    for at in space.points() {
        let columns = &mut columns[..at.gradients.len()];
        strain_columns::<D, S>(at.gradients, columns);
        let mut strain = [0.0; S];
        let at_nodes = at.nodes.iter().flat_map(|&node| &v[D * node as usize..][..D]);
        for (column, v) in columns.iter().zip(at_nodes) {
            strain.iter_mut().zip(column).for_each(|(sum, b)| *sum += (b * v).abs());
        }
        let matrix = law.on(space.region(at.cell)).matrix::<S>();
        let more = more(&at.strain(v)).unwrap_or([[0.0; S]; S]);
        let row = |(row, more): (&[f64; S], &[f64; S])| -> f64 {
            let sizes = row.iter().zip(more).map(|(c, more)| c.abs() + more.abs());
            at.weight * sizes.zip(&strain).map(|(c, e)| c * e).sum::<f64>()
        };
        let stress: Vec<f64> = matrix.iter().zip(&more).map(row).collect();
        for (node, columns) in at.nodes.iter().zip(columns.chunks_exact(D)) {
            for (sum, column) in sums[D * *node as usize..][..D].iter_mut().zip(columns) {
                *sum += column.iter().zip(&stress).map(|(b, s)| (b * s).abs()).sum::<f64>();
            }
        }
    }
    space.add_jump_terms::<D>(law, v, sums);
}
