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
//! Both take one rule of twelve points a piece. A panel is cut where a guard changes sign, at neighbouring numbers, and
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
const HALVINGS: u32 = 6;
/// Parts of a lane halved beyond that: both sides of a few powers, with a neighbour each.
const MOST: usize = 8;
/// Deepest level: s^-0.9, of which a halving leaves 93 %, takes 500.
const DEEPEST: u32 = 600;
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
    /// Times the weights of the rule.
    weighted: Vec<Vec<f64>>,
    is_rough: Vec<bool>,
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
        let (group, members) = (all.group(), all.group().members.len());
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
            };
            pieces.clear();
            pieces.extend(lanes.iter().enumerate().map(whole));
            parts.clear();
            parts.resize(members * lanes.len(), 0.0);
            sizes.clear();
            for round in 0.. {
                if pieces.is_empty() {
                    break;
                }
                if round == 0 && !group.guards.results.is_empty() {
                    self.cut(below, all, lanes, &mut pieces);
                }
                let points = pieces.iter();
                let points =
                    points.flat_map(|piece| GAUSS.abscissae.map(|share| (piece, piece.at(share))));
                self.sample(&group.tape, below, all, lanes, points, &mut values);
                self.sample_kernels(group, (lanes, &pieces), &mut kernels);
                // Where products have to be looked at.
                let mut is_left: Vec<bool> =
                    kernels.of_piece.iter().map(|&k| kernels.is_rough[k]).collect();
                values.iter().for_each(|values| add_unresolved(values, &mut is_left));
                let product = |k: usize, m: usize| -> [f64; ORDER] {
                    let member = &group.members[m];
                    let f = &values[member.integrand][ORDER * k..][..ORDER];
                    let kernel = &kernels.values[member.kernel];
                    let kernel = &kernel[ORDER * kernels.of_piece[k]..][..ORDER];
                    std::array::from_fn(|i| kernel[i] * f[i])
                };
                if round == 0 && is_left.contains(&true) {
                    // ∫ |k f| over each lane, of each member.
                    sizes.resize(members * lanes.len(), 0.0);
                    for (k, piece) in pieces.iter().enumerate() {
                        for (m, size) in
                            sizes[members * piece.lane..][..members].iter_mut().enumerate()
                        {
                            *size +=
                                piece.width() * dot(&GAUSS.weights, &product(k, m).map(f64::abs));
                        }
                    }
                }
                let mut unresolved = vec![0; lanes.len()];
                for (k, piece) in pieces.iter().enumerate().filter(|_| !sizes.is_empty()) {
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
                for (k, piece) in pieces.iter_mut().enumerate().filter(|(k, _)| is_left[*k]) {
                    let few = unresolved[piece.lane] <= MOST && piece.halvings < DEEPEST;
                    let middle = piece.at(0.5);
                    let can = middle != piece.from && middle != piece.to;
                    if can && (piece.halvings < HALVINGS || few) {
                        let half = Piece { halvings: piece.halvings + 1, ..*piece };
                        next.extend([Piece { to: middle, ..half }, Piece { from: middle, ..half }]);
                        // Nothing of the whole is added.
                        piece.to = piece.from;
                        continue;
                    }
                    lacking.resize(sums.len(), 0.0);
                    for (m, lacking) in
                        lacking[members * lanes[piece.lane].sum..][..members].iter_mut().enumerate()
                    {
                        *lacking += piece.width() * last(&product(k, m));
                    }
                }
                add_parts(group, (&kernels, &values), &pieces, &mut parts);
                std::mem::swap(&mut pieces, &mut next);
            }
            for (lane, parts) in lanes.iter().zip(parts.chunks(members)) {
                let of_lane = sums[members * lane.sum..].iter_mut();
                of_lane.zip(parts).for_each(|(sum, part)| *sum += part);
            }
        }
        self.kernels = kernels;
    }

    /// The parts of lanes between changes of sign of guards.
    fn cut(&mut self, below: &mut [Past], all: Around<'_>, lanes: &[Lane], whole: &mut Vec<Piece>) {
        let (group, mut values) = (all.group(), Vec::new());
        let times = |piece: &Piece| {
            let (piece, count) = (*piece, group.watches(piece.width()));
            (0..=count).map(move |i| piece.at(i as f64 / count as f64))
        };
        let points = whole.iter().flat_map(|piece| times(piece).map(move |at| (piece, at)));
        self.sample(&group.guards, below, all, lanes, points, &mut values);
        // Between times: the piece, the guard, the ends, and whether it is negative before.
        let (mut brackets, mut first) = (Vec::new(), 0);
        for (k, piece) in whole.iter().enumerate() {
            let signs = first..=first + group.watches(piece.width());
            first = signs.end() + 1;
            for (g, guard) in values.iter().enumerate() {
                let guard = &guard[signs.clone()];
                let negative = guard.iter().fold(0, |sum, value| sum + usize::from(*value < 0.0));
                if negative == 0 || negative == guard.len() {
                    continue;
                }
                let ends = times(piece).zip(times(piece).skip(1));
                for (signs, (low, high)) in guard.windows(2).zip(ends) {
                    if (signs[0] < 0.0) != (signs[1] < 0.0) {
                        brackets.push((k, g, [low, high], signs[0] < 0.0));
                    }
                }
            }
        }
        let mut cuts = Vec::new();
        while !brackets.is_empty() {
            brackets.retain(|&(k, _, [low, high], _)| {
                let middle = 0.5 * (low + high);
                let size = whole[k].from.abs().max(whole[k].to.abs());
                let closed = (high - low).abs() <= CLOSED * size || middle == low || middle == high;
                if closed {
                    cuts.push((k, [low, high]));
                }
                !closed
            });
            let middles = brackets.iter().map(|&(k, _, [a, b], _)| (&whole[k], 0.5 * (a + b)));
            self.sample(&group.guards, below, all, lanes, middles, &mut values);
            for (i, (_, g, ends, negative)) in brackets.iter_mut().enumerate() {
                let end = usize::from((values[*g][i] < 0.0) != *negative);
                ends[end] = 0.5 * (ends[0] + ends[1]);
            }
        }
        let order = |k: usize, at: f64| (at - whole[k].from).abs();
        cuts.sort_by(|(k, a), (l, b)| k.cmp(l).then(order(*k, a[0]).total_cmp(&order(*l, b[0]))));
        let (mut pieces, mut cuts) = (Vec::with_capacity(whole.len()), cuts.iter().peekable());
        for (k, &piece) in whole.iter().enumerate() {
            let mut from = piece.from;
            while let Some((_, [low, high])) = cuts.next_if(|(of, _)| *of == k) {
                if order(k, *low) > order(k, from) {
                    pieces.push(Piece { from, to: *low, ..piece });
                }
                from = if order(k, *high) > order(k, from) { *high } else { from };
            }
            pieces.extend((from != piece.to).then_some(Piece { from, ..piece }));
        }
        *whole = pieces;
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
        Kernels { of_piece, values, weighted, is_rough, lags }: &mut Kernels,
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
        weighted.resize_with(group.kernels.len(), Vec::new);
        is_rough.clear();
        is_rough.resize(lags.len() / ORDER, false);
        for ((kernel, values), weighted) in group.kernels.iter().zip(values).zip(weighted) {
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
            add_unresolved(values, is_rough);
            let weights = GAUSS.weights.iter().cycle();
            weighted.clear();
            weighted.extend(values.iter().zip(weights).map(|(value, weight)| weight * value));
        }
    }
}

