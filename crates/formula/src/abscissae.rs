//! Integrals that depend on one coordinate, at very many values of it, as on a mesh whose points share none.
//!
//! On pieces of the axis where they are smooth they are interpolated between a few values. Pieces are halved where they
//! are not, towards kinks, and what is left is taken value by value.

use rustc_hash::FxHashMap;

use super::history::HistoryPlan;
use super::past::dot;
use super::quadrature::{GAUSS, ORDER};
use super::resolution::last;
use super::stage::Stages;

/// Fewer values are taken one by one.
const MANY: usize = 4096;
/// Pieces of the axis to begin with: what is narrower than a node's share of them is not seen.
const PIECES: usize = 16;
/// Values of a piece that are taken one by one, at most.
const FEW: usize = 2 * ORDER;
/// What interpolation may leave out, as a share of the largest integral.
const SHARE: f64 = 1e-13;
/// Interpolation is given up when nodes are more than this part of the values.
const WORTH: usize = 4;

/// The values of a coordinate, one per tuple.
#[derive(Clone, Debug)]
pub(super) struct Abscissae {
    axis: usize,
    x: Vec<f64>,
    /// The tuples, by their values.
    order: Vec<u32>,
}

/// Some tuples in order, and a part of the axis that holds them.
struct Piece<'a> {
    tuples: &'a [u32],
    from: f64,
    to: f64,
}

/// What is bound to the nodes of a piece, or to its few tuples, by the ends of the piece: the same pieces serve at other
/// times.
pub(super) type Nodes<B> = FxHashMap<[u64; 2], B>;

impl Abscissae {
    /// The abscissae of a group of integrals with a recursion; none where they are few, or of several coordinates.
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

    /// A point of the axis.
    pub(super) fn point(&self, x: f64) -> [f64; 3] {
        let mut point = [0.0; 3];
        point[self.axis] = x;
        point
    }

    /// Fills in so many integrals at all tuples: `bind` prepares some places, and `sample` gives the integrals there. False
    /// where they are not smooth enough, or too few.
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
                .map(|own| at(own, &GAUSS.abscissae.map(|share| own.from + width(own) * share)))
                .collect();
            for own in found.iter().flat_map(|found| found.chunks_exact(members)) {
                sizes.iter_mut().zip(own).for_each(|(size, value)| *size = size.max(value.abs()));
            }
            let mut halves = Vec::new();
            for (piece, own) in pieces.iter().zip(&found) {
                let column = |m: usize| std::array::from_fn(|k| own[k * members + m]);
                let columns: Vec<[f64; ORDER]> = (0..members).map(column).collect();
                // NaN is not smooth.
                if columns.iter().zip(&sizes).all(|(own, size)| last(own) <= SHARE * size) {
                    self.fill(piece, &columns, values);
                    continue;
                }
                for half in self.halves(piece) {
                    if half.tuples.len() > FEW {
                        halves.push(half);
                        continue;
                    }
                    let x = |&tuple: &u32| self.x[tuple as usize];
                    let own = at(&half, &half.tuples.iter().map(x).collect::<Vec<f64>>());
                    for (&tuple, own) in half.tuples.iter().zip(own.chunks_exact(members)) {
                        values[members * tuple as usize..][..members].copy_from_slice(own);
                    }
                }
            }
            pieces = halves;
        }
        true
    }

    /// Equal pieces of the axis.
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

    /// How many of some tuples in order are below a place.
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
            let own = &mut values[columns.len() * tuple as usize..][..columns.len()];
            own.iter_mut().zip(columns).for_each(|(own, column)| *own = dot(&weights, column));
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

    /// Two functions, one with a kink: few places are taken, most of them nodes, and at another time none is new.
    #[test]
    fn smooth_pieces_are_filled_in_from_few_nodes() {
        let x: Vec<f64> = (0..8000).map(|k| (0.618_033_988_749_894_9 * k as f64).fract()).collect();
        let own = abscissae(x.clone());
        let (bound, given) = (std::cell::Cell::new(0), |places: &[f64]| places.to_vec());
        let bind = |places: &[f64]| {
            bound.set(bound.get() + places.len());
            given(places)
        };
        let f = |x: f64| [(3.0 * x).sin(), (x - 0.37).abs()];
        let sample = |places: &mut Vec<f64>| places.iter().flat_map(|&x| f(x)).collect();
        let (mut nodes, mut values) = (Nodes::default(), vec![f64::NAN; 2 * x.len()]);
        assert!(own.interpolate(2, &mut nodes, bind, sample, &mut values), "two smooth pieces");
        assert!(bound.get() < 1000, "{}", bound.get());
        for (tuple, found) in values.chunks(2).enumerate() {
            let exact = (x[tuple] - 0.37).abs() < 1e-3;
            for (a, b) in found.iter().zip(f(x[tuple])) {
                let most = if exact { 0.0 } else { 2.0 * SHARE };
                assert!((a - b).abs() <= most, "{}: {a} {b}", x[tuple]);
            }
        }
        let before = bound.replace(0);
        assert!(own.interpolate(2, &mut nodes, bind, sample, &mut values) && bound.get() == 0);
        assert!(before > 0);
        // Noise of ten shares is smooth nowhere.
        let noise = |x: f64| 1.0 + 10.0 * SHARE * (1e6 * x).sin();
        let noisy = |places: &mut Vec<f64>| places.iter().map(|&x| noise(x)).collect();
        let mut others = Nodes::default();
        assert!(!own.interpolate(1, &mut others, given, noisy, &mut values[..x.len()]));
    }
}
