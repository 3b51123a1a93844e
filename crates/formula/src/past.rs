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

use super::block::{BLOCK, Registers};
use super::history::{Group, Kernel, Plan};
use super::quadrature::{GAUSS, ORDER};
use super::tape::{Source, Tape};

/// Lanes integrated at once, so that integrands stay in cache.
const CHUNK: usize = 128;
/// Limit of lanes of several panels listed together, so that few places fill chunks.
const BATCH: usize = 4096;
/// Last two coefficients of a resolved function over its largest value. Coefficients then fall by the tenth root of this
/// or faster, and the error of the rule, exact to degree 23, is below rounding, for a product of two resolved functions too.
const RESOLVED: f64 = 1e-8;
/// Negligible share of an integral; the unit of rounding is 1.1e-16 and the estimates are upper bounds.
const NEGLIGIBLE: f64 = 5e-17;
/// Levels to which all parts of a lane are halved.
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

/// A panel or a part of it at a place, by times or by lags, which are exact near the end.
#[derive(Clone, Copy)]
struct Lane {
    /// The number of the integral that it is part of.
    sum: usize,
    place: u32,
    from: f64,
    to: f64,
    /// Kernels count lags from here.
    end: f64,
    by_lag: bool,
}

/// A part of a lane.
#[derive(Clone, Copy)]
struct Piece {
    lane: usize,
    from: f64,
    to: f64,
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

/// Kernels at the points of pieces; neighbours in a list often have the same.
#[derive(Clone, Debug, Default)]
struct Kernels {
    /// For each piece.
    of_piece: Vec<usize>,
    /// For each kernel.
    values: Vec<Vec<f64>>,
    is_resolved: Vec<bool>,
    lags: Vec<f64>,
}

#[derive(Clone, Debug)]
pub(super) struct Past {
    places: Vec<[f64; 3]>,
    /// The groups that the integrands read, and their place for each place.
    inner: Vec<(usize, Vec<u32>)>,
    /// For each edge the values of all members at all places.
    edges: Vec<Vec<f64>>,
    /// Error estimates of the edges; empty if zero.
    remainders: Vec<Vec<f64>>,
    kernels: Kernels,
    registers: Registers,
    at: (Vec<u32>, Vec<f64>),
}

impl Past {
    pub(super) fn new(group: &Group, places: Vec<[f64; 3]>, inner: Vec<(usize, Vec<u32>)>) -> Self {
        Self {
            edges: vec![vec![0.0; places.len() * group.members.len()]],
            remainders: vec![Vec::new()],
            places,
            inner,
            kernels: Kernels::default(),
            registers: Registers::default(),
            at: Default::default(),
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
        let (group, members) = (all.group(), all.group().members.len());
        let ends: Vec<f64> = times.iter().map(|t| if t.is_finite() { *t } else { 0.0 }).collect();
        let last = group.panel(ends.iter().copied().fold(0.0, f64::max));
        if !group.general {
            self.extend(below, all, last);
        }
        let mut known = None;
        let mut panel_of = |end: f64| match known {
            Some((of, panel)) if of == end => panel,
            _ => known.insert((end, group.panel(end))).1,
        };
        let panels: Vec<usize> = ends.iter().map(|end| panel_of(*end)).collect();
        let (mut values, mut lacking) = (vec![0.0; members * times.len()], Vec::new());
        let mut lanes = Vec::new();
        for panel in 0..=last {
            for (sum, (&end, &of_end)) in ends.iter().zip(&panels).enumerate() {
                let is_part = if group.general { panel <= of_end } else { panel == of_end };
                if is_part {
                    let from = if panel > 0 { group.edge(panel) } else { 0.0 };
                    let to = if panel < of_end { group.edge(panel + 1) } else { end };
                    append_lanes(group, (sum, places[sum]), [from, to, end], &mut lanes);
                }
            }
            if lanes.len() >= BATCH || panel == last {
                self.integrate(below, all, &lanes, (&mut values, &mut lacking));
                lanes.clear();
            }
        }
        let (mut decays, mut decay_of) = (Vec::new(), f64::NAN);
        for (k, (&end, &panel)) in ends.iter().zip(&panels).enumerate() {
            let (of_lane, first) = (members * k..members * (k + 1), members * places[k] as usize);
            if !times[k].is_finite() {
                values[of_lane].fill(f64::NAN);
            } else if !group.general {
                let lag = end - group.edge(panel);
                if decay_of != lag {
                    (decays, decay_of) = (group.decays(lag), lag);
                }
                let left = self.remainders[panel].get(first..first + members);
                if left.is_some() {
                    lacking.resize(values.len(), 0.0);
                }
                for (m, at) in of_lane.enumerate() {
                    values[at] += decays[m] * self.edges[panel][first + m];
                    if let Some(left) = left {
                        lacking[at] += decays[m] * left[m];
                    }
                }
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
        let (places, size) = (self.places.len(), self.places.len() * group.members.len());
        while self.edges.len() <= last {
            let first = self.edges.len() - 1;
            let count = (BATCH / places.max(1)).clamp(1, last - first);
            let mut lanes = Vec::with_capacity(2 * count * places);
            for panel in first..first + count {
                let [from, end] = [group.edge(panel), group.edge(panel + 1)];
                for place in 0..places {
                    let sum = places * (panel - first) + place;
                    append_lanes(group, (sum, place as u32), [from, end, end], &mut lanes);
                }
            }
            let (mut sums, mut lacking) = (vec![0.0; size * count], Vec::new());
            self.integrate(below, all, &lanes, (&mut sums, &mut lacking));
            for panel in first..first + count {
                let decays = group.decays(group.edge(panel + 1) - group.edge(panel));
                let of_panel = size * (panel - first)..size * (panel - first + 1);
                let own = lacking.get(of_panel.clone()).unwrap_or(&[]);
                let mut left =
                    if own.iter().any(|part| *part != 0.0) { own.to_vec() } else { Vec::new() };
                if !self.remainders[panel].is_empty() {
                    left.resize(size, 0.0);
                }
                let mut next =
                    if count == 1 { std::mem::take(&mut sums) } else { sums[of_panel].to_vec() };
                for (all, before) in
                    [(&mut next, &self.edges[panel]), (&mut left, &self.remainders[panel])]
                {
                    let terms = before.iter().zip(decays.iter().cycle());
                    all.iter_mut()
                        .zip(terms)
                        .for_each(|(sum, (before, decay))| *sum += decay * before);
                }
                self.edges.push(next);
                self.remainders.push(left);
            }
        }
    }

    /// Adds the integrals of all members over the lanes, and their error estimates, which are empty if zero.
    fn integrate(
        &mut self,
        below: &mut [Past],
        all: Around<'_>,
        lanes: &[Lane],
        (sums, lacking): (&mut [f64], &mut Vec<f64>),
    ) {
        let (group, rule) = (all.group(), &*GAUSS);
        let (members, guarded) = (group.members.len(), !group.guards.results.is_empty());
        let (stride, skipped) = if guarded { (ORDER + 2, 1) } else { (ORDER, 0) };
        let (mut values, mut kernels) = (Vec::new(), std::mem::take(&mut self.kernels));
        let (mut pieces, mut next, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
        // Of each lane, which are added in their order: the last bit is then independent of other lanes.
        let mut parts = Vec::new();
        for lanes in lanes.chunks(CHUNK) {
            let whole = |(lane, &Lane { from, to, .. }): (usize, &Lane)| Piece {
                lane,
                from,
                to,
                halvings: 0,
                cuts: 0,
            };
            pieces.clear();
            pieces.extend(lanes.iter().enumerate().map(whole));
            parts.clear();
            parts.resize(members * lanes.len(), 0.0);
            for round in 0.. {
                if pieces.is_empty() {
                    break;
                }
                let cuts = self.sampled(below, all, (lanes, &pieces), &mut values);
                self.sample_kernels(group, (lanes, &pieces), &mut kernels);
                let integrand = |i: usize, k: usize| &values[i][stride * k + skipped..][..ORDER];
                let product = |k: usize, m: usize| -> [f64; ORDER] {
                    let (member, f) = (&group.members[m], integrand(group.members[m].integrand, k));
                    let kernel =
                        &kernels.values[member.kernel][ORDER * kernels.of_piece[k]..][..ORDER];
                    std::array::from_fn(|i| kernel[i] * f[i])
                };
                // Where products have to be looked at.
                let rough = |k: usize| {
                    !kernels.is_resolved[kernels.of_piece[k]]
                        || (0..group.integrands).any(|i| is_unresolved(integrand(i, k)))
                };
                let mut is_left: Vec<bool> = (0..pieces.len()).map(rough).collect();
                if round == 0 {
                    sizes.clear();
                    if !cuts.is_empty() || is_left.contains(&true) {
                        // ∫ |k f| over each lane, of each member.
                        sizes.extend((0..members * lanes.len()).map(|at| {
                            let sizes = product(at / members, at % members).map(f64::abs);
                            pieces[at / members].width() * dot(&rule.weights, &sizes)
                        }));
                    }
                }
                let mut unresolved = vec![0; lanes.len()];
                let mut next_cut = cuts.iter().peekable();
                cuts.iter().for_each(|(k, _)| is_left[*k] = false);
                for (k, piece) in pieces.iter().enumerate() {
                    is_left[k] = is_left[k]
                        && (0..members).any(|m| {
                            let product = product(k, m);
                            let left = piece.width() * last(&product);
                            is_unresolved(&product)
                                && left > NEGLIGIBLE * sizes[members * piece.lane + m]
                        });
                    unresolved[piece.lane] += usize::from(is_left[k]);
                }
                next.clear();
                for (k, piece) in pieces.iter().enumerate() {
                    if let Some((_, [low, high])) = next_cut.next_if(|(of, _)| *of == k) {
                        let piece = Piece { cuts: piece.cuts + 1, ..*piece };
                        next.extend([Piece { to: *low, ..piece }, Piece { from: *high, ..piece }]);
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
                    let of_lane = members * piece.lane..members * (piece.lane + 1);
                    for (m, part) in parts[of_lane].iter_mut().enumerate() {
                        let product = product(k, m);
                        *part += (piece.to - piece.from) * dot(&rule.weights, &product);
                        if is_left[k] {
                            lacking.resize(sums.len(), 0.0);
                            lacking[members * lanes[piece.lane].sum + m] +=
                                piece.width() * last(&product);
                        }
                    }
                }
                next.retain(|piece: &Piece| piece.from != piece.to);
                std::mem::swap(&mut pieces, &mut next);
            }
            for (lane, parts) in lanes.iter().zip(parts.chunks(members)) {
                let of_lane = sums[members * lane.sum..].iter_mut();
                of_lane.zip(parts).for_each(|(sum, part)| *sum += part);
            }
        }
        self.kernels = kernels;
    }

    /// Puts the integrands at the points of pieces, and guards there and at the ends, into `values`. Returns the
    /// neighbouring numbers between which a guard changes sign, with the number of the piece.
    fn sampled(
        &mut self,
        below: &mut [Past],
        all: Around<'_>,
        (lanes, pieces): (&[Lane], &[Piece]),
        values: &mut Vec<Vec<f64>>,
    ) -> Vec<(usize, [f64; 2])> {
        let (group, rule) = (all.group(), &*GAUSS);
        let mut shares = [0.0; ORDER + 2];
        shares[1..=ORDER].copy_from_slice(&rule.abscissae);
        shares[ORDER + 1] = 1.0;
        if group.guards.results.is_empty() {
            let points =
                pieces.iter().flat_map(|piece| rule.abscissae.map(|u| (piece, piece.at(u))));
            self.sample(&group.tape, below, all, lanes, points, values);
            return Vec::new();
        }
        let points = pieces.iter().flat_map(|piece| shares.map(|u| (piece, piece.at(u))));
        self.sample(&group.tape, below, all, lanes, points, values);
        let guards = &values[group.integrands..];
        // The first change in each piece: its guard, its ends, and whether it is negative before.
        let mut brackets: Vec<(usize, usize, [f64; 2], bool)> = Vec::new();
        for (k, piece) in pieces.iter().enumerate().filter(|(_, piece)| piece.cuts < CUTS) {
            let changes = |(g, guard): (usize, &Vec<f64>)| {
                let signs = &guard[shares.len() * k..][..shares.len()];
                let negative = signs.iter().fold(0, |sum, value| sum + usize::from(*value < 0.0));
                if negative == 0 || negative == shares.len() {
                    return None;
                }
                let first = signs[0] < 0.0;
                signs.iter().position(|value| (*value < 0.0) != first).map(|i| (i, g, first))
            };
            let change = guards.iter().enumerate().filter_map(changes).min();
            brackets.extend(change.map(|(i, g, negative)| {
                (k, g, [piece.at(shares[i - 1]), piece.at(shares[i])], negative)
            }));
        }
        let (mut cuts, mut found) = (Vec::new(), Vec::new());
        while !brackets.is_empty() {
            brackets.retain(|&(k, _, [low, high], _)| {
                let middle = 0.5 * (low + high);
                let size = pieces[k].from.abs().max(pieces[k].to.abs());
                let closed = (high - low).abs() <= CLOSED * size || middle == low || middle == high;
                if closed {
                    cuts.push((k, [low, high]));
                }
                !closed
            });
            let middles = brackets.iter().map(|&(k, _, [a, b], _)| (&pieces[k], 0.5 * (a + b)));
            self.sample(&group.guards, below, all, lanes, middles, &mut found);
            for (i, (_, g, ends, negative)) in brackets.iter_mut().enumerate() {
                let end = usize::from((found[*g][i] < 0.0) != *negative);
                ends[end] = 0.5 * (ends[0] + ends[1]);
            }
        }
        cuts.sort_unstable_by_key(|(k, _)| *k);
        cuts
    }

    /// The results of a tape at places of pieces.
    fn sample<'p>(
        &mut self,
        tape: &Tape,
        below: &mut [Past],
        all: Around<'_>,
        lanes: &[Lane],
        points: impl Iterator<Item = (&'p Piece, f64)>,
        values: &mut Vec<Vec<f64>>,
    ) {
        let Self { places: coordinates, inner, registers, at: (places, times), .. } = self;
        places.clear();
        times.clear();
        for (piece, at) in points {
            let lane = &lanes[piece.lane];
            places.push(lane.place);
            times.push(if lane.by_lag { lane.end - at } else { at });
        }
        let mut recalled = Vec::new();
        for &(group, ref place) in inner.iter().filter(|(group, _)| tape.reads(*group)) {
            let places: Vec<u32> = places.iter().map(|&p| place[p as usize]).collect();
            let (lower, rest) = below.split_at_mut(group);
            let values = rest[0].values(lower, Around { group, ..all }, &places, times);
            recalled.push((group, values));
        }
        values.resize_with(tape.results.len(), Vec::new);
        values.iter_mut().for_each(Vec::clear);
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
                    let known = recalled.iter().find(|(known, _)| *known == group);
                    let known = known.map_or(&[][..], |(_, values)| &values[members * start..]);
                    let mine = known.iter().skip(member).step_by(members);
                    out.iter_mut().zip(mine).for_each(|(out, value)| *out = *value);
                }
            });
            for (values, &result) in values.iter_mut().zip(&tape.results) {
                values.extend_from_slice(registers.lanes(result, end - start));
            }
        }
    }

    fn sample_kernels(
        &mut self,
        group: &Group,
        (lanes, pieces): (&[Lane], &[Piece]),
        Kernels { of_piece, values, is_resolved, lags }: &mut Kernels,
    ) {
        of_piece.clear();
        lags.clear();
        let mut last = None;
        for piece in pieces {
            let Lane { end, by_lag, .. } = lanes[piece.lane];
            let key = Some((piece.from, piece.to, end, by_lag));
            if last != key {
                last = key;
                let lag = |u| if by_lag { piece.at(u) } else { end - piece.at(u) };
                lags.extend(GAUSS.abscissae.map(lag));
            }
            of_piece.push(lags.len() / ORDER - 1);
        }
        values.resize_with(group.kernels.len(), Vec::new);
        is_resolved.clear();
        is_resolved.resize(lags.len() / ORDER, true);
        for (kernel, values) in group.kernels.iter().zip(values) {
            values.clear();
            match kernel {
                Kernel::Exponential(c) => values.extend(lags.iter().map(|lag| (-c * lag).exp())),
                Kernel::General(tape) => {
                    for lags in lags.chunks(BLOCK) {
                        // A kernel depends on time only.
                        self.registers.run(tape, lags.len(), |_, out| out.copy_from_slice(lags));
                        let found = self.registers.lanes(tape.results[0], lags.len());
                        values.extend_from_slice(found);
                    }
                }
            }
            for (all, values) in is_resolved.iter_mut().zip(values.chunks(ORDER)) {
                *all &= !is_unresolved(values);
            }
        }
    }
}

/// The parts of a panel: two if guards are watched at the points of the rule; for kernels that are no exponentials, the
/// second half of the past by lags.
fn append_lanes(
    group: &Group,
    (sum, place): (usize, u32),
    [from, to, end]: [f64; 3],
    out: &mut Vec<Lane>,
) {
    let middle = if group.guards.results.is_empty() { to } else { 0.5 * (from + to) };
    for [from, to] in [[from, middle], [middle, to]] {
        let turn = if group.general { (0.5 * end).clamp(from.min(to), to.max(from)) } else { to };
        for (from, to, by_lag) in [(from, turn, false), (end - to, end - turn, true)] {
            if from != to {
                out.push(Lane { sum, place, from, to, end, by_lag });
            }
        }
    }
}

/// Whether the last coefficients exceed a share of the largest value. False for non-finite values, which no halving
/// removes.
#[inline(always)]
fn is_unresolved(values: &[f64]) -> bool {
    let mut largest = [0.0; 4];
    for values in values[..ORDER].as_chunks::<4>().0 {
        for l in 0..4 {
            largest[l] = if values[l].abs() > largest[l] { values[l].abs() } else { largest[l] };
        }
    }
    last(values) > RESOLVED * largest.into_iter().fold(0.0, f64::max)
}

/// Sum of the last two coefficients in magnitude: about the error of the interpolating polynomial for a power with its
/// root at an end, and above that of the rule.
#[inline(always)]
fn last(values: &[f64]) -> f64 {
    GAUSS.last.iter().map(|weights| dot(weights, values).abs()).sum()
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Independent partial sums.
    let mut sums = [0.0; 4];
    let pairs = a[..ORDER].as_chunks::<4>().0.iter().zip(b[..ORDER].as_chunks::<4>().0);
    for (a, b) in pairs {
        for l in 0..4 {
            sums[l] += a[l] * b[l];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
