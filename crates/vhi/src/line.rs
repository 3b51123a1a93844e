//! Vector-valued laws, reduced to a line.
//!
//! A scalar law acts on the axis of its coordinate. A vector law is r ↦ S(|r|) r/|r| with the scalar law r ↦ S(|r|)
//! sign r: along the line of z = r + γ s it is that law, and across the line, to first order, the spring S/|r|. The
//! line turns with z. |z| is at least γ S where the vector slips, so the line is known to rounding however small the
//! slip, which r alone would not tell.

use std::ops::Range;

use super::{BoundaryGraph, GraphPiece, StepState};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlipLine {
    pub(crate) along: [f64; 2],
    /// The stiffness across it, over the weight.
    across: f64,
}

impl SlipLine {
    pub(crate) const AXIS: Self = Self { along: [1.0, 0.0], across: 0.0 };
}

/// A slip shorter than this share of γ S gets the spring of this one: a spring 1e8 times as stiff as the body fixes the
/// direction as well, and leaves half of the digits to the stiffness along it.
const SHORTEST: f64 = 1e-8;

/// Units of rounding by which an argument is moved: enough that the rounding of a law is a small share of its change.
const MOVED: f64 = 8.0;

/// What rounding changes in a law at `place`, a difference of numbers that have the sum `size`, over ε. Not by a slope: a
/// kink beside the place counts.
pub fn rounding_of(law: impl Fn(f64) -> f64, place: f64, size: f64) -> f64 {
    let by = MOVED * f64::EPSILON * size;
    (law(place + by) - law(place - by)).abs() / (2.0 * MOVED * f64::EPSILON)
}

