//! Graphs G = ∂j_ν(· - s) + ∂I_{[floor, g]} on single coordinates, and the choice of a piece.
//!
//! The unilateral constraint is the last vertical piece of the graph, a jump of ∂j_ν an inner one; one rule serves
//! both. For γ α_ν < 1 the map (u, c) ↦ z = u + γ c is one to one along the graph, so z selects the piece: the
//! primal-dual active set strategy.

use std::sync::Arc;

use super::StepState;
use crate::law::Potential;

/// The coordinate a graph sits on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    pub dof: u32,
    /// u_ν = sign · u.
    pub sign: f64,
    /// Weight w of the pressure in the force balance.
    pub weight: f64,
    /// The bound g, or ∞.
    pub gap: f64,
    /// The lower bound, or -∞ (always, in contact).
    pub floor: f64,
    pub law: u32,
    /// The shift s of the potential: ∂j_ν(u_ν - s).
    pub shift: f64,
    /// γ (length/pressure), the scaling of the complementarity condition.
    pub gamma: f64,
    /// Number of consecutive coordinates that the law takes as one vector, starting here: 1 for a scalar law, 0 inside
    /// a vector.
    pub span: u8,
}

/// The piece of a graph on which a coordinate lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GraphPiece {
    /// c is the (single) value of ∂j_ν.
    Free,
    /// u_ν is fixed at `value`, c lies in [lo, hi] (hi = ∞ at the bound, lo = -∞ at the lower one).
    Pinned { value: f64, lo: f64, hi: f64 },
}

/// All graphs of a time level.
pub struct BoundaryGraph {
    pub coordinates: Vec<Coordinate>,
    /// [`crate::law::NoPotential`] where the graph has only the constraint.
    pub potentials: Vec<Arc<dyn Potential>>,
}

impl BoundaryGraph {
    fn potential(&self, i: usize) -> &dyn Potential {
        &*self.potentials[self.coordinates[i].law as usize]
    }

    /// α of (2.8c) of the potential of coordinate i.
    pub fn descent(&self, i: usize) -> f64 {
        self.potential(i).alpha()
    }

    /// The piece that z = u_ν + γ c selects for coordinate i.
    pub fn piece(&self, i: usize, z: f64) -> GraphPiece {
        let (at, potential) = (&self.coordinates[i], self.potential(i));
        if at.gap.is_finite() {
            let lo = potential.subdifferential(at.gap - at.shift).0;
            if z >= at.gap + at.gamma * lo {
                return GraphPiece::Pinned { value: at.gap, lo, hi: f64::INFINITY };
            }
        }
        if at.floor.is_finite() {
            let hi = potential.subdifferential(at.floor - at.shift).1;
            if z <= at.floor + at.gamma * hi {
                return GraphPiece::Pinned { value: at.floor, lo: f64::NEG_INFINITY, hi };
            }
        }
        for &jump in potential.jumps() {
            let value = jump + at.shift;
            let (lo, hi) = potential.subdifferential(jump);
            if value > at.floor
                && value < at.gap
                && z >= value + at.gamma * lo
                && z <= value + at.gamma * hi
            {
                return GraphPiece::Pinned { value, lo, hi };
            }
        }
        GraphPiece::Free
    }

    /// Number of jumps below the free piece that z selects.
    pub(crate) fn jumps_below(&self, i: usize, z: f64) -> usize {
        let (at, potential) = (&self.coordinates[i], self.potential(i));
        let passed =
            |jump: &f64| z > jump + at.shift + at.gamma * potential.subdifferential(*jump).1;
        potential.jumps().partition_point(passed)
    }

    /// The first jump (a value of u_ν) between the free piece above `before` jumps and the one that z selects; None if
    /// they are the same.
    pub(crate) fn jump_across(&self, i: usize, before: usize, z: f64) -> Option<f64> {
        let now = self.jumps_below(i, z);
        let crossed = match now.cmp(&before) {
            std::cmp::Ordering::Greater => before,
            std::cmp::Ordering::Less => before - 1,
            std::cmp::Ordering::Equal => return None,
        };
        Some(self.potential(i).jumps()[crossed] + self.coordinates[i].shift)
    }

    /// Pressure and slope of a free coordinate above `below` jumps. The branch is chosen by z, so an argument that
    /// rounding has put on or beyond the next jump is moved back.
    pub fn value_and_slope(&self, i: usize, below: usize, normal: f64) -> (f64, f64) {
        let potential = self.potential(i);
        let jumps = potential.jumps();
        let mut r = normal - self.coordinates[i].shift;
        if let Some(last) = below.checked_sub(1).and_then(|last| jumps.get(last)) {
            r = r.max(last.next_up());
        }
        if let Some(next) = jumps.get(below) {
            r = r.min(next.next_down());
        }
        potential.value_and_slope(r)
    }

