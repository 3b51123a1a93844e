//! The past of a group of hereditary integrals at places.
//!
//! With panel edges T_p and the panel integral J_p, integrals with exponential kernels are
//!
//!   I(T_{p+1}) = exp(-c (T_{p+1} - T_p)) I(T_p) + J_p,
//!
//! and likewise at t in place of T_{p+1}. The values at edges are kept; they depend on the panels alone, so that a
//! value is independent of earlier evaluations. A kernel that is no exponential has no such recursion: its integrals are
//! taken over all panels at each t.
//!
//! Both take one rule of twelve points a piece. A piece is cut where a guard changes sign, at neighbouring numbers, and
//! halved where the products of kernel and integrand are not resolved. Halving towards a power (s - a)^p, p > -1, gains
//! 1 + p bits a level: it goes on until the unresolved part is below the rounding of the integral. Products that are
//! unresolved everywhere, as rounding noise is, are halved a few times only; the remaining error is estimated.

use rustc_hash::FxHashMap;

use super::block::{BLOCK, Registers};
use super::history::{Group, Kernel, Plan};
use super::quadrature::{GAUSS, ORDER};
use super::tape::{Source, Tape};

/// Lanes integrated at once, so that integrands stay in cache.
const CHUNK: usize = 512;
/// Last two coefficients of a resolved product over its largest value. Coefficients then fall by the tenth root of this
/// or faster, and the error of the rule, exact to degree 23, is below rounding.
const RESOLVED: f64 = 1e-8;
/// Negligible share of an integral; the unit of rounding is 1.1e-16 and the estimates are upper bounds.
const NEGLIGIBLE: f64 = 5e-17;
/// Levels to which all parts of a panel are halved.
const HALVINGS: u32 = 4;
/// Parts of a lane halved beyond that: both sides of a few powers, with a neighbour each.
const MOST: usize = 8;
/// Deepest level: s^-0.9, of which a halving leaves 93 %, takes 500.
const DEEPEST: u32 = 600;
/// Most cuts of a piece, so that a guard of rounding noise ends.
const CUTS: u32 = 12;
/// Cuts are sought to this share of their time, less than a unit in the last place.
const CLOSED: f64 = 1e-16;

/// What integrals may read, and the group they are of.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    pub(super) plan: &'a Plan,
    pub(super) group: usize,
    pub(super) zeta: f64,
}

impl<'a> Around<'a> {
    fn group(&self) -> &'a Group {
        &self.plan.groups[self.group]
    }
}

/// An interval of times at a place; kernels count lags from `end`.
#[derive(Clone, Copy)]
struct Lane {
    place: u32,
    from: f64,
    end: f64,
}

/// A part of a lane, by times or by lags, which are exact near the end.
#[derive(Clone, Copy, PartialEq)]
struct Piece {
    lane: usize,
    from: f64,
    to: f64,
    by_lag: bool,
    halvings: u32,
    cuts: u32,
}

impl Piece {
    fn at(&self, share: f64) -> f64 {
        self.from + (self.to - self.from) * share
    }

    fn width(&self) -> f64 {
        (self.to - self.from).abs()
    }
}

/// The ends of a piece and of its lane, and whether it goes by lags.
type Key = ([u64; 3], bool);

#[derive(Clone, Debug)]
pub(super) struct Past {
    places: Vec<[f64; 3]>,
    /// The groups that the integrands read, and their place for each place.
    inner: Vec<(usize, Vec<u32>)>,
    /// For each edge the values of all members at all places.
    edges: Vec<Vec<f64>>,
    /// Error estimates of the edges; empty if zero.
    remainders: Vec<Vec<f64>>,
    /// The kernels at the points of pieces: lanes that end together have the same.
    kernels: FxHashMap<Key, Vec<[f64; ORDER]>>,
    registers: Registers,
}

impl Past {
    pub(super) fn new(group: &Group, places: Vec<[f64; 3]>, inner: Vec<(usize, Vec<u32>)>) -> Self {
        Self {
            edges: vec![vec![0.0; places.len() * group.members.len()]],
            remainders: vec![Vec::new()],
            places,
            inner,
            kernels: FxHashMap::default(),
            registers: Registers::default(),
        }
    }

    pub(super) fn places(&self) -> usize {
        self.places.len()
    }

    pub(super) fn reset(&mut self) {
        self.edges.truncate(1);
        self.remainders.truncate(1);
    }

