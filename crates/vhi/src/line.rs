//! The line that a graph sits on.
//!
//! A law of numbers has the axis of its coordinate. A law of vectors is r ↦ S(|r|) r/|r| where r ↦ S(|r|) sign r is the law
//! of numbers: on the line along z = r + γ s it is that law, and across the line, to first order, the spring S/|r|. So
//! a vector needs a line that turns with z, and nothing else. |z| is at least γ S where the vector slips: the line is
//! known to rounding however small the slip is, which r alone would not tell.

use std::ops::Range;

use super::{BoundaryGraph, Piece};

/// A line through 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    /// Its direction.
    pub(crate) along: [f64; 2],
    /// The stiffness across it, over the weight.
    across: f64,
}

impl Line {
    /// The axis of a coordinate.
    pub(crate) const AXIS: Self = Self { along: [1.0, 0.0], across: 0.0 };
}

/// A slip shorter than this share of γ S has the spring of this one: a spring that is 1e8 times as stiff as the body holds
/// a direction as well, and leaves half of the digits to the stiffness along it.
const SHORTEST: f64 = 1e-8;

impl BoundaryGraph {
    /// The first coordinates of all laws.
    pub(crate) fn laws(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.coordinates.len()).filter(|&i| self.coordinates[i].span > 0)
    }

    /// The coordinates of the law that begins at i.
    pub(crate) fn span(&self, i: usize) -> Range<usize> {
        i..i + usize::from(self.coordinates[i].span)
    }

    /// Slopes of a level: one a coordinate, and one a vector.
    pub(crate) fn slopes(&self) -> usize {
        let vectors = self.coordinates.iter().filter(|at| at.span > 1).count();
        self.coordinates.len() + vectors
    }

    /// The line of the law at i for (u, c), and the place z ≥ 0 on it; of a law of numbers the axis and any z.
    pub(crate) fn line(&self, i: usize, u: &[f64], pressure: &[f64]) -> (Line, f64) {
        let at = &self.coordinates[i];
        let z = |j: usize| self.normal(j, u) + at.gamma * pressure[j];
        if at.span == 1 {
            return (Line::AXIS, z(i));
        }
        let [a, b] = [z(i), z(i + 1)];
        let length = a.hypot(b);
        if length == 0.0 {
            return (Line::AXIS, 0.0);
        }
        let mut line = Line { along: [a / length, b / length], across: 0.0 };
        if self.piece(i, length) != Piece::Free {
            return (line, length);
        }
        let below = self.jumps_below(i, length);
        let bound = self.value_and_slope(i, below, self.place(i, &line, u)).0;
        let slip = (length - at.gamma * bound).max(SHORTEST * at.gamma * bound);
        if slip > 0.0 {
            line.across = bound / slip;
        }
        (line, length)
    }

    /// The place of u on a line.
    pub(crate) fn place(&self, i: usize, line: &Line, u: &[f64]) -> f64 {
        match self.coordinates[i].span {
            1 => self.normal(i, u),
            _ => line.along[0] * self.normal(i, u) + line.along[1] * self.normal(i + 1, u),
        }
    }

    /// The pressures of a law that is free above `below` jumps, linear across its line.
    pub(crate) fn set_pressures(
        &self,
        i: usize,
        (below, line): (usize, &Line),
        u: &[f64],
        pressure: &mut [f64],
    ) {
        let place = self.place(i, line, u);
        let value = self.value_and_slope(i, below, place).0;
        if self.coordinates[i].span == 1 {
            pressure[i] = value;
            return;
        }
        for (j, along) in self.span(i).zip(line.along) {
            pressure[j] = along * value + line.across * (self.normal(j, u) - along * place);
        }
    }

    /// Its slopes, times the weight: on the coordinates, and between the two of a vector at `mixed`.
    pub(crate) fn set_slopes(
        &self,
        i: usize,
        (below, line): (usize, Line),
        u: &[f64],
        (slopes, mixed): (&mut [f64], usize),
    ) {
        let at = &self.coordinates[i];
        let slope = self.value_and_slope(i, below, self.place(i, &line, u)).1;
        if at.span == 1 {
            slopes[i] = at.weight * slope;
            return;
        }
        let [a, b] = line.along;
        slopes[i] = at.weight * (slope * a * a + line.across * b * b);
        slopes[i + 1] = at.weight * (slope * b * b + line.across * a * a);
        let turned = at.sign * self.coordinates[i + 1].sign;
        slopes[mixed] = turned * at.weight * (slope - line.across) * a * b;
    }

    /// Distance of (u_ν, c) from the graph, as a force: zero exactly on the graph.
    ///
    /// At a pinned piece it is w·dist(c, [lo, hi]) for u_ν at its value; else the violation of the
    /// bound over γ; continuous in both.
    pub(crate) fn defect(&self, i: usize, u: &[f64], pressure: &[f64]) -> f64 {
        let at = &self.coordinates[i];
        let (line, z) = self.line(i, u, pressure);
        match self.piece(i, z) {
            Piece::Pinned { value, .. } if at.span == 1 => {
                at.weight * (self.normal(i, u) - value).abs() / at.gamma
            }
            Piece::Pinned { .. } => {
                at.weight * self.normal(i, u).hypot(self.normal(i + 1, u)) / at.gamma
            }
            Piece::Free => {
                let place = self.place(i, &line, u);
                let value = self.value_and_slope(i, self.jumps_below(i, z), place).0;
                if at.span == 1 {
                    return at.weight * (pressure[i] - value).abs();
                }
                let [a, b] = line.along.map(|along| along * value);
                at.weight * (pressure[i] - a).hypot(pressure[i + 1] - b)
            }
        }
    }
}
