//! Bᵀσ and BᵀCB at the points where strains live, and their scatter.

use super::{Discretization, Frames};
use crate::space::StrainPoint;
use algebra::in_dimension;
use algebra::tensor::off_diagonal;
use vhi::law::TensorField;

/// The columns of B at a point of a cell: the Mandel strain of each unit displacement.
#[inline]
fn strain_columns<const D: usize, const S: usize>(gradients: &[f64], out: &mut [[f64; S]]) {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (g, columns) in gradients.chunks_exact(D).zip(out.chunks_exact_mut(D)) {
        columns.fill([0.0; S]);
        for (i, column) in columns.iter_mut().enumerate() {
            column[i] = g[i];
        }
        for (k, &(i, j)) in off_diagonal(D).iter().enumerate() {
            columns[i][D + k] = half * g[j];
            columns[j][D + k] = half * g[i];
        }
    }
}

/// Unknowns of a cell of any element: a tetrahedron with 10 nodes has the most.
const MOST_UNKNOWNS: usize = 30;

/// Room for the matrix of a cell.
pub(crate) const ROOM: usize = MOST_UNKNOWNS * MOST_UNKNOWNS;

/// The leading part of `room` ← weight · Bᵀ C B of a point, row-major of order D times the nodes of its cell.
#[inline]
pub(crate) fn point_stiffness<'a, const D: usize, const S: usize>(
    at: &StrainPoint<'_>,
    law: &[[f64; S]; S],
    room: &'a mut [f64; ROOM],
) -> &'a mut [f64] {
    let (order, weight) = (at.gradients.len(), at.weight);
    let local = &mut room[..order * order];
    let mut columns = [[0.0; S]; MOST_UNKNOWNS];
    strain_columns::<D, S>(at.gradients, &mut columns[..order]);
    for j in 0..order {
        let mut stress = [0.0; S];
        for (p, row) in law.iter().enumerate() {
            for q in 0..S {
                stress[p] += row[q] * columns[j][q];
            }
        }
        for i in j..order {
            let mut sum = 0.0;
            for p in 0..S {
                sum += columns[i][p] * stress[p];
            }
            local[order * i + j] = weight * sum;
            local[order * j + i] = weight * sum;
        }
    }
    local
}

/// Adds the work σ:ε(v) of a point of a cell to the nodal vector `force`, for the stress there times the weight of the
/// point, `stress`.
#[inline]
pub fn stress_force<const D: usize, const S: usize>(
    gradients: &[f64],
    nodes: &[u32],
    stress: &[f64; S],
    force: &mut [f64],
) {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (g, &node) in gradients.chunks_exact(D).zip(nodes) {
        let out = &mut force[D * node as usize..D * node as usize + D];
        let mut sums: [f64; D] = std::array::from_fn(|i| stress[i] * g[i]);
        for (k, &(i, j)) in off_diagonal(D).iter().enumerate() {
            sums[i] += half * stress[D + k] * g[j];
            sums[j] += half * stress[D + k] * g[i];
        }
        out.iter_mut().zip(sums).for_each(|(out, sum)| *out += sum);
    }
}

impl Discretization {
    /// Lower-triangle values of the stiffness matrix of a tensor, in Cartesian components.
    pub fn stiffness(&self, law: &TensorField) -> Vec<f64> {
        in_dimension!(self.mesh.dimension, D, S => self.stiffness_in::<D, S>(law, &Frames::default()))
    }

    /// Lower-triangle values of the stiffness matrix, in the unknowns of the contact problem.
    pub(crate) fn stiffness_of_unknowns(&self, law: &TensorField) -> Vec<f64> {
        in_dimension!(self.mesh.dimension, D, S => self.stiffness_in::<D, S>(law, &self.frames))
    }

    fn stiffness_in<const D: usize, const S: usize>(
        &self,
        law: &TensorField,
        frames: &Frames,
    ) -> Vec<f64> {
        let (mut values, mut room) = (vec![0.0; self.pattern.entries()], [0.0; ROOM]);
        for at in self.points() {
            let matrix = law.on(self.region(at.cell)).matrix::<S>();
            let local = point_stiffness::<D, S>(&at, &matrix, &mut room);
            frames.rotate_cell(at.nodes, local);
            self.pattern.scatter::<D>(at.cell, at.nodes, local, &mut values);
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::strain_of;

    /// B by columns, Bᵀσ and the strain of a nodal vector are one operator, in both dimensions.
    fn one_operator<const D: usize, const S: usize>(gradients: &[f64]) {
        let nodes: Vec<u32> = (0..=D as u32).collect();
        let order = D * (D + 1);
        let v: Vec<f64> = (0..order).map(|i| (i as f64 * 0.7).sin()).collect();
        let stress: [f64; S] = std::array::from_fn(|i| 1.0 + i as f64);
        let mut columns = [[0.0; S]; 12];
        strain_columns::<D, S>(gradients, &mut columns[..order]);
        let strain = strain_of::<S>(gradients, &nodes, &v);
        let mut force = vec![0.0; order];
        stress_force::<D, S>(gradients, &nodes, &stress, &mut force);
        let work: f64 = force.iter().zip(&v).map(|(f, v)| f * v).sum();
        let density: f64 = strain.iter().zip(&stress).map(|(e, s)| e * s).sum();
        assert!((work - density).abs() < 1e-13);
        for p in 0..S {
            let sum: f64 = (0..order).map(|i| columns[i][p] * v[i]).sum();
            assert!((sum - strain[p]).abs() < 1e-14);
        }
    }

    #[test]
    fn strain_and_force_are_adjoint() {
        one_operator::<2, 3>(&[-1.3, -0.4, 0.9, -0.6, 0.4, 1.0]);
        one_operator::<3, 6>(&[-1.0, -0.8, -1.1, 1.0, 0.3, 0.2, -0.2, 0.9, 0.1, 0.2, -0.4, 0.8]);
    }
}
