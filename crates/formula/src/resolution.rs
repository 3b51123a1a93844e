//! Resolution of integrands by the quadrature, and the choice of pieces to be halved.
//!
//! Halving towards a power (s - a)^p, p > -1, gains 1 + p bits a level: it goes on until the unresolved part is below
//! the rounding of the integral. Integrands that are unresolved everywhere, as rounding noise is, are halved a few
//! times only. The remaining error is estimated.

use super::breaks::Piece;
use super::history::HistoryPlan;
use super::quadrature::{GAUSS, ORDER};

/// Last two coefficients of a resolved integrand over its largest value. Coefficients then fall by the tenth root of
/// this or faster, and the error of the rule, exact to degree 23, is below rounding.
pub(super) const RESOLVED: f64 = 1e-8;
/// Accuracy when the interpolating polynomial is integrated against a kernel: the error is as large as the next
/// coefficient, not its square.
const INTERPOLATED: f64 = 1e-12;
/// Negligible share of an integral; the unit of rounding is 1.1e-16 and the estimates are upper bounds.
pub(super) const NEGLIGIBLE: f64 = 5e-17;
/// Levels to which all parts of a panel are halved.
const HALVINGS: usize = 4;
/// Parts halved beyond that: both sides of a few powers, with a neighbour each.
const MOST: usize = 8;
/// Deepest level: s^-0.9, of which a halving leaves 93 %, takes 500.
const DEEPEST: usize = 600;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    /// The integral is accurate to rounding.
    Resolved,
    Halved,
    /// Accepted with an error estimate.
    Left,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Resolution {
    pub(super) marks: Vec<Mark>,
    /// ∫ |f| over each lane, of each integrand.
    sizes: Vec<f64>,
    unresolved: Vec<usize>,
}

impl Resolution {
    /// Marks `pieces` from the integrands at their points. Call for depth 0, then for the halves of what it marks.
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

/// Whether the last coefficients exceed a share of the largest value. False for non-finite values, which no halving
/// removes.
pub(super) fn is_unresolved(values: &[f64], share: f64) -> bool {
    let larger = |most: f64, value: &f64| if value.abs() > most { value.abs() } else { most };
    let last = last(values);
    if last <= share * values[0].abs() {
        return false;
    }
    last > share * values.iter().fold(0.0, larger)
}

/// Sum of the last two coefficients in magnitude: about the error of the interpolating polynomial for a power with its
/// root at an end, and above that of the rule.
pub(super) fn last(values: &[f64]) -> f64 {
    GAUSS.last.iter().map(|weights| super::past::dot(weights, values).abs()).sum()
}