    /// u_ν of coordinate i.
    pub fn normal(&self, i: usize, u: &[f64]) -> f64 {
        let at = &self.coordinates[i];
        at.sign * u[at.dof as usize]
    }

    /// Slopes of the free coordinates at a solution (a stiffness), in the order of
    /// [`crate::StepInequality::linearize`], and increment 0 on the pinned ones.
    pub fn pieces(&self, solution: &StepState) -> (Vec<f64>, Vec<Option<f64>>) {
        let mut slopes = vec![0.0; self.slopes()];
        let mut prescribed = vec![Some(0.0); self.coordinates.len()];
        let mut mixed = self.coordinates.len();
        for i in self.laws() {
            let (line, z) = self.line(i, &solution.u, &solution.pressure);
            if self.piece(i, z) == GraphPiece::Free {
                let below = self.jumps_below(i, z);
                self.set_slopes(i, (below, line), &solution.u, (&mut slopes, mixed));
                prescribed[self.span(i)].fill(None);
            }
            mixed += usize::from(self.coordinates[i].span > 1);
        }
        (slopes, prescribed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::PiecewiseLinear;

    fn graph() -> BoundaryGraph {
        let points = vec![(0.0, 0.0), (0.0, 1.0), (0.5, 0.8)];
        let at = Coordinate {
            dof: 0,
            sign: -1.0,
            weight: 0.5,
            gap: 0.6,
            floor: -0.4,
            law: 0,
            shift: 0.1,
            gamma: 0.3,
            span: 1,
        };
        BoundaryGraph {
            coordinates: vec![at],
            potentials: vec![Arc::new(PiecewiseLinear::new(points, 0.0, 0.0).unwrap())],
        }
    }

    fn defect(graph: &BoundaryGraph, normal: f64, pressure: f64) -> f64 {
        graph.defect(0, &[graph.coordinates[0].sign * normal], &[pressure])
    }

    /// Every point of the graph selects its piece.
    #[test]
    fn z_selects_the_piece_that_it_came_from() {
        let graph = graph();
        let gamma = 0.3;
        assert_eq!(graph.piece(0, -0.2), GraphPiece::Free);
        let jump = GraphPiece::Pinned { value: 0.1, lo: 0.0, hi: 1.0 };
        assert_eq!(graph.piece(0, 0.1 + gamma * 0.4), jump);
        let (pressure, _) = graph.value_and_slope(0, 1, 0.3);
        assert_eq!(graph.piece(0, 0.3 + gamma * pressure), GraphPiece::Free);
        let floor = GraphPiece::Pinned { value: -0.4, lo: f64::NEG_INFINITY, hi: 0.0 };
        assert_eq!(graph.piece(0, -0.4 - gamma * 0.5), floor);
        let bound = GraphPiece::Pinned { value: 0.6, lo: 0.8, hi: f64::INFINITY };
        assert_eq!(graph.piece(0, 0.6 + gamma * 2.0), bound);
    }

    /// Rounding at the ends of the jump must not leave the chosen branch.
    #[test]
    fn a_free_coordinate_stays_on_its_branch() {
        let graph = graph();
        for normal in [0.1f64.next_down(), 0.1, 0.1f64.next_up()] {
            assert_eq!(graph.value_and_slope(0, 0, normal).0, 0.0);
            // The slope -0.4 over a few units of rounding.
            assert!((graph.value_and_slope(0, 1, normal).0 - 1.0).abs() < 1e-15);
            for pressure in [0.0, 1.0] {
                assert!(defect(&graph, normal, pressure) < 1e-15, "{normal} {pressure}");
            }
        }
    }

    #[test]
    fn defect_vanishes_on_the_graph_and_only_there() {
        let graph = graph();
        for (normal, pressure) in [(0.1, 0.4), (0.6, 3.0), (-0.3, 0.0), (-0.4, -2.0)] {
            assert!(defect(&graph, normal, pressure) < 1e-15, "{normal} {pressure}");
        }
        for (normal, pressure) in [(0.1, 1.4), (0.7, 3.0), (-0.3, 0.2), (0.6, 0.2), (-0.5, -1.0)] {
            assert!(defect(&graph, normal, pressure) > 1e-3, "{normal} {pressure}");
        }
    }
}
