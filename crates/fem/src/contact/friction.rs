//! Friction on Γ3: -σ_τ = s ∈ S ∂|u_τ|, S = c(x, t) S_0(|u_τ|), or that times p(u_ν), p = ∂j_ν.
//!
//! r ↦ S(|r|) sign r is the graph of a potential with one jump, at r = 0, which is a vertex that sticks. So it is solved as
//! the normal law is: a graph on the unknown that carries u_τ, at each vertex with the weight of the vertex rule; in space
//! on the vector of the two unknowns that carry it. These graphs stand behind those of the normal law, one a tangent of each
//! free point. A bound that follows p is that of the state whose residual was evaluated last; its slope in u_ν is an entry
//! of the Jacobian without a mirror image.

use std::sync::Arc;

use super::trace::{Tangential, TracePoint};
use super::{ContactProblem, Discretization, Model};
use algebra::linalg::NonsymmetricEntry;
use vhi::law::{NoPotential, Potential, Scaled};
use vhi::{BoundaryGraph, Coordinate, StepState};

/// A function on Γ3 × [0, T].
pub type OnContactInTime = Box<dyn Fn([f64; 3], f64) -> f64 + Send + Sync>;

/// The law of friction: at x and t the graph is c(x, t) times that of S_0, or c(x, t) p(u_ν) times it.
pub struct Friction {
    /// c(x, t) ≥ 0 at a point of Γ3.
    pub factor: OnContactInTime,
    /// r ↦ S_0(|r|) sign r, odd, with its jump at 0: a stress, or a number where S follows p.
    pub graph: Arc<dyn Potential>,
    /// True where S = c S_0 p(u_ν): p ≥ 0 alone, without the multiplier λ, and without jumps, by the vertex rule.
    pub follows_pressure: bool,
}

impl Friction {
    /// The graph at a point of Γ3 where p(u_ν) = `pressure`.
    pub fn at(&self, x: [f64; 3], t: f64, pressure: f64) -> Scaled {
        self.scaled((self.factor)(x, t), pressure)
    }

    pub(super) fn scaled(&self, factor: f64, pressure: f64) -> Scaled {
        let followed = if self.follows_pressure { pressure } else { 1.0 };
        Scaled { potential: self.graph.clone(), factor: factor * followed }
    }
}

/// Friction that follows p, at the open level: empty where it does not.
#[derive(Default)]
pub(super) struct Following {
    /// c(x, t) at the free points of the trace.
    pub(super) factors: Vec<f64>,
    /// The pressures of all graphs on the pieces that were chosen last.
    pub(super) pressures: Vec<f64>,
}

/// Appends the graphs of friction, one a free point of the trace in its order, without their laws, which
/// `ContactProblem::set_friction` gives at each time.
pub(super) fn append_graphs(
    space: &Discretization,
    model: &Model,
    elastic: &[f64],
    graph: &mut BoundaryGraph,
) {
    if model.friction.is_none() {
        return;
    }
    for point in space.trace.points.iter().filter(|point| point.carries()) {
        let unknowns = point.tangential_unknowns(space);
        let stiffness = |at: &Tangential| elastic[space.pattern.diagonal(at.unknown as usize)];
        let stiffness = unknowns.iter().map(stiffness).sum::<f64>() / unknowns.len() as f64;
        for (k, Tangential { unknown, sign }) in unknowns.iter().enumerate() {
            graph.coordinates.push(Coordinate {
                dof: *unknown,
                sign: *sign,
                weight: point.weight,
                gap: f64::INFINITY,
                floor: f64::NEG_INFINITY,
                law: graph.potentials.len() as u32,
                shift: 0.0,
                // As for the normal law: a vertex changes its side of the jump by way of the jump.
                gamma: point.weight / stiffness,
                span: if k == 0 { unknowns.len() as u8 } else { 0 },
            });
        }
        graph.potentials.push(Arc::new(NoPotential));
    }
}

/// The multipliers s of the last graphs, at the points of the trace; 0 on Γ1.
pub(super) fn show(space: &Discretization, pressures: &[f64], shown: &mut [f64]) {
    let m = space.mesh.dimension - 1;
    let points = space.trace.points.iter().zip(shown.chunks_exact_mut(m));
    let free = points.filter(|(point, _)| point.carries());
    for ((_, at_point), s) in free.rev().zip(pressures.rchunks_exact(m)) {
        at_point.copy_from_slice(s);
    }
}

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
