//! What the answer of a solver to a case leaves of the discrete equations, and what its terms are.

use algebra::in_dimension;
use algebra::linalg::axpy;
use algebra::tensor::{Symmetric, norm};
use fem::contact::stress_force;
use scene::setup::{MeshData, Setup};
use vhi::history::TimeGrid;
use vhi::law::{Projection, TensorField};

/// The sum of forces by levels, the others times a factor.
pub(super) fn added(mut own: Vec<Vec<f64>>, factor: f64, others: &[Vec<f64>]) -> Vec<Vec<f64>> {
    own.iter_mut().zip(others).for_each(|(own, other)| axpy(factor, other, own));
    own
}

/// The answer of a solver to a case, and what it leaves.
pub(super) struct Left<'a> {
    pub(super) setup: &'a Setup,
    pub(super) data: &'a MeshData,
    pub(super) grid: TimeGrid,
    pub(super) u: Vec<Vec<f64>>,
    pub(super) pressures: Vec<Vec<f64>>,
    /// (σ, ε(v)) - F(v) by levels, with the law where its rule is not that of the vertices.
    pub(super) balance: Vec<Vec<f64>>,
    /// The largest force, and the residuals that count as none.
    pub(super) scale: f64,
    pub(super) sound: f64,
    /// Sums of the past as the answer has them, κ and ‖ε(u_n)‖, by levels.
    pub(super) histories: Vec<Vec<Vec<f64>>>,
    pub(super) kappa: Vec<f64>,
    pub(super) norms: Vec<f64>,
    pub(super) loads: Vec<Vec<f64>>,
    /// Rows that no force of contact reaches.
    pub(super) rows: Vec<usize>,
}

impl Left<'_> {
    /// The rows without contact of all levels, without what supports planes of symmetry.
    pub(super) fn long(&self, levels: &[Vec<f64>]) -> Vec<f64> {
        let of_level = |level: &Vec<f64>| {
            let mut level = level.clone();
            self.data.space.frames.without_support(&mut level);
            self.rows.iter().map(move |&row| level[row])
        };
        levels.iter().flat_map(of_level).collect()
    }

    /// (ℬ ε(v), ε(·)) by levels.
    pub(super) fn stiff(&self, law: &TensorField, v: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let space = &self.data.space;
        let values = space.stiffness(law);
        let of_level = |v: &Vec<f64>| {
            let mut out = vec![0.0; space.dofs()];
            space.pattern.multiply(&values, &v[..space.dofs()], &mut out);
            out
        };
        v.iter().map(of_level).collect()
    }

    /// The forces of sums over the past by levels, a sum a term.
    pub(super) fn remembered(&self, sums: &[Vec<Vec<f64>>]) -> Vec<Vec<f64>> {
        self.remembered_by(&TensorField::clone, sums)
    }

    /// The same with other tensors in the place of the terms' own.
    pub(super) fn remembered_by(
        &self,
        tensor: &dyn Fn(&TensorField) -> TensorField,
        sums: &[Vec<Vec<f64>>],
    ) -> Vec<Vec<f64>> {
        let none = vec![vec![0.0; self.data.space.dofs()]; sums.len()];
        self.setup.model.memory.iter().enumerate().fold(none, |forces, (i, term)| {
            let of_term: Vec<Vec<f64>> = sums.iter().map(|sums| sums[i].clone()).collect();
            added(forces, 1.0, &self.stiff(&tensor(&term.tensor), &of_term))
        })
    }

    /// The forces of the projection by levels for other limits; of the `whole` strain in place of its deviator.
    pub(super) fn projected(&self, kappa: &[f64], whole: bool) -> Vec<Vec<f64>> {
        let (space, projection) = (&*self.data.space, &self.setup.model.projection);
        let level = |(u, &kappa): (&Vec<f64>, &f64)| {
            let mut force = vec![0.0; space.nodes.len()];
            in_dimension!(space.mesh.dimension, D, S => {
                let mut shear: Symmetric<S> = [0.0; S];
                shear[S - 1] = 1.0;
                let mu = projection.stress(&shear, 0.0).map_or(0.0, |stress| stress[S - 1]);
                for at in space.points() {
                    let strain = at.strain::<S>(u);
                    let size = norm(&strain);
                    let of_whole = || strain.map(|e| mu * (1.0 - kappa / size) * e);
                    let stress = match whole {
                        true => (size > kappa).then(of_whole),
                        false => projection.stress(&strain, kappa),
                    };
                    if let Some(stress) = stress {
                        let stress = stress.map(|s| at.weight * s);
                        stress_force::<D, S>(at.gradients, at.nodes, &stress, &mut force);
                    }
                }
            });
            force.truncate(space.dofs());
            force
        };
        self.u.iter().zip(kappa).map(level).collect()
    }
}
