//! The past of a group of hereditary integrals at bound points.
//!
//! With panel edges T_p and the panel integral J_p,
//!
//!   I(T_{p+1}) = exp(-c (T_{p+1} - T_p)) I(T_p) + J_p,
//!
//! and likewise at t in place of T_{p+1}. The values at edges are kept; they depend on the panels alone, so that a
//! value is independent of earlier evaluations. Estimates of the quadrature error are carried along.

use std::sync::Arc;

use super::abscissae::{Abscissae, Nodes};
use super::bound::BoundProgram;
use super::breaks::{Breaks, Lane, Piece};
use super::history::{HistoryPlan, Kernel};
use super::memory::PastPanels;
use super::quadrature::{GAUSS, ORDER};
use super::resolution::{Mark, Resolution, last};
use super::sampler::{Sampler, Surroundings};
use super::weights::{STRIDE, Weights};

/// Lanes integrated at once, so that integrands stay in cache and breaks are sought together.
const CHUNK: usize = 128;
const BATCH: usize = 4096;

#[derive(Clone, Debug)]
pub(super) struct Past {
    group: usize,
    tuples: usize,
    /// Set if there are so many tuples that integrals are interpolated.
    abscissae: Option<Abscissae>,
    nodes: Nodes<BoundProgram>,
    /// For each edge the values of all members at all tuples.
    edges: Vec<Vec<f64>>,
    /// Error estimates of the edges; empty if zero.
    remainders: Vec<Vec<f64>>,
    memory: PastPanels,
    breaks: Breaks,
    sampler: Sampler,
    weights: Weights,
    resolution: Resolution,
    lanes: Vec<Lane>,
    halves: Vec<Piece>,
    /// Error estimates of the values last returned.
    lacking: Vec<f64>,
}

/// Integrals of lanes, `members` each, with error estimates.
struct Sums<'a> {
    values: &'a mut [f64],
    lacking: &'a mut [f64],
}

impl Past {
    pub(super) fn new(
        plan: &HistoryPlan,
        group: usize,
        tuples: usize,
        abscissae: Option<Abscissae>,
    ) -> Self {
        let nested = plan.nested();
        Self {
            group,
            tuples,
            abscissae,
            nodes: Nodes::default(),
            edges: vec![vec![0.0; tuples * plan.members.len()]],
            remainders: vec![Vec::new()],
            memory: PastPanels::default(),
            breaks: Breaks::new(&nested),
            sampler: Sampler::new(&nested),
            weights: Weights::default(),
            resolution: Resolution::default(),
            lanes: Vec::new(),
            halves: Vec::new(),
            lacking: Vec::new(),
        }
    }

    pub(super) fn reset(&mut self) {
        self.edges.truncate(1);
        self.remainders.truncate(1);
        self.memory = PastPanels::default();
    }

    /// Values at lanes of tuple and time: `out[lane * members + member]`; NaN at non-finite times.
    pub(super) fn values(
        &mut self,
        below: &mut [Past],
        all: Surroundings,
        tuples: &[u32],
        times: &[f64],
        out: &mut Vec<f64>,
    ) {
        let plan = &all.plan.histories[self.group];
        // Tuples come in order, so equal counts mean all of them.
        let same = tuples.len() == self.tuples && times.windows(2).all(|pair| pair[0] == pair[1]);
        if let Some(&t) = times.first().filter(|_| same)
            && self.interpolate(plan, all, t, out)
        {
            return;
        }
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
        let mut lacking = std::mem::take(&mut self.lacking);
        lacking.clear();
        lacking.resize(out.len(), 0.0);
        let mut sums = Sums { values: out, lacking: &mut lacking };
        self.integrate(plan, below, all, &lanes, &mut sums, None);
        let parts = out.chunks_mut(members.max(1)).zip(lacking.chunks_mut(members.max(1)));
        for ((lane, time), (values, lacking)) in lanes.iter().zip(times).zip(parts) {
            if time.is_finite() {
                self.add_past(plan, lane, &mut Sums { values, lacking });
            } else {
                values.fill(f64::NAN);
            }
        }
        if all.plan.adds_remainders {
            out.iter_mut().zip(&lacking).for_each(|(value, lacking)| *value += lacking);
        }
        (self.lanes, self.lacking) = (lanes, lacking);
    }

