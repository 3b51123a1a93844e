//! Interpolation of integrals that depend on one coordinate, for very many values of it.
//!
//! The axis is cut into pieces, halved towards kinks until they are smooth, and each is interpolated between a few
//! nodes; values where that fails are computed one by one.

use rustc_hash::FxHashMap;

use super::history::HistoryPlan;
use super::past::dot;
use super::quadrature::{GAUSS, ORDER};
use super::resolution::last;
use super::stage::Stages;

const MANY: usize = 4096;
/// Initial pieces of the axis; features narrower than a node's share of one are missed.
const PIECES: usize = 16;
/// Pieces with at most so many values are not interpolated.
const FEW: usize = 2 * ORDER;
/// Interpolation error allowed, relative to the largest integral.
const SHARE: f64 = 1e-13;
/// Interpolation is given up when nodes exceed this part of the values.
const WORTH: usize = 4;

#[derive(Clone, Debug)]
pub(super) struct Abscissae {
    axis: usize,
    x: Vec<f64>,
    /// Indices of the tuples, sorted by value.
    order: Vec<u32>,
}

struct Piece<'a> {
    tuples: &'a [u32],
    from: f64,
    to: f64,
}

/// What is bound to the nodes (or few tuples) of a piece, keyed by the ends of the piece, for reuse at other times.
pub(super) type Nodes<B> = FxHashMap<[u64; 2], B>;

impl Abscissae {
    /// Abscissae for a group of integrals with a recursion; none if they are few or depend on several coordinates.
    pub(super) fn of(plan: &HistoryPlan, stages: &Stages, points: &[[f64; 3]]) -> Option<Self> {
        let first = stages.first_points(plan.mask);
        if plan.mask.count_ones() != 1 || first.len() < MANY || plan.is_general() {
            return None;
        }
        let axis = plan.mask.trailing_zeros() as usize;
        let x: Vec<f64> = first.iter().map(|&p| points[p as usize][axis]).collect();
        let mut order: Vec<u32> = (0..x.len() as u32).collect();
        order.sort_unstable_by(|&a, &b| x[a as usize].total_cmp(&x[b as usize]));
        x.iter().all(|x| x.is_finite()).then_some(Self { axis, x, order })
    }

    pub(super) fn point(&self, x: f64) -> [f64; 3] {
        let mut point = [0.0; 3];
        point[self.axis] = x;
        point
    }