    /// Values at lanes of place and time: `[lane * members + member]`; NaN at non-finite times. `below` are the groups
    /// that may be nested in this one.
    pub(super) fn values(
        &mut self,
        below: &mut [Past],
        all: Around<'_>,
        places: &[u32],
        times: &[f64],
    ) -> Vec<f64> {
        let group = all.group();
        let finite = |t: &f64| if t.is_finite() { *t } else { 0.0 };
        if !group.general {
            let last = group.panel(times.iter().map(finite).fold(0.0, f64::max));
            self.extend(below, all, last);
        }
        let lane = |(&place, time): (&u32, &f64)| {
            let end = finite(time);
            let from = if group.general { 0.0 } else { group.edge(group.panel(end)) };
            Lane { place, from, end }
        };
        let lanes: Vec<Lane> = places.iter().zip(times).map(lane).collect();
        let [mut values, mut lacking] = self.integrate(below, all, &lanes);
        let members = group.members.len();
        for (k, (lane, time)) in lanes.iter().zip(times).enumerate() {
            if !group.general {
                let (panel, first) = (group.panel(lane.end), members * lane.place as usize);
                let left = self.remainders[panel].get(first..first + members);
                if left.is_some() && lacking.is_empty() {
                    lacking = vec![0.0; values.len()];
                }
                for m in 0..members {
                    let decay = decay(group, m, lane.end - lane.from);
                    values[members * k + m] += decay * self.edges[panel][first + m];
                    if let Some(left) = left {
                        lacking[members * k + m] += decay * left[m];
                    }
                }
            }
            if !time.is_finite() {
                values[members * k..members * (k + 1)].fill(f64::NAN);
            }
        }
        if all.plan.adds_remainders {
            values.iter_mut().zip(&lacking).for_each(|(value, lacking)| *value += lacking);
        }
        values
    }

    /// Adds edges up to the last one needed, with error estimates.
    fn extend(&mut self, below: &mut [Past], all: Around<'_>, last: usize) {
        let group = all.group();
        for panel in self.edges.len() - 1..last {
            let (from, end) = (group.edge(panel), group.edge(panel + 1));
            let places = 0..self.places.len() as u32;
            let lanes: Vec<Lane> = places.map(|place| Lane { place, from, end }).collect();
            let [mut next, mut left] = self.integrate(below, all, &lanes);
            let members = group.members.len();
            let decays: Vec<f64> = (0..members).map(|m| decay(group, m, end - from)).collect();
            if !self.remainders[panel].is_empty() {
                left.resize(next.len(), 0.0);
            }
            for (all, before) in
                [(&mut next, &self.edges[panel]), (&mut left, &self.remainders[panel])]
            {
                let terms = before.iter().zip(decays.iter().cycle());
                all.iter_mut().zip(terms).for_each(|(sum, (before, decay))| *sum += decay * before);
            }
            self.edges.push(next);
            self.remainders.push(left);
        }
    }

    /// The integrals of all members over the lanes, and their error estimates; empty if zero.
    fn integrate(&mut self, below: &mut [Past], all: Around<'_>, lanes: &[Lane]) -> [Vec<f64>; 2] {
        let group = all.group();
        let members = group.members.len();
        let (mut sums, mut lacking) = (vec![0.0; lanes.len() * members], Vec::new());
        let mut products: Vec<[f64; ORDER]> = Vec::new();
        self.kernels.clear();
        for (chunk, lanes) in lanes.chunks(CHUNK).enumerate() {
            let first = CHUNK * members * chunk;
            let mut pieces = Vec::new();
            lanes
                .iter()
                .enumerate()
                .for_each(|(k, lane)| append_pieces(group, k, lane, &mut pieces));
            // ∫ |k f| over each lane, of each member.
            let mut sizes = vec![0.0; lanes.len() * members];
            for round in 0.. {
                if pieces.is_empty() {
                    break;
                }
                let (values, cuts) = self.sampled(below, all, lanes, &pieces);
                products.clear();
                for (k, piece) in pieces.iter().enumerate() {
                    let kernels = self.kernels_on(group, piece, lanes[piece.lane].end);
                    for (m, member) in group.members.iter().enumerate() {
                        let f = &values[member.integrand][ORDER * k..][..ORDER];
                        let kernel = &kernels[member.kernel];
                        let product: [f64; ORDER] = std::array::from_fn(|i| kernel[i] * f[i]);
                        if round == 0 {
                            let size = dot(&GAUSS.weights, &product.map(f64::abs));
                            sizes[members * piece.lane + m] += piece.width() * size;
                        }
                        products.push(product);
                    }
                }
                let mut unresolved = vec![0; lanes.len()];
                let mut is_left = vec![false; pieces.len()];
                for (k, piece) in pieces.iter().enumerate() {
                    let sizes = &sizes[members * piece.lane..];
                    let left = |(product, size): (&[f64; ORDER], &f64)| {
                        is_unresolved(product) && piece.width() * last(product) > NEGLIGIBLE * size
                    };
                    let products = products[members * k..][..members].iter();
                    is_left[k] = cuts[k].is_none() && products.zip(sizes).any(left);
                    unresolved[piece.lane] += usize::from(is_left[k]);
                }
                let mut next = Vec::new();
                for (k, piece) in pieces.iter().enumerate() {
                    if let Some([low, high]) = cuts[k] {
                        let piece = Piece { cuts: piece.cuts + 1, ..*piece };
                        next.extend([Piece { to: low, ..piece }, Piece { from: high, ..piece }]);
                        continue;
                    }
                    let few = unresolved[piece.lane] <= MOST && piece.halvings < DEEPEST;
                    let middle = piece.at(0.5);
                    let can = middle != piece.from && middle != piece.to;
                    if is_left[k] && can && (piece.halvings < HALVINGS || few) {
                        let piece = Piece { halvings: piece.halvings + 1, ..*piece };
                        next.extend([
                            Piece { to: middle, ..piece },
                            Piece { from: middle, ..piece },
                        ]);
                        continue;
                    }
                    for (m, product) in products[members * k..][..members].iter().enumerate() {
                        let at = first + members * piece.lane + m;
                        sums[at] += (piece.to - piece.from) * dot(&GAUSS.weights, product);
                        if is_left[k] {
                            lacking.resize(sums.len(), 0.0);
                            lacking[at] += piece.width() * last(product);
                        }
                    }
                }
                next.retain(|piece| piece.from != piece.to);
                pieces = next;
            }
        }
        [sums, lacking]
    }