    fn add_past(&mut self, plan: &HistoryPlan, lane: &Lane, sums: &mut Sums<'_>) {
        let panel = plan.panel(lane.to);
        let decay = self.weights.decay(plan, lane.to - lane.from);
        let start = lane.tuple as usize * plan.members.len();
        for (m, member) in plan.members.iter().enumerate() {
            if let Kernel::Exponential(_) = plan.kernels[member.kernel] {
                let factor = decay[member.kernel];
                sums.values[m] += factor * self.edges[panel][start + m];
                if let Some(lacking) = self.remainders[panel].get(start + m) {
                    sums.lacking[m] += factor * lacking;
                }
            }
        }
        self.memory.add(plan, &mut self.weights, panel, lane, [sums.values, sums.lacking]);
    }

    fn extend(&mut self, plan: &HistoryPlan, below: &mut [Past], all: Surroundings, last: usize) {
        let members = plan.members.len();
        while self.edges.len() <= last {
            // Panels side by side share the rounds of the search for breaks.
            let first = self.edges.len() - 1;
            let count = (BATCH / self.tuples.max(1)).clamp(1, last - first);
            let of_panel = |panel: usize| {
                let (from, to) = (plan.edge(panel), plan.edge(panel + 1));
                (0..self.tuples as u32).map(move |tuple| Lane { tuple, from, to })
            };
            let lanes: Vec<Lane> = (first..first + count).flat_map(of_panel).collect();
            // Untouched zero pages take no memory.
            let [mut values, mut lacking] = [(); 2].map(|()| vec![0.0; lanes.len() * members]);
            let mut sums = Sums { values: &mut values, lacking: &mut lacking };
            self.integrate(plan, below, all, &lanes, &mut sums, Some(first));
            if count == 1 {
                self.add_edge(plan, values, lacking);
                continue;
            }
            for index in 0..count {
                let range = members * self.tuples * index..members * self.tuples * (index + 1);
                self.add_edge(plan, values[range.clone()].to_vec(), lacking[range].to_vec());
            }
        }
    }

    /// Interpolates the values of all tuples at one time; false if the integrals are not smooth on few enough pieces,
    /// or the tuples too few.
    fn interpolate(
        &mut self,
        plan: &HistoryPlan,
        all: Surroundings,
        t: f64,
        out: &mut Vec<f64>,
    ) -> bool {
        let Some(abscissae) = self.abscissae.as_ref().filter(|_| t.is_finite()) else {
            return false;
        };
        let members = plan.members.len();
        out.clear();
        out.resize(members * self.tuples, 0.0);
        let bind = |places: &[f64]| {
            let points: Vec<[f64; 3]> = places.iter().map(|&x| abscissae.point(x)).collect();
            BoundProgram::new(Arc::clone(all.plan), &points, false)
        };
        let sample = |bound: &mut BoundProgram| bound.integrals(self.group, t, all.zeta);
        abscissae.interpolate(members, &mut self.nodes, bind, sample, out)
    }

    /// Adds an edge from the integrals over the panel before it, with error estimates.
    fn add_edge(&mut self, plan: &HistoryPlan, mut next: Vec<f64>, mut lacking: Vec<f64>) {
        let panel = self.edges.len() - 1;
        let decay = self.weights.decay(plan, plan.edge(panel + 1) - plan.edge(panel));
        let add = |next: &mut [f64], before: &[f64]| {
            let factors = plan.members.iter().map(|m| decay[m.kernel]).cycle();
            for ((next, before), factor) in next.iter_mut().zip(before).zip(factors) {
                *next += factor * before;
            }
        };
        add(&mut next, &self.edges[panel]);
        add(&mut lacking, &self.remainders[panel]);
        self.edges.push(next);
        lacking.truncate(if lacking.iter().all(|&part| part == 0.0) { 0 } else { usize::MAX });
        self.remainders.push(lacking);
    }

