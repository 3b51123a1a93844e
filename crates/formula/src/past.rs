//! The past of a group of hereditary integrals at bound points.
//!
//! With panel edges T_p and the panel integral J_p,
//!
//!   I(T_{p+1}) = exp(-c (T_{p+1} - T_p)) I(T_p) + J_p,
//!
//! and likewise at t in place of T_{p+1}. The values at edges are kept; they depend on the panels alone, so that a
//! value is independent of earlier evaluations. Estimates of the quadrature error are carried along. A kernel that is no
//! exponential has no such recursion: its integrals are taken over all panels at each t.

use super::breaks::{Breaks, Lane, Piece};
use super::history::HistoryPlan;
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
    /// For each edge the values of all members at all tuples.
    edges: Vec<Vec<f64>>,
    /// Error estimates of the edges; empty if zero.
    remainders: Vec<Vec<f64>>,
    breaks: Breaks,
    sampler: Sampler,
    weights: Weights,
    resolution: Resolution,
    lanes: Vec<Lane>,
    halves: Vec<Piece>,
    /// Error estimates of the values last returned.
    lacking: Vec<f64>,
}

impl Past {
    pub(super) fn new(plan: &HistoryPlan, group: usize, tuples: usize) -> Self {
        let nested = plan.nested();
        Self {
            group,
            tuples,
            edges: vec![vec![0.0; tuples * plan.members.len()]],
            remainders: vec![Vec::new()],
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
        let finite = |t: &f64| if t.is_finite() { *t } else { 0.0 };
        let last = plan.panel(times.iter().map(finite).fold(0.0, f64::max));
        let members = plan.members.len();
        let (mut lanes, mut lacking) =
            (std::mem::take(&mut self.lanes), std::mem::take(&mut self.lacking));
        out.clear();
        out.resize(tuples.len() * members, 0.0);
        lacking.clear();
        lacking.resize(out.len(), 0.0);
        if !plan.is_general() {
            self.extend(below, all, last);
        }
        for panel in 0..if plan.is_general() { last + 1 } else { 1 } {
            let lane = |(&tuple, time): (&u32, &f64)| {
                let end = finite(time);
                let [from, to] = match plan.is_general() {
                    true => {
                        [panel, panel + 1].map(|p| if p > 0 { plan.edge(p).min(end) } else { 0.0 })
                    }
                    false => [plan.edge(plan.panel(end)), end],
                };
                Lane { tuple, from, to, end }
            };
            lanes.clear();
            lanes.extend(tuples.iter().zip(times).map(lane));
            self.integrate(below, all, &lanes, [out, &mut lacking]);
        }
        for (k, (lane, time)) in lanes.iter().zip(times).enumerate() {
            let (range, start) = (members * k..members * (k + 1), members * lane.tuple as usize);
            if !time.is_finite() {
                out[range].fill(f64::NAN);
            } else if !plan.is_general() {
                let panel = plan.panel(lane.to);
                let decay = self.weights.decay(plan, lane.to - lane.from);
                for (m, k) in range.enumerate() {
                    let factor = decay[plan.members[m].kernel];
                    out[k] += factor * self.edges[panel][start + m];
                    if let Some(left) = self.remainders[panel].get(start + m) {
                        lacking[k] += factor * left;
                    }
                }
            }
        }
        if all.plan.adds_remainders {
            out.iter_mut().zip(&lacking).for_each(|(value, lacking)| *value += lacking);
        }
        (self.lanes, self.lacking) = (lanes, lacking);
    }

    /// Adds edges up to the last one needed, with error estimates.
    fn extend(&mut self, below: &mut [Past], all: Surroundings, last: usize) {
        let plan = &all.plan.histories[self.group];
        let size = plan.members.len() * self.tuples;
        while self.edges.len() <= last {
            // Panels side by side share the rounds of the search for breaks.
            let first = self.edges.len() - 1;
            let count = (BATCH / self.tuples.max(1)).clamp(1, last - first);
            let of_panel = |panel: usize| {
                let (from, to) = (plan.edge(panel), plan.edge(panel + 1));
                (0..self.tuples as u32).map(move |tuple| Lane { tuple, from, to, end: to })
            };
            let lanes: Vec<Lane> = (first..first + count).flat_map(of_panel).collect();
            let [mut values, mut lacking] = [(); 2].map(|()| vec![0.0; size * count]);
            self.integrate(below, all, &lanes, [&mut values, &mut lacking]);
            for panel in first..first + count {
                let decay = self.weights.decay(plan, plan.edge(panel + 1) - plan.edge(panel));
                let [mut next, mut left] = [&mut values, &mut lacking].map(|all| {
                    let rest = all.split_off(size);
                    std::mem::replace(all, rest)
                });
                let pairs = [(&mut next, &self.edges[panel]), (&mut left, &self.remainders[panel])];
                for (next, before) in pairs {
                    let factors = plan.members.iter().map(|m| decay[m.kernel]).cycle();
                    let terms = before.iter().zip(factors).map(|(before, factor)| factor * before);
                    next.iter_mut().zip(terms).for_each(|(next, term)| *next += term);
                }
                if left.iter().all(|&part| part == 0.0) {
                    left = Vec::new();
                }
                self.edges.push(next);
                self.remainders.push(left);
            }
        }
    }

    /// Adds the integrals of all members over the lanes, and their error estimates. Pieces are halved where unresolved.
    fn integrate(
        &mut self,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
        [sums, lacking]: [&mut [f64]; 2],
    ) {
        let plan = &all.plan.histories[self.group];
        for (batch, lanes) in lanes.chunks(BATCH).enumerate() {
            self.breaks.find(plan, below, all, lanes);
            let found = std::mem::take(&mut self.breaks.pieces);
            let mut rest = &found[..];
            for (chunk, lanes) in lanes.chunks(CHUNK).enumerate() {
                let before = CHUNK * chunk;
                let end = (before + lanes.len()) as u32;
                let (mine, others) = rest.split_at(rest.partition_point(|piece| piece.lane < end));
                rest = others;
                let lane = |piece: &Piece| Piece { lane: piece.lane - before as u32, ..*piece };
                let mut pieces: Vec<Piece> = mine.iter().map(lane).collect();
                for depth in 0.. {
                    self.sampler.clear();
                    for piece in &pieces {
                        let at = |u: &f64| piece.from + (piece.to - piece.from) * u;
                        let tuple = lanes[piece.lane as usize].tuple;
                        self.sampler.extend(tuple, GAUSS.abscissae.iter().map(at));
                    }
                    self.sampler.run(&plan.tape, plan.mask, below, all);
                    let values = &self.sampler.values;
                    self.resolution.mark(plan, lanes.len(), &pieces, values, depth);
                    self.halves.clear();
                    for (k, (piece, mark)) in pieces.iter().zip(&self.resolution.marks).enumerate()
                    {
                        if *mark == Mark::Halved {
                            self.halves.extend(piece.halves());
                            continue;
                        }
                        let (lane, left) = (piece.lane as usize, *mark == Mark::Left);
                        let weights = self.weights.of(plan, piece.from, piece.to, lanes[lane].end);
                        let first = plan.members.len() * (BATCH * batch + before + lane);
                        for (m, member) in plan.members.iter().enumerate() {
                            let values = &values[member.integrand][k * ORDER..][..ORDER];
                            let weights = &weights[member.kernel * STRIDE..][..STRIDE];
                            sums[first + m] += dot(weights, values);
                            if left || weights[ORDER] > 0.0 {
                                lacking[first + m] += estimate(weights, values, left);
                            }
                        }
                    }
                    if self.halves.is_empty() {
                        break;
                    }
                    std::mem::swap(&mut pieces, &mut self.halves);
                }
            }
            self.breaks.pieces = found;
        }
    }
}

/// Error estimate of Σ w_i f_i from [`STRIDE`] weights: of the kernel, and of the integrand if `left` unresolved.
fn estimate(weights: &[f64], values: &[f64], left: bool) -> f64 {
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
