//! The past of a group of hereditary integrals at bound points.
//!
//! With panel edges T_p and the panel integral J_p,
//!
//!   I(T_{p+1}) = exp(-c (T_{p+1} - T_p)) I(T_p) + J_p,
//!
//! and the value at t is the same with t in place of T_{p+1}.  The values at
//! edges are kept.  They depend on the panels alone, so that a value is the
//! same whichever times were evaluated before.

use super::breaks::{Breaks, Lane, Piece};
use super::history::{HistoryPlan, Kernel};
use super::memory::Memory;
use super::quadrature::{GAUSS, ORDER};
use super::sampler::{Sampler, Surroundings};
use super::weights::Weights;

/// Lanes integrated at once.
const CHUNK: usize = 128;

/// The last two coefficients of a resolved integrand over its largest value.
/// They then fall by the tenth root of this or faster, and what the rule,
/// exact to degree 23, leaves out is below the rounding.
const RESOLVED: f64 = 1e-8;
/// How often a part of a panel is halved.
const HALVINGS: usize = 4;

/// Integrals up to every panel edge reached so far, and scratch memory.
#[derive(Clone, Debug)]
pub(super) struct Past {
    group: usize,
    tuples: usize,
    /// For each edge the values of all members at all tuples.
    edges: Vec<Vec<f64>>,
    memory: Memory,
    breaks: Breaks,
    sampler: Sampler,
    weights: Weights,
    lanes: Vec<Lane>,
    /// Of pieces that are not resolved.
    halves: Vec<Piece>,
}

impl Past {
    pub(super) fn new(plan: &HistoryPlan, group: usize, tuples: usize) -> Self {
        let nested = plan.nested();
        Self {
            group,
            tuples,
            edges: vec![vec![0.0; tuples * plan.members.len()]],
            memory: Memory::default(),
            breaks: Breaks::new(&nested),
            sampler: Sampler::new(&nested),
            weights: Weights::default(),
            lanes: Vec::new(),
            halves: Vec::new(),
        }
    }

    /// Forgets everything, for another zeta.
    pub(super) fn reset(&mut self) {
        self.edges.truncate(1);
        self.memory = Memory::default();
    }

    /// The members' values at lanes of tuple and time: `out[lane * members +
    /// member]`.  At times that are not finite the values are NaN.
    pub(super) fn values(
        &mut self,
        below: &mut [Past],
        all: Surroundings,
        tuples: &[u32],
        times: &[f64],
        out: &mut Vec<f64>,
    ) {
        let plan = &all.plan.histories[self.group];
        let finite = |t: &f64| if t.is_finite() { *t } else { 0.0 };
        let last = times.iter().map(finite).fold(0.0, f64::max);
        self.extend(plan, below, all, plan.panel(last));

        let members = plan.members.len();
        let mut lanes = std::mem::take(&mut self.lanes);
        lanes.clear();
        lanes.extend(tuples.iter().zip(times).map(|(&tuple, time)| {
            let to = finite(time);
            Lane { tuple, from: plan.edge(plan.panel(to)), to }
        }));
        out.clear();
        out.resize(lanes.len() * members, 0.0);
        self.integrate(plan, below, all, &lanes, out, None);
        for ((lane, time), out) in lanes.iter().zip(times).zip(out.chunks_mut(members.max(1))) {
            if time.is_finite() {
                self.add_past(plan, lane, out);
            } else {
                out.fill(f64::NAN);
            }
        }
        self.lanes = lanes;
    }

    /// Adds what went before the beginning of the lane's panel.
    fn add_past(&mut self, plan: &HistoryPlan, lane: &Lane, out: &mut [f64]) {
        let panel = plan.panel(lane.to);
        let decay = self.weights.decay(plan, lane.to - lane.from);
        let start = lane.tuple as usize * plan.members.len();
        let edge = &self.edges[panel][start..];
        for ((member, out), edge) in plan.members.iter().zip(out.iter_mut()).zip(edge) {
            if let Kernel::Exponential(_) = plan.kernels[member.kernel] {
                *out += decay[member.kernel] * edge;
            }
        }
        self.memory.add(plan, &mut self.weights, panel, lane, out);
    }

