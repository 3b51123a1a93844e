//! Friction on Γ3, as it enters the discrete scheme: -σ_τ = s ∈ S ∂|u_τ|, S = c(x, t) S_0(|u_τ|), or that times p(u_ν),
//! p = ∂j_ν.
//!
//! r ↦ S(|r|) sign r is the graph of a potential with one jump, at r = 0, which is a vertex that sticks. So it is solved as
//! the normal law is: a graph on the unknown that carries u_τ, at each vertex with the weight of the vertex rule; in space
//! on the vector of the two unknowns that carry it. A bound
//! that follows p is that of the state whose residual was evaluated last; its slope in u_ν is an entry of the Jacobian
//! without a mirror image.

use std::sync::Arc;

use super::trace::TracePoint;
use super::{ContactProblem, Discretization, Model, StepView};
use algebra::linalg::NonsymmetricEntry;
use vhi::law::{Potential, Projection, Scaled, graph_distance};
use vhi::{BoundaryGraph, Coordinate};

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

    fn scaled(&self, factor: f64, pressure: f64) -> Scaled {
        let followed = if self.follows_pressure { pressure } else { 1.0 };
        Scaled { potential: self.graph.clone(), factor: factor * followed }
    }
}

/// Friction that follows p, at the open level: empty where it does not.
#[derive(Default)]
pub(super) struct Following {
    /// c(x, t) at the free points of the trace.
    factors: Vec<f64>,
    /// The pressures of all graphs on the pieces that were chosen last.
    pressures: Vec<f64>,
    /// Its part of the Jacobian.
    entries: Vec<NonsymmetricEntry>,
}

impl Following {
    pub(super) fn take_pressures(&mut self, pressures: &[f64]) {
        if !self.factors.is_empty() {
            self.pressures.clear();
            self.pressures.extend_from_slice(pressures);
        }
    }
}

/// Where a point of the trace carries u_τ along one tangent = sign · unknown.
struct Tangential {
    unknown: u32,
    sign: f64,
}

/// A component of a unit vector that is zero but for rounding.
const ALONG_AXIS: f64 = 1e-12;

impl TracePoint {
    /// The unit tangent in the plane, towards growing x, or growing y on a side along y.
    pub fn tangent(&self) -> [f64; 2] {
        let [x, y, _] = self.normal;
        if y < -ALONG_AXIS || (y <= ALONG_AXIS && x > 0.0) { [-y, x] } else { [y, -x] }
    }

    /// The d - 1 unit tangents along which u_τ and s are given, orthogonal to each other and to ν.
    pub fn tangents(&self) -> impl Iterator<Item = &[f64]> {
        let d = usize::from(self.dimension);
        self.tangents[..d - 1].iter().map(move |tangent| &tangent[..d])
    }

    /// u_τ of a nodal vector along the tangents; its second number is 0 in the plane.
    pub fn slip(&self, u: &[f64]) -> [f64; 2] {
        let own = &u[usize::from(self.dimension) * self.node as usize..];
        let along = |tangent: &[f64]| tangent.iter().zip(own).map(|(t, u)| t * u).sum();
        let mut slip = [0.0; 2];
        slip.iter_mut().zip(self.tangents()).for_each(|(slip, tangent)| *slip = along(tangent));
        slip
    }

    /// Adds the tangential force with these components along the tangents to forces by nodes.
    pub(super) fn add_tangential(&self, components: &[f64], force: &mut [f64]) {
        let own = &mut force[usize::from(self.dimension) * self.node as usize..];
        for (value, tangent) in components.iter().zip(self.tangents()) {
            own.iter_mut().zip(tangent).for_each(|(force, along)| *force += value * along);
        }
    }

    /// The unknowns of u_τ: the other Cartesian ones, or those of a frame behind the first.
    fn tangential_unknowns(&self, space: &Discretization) -> Vec<Tangential> {
        let d = usize::from(self.dimension);
        let frame = space.frames.rows().find(|(node, _)| *node == self.node as usize);
        let unknown = |(k, tangent): (usize, &[f64])| {
            let (component, sign) = match &frame {
                Some((_, rows)) => {
                    let row = &rows[d * (k + 1)..];
                    let along: f64 = row.iter().zip(tangent).map(|(row, t)| row * t).sum();
                    (k + 1, along.signum())
                }
                None => {
                    let axis = tangent.iter().position(|own| *own != 0.0).unwrap_or(0);
                    (axis, tangent[axis])
                }
            };
            Tangential { unknown: (d * self.node as usize + component) as u32, sign }
        };
        self.tangents().enumerate().map(unknown).collect()
    }
}

