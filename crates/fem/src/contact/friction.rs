//! Friction in a time level. A bound that follows p is that of the state whose residual was evaluated last; its slope in
//! u_ν is an entry of the Jacobian without a mirror image.

use std::sync::Arc;

use super::ContactProblem;
use super::trace::TracePoint;
use algebra::linalg::NonsymmetricEntry;
use vhi::StepState;

impl ContactProblem<'_> {
    /// Sets friction to time t: the laws of the last graphs, or the factors of p in them.
    pub(super) fn set_friction(&mut self, t: f64) {
        let Some(friction) = &self.model.friction else { return };
        let free = self.space.trace.points.iter().filter(|point| point.carries());
        let factor = |point: &TracePoint| {
            (friction.factor)(self.space.mesh.point(&[point.vertex], &[1.0]), t)
        };
        if friction.follows_pressure {
            self.following.factors.clear();
            self.following.factors.extend(free.map(factor));
            return;
        }
        for (point, law) in free.rev().zip(self.graph.potentials.iter_mut().rev()) {
            *law = Arc::new(friction.scaled(factor(point), 1.0));
        }
    }

    /// Sets laws that follow p to the present unknowns. The graphs of the normal law come first, in the same order.
    pub(super) fn follow_pressure(&mut self) {
        let Some(friction) = &self.model.friction else { return };
        let m = self.space.mesh.dimension - 1;
        let first = self.graph.coordinates.len() - m * self.following.factors.len();
        for (i, &factor) in self.following.factors.iter().enumerate() {
            let p = self.graph.value_and_slope(i, 0, self.graph.normal(i, &self.unknowns)).0;
            let law = self.graph.coordinates[first + m * i].law as usize;
            self.graph.potentials[law] = Arc::new(friction.scaled(factor, p));
        }
    }

    /// ∂(w s)/∂u_ν = w (s/p) p'(u_ν) where the friction follows p and slips. A prescribed u_ν has its part moved to the
    /// right side instead.
    pub(super) fn couple(&mut self, prescribed: &[Option<f64>]) {
        let (graph, m) = (&self.graph, self.space.mesh.dimension - 1);
        let first = self.graph.coordinates.len() - m * self.following.factors.len();
        self.jacobian.couplings.clear();
        for j in 0..m * self.following.factors.len() {
            let i = j / m;
            let (normal, tangential) = (&graph.coordinates[i], &graph.coordinates[first + j]);
            let (p, slope) = graph.value_and_slope(i, 0, graph.normal(i, &self.unknowns));
            let s = self.following.pressures.get(first + j).copied().unwrap_or(0.0);
            if prescribed[first + j].is_some() || p <= 0.0 {
                continue;
            }
            let value = tangential.sign * normal.sign * tangential.weight * slope * s / p;
            match prescribed[i] {
                Some(increment) => self.lifted.push((tangential.dof as usize, value * increment)),
                None => self.jacobian.couplings.push(NonsymmetricEntry {
                    row: tangential.dof as usize,
                    column: normal.dof as usize,
                    value,
                }),
            }
        }
    }

    /// Adds what rounding of u_ν moves in friction that follows p: its part s/p of what it moves in p.
    pub(super) fn add_rounding_of_friction(&self, state: &StepState, sizes: &mut [f64]) {
        let (graph, m) = (&self.graph, self.space.mesh.dimension - 1);
        let first = graph.coordinates.len() - m * self.following.factors.len();
        for j in 0..m * self.following.factors.len() {
            let (normal, tangential) = (&graph.coordinates[j / m], &graph.coordinates[first + j]);
            let (p, s) = (state.pressure[j / m], state.pressure[first + j]);
            if p > 0.0 {
                let of_p = sizes[normal.dof as usize];
                sizes[tangential.dof as usize] += of_p * s.abs() / p;
            }
        }
    }

    /// Adds the slopes between the two unknowns of each vector, which stand behind those of the coordinates.
    pub(super) fn add_mixed(&self, slopes: &[f64], tangent: &mut [f64]) {
        let coordinates = &self.graph.coordinates;
        let pairs = coordinates.windows(2).filter(|pair| pair[0].span > 1);
        for (slope, pair) in slopes[coordinates.len()..].iter().zip(pairs) {
            let at = [pair[0].dof as usize, pair[1].dof as usize];
            self.space.pattern.add(at, *slope, tangent);
        }
    }

    /// From then on solves are with the transposed Jacobian, or again with the Jacobian. The level is frozen: no piece of
    /// its history makes the Jacobian unsymmetric.
    pub(super) fn transpose(&mut self) {
        self.jacobian.transpose_couplings();
    }
}
