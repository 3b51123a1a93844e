//! How well the quadrature resolves integrands on the pieces of a panel, and which pieces are halved.
//!
//! Halving towards a power (s - a)^p, p > -1, gains 1 + p bits a level: it goes on until what is not resolved is below
//! the rounding of the integral. Integrands that are unresolved everywhere, as rounding itself is, are halved a few
//! times alone. What then remains is estimated.

use super::breaks::Piece;
use super::history::HistoryPlan;
use super::quadrature::{GAUSS, ORDER};

/// The last two coefficients of a resolved integrand over its largest value. They then fall by the tenth root of this
/// or faster, and what the rule, exact to degree 23, leaves out is below the rounding.
pub(super) const RESOLVED: f64 = 1e-8;
/// The accuracy where the polynomial through the values is integrated against a kernel: what it leaves out is as large as
/// the next coefficient, not its square.
const INTERPOLATED: f64 = 1e-12;
/// A share of an integral that is lost in its rounding, whose unit is 1.1e-16: the estimates below are upper ones.
pub(super) const NEGLIGIBLE: f64 = 5e-17;
/// How often all parts of a panel are halved.
const HALVINGS: usize = 4;
/// How many parts of a panel are halved beyond that: two sides of a few powers, with a neighbour each.
const MOST: usize = 8;
/// How often these are halved: s^-0.9, of which a halving leaves 93 %, takes 500.
const DEEPEST: usize = 600;

/// What becomes of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    /// Its integral is right to rounding.
    Resolved,
    /// The panel is not resolved: its halves come next.
    Halved,
    /// It is taken as it is, and what it may lack is estimated.
    Left,
}

/// The marks of the pieces of some lanes, with scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Resolution {
    pub(super) marks: Vec<Mark>,
    /// ∫ |f| over each lane, of each integrand.
    sizes: Vec<f64>,
    /// Unresolved pieces of each lane.
    unresolved: Vec<usize>,
}

impl Resolution {
    /// Marks `pieces` of so many lanes from the values of the integrands at their points. To be called for depth 0, then
    /// for the halves of what it marks.
    pub(super) fn mark(
        &mut self,
        plan: &HistoryPlan,
        lanes: usize,
        pieces: &[Piece],
        values: &[Vec<f64>],
        depth: usize,
    ) {
        let share = if plan.is_general() { INTERPOLATED } else { RESOLVED };
        let of = |k: usize| values.iter().map(move |values| &values[k * ORDER..][..ORDER]);
        self.marks.clear();
        self.marks.extend((0..pieces.len()).map(|k| {
            let resolved = of(k).all(|values| !is_unresolved(values, share));
            if resolved { Mark::Resolved } else { Mark::Left }
        }));
        if depth == 0 {
            self.sizes.clear();
        }
        if self.marks.iter().all(|mark| *mark == Mark::Resolved) {
            return;
        }
        if self.sizes.is_empty() {
            self.measure(lanes, pieces, values);
        }
        self.unresolved.clear();
        self.unresolved.resize(lanes, 0);
        for (k, (piece, mark)) in pieces.iter().zip(&mut self.marks).enumerate() {
            let lane = piece.lane as usize;
            let sizes = &self.sizes[lane * values.len()..];
            let negligible = |(values, size): (&[f64], &f64)| {
                piece.width() * last(values) <= NEGLIGIBLE * size || !is_unresolved(values, share)
            };
            if *mark == Mark::Left && of(k).zip(sizes).all(negligible) {
                *mark = Mark::Resolved;
            }
            self.unresolved[lane] += usize::from(*mark == Mark::Left);
        }
        for (piece, mark) in pieces.iter().zip(&mut self.marks) {
            let few = self.unresolved[piece.lane as usize] <= MOST && depth < DEEPEST;
            if *mark == Mark::Left && (depth < HALVINGS || few) && piece.can_be_halved() {
                *mark = Mark::Halved;
            }
        }
    }

    fn measure(&mut self, lanes: usize, pieces: &[Piece], values: &[Vec<f64>]) {
        self.sizes.resize(lanes * values.len(), 0.0);
        for (k, piece) in pieces.iter().enumerate() {
            let sizes = &mut self.sizes[piece.lane as usize * values.len()..];
            for (size, values) in sizes.iter_mut().zip(values) {
                let values = &values[k * ORDER..][..ORDER];
                let pairs = values.iter().zip(&GAUSS.weights);
                *size += piece.width() * pairs.map(|(f, w)| w * f.abs()).sum::<f64>();
            }
        }
    }
}

/// Whether the last coefficients exceed a share of the largest value. Numbers that are not finite stay so on any part:
/// they do not.
pub(super) fn is_unresolved(values: &[f64], share: f64) -> bool {
    let larger = |most: f64, value: &f64| if value.abs() > most { value.abs() } else { most };
    let last = last(values);
    // Most are resolved by far: any value is large enough.
    if last <= share * values[0].abs() {
        return false;
    }
    last > share * values.iter().fold(0.0, larger)
}

/// The sum of the sizes of the last two coefficients: about what the polynomial through the values lacks of a power with
/// its root at an end, and more than the rule does.
pub(super) fn last(values: &[f64]) -> f64 {
    GAUSS.last.iter().map(|weights| super::past::dot(weights, values).abs()).sum()
}