/// Appends the graphs of friction, one a free point of the trace in its order, without their laws, which
/// [`set_laws`] gives at each time.
pub(super) fn append_graphs<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    elastic: &[f64],
    graph: &mut BoundaryGraph,
) {
    if model.friction.is_none() {
        return;
    }
    for point in space.trace.points.iter().filter(|point| point.carries()) {
        let own = point.tangential_unknowns(space);
        let stiffness = |at: &Tangential| elastic[space.pattern.diagonal(at.unknown as usize)];
        let stiffness = own.iter().map(stiffness).sum::<f64>() / own.len() as f64;
        for (k, Tangential { unknown, sign }) in own.iter().enumerate() {
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
                span: if k == 0 { own.len() as u8 } else { 0 },
            });
        }
        graph.potentials.push(Arc::new(vhi::law::NoPotential));
    }
}

impl<P: Projection> ContactProblem<'_, P> {
    /// Friction as it is at time t: the laws of the last graphs, or what p is multiplied by in them.
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

    /// Laws that follow p, as they are at the present unknowns. The graphs of the normal law come first, in the same order.
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
        self.following.entries.clear();
        for j in 0..m * self.following.factors.len() {
            let i = j / m;
            let (normal, own) = (&graph.coordinates[i], &graph.coordinates[first + j]);
            let (p, slope) = graph.value_and_slope(i, 0, graph.normal(i, &self.unknowns));
            let s = self.following.pressures.get(first + j).copied().unwrap_or(0.0);
            if prescribed[first + j].is_some() || p <= 0.0 {
                continue;
            }
            let value = own.sign * normal.sign * own.weight * slope * s / p;
            match prescribed[i] {
                Some(increment) => self.lifted.push((own.dof as usize, value * increment)),
                None => self.following.entries.push(NonsymmetricEntry {
                    row: own.dof as usize,
                    column: normal.dof as usize,
                    value,
                }),
            }
        }
        self.solver.couple(self.following.entries.iter().copied());
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
        self.solver.transpose_couplings();
    }
}

/// The multipliers s of the last graphs, at the points of the trace; 0 on Γ1.
pub(super) fn show(space: &Discretization, pressures: &[f64], shown: &mut [f64]) {
    let m = space.mesh.dimension - 1;
    let points = space.trace.points.iter().zip(shown.chunks_exact_mut(m));
    let free = points.filter(|(point, _)| point.carries());
    for ((_, own), s) in free.rev().zip(pressures.rchunks_exact(m)) {
        own.copy_from_slice(s);
    }
}

/// Adds Σ w s v_τ to forces by nodes.
pub(super) fn add_force(space: &Discretization, view: &StepView<'_>, force: &mut [f64]) {
    for (point, s) in space.trace.points.iter().zip(view.friction_stresses(space)) {
        let mut own = [0.0; 2];
        own.iter_mut().zip(s).for_each(|(own, s)| *own = point.weight * s);
        point.add_tangential(&own[..s.len()], force);
    }
}

/// Largest distance of (u_τ, s) from the law at the free points, as a force; `stiffness` answers to a displacement.
pub(super) fn violation<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    view: &StepView<'_>,
    stiffness: f64,
) -> f64 {
    let Some(friction) = &model.friction else { return 0.0 };
    let points = space.trace.points.iter().zip(view.friction_stresses(space)).enumerate();
    let distances = points.filter(|(_, (point, _))| point.carries()).map(|(i, (point, s))| {
        let x = space.mesh.point(&[point.vertex], &[1.0]);
        let pressure = model.boundary.as_ref().map_or(0.0, |boundary| {
            let normal = space.trace.normal(i, view.u);
            boundary.potential_at(x).subdifferential(normal - (boundary.shift)(x)).0
        });
        let law = friction.at(x, view.t, pressure);
        distance(&law, (&point.slip(view.u)[..s.len()], s), point.weight, stiffness)
    });
    distances.fold(0.0, f64::max)
}

impl StepView<'_> {
    /// The components of s along the tangents, point by point; nothing without friction.
    pub fn friction_stresses(&self, space: &Discretization) -> impl Iterator<Item = &[f64]> {
        self.friction.chunks_exact(space.mesh.dimension - 1)
    }
}

/// Distance of (u_τ, s) from the law as a force. With r = `stiffness`/`weight`, the point of the graph whose s + r u_τ is
/// that of (u_τ, s) lies along it: what is across counts as it is, what is along as a law of numbers has it.
fn distance(law: &Scaled, (slip, s): (&[f64], &[f64]), weight: f64, stiffness: f64) -> f64 {
    let (&[a, b], &[p, q]) = (slip, s) else {
        return graph_distance(law, [slip[0], s[0]], weight, stiffness);
    };
    let r = stiffness / weight;
    let z = [p + r * a, q + r * b];
    let length = z[0].hypot(z[1]);
    let [c, d] = if length > 0.0 { z.map(|z| z / length) } else { [1.0, 0.0] };
    let across = weight * (c * q - d * p).abs();
    graph_distance(law, [c * a + d * b, c * p + d * q], weight, stiffness).max(across)
}
