//! The discrete solution as the audit reads it: u_j^{kh} and λ_n alone; strains, ζ and θ of (4.2) by
//! trapezoidal sums made here.

use super::pointwise::{PlainMaterial, Plane, dot};
use algebra::linalg::axpy;
use fem::contact::Discretization;
use vhi::history::TimeGrid;

/// The past of a run.
#[derive(Default)]
pub(crate) struct Past {
    /// u_j^{kh}, clamped nodes included.
    pub displacements: Vec<Vec<f64>>,
    /// ‖ε(u_j^{kh})‖.
    pub norms: Vec<f64>,
}

/// One level of a run.
pub(crate) struct DiscreteLevel {
    /// ε(u_n^{kh}) at the strain points: one a cell, or as many as determine a linear tensor.
    pub strain: Vec<Plane>,
    /// ψ_h with φ(S_n^{kh}u^{kh}, u_n^{kh}, v) = (ψ_h, ε(v)), there.
    pub coupled: Vec<Plane>,
    /// θ_h there.
    pub theta: Vec<Plane>,
    /// κ(ζ̃(t_n)).
    pub kappa: f64,
    /// ζ̃(t_n).
    pub zeta: f64,
}

/// Weights of Σ' for j = 0, …, n: half of the neighbouring steps.
pub(crate) fn primed_weights(grid: &TimeGrid, n: usize) -> Vec<f64> {
    let times = &grid.times()[..=n];
    let mut weights = vec![0.0; n + 1];
    for (j, pair) in times.windows(2).enumerate() {
        weights[j] += 0.5 * (pair[1] - pair[0]);
        weights[j + 1] += 0.5 * (pair[1] - pair[0]);
    }
    weights
}

/// These weights times b(t_n - t_j).
pub(crate) fn kernel_weights(
    material: &PlainMaterial,
    grid: &TimeGrid,
    mut weights: Vec<f64>,
) -> Vec<f64> {
    let now = grid.time(weights.len() - 1);
    weights.iter_mut().zip(grid.times()).for_each(|(w, t)| *w *= material.kernel(now - t));
    weights
}

/// ε of a nodal vector at all strain points.
pub(crate) fn strains(space: &Discretization, nodal: &[f64]) -> Vec<Plane> {
    space.points().map(|at| at.strain(nodal)).collect()
}

impl Past {
    pub(crate) fn level(
        &mut self,
        space: &Discretization,
        material: &PlainMaterial,
        grid: &TimeGrid,
        u: &[f64],
    ) -> DiscreteLevel {
        let strain = strains(space, u);
        let squares = strain.iter().zip(space.points()).map(|(e, at)| at.weight * dot(e, e));
        self.norms.push(squares.sum::<f64>().sqrt());
        self.displacements.push(u.to_vec());
        let weights = primed_weights(grid, self.norms.len() - 1);
        let zeta = weights.iter().zip(&self.norms).map(|(w, e)| w * e).sum();
        let mut history = vec![0.0; u.len()];
        if material.remembers() {
            let factors = kernel_weights(material, grid, weights);
            factors.iter().zip(&self.displacements).for_each(|(w, u)| axpy(*w, u, &mut history));
        }
        let theta: Vec<Plane> =
            strains(space, &history).iter().map(|h| material.remembered(h)).collect();
        let kappa = material.kappa(zeta);
        let coupled =
            strain.iter().zip(&theta).map(|(e, theta)| material.coupled(e, theta, kappa)).collect();
        DiscreteLevel { strain, coupled, theta, kappa, zeta }
    }
}