impl BoundaryGraph {
    /// The first coordinates of all laws.
    pub(crate) fn laws(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.coordinates.len()).filter(|&i| self.coordinates[i].span > 0)
    }

    /// The coordinates of the law that begins at i.
    pub(crate) fn span(&self, i: usize) -> Range<usize> {
        i..i + usize::from(self.coordinates[i].span)
    }

    /// Number of slopes of a level: one per coordinate, and one per vector.
    pub(crate) fn slopes(&self) -> usize {
        let vectors = self.coordinates.iter().filter(|at| at.span > 1).count();
        self.coordinates.len() + vectors
    }

    /// The line of the law at i for (u, c), and the place z ≥ 0 on it; for a scalar law the axis and any z.
    pub(crate) fn line(&self, i: usize, u: &[f64], pressure: &[f64]) -> (SlipLine, f64) {
        let at = &self.coordinates[i];
        let z = |j: usize| self.normal(j, u) + at.gamma * pressure[j];
        if at.span == 1 {
            return (SlipLine::AXIS, z(i));
        }
        let [a, b] = [z(i), z(i + 1)];
        let length = a.hypot(b);
        if length == 0.0 {
            return (SlipLine::AXIS, 0.0);
        }
        let mut line = SlipLine { along: [a / length, b / length], across: 0.0 };
        if self.piece(i, length) != GraphPiece::Free {
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

    pub(crate) fn place(&self, i: usize, line: &SlipLine, u: &[f64]) -> f64 {
        match self.coordinates[i].span {
            1 => self.normal(i, u),
            _ => line.along[0] * self.normal(i, u) + line.along[1] * self.normal(i + 1, u),
        }
    }

    /// The pressures of a law that is free above `below` jumps, linear across its line.
    pub(crate) fn set_pressures(
        &self,
        i: usize,
        (below, line): (usize, &SlipLine),
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

    /// Its slopes, times the weight: on the coordinates, and for vectors the mixed one at `mixed`.
    pub(crate) fn set_slopes(
        &self,
        i: usize,
        (below, line): (usize, SlipLine),
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

    /// Adds how large the parts u_ν - s of the forces w c are before they cancel, by dofs: the change of c by rounding of u_ν
    /// and s, over ε. A coordinate that is pinned has its value exactly.
    pub fn add_rounding(&self, state: &StepState, sizes: &mut [f64]) {
        for i in self.laws() {
            let (line, z) = self.line(i, &state.u, &state.pressure);
            if self.piece(i, z) != GraphPiece::Free {
                continue;
            }
            let (below, place) = (self.jumps_below(i, z), self.place(i, &line, &state.u));
            let law = |value: f64| self.value_and_slope(i, below, value).0;
            let size = place.abs() + self.coordinates[i].shift.abs();
            let change = self.coordinates[i].weight * rounding_of(law, place, size);
            for (j, along) in self.span(i).zip(line.along) {
                sizes[self.coordinates[j].dof as usize] += change * along.abs();
            }
        }
    }

    /// Distance of (u_ν, c) from the graph, as a force: zero exactly on the graph.
    ///
    /// On a pinned piece it is w·dist(c, [lo, hi]) with u_ν at its value; else the violation of the bound over γ;
    /// continuous in both.
    pub(crate) fn defect(&self, i: usize, u: &[f64], pressure: &[f64]) -> f64 {
        let at = &self.coordinates[i];
        let (line, z) = self.line(i, u, pressure);
        match self.piece(i, z) {
            GraphPiece::Pinned { value, .. } if at.span == 1 => {
                at.weight * (self.normal(i, u) - value).abs() / at.gamma
            }
            GraphPiece::Pinned { .. } => {
                at.weight * self.normal(i, u).hypot(self.normal(i + 1, u)) / at.gamma
            }
            GraphPiece::Free => {
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::PiecewiseLinear;
    use crate::{Coordinate, Newton, Scratch, StepInequality, StepState};
    use algebra::linalg::FactorError;

    const WEIGHT: f64 = 0.5;
    const STIFFNESS: f64 = 3.0;

    /// One vertex on a spring, k u + w s = f with s ∈ S(|u|) ∂|u|: the second unknown is -u_2.
    struct Vertex {
        graph: BoundaryGraph,
        load: [f64; 2],
        tangent: [f64; 3],
        prescribed: Vec<Option<f64>>,
        iterations: usize,
    }

    fn vertex(points: Vec<(f64, f64)>, load: [f64; 2]) -> Vertex {
        let backward = points.iter().rev().map(|&(r, s)| (-r, -s));
        let both = backward.chain(points.iter().copied()).collect();
        let coordinate = |dof: u32| Coordinate {
            dof,
            sign: if dof == 0 { 1.0 } else { -1.0 },
            weight: WEIGHT,
            gap: f64::INFINITY,
            floor: f64::NEG_INFINITY,
            law: 0,
            shift: 0.0,
            gamma: WEIGHT / STIFFNESS,
            span: if dof == 0 { 2 } else { 0 },
        };
        let graph = BoundaryGraph {
            coordinates: vec![coordinate(0), coordinate(1)],
            potentials: vec![Arc::new(PiecewiseLinear::new(both, 0.0, 0.0).expect("a law"))],
        };
        let (tangent, prescribed) = ([0.0; 3], Vec::new());
        Vertex { graph, load: [load[0], -load[1]], tangent, prescribed, iterations: 0 }
    }

    impl StepInequality for Vertex {
        fn dofs(&self) -> usize {
            2
        }

        fn graph(&self) -> &BoundaryGraph {
            &self.graph
        }

        fn residual(&mut self, u: &[f64], out: &mut [f64]) {
            (0..2).for_each(|i| out[i] = STIFFNESS * u[i] - self.load[i]);
        }

        fn linearize(
            &mut self,
            slopes: &[f64],
            prescribed: &[Option<f64>],
        ) -> Result<(), FactorError> {
            self.tangent = [STIFFNESS + slopes[0], STIFFNESS + slopes[1], slopes[2]];
            self.prescribed = prescribed.to_vec();
            self.iterations += 1;
            Ok(())
        }

        fn solve(&mut self, rhs: &mut [f64], _: f64) -> Result<(), FactorError> {
            let ([a, b, c], [f, g]) = (self.tangent, [rhs[0], rhs[1]]);
            match self.prescribed[..] {
                [Some(x), Some(y)] => rhs.copy_from_slice(&[x, y]),
                _ => {
                    let determinant = a * b - c * c;
                    rhs[0] = (b * f - c * g) / determinant;
                    rhs[1] = (a * g - c * f) / determinant;
                }
            }
            Ok(())
        }

        fn force_scale(&self, u: &[f64]) -> f64 {
            STIFFNESS * u[0].hypot(u[1]) + self.load[0].hypot(self.load[1])
        }
    }

    /// u = f/|f| (|f| - w S)/k where positive, from starts on all sides of 0; also for slips within the rounding of the
    /// forces, where u alone has no direction.
    #[test]
    fn a_vertex_on_a_spring_slips_along_its_load() {
        let bound = 0.4;
        for excess in [-0.5, -1e-9, 1e-14, 1e-10, 1e-6, 1e-2, 0.3, 5.0] {
            for turn in 0..12 {
                let (along, size) = (
                    f64::from(turn) * std::f64::consts::FRAC_PI_6 + 0.1,
                    WEIGHT * bound * (1.0 + excess),
                );
                let load = [size * along.cos(), size * along.sin()];
                for start in [[0.0, 0.0], [0.3, -0.2], [-0.4, 0.1], [1e-9, 1e-9]] {
                    let mut problem = vertex(vec![(0.0, bound)], load);
                    let mut state = StepState { u: start.to_vec(), pressure: vec![0.0; 2] };
                    let info =
                        Newton::standard().solve(&mut problem, &mut state, &mut Scratch::default());
                    let info = info.unwrap_or_else(|e| panic!("{excess} {turn} {start:?}: {e}"));
                    let slip = WEIGHT * bound * excess.max(0.0) / STIFFNESS;
                    let wanted = [slip * along.cos(), -slip * along.sin()];
                    let off = (state.u[0] - wanted[0]).hypot(state.u[1] - wanted[1]);
                    // The tolerance of the residual, over the stiffness.
                    assert!(off <= 1e-14 * (1.0 + slip), "{excess} {turn} {start:?}: {off}");
                    // Back through 0, then once or twice for the curvature of the circle.
                    assert!(info.iterations <= 9, "{excess} {turn} {start:?}: {}", info.iterations);
                }
            }
        }
    }

    /// Slopes against differences of S(|u|) u/|u|, for a falling and a rising bound.
    #[test]
    fn slopes_are_differences() {
        const STEP: f64 = 1e-6;
        for points in [vec![(0.0, 0.4), (0.5, 0.3)], vec![(0.0, 0.1), (0.5, 0.7)]] {
            let graph = vertex(points.clone(), [0.0; 2]).graph;
            let ((_, s0), (r1, s1)) = (points[0], points[1]);
            // In unknowns: a displacement (x, -y), a force w (s_1, -s_2).
            let force = |[x, y]: [f64; 2]| {
                let r = x.hypot(y);
                [x, y].map(|component| WEIGHT * (s0 + (s1 - s0) * r / r1) * component / r)
            };
            let at = [0.11, -0.17];
            let s = force(at).map(|component| component / WEIGHT);
            let state = StepState { u: at.to_vec(), pressure: vec![s[0], -s[1]] };
            let (slopes, prescribed) = graph.pieces(&state);
            assert_eq!(prescribed, [None, None]);
            for (j, column) in [[slopes[0], slopes[2]], [slopes[2], slopes[1]]].iter().enumerate() {
                let moved = |sign: f64| {
                    let mut at = at;
                    at[j] += sign * STEP;
                    force(at)
                };
                let (plus, minus) = (moved(1.0), moved(-1.0));
                for (i, slope) in column.iter().enumerate() {
                    let difference = (plus[i] - minus[i]) / (2.0 * STEP);
                    // STEP² times a third derivative S/|u|³ of about 50; rounding 1e-16/STEP.
                    assert!((difference - slope).abs() < 1e-8, "{i} {j}: {difference} {slope}");
                }
            }
        }
    }
}