    /// Adds the integrals of all members over the lanes. Whole panels, from `whole` on, are stored for general kernels.
    fn integrate(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
        sums: &mut Sums<'_>,
        whole: Option<usize>,
    ) {
        let members = plan.members.len();
        let whole = whole.filter(|_| plan.is_general());
        for (index, lanes) in lanes.chunks(BATCH).enumerate() {
            let first = BATCH * index;
            self.breaks.find(plan, below, all, lanes);
            let pieces = std::mem::take(&mut self.breaks.pieces);
            let mut rest = &pieces[..];
            for (index, lanes) in lanes.chunks(CHUNK).enumerate() {
                let (before, first) = (CHUNK * index, first + CHUNK * index);
                let end = (before + lanes.len()) as u32;
                let (of_chunk, others) =
                    rest.split_at(rest.partition_point(|piece| piece.lane < end));
                rest = others;
                let lane = |piece: &Piece| Piece { lane: piece.lane - before as u32, ..*piece };
                let of_chunk: Vec<Piece> = of_chunk.iter().map(lane).collect();
                let range = members * first..members * (first + lanes.len());
                let values = &mut sums.values[range.clone()];
                let mut sums = Sums { values, lacking: &mut sums.lacking[range] };
                self.integrate_pieces(
                    plan,
                    below,
                    all,
                    (lanes, of_chunk),
                    &mut sums,
                    whole.is_some(),
                );
                if let Some(panel) = whole {
                    let panel = |lane: usize| panel + (first + lane) / self.tuples;
                    self.memory.put_away(plan, panel, lanes.len());
                }
            }
            self.breaks.pieces = pieces;
        }
    }

    /// Adds the integrals over pieces of some lanes, halved where unresolved; `keeps` stores them.
    fn integrate_pieces(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        (lanes, mut pieces): (&[Lane], Vec<Piece>),
        sums: &mut Sums<'_>,
        keeps: bool,
    ) {
        for depth in 0.. {
            self.sample(plan, below, all, lanes, &pieces);
            let values = &self.sampler.values;
            self.resolution.mark(plan, lanes.len(), &pieces, values, depth);
            self.halves.clear();
            for (k, piece) in pieces.iter().enumerate() {
                match self.resolution.marks[k] {
                    Mark::Halved => self.halves.extend(piece.halves()),
                    mark => {
                        let left = mark == Mark::Left;
                        self.add_piece(plan, lanes, (k, piece), left, sums);
                        if keeps {
                            self.memory.keep(plan, (k, piece), left, &self.sampler.values);
                        }
                    }
                }
            }
            if self.halves.is_empty() {
                break;
            }
            std::mem::swap(&mut pieces, &mut self.halves);
        }
    }

    /// Adds the integrals over piece k of those sampled, with an error estimate if it is `left` unresolved.
    fn add_piece(
        &mut self,
        plan: &HistoryPlan,
        lanes: &[Lane],
        (k, piece): (usize, &Piece),
        left: bool,
        sums: &mut Sums<'_>,
    ) {
        let lane = piece.lane as usize;
        let weights = self.weights.of(plan, piece.from, piece.to, lanes[lane].to);
        let first = lane * plan.members.len();
        for (m, member) in plan.members.iter().enumerate() {
            let values = &self.sampler.values[member.integrand][k * ORDER..][..ORDER];
            let weights = &weights[member.kernel * STRIDE..][..STRIDE];
            sums.values[first + m] += dot(weights, values);
            if left || weights[ORDER] > 0.0 {
                sums.lacking[first + m] += lacking(weights, values, left);
            }
        }
    }

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
}

/// Error estimate of Σ w_i f_i from [`STRIDE`] weights: of the kernel, and of the integrand if `left` unresolved.
pub(super) fn lacking(weights: &[f64], values: &[f64], left: bool) -> f64 {
    let (weights, of_kernel) = (&weights[..ORDER], weights[ORDER]);
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let of_integrand = weights.iter().map(|w| w.abs()).sum::<f64>() * last(values);
    of_kernel * largest + if left { of_integrand } else { 0.0 }
}

pub(super) fn dot(weights: &[f64], values: &[f64]) -> f64 {
    // Independent partial sums.
    let mut sums = [0.0; WIDTH];
    let (weights, values) = (&weights[..ORDER], &values[..ORDER]);
    for (w, v) in weights.as_chunks::<WIDTH>().0.iter().zip(values.as_chunks::<WIDTH>().0) {
        for l in 0..WIDTH {
            sums[l] += w[l] * v[l];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Number of partial sums; divides [`ORDER`].
const WIDTH: usize = 4;
const _: () = assert!(ORDER.is_multiple_of(WIDTH));
