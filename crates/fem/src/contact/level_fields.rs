//! What a solution of one time level is measured by, and the distance of two.

use super::nodal_norms::{l2_norm, strain_norm, trace_norm};
use super::{Discretization, Floors, Model, StepView};
use algebra::in_dimension;

/// What a solution of one time level is measured by.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LevelFields {
    /// u_n as a nodal vector.
    pub u: Vec<f64>,
    /// σ_n at the strain points, the numbers of each one after another (Mandel).
    pub stress: Vec<f64>,
    /// ξ_n + λ_n at the points of the trace.
    pub pressure: Vec<f64>,
}

impl LevelFields {
    /// The fields that `view` shows.
    pub fn of(space: &Discretization, model: &Model, view: &StepView<'_>) -> Self {
        let sum = view.compliance.iter().zip(view.multiplier).map(|(xi, lambda)| xi + lambda);
        Self {
            u: view.u.to_vec(),
            stress: in_dimension!(space.mesh.dimension, D, S => {
                space.points().flat_map(|at| view.stress_at::<S>(space, model, &at)).collect()
            }),
            pressure: sum.collect(),
        }
    }

    /// The distance of two solutions of one level in every norm.
    pub fn distance(&self, other: &Self, space: &Discretization) -> Floors {
        let minus =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let u = minus(&self.u, &other.u);
        let stress = minus(&self.stress, &other.stress);
        let numbers = stress.len() / space.geometry.points().max(1);
        let points = stress.chunks(numbers.max(1)).zip(space.points());
        let squares = points.map(|(s, at)| at.weight * s.iter().map(|s| s * s).sum::<f64>());
        let pressure = minus(&self.pressure, &other.pressure);
        let points = space.trace.points.iter().zip(&pressure);
        Floors {
            v: strain_norm(space, &u),
            l2: l2_norm(space, &u),
            stress: squares.sum::<f64>().sqrt(),
            trace: trace_norm(space, &u),
            pressure: points.map(|(at, p)| at.weight * p * p).sum::<f64>().sqrt(),
        }
    }
}