/// The parts of a panel: for kernels that are no exponentials, the second half of the past by lags.
fn append_lanes(
    group: &Group,
    (sum, place): (usize, u32),
    [from, to, end]: [f64; 3],
    out: &mut Vec<Lane>,
) {
    let turn = if group.general { (0.5 * end).clamp(from.min(to), to.max(from)) } else { to };
    for (from, to, by_lag) in [(from, turn, false), (end - to, end - turn, true)] {
        if from != to {
            out.push(Lane { sum, place, from, to, end, by_lag });
        }
    }
}

/// Marks the pieces in which values are unresolved.
fn add_unresolved(values: &[f64], is_unresolved_in: &mut [bool]) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            for (marked, values) in is_unresolved_in.iter_mut().zip(values.chunks_exact(ORDER)) {
                *marked |= is_unresolved(values);
            }
        },
    );
}

/// Adds the integrals over pieces to those over their lanes.
fn add_parts(
    group: &Group,
    (kernels, values): (&Kernels, &[Vec<f64>]),
    pieces: &[Piece],
    parts: &mut [f64],
) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            let members = group.members.len();
            for (m, member) in group.members.iter().enumerate() {
                let (f, kernel) = (&values[member.integrand], &kernels.weighted[member.kernel]);
                for ((k, piece), f) in pieces.iter().enumerate().zip(f.chunks_exact(ORDER)) {
                    if piece.from != piece.to {
                        let kernel = &kernel[ORDER * kernels.of_piece[k]..][..ORDER];
                        parts[members * piece.lane + m] += (piece.to - piece.from) * dot(kernel, f);
                    }
                }
            }
        },
    );
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
    let [a, b] = &GAUSS.last;
    dot(a, values).abs() + dot(b, values).abs()
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