    /// Fills in `members` integrals at all tuples: `bind` prepares places and `sample` gives the integrals there. False
    /// if they are not smooth enough, or too few.
    pub(super) fn interpolate<B>(
        &self,
        members: usize,
        nodes: &mut Nodes<B>,
        bind: impl Fn(&[f64]) -> B,
        mut sample: impl FnMut(&mut B) -> Vec<f64>,
        values: &mut [f64],
    ) -> bool {
        let mut at = |piece: &Piece<'_>, places: &[f64]| {
            let ends = [piece.from, piece.to].map(f64::to_bits);
            sample(nodes.entry(ends).or_insert_with(|| bind(places)))
        };
        let mut sizes = vec![0.0f64; members];
        let (mut pieces, mut taken) = (self.pieces(), 0);
        while !pieces.is_empty() {
            taken += ORDER * pieces.len();
            if WORTH * taken > self.x.len() {
                return false;
            }
            let width = |piece: &Piece<'_>| piece.to - piece.from;
            let found: Vec<Vec<f64>> = pieces
                .iter()
                .map(|piece| {
                    at(piece, &GAUSS.abscissae.map(|share| piece.from + width(piece) * share))
                })
                .collect();
            for at_node in found.iter().flat_map(|found| found.chunks_exact(members)) {
                sizes
                    .iter_mut()
                    .zip(at_node)
                    .for_each(|(size, value)| *size = size.max(value.abs()));
            }
            let mut halves = Vec::new();
            for (piece, sampled) in pieces.iter().zip(&found) {
                let column = |m: usize| std::array::from_fn(|k| sampled[k * members + m]);
                let columns: Vec<[f64; ORDER]> = (0..members).map(column).collect();
                // NaN counts as not smooth.
                if columns.iter().zip(&sizes).all(|(column, size)| last(column) <= SHARE * size) {
                    self.fill(piece, &columns, values);
                    continue;
                }
                for half in self.halves(piece) {
                    if half.tuples.len() > FEW {
                        halves.push(half);
                        continue;
                    }
                    let x = |&tuple: &u32| self.x[tuple as usize];
                    let sampled = at(&half, &half.tuples.iter().map(x).collect::<Vec<f64>>());
                    for (&tuple, sampled) in half.tuples.iter().zip(sampled.chunks_exact(members)) {
                        values[members * tuple as usize..][..members].copy_from_slice(sampled);
                    }
                }
            }
            pieces = halves;
        }
        true
    }

    fn pieces(&self) -> Vec<Piece<'_>> {
        let [from, to] = [0, self.order.len() - 1].map(|k| self.x[self.order[k] as usize]);
        let edge = |k: usize| from + (to - from) * (k as f64 / PIECES as f64);
        let mut rest = &self.order[..];
        let piece = |k: usize| {
            let end = if k + 1 == PIECES { rest.len() } else { self.below(rest, edge(k + 1)) };
            let (tuples, others) = rest.split_at(end);
            rest = others;
            Piece { tuples, from: edge(k), to: edge(k + 1) }
        };
        (0..PIECES).map(piece).filter(|piece| !piece.tuples.is_empty()).collect()
    }

    fn below(&self, tuples: &[u32], x: f64) -> usize {
        tuples.partition_point(|&tuple| self.x[tuple as usize] < x)
    }

    fn halves<'a>(&self, piece: &Piece<'a>) -> [Piece<'a>; 2] {
        let middle = 0.5 * (piece.from + piece.to);
        let (low, high) = piece.tuples.split_at(self.below(piece.tuples, middle));
        [(low, piece.from, middle), (high, middle, piece.to)].map(|(tuples, from, to)| Piece {
            tuples,
            from,
            to,
        })
    }

    fn fill(&self, piece: &Piece<'_>, columns: &[[f64; ORDER]], values: &mut [f64]) {
        for &tuple in piece.tuples {
            let share = (self.x[tuple as usize] - piece.from) / (piece.to - piece.from);
            let weights = GAUSS.lagrange(share);
            let integrals = &mut values[columns.len() * tuple as usize..][..columns.len()];
            integrals
                .iter_mut()
                .zip(columns)
                .for_each(|(integrals, column)| *integrals = dot(&weights, column));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn abscissae(x: Vec<f64>) -> Abscissae {
        let mut order: Vec<u32> = (0..x.len() as u32).collect();
        order.sort_unstable_by(|&a, &b| x[a as usize].total_cmp(&x[b as usize]));
        Abscissae { axis: 0, x, order }
    }

    /// Two functions, one with a kink: few places are used, mostly nodes, and none is new at another time.
    #[test]
    fn smooth_pieces_are_filled_in_from_few_nodes() {
        let x: Vec<f64> = (0..8000).map(|k| (0.618_033_988_749_894_9 * k as f64).fract()).collect();
        let abscissae_of_x = abscissae(x.clone());
        let (bound, given) = (std::cell::Cell::new(0), |places: &[f64]| places.to_vec());
        let bind = |places: &[f64]| {
            bound.set(bound.get() + places.len());
            given(places)
        };
        let f = |x: f64| [(3.0 * x).sin(), (x - 0.37).abs()];
        let sample = |places: &mut Vec<f64>| places.iter().flat_map(|&x| f(x)).collect();
        let (mut nodes, mut values) = (Nodes::default(), vec![f64::NAN; 2 * x.len()]);
        assert!(
            abscissae_of_x.interpolate(2, &mut nodes, bind, sample, &mut values),
            "two smooth pieces"
        );
        assert!(bound.get() < 1000, "{}", bound.get());
        for (tuple, found) in values.chunks(2).enumerate() {
            let exact = (x[tuple] - 0.37).abs() < 1e-3;
            for (a, b) in found.iter().zip(f(x[tuple])) {
                let most = if exact { 0.0 } else { 2.0 * SHARE };
                assert!((a - b).abs() <= most, "{}: {a} {b}", x[tuple]);
            }
        }
        let before = bound.replace(0);
        assert!(
            abscissae_of_x.interpolate(2, &mut nodes, bind, sample, &mut values)
                && bound.get() == 0
        );
        assert!(before > 0);
        // Noise of ten shares is smooth nowhere.
        let noise = |x: f64| 1.0 + 10.0 * SHARE * (1e6 * x).sin();
        let noisy = |places: &mut Vec<f64>| places.iter().map(|&x| noise(x)).collect();
        let mut others = Nodes::default();
        assert!(!abscissae_of_x.interpolate(1, &mut others, given, noisy, &mut values[..x.len()]));
    }
}