    /// Fills in the values at edges up to that of panel `last`.
    fn extend(&mut self, plan: &HistoryPlan, below: &mut [Past], all: Surroundings, last: usize) {
        while self.edges.len() <= last {
            let panel = self.edges.len() - 1;
            let (from, to) = (plan.edge(panel), plan.edge(panel + 1));
            let lane = |tuple| Lane { tuple: tuple as u32, from, to };
            let lanes: Vec<Lane> = (0..self.tuples).map(lane).collect();
            let mut next = vec![0.0; lanes.len() * plan.members.len()];
            self.integrate(plan, below, all, &lanes, &mut next, Some(panel));
            let decay = self.weights.decay(plan, to - from);
            let factors = plan.members.iter().map(|m| decay[m.kernel]).cycle();
            for ((next, edge), factor) in next.iter_mut().zip(&self.edges[panel]).zip(factors) {
                *next += factor * edge;
            }
            self.edges.push(next);
        }
    }

    /// Adds to `sums` the integrals of all members over the lanes; those of a
    /// whole panel are remembered for general kernels.
    fn integrate(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
        sums: &mut [f64],
        whole: Option<usize>,
    ) {
        let members = plan.members.len();
        let halvings = if plan.is_general() { 0 } else { HALVINGS };
        for (lanes, sums) in lanes.chunks(CHUNK).zip(sums.chunks_mut(CHUNK * members)) {
            self.breaks.find(plan, below, all, lanes);
            let mut pieces = std::mem::take(&mut self.breaks.pieces);
            for halving in 0..=halvings {
                self.sample(plan, below, all, lanes, &pieces);
                self.halves.clear();
                for (k, piece) in pieces.iter().enumerate() {
                    if halving < halvings && !self.is_resolved(k) {
                        self.halves.extend(piece.halves());
                        continue;
                    }
                    let lane = &lanes[piece.lane as usize];
                    let weights = self.weights.of(plan, piece.from, piece.to, lane.to);
                    let sums = &mut sums[piece.lane as usize * members..];
                    for (member, sum) in plan.members.iter().zip(sums) {
                        let values = &self.sampler.values[member.integrand][k * ORDER..];
                        let weights = &weights[member.kernel * ORDER..];
                        *sum += dot(weights, values);
                    }
                }
                if self.halves.is_empty() {
                    break;
                }
                std::mem::swap(&mut pieces, &mut self.halves);
            }
            if whole.is_some() && plan.is_general() {
                self.memory.keep(plan, whole, lanes, &pieces, &self.sampler.values);
            }
            self.breaks.pieces = pieces;
        }
    }

    /// Samples the integrands at the quadrature points of all pieces.
    fn sample(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
        pieces: &[Piece],
    ) {
        self.sampler.clear();
        for piece in pieces {
            let at = |u: &f64| piece.from + (piece.to - piece.from) * u;
            let tuple = lanes[piece.lane as usize].tuple;
            self.sampler.extend(tuple, GAUSS.abscissae.iter().map(at));
        }
        self.sampler.run(&plan.tape, plan.mask, below, all);
    }

    /// Whether the last coefficients of all integrands on a piece are small.
    fn is_resolved(&self, piece: usize) -> bool {
        self.sampler.values.iter().all(|values| {
            let values = &values[piece * ORDER..][..ORDER];
            let larger =
                |most: f64, value: &f64| if value.abs() > most { value.abs() } else { most };
            let largest = values.iter().fold(0.0, larger);
            let last = GAUSS.last.iter().map(|weights| dot(weights, values).abs());
            // Numbers that are not finite stay so on any part.
            let unresolved = last.sum::<f64>() > RESOLVED * largest;
            !unresolved
        })
    }
}

/// The sum over one set of quadrature points.
pub(super) fn dot(weights: &[f64], values: &[f64]) -> f64 {
    // Sums that do not wait for each other.
    let mut sums = [0.0; WIDTH];
    let (weights, values) = (&weights[..ORDER], &values[..ORDER]);
    for (w, v) in weights.as_chunks::<WIDTH>().0.iter().zip(values.as_chunks::<WIDTH>().0) {
        for l in 0..WIDTH {
            sums[l] += w[l] * v[l];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Points that are summed side by side; a part of [`ORDER`].
const WIDTH: usize = 4;
const _: () = assert!(ORDER.is_multiple_of(WIDTH));