    /// The integrands at the points of pieces, and the neighbouring numbers between which a guard changes sign.
    fn sampled(
        &mut self,
        below: &mut [Past],
        all: Around<'_>,
        lanes: &[Lane],
        pieces: &[Piece],
    ) -> (Vec<Vec<f64>>, Vec<Option<[f64; 2]>>) {
        let group = all.group();
        let guarded = !group.guards.results.is_empty();
        let shares = [&[0.0][..], &GAUSS.abscissae, &[1.0]].concat();
        let shares = if guarded { &shares[..] } else { &GAUSS.abscissae };
        let points =
            pieces.iter().flat_map(|piece| shares.iter().map(move |&u| (piece, piece.at(u))));
        let mut values = self.sample(&group.tape, below, all, lanes, points);
        let mut cuts = vec![None; pieces.len()];
        if !guarded {
            return (values, cuts);
        }
        let guards = values.split_off(group.integrands);
        for values in &mut values {
            let inner = values.chunks(shares.len()).flat_map(|of_piece| &of_piece[1..=ORDER]);
            *values = inner.copied().collect();
        }
        // The first change in each piece: its guard, its ends, and whether it is negative before.
        let mut brackets: Vec<(usize, usize, [f64; 2], bool)> = Vec::new();
        for (k, piece) in pieces.iter().enumerate().filter(|(_, piece)| piece.cuts < CUTS) {
            let of_piece = |guard: &Vec<f64>, i: usize| guard[shares.len() * k + i] < 0.0;
            let change = (1..shares.len()).find_map(|i| {
                let g = guards.iter().position(|g| of_piece(g, i) != of_piece(g, i - 1))?;
                Some((
                    k,
                    g,
                    [piece.at(shares[i - 1]), piece.at(shares[i])],
                    of_piece(&guards[g], i - 1),
                ))
            });
            brackets.extend(change);
        }
        while !brackets.is_empty() {
            brackets.retain(|&(k, _, [low, high], _)| {
                let middle = 0.5 * (low + high);
                let size = pieces[k].from.abs().max(pieces[k].to.abs());
                let closed = (high - low).abs() <= CLOSED * size || middle == low || middle == high;
                if closed {
                    cuts[k] = Some([low, high]);
                }
                !closed
            });
            let middles = brackets.iter().map(|&(k, _, [a, b], _)| (&pieces[k], 0.5 * (a + b)));
            let found = self.sample(&group.guards, below, all, lanes, middles);
            for (i, (_, g, ends, negative)) in brackets.iter_mut().enumerate() {
                let end = usize::from((found[*g][i] < 0.0) != *negative);
                ends[end] = 0.5 * (ends[0] + ends[1]);
            }
        }
        (values, cuts)
    }

    /// The results of a tape at places of pieces.
    fn sample<'p>(
        &mut self,
        tape: &Tape,
        below: &mut [Past],
        all: Around<'_>,
        lanes: &[Lane],
        points: impl Iterator<Item = (&'p Piece, f64)>,
    ) -> Vec<Vec<f64>> {
        let point = |(piece, at): (&Piece, f64)| {
            let lane = &lanes[piece.lane];
            (lane.place, if piece.by_lag { lane.end - at } else { at })
        };
        let (places, times): (Vec<u32>, Vec<f64>) = points.map(point).unzip();
        let Self { places: coordinates, inner, registers, .. } = self;
        let mut recalled = Vec::new();
        for &(group, ref place) in inner.iter().filter(|(group, _)| tape.reads(*group)) {
            let places: Vec<u32> = places.iter().map(|&p| place[p as usize]).collect();
            let (lower, rest) = below.split_at_mut(group);
            let values = rest[0].values(lower, Around { group, ..all }, &places, &times);
            recalled.push((group, values));
        }
        let mut values = vec![Vec::with_capacity(times.len()); tape.results.len()];
        for start in (0..times.len()).step_by(BLOCK) {
            let end = times.len().min(start + BLOCK);
            let (places, times) = (&places[start..end], &times[start..end]);
            registers.run(tape, end - start, |source, out| match source {
                Source::Time => out.copy_from_slice(times),
                Source::Zeta => out.fill(all.zeta),
                Source::Axis(axis) => {
                    let at = out.iter_mut().zip(places);
                    at.for_each(|(out, &place)| *out = coordinates[place as usize][axis]);
                }
                Source::Integral(group, member) => {
                    let members = all.plan.groups[group].members.len();
                    let known = recalled.iter().filter(|(known, _)| *known == group);
                    let known = known.flat_map(|(_, values)| &values[members * start..]);
                    let mine = known.skip(member).step_by(members);
                    out.iter_mut().zip(mine).for_each(|(out, value)| *out = *value);
                }
            });
            for (values, &result) in values.iter_mut().zip(&tape.results) {
                values.extend_from_slice(registers.lanes(result, end - start));
            }
        }
        values
    }

    /// The kernels at the points of a piece.
    fn kernels_on(&mut self, group: &Group, piece: &Piece, end: f64) -> &[[f64; ORDER]] {
        let key = ([piece.from, piece.to, end].map(f64::to_bits), piece.by_lag);
        let Self { kernels, registers, .. } = self;
        kernels.entry(key).or_insert_with(|| {
            let lag = |u| if piece.by_lag { piece.at(u) } else { end - piece.at(u) };
            let lags = GAUSS.abscissae.map(lag);
            let of = |kernel: &Kernel| match kernel {
                Kernel::Exponential(c) => lags.map(|lag| (-c * lag).exp()),
                Kernel::General(tape) => {
                    // A kernel depends on time only.
                    registers.run(tape, ORDER, |_, out| out.copy_from_slice(&lags));
                    std::array::from_fn(|i| registers.lanes(tape.results[0], ORDER)[i])
                }
            };
            group.kernels.iter().map(of).collect()
        })
    }
}

/// The panels of a lane: one for exponential kernels; for others all, the second half by lags.
fn append_pieces(group: &Group, lane: usize, Lane { from, end, .. }: &Lane, out: &mut Vec<Piece>) {
    let whole = Piece { lane, from: *from, to: *end, by_lag: false, halvings: 0, cuts: 0 };
    let last = if group.general { group.panel(*end) } else { 0 };
    for panel in 0..=last {
        let from = if panel > 0 { group.edge(panel) } else { *from };
        let to = if panel < last { group.edge(panel + 1) } else { *end };
        let turn = if group.general { (0.5 * end).clamp(from.min(to), to.max(from)) } else { to };
        out.push(Piece { from, to: turn, ..whole });
        out.push(Piece { from: end - to, to: end - turn, by_lag: true, ..whole });
    }
    out.retain(|piece| piece.from != piece.to);
}

/// exp(-c lag) of a member.
fn decay(group: &Group, member: usize, lag: f64) -> f64 {
    match group.kernels[group.members[member].kernel] {
        Kernel::Exponential(c) => (-c * lag).exp(),
        Kernel::General(..) => 0.0,
    }
}

/// Whether the last coefficients exceed a share of the largest value. False for non-finite values, which no halving
/// removes.
fn is_unresolved(values: &[f64; ORDER]) -> bool {
    let larger = |most: f64, value: &f64| if value.abs() > most { value.abs() } else { most };
    last(values) > RESOLVED * values.iter().fold(0.0, larger)
}

/// Sum of the last two coefficients in magnitude: about the error of the interpolating polynomial for a power with its
/// root at an end, and above that of the rule.
fn last(values: &[f64; ORDER]) -> f64 {
    GAUSS.last.iter().map(|weights| dot(weights, values).abs()).sum()
}

fn dot(a: &[f64; ORDER], b: &[f64; ORDER]) -> f64 {
    // Independent partial sums.
    let mut sums = [0.0; 4];
    for (a, b) in a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0) {
        for l in 0..4 {
            sums[l] += a[l] * b[l];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
