//! Quadrature points on lines along the axes, cut where guards of the stress change sign.
//!
//! The axes are taken in the order z, x, y. Along each, a line is cut at sign changes of guards that vary along it and
//! earlier axes only: a front x = x0(z, t) cuts each line along x at its position.

use crate::Exact;
use crate::sign_changes::{Guards, sign_changes};
use crate::symbolic::AXES;
use fem::space::quadrature::gauss_legendre;
use formula::Node;

/// The order of the axes.
const ORDER: [usize; 3] = [2, 0, 1];
/// Gauss points per piece and pieces per direction, in the plane and in space.
const POINTS: usize = 6;
const PIECES: [usize; 2] = [32, 6];
/// Intervals of a line on which guards are watched.
const WATCHES: usize = 64;

/// The guards of the stress at one time, and at t = 0, where histories begin.
pub(super) struct Lines<'a> {
    size: &'a [f64],
    guards: Guards,
    depends: Vec<[bool; 3]>,
    times: [f64; 2],
}

impl<'a> Lines<'a> {
    pub(super) fn new(exact: &'a Exact, t: f64) -> Self {
        let graph = &exact.data.graph;
        // The stress has the guards of strain and memory, and those of regions.
        let named = exact.data.regions.iter().map(|region| region.condition);
        let nodes: Vec<Node> = exact.strain.iter().chain(&exact.memory).copied().collect();
        let mut all: Vec<(Node, [bool; 3])> = Vec::new();
        for guard in graph.guards(&nodes).into_iter().chain(named) {
            all.push((guard, AXES.map(|axis| graph.depends_on(guard, axis))));
        }
        let guards: Vec<Node> = all.iter().map(|(guard, _)| *guard).collect();
        Self {
            size: &exact.data.size,
            guards: Guards::new(graph, &guards, exact.data.horizon),
            depends: all.into_iter().map(|(_, depends)| depends).collect(),
            times: [t, 0.0],
        }
    }

    /// Sign changes, on the line along an axis through `point`, of guards that depend on this axis and otherwise on
    /// `known` axes only.
    fn changes(&self, axis: usize, point: [f64; 3], known: [bool; 3]) -> Vec<f64> {
        let decides = |depends: &[bool; 3]| {
            depends[axis] && (0..3).all(|i| i == axis || known[i] || !depends[i])
        };
        let chosen: Vec<bool> = self.depends.iter().map(decides).collect();
        let mut found = Vec::new();
        if !chosen.contains(&true) {
            return found;
        }
        let width = self.size[axis];
        for time in self.times {
            found.extend(sign_changes(0.0, width, WATCHES, |places| {
                let at = |&place: &f64| {
                    let mut moved = point;
                    moved[axis] = place;
                    moved
                };
                let points: Vec<[f64; 3]> = places.iter().map(at).collect();
                let mut values = self.guards.at(&points, time);
                // The other guards are ignored.
                let ignored = values.iter_mut().zip(&chosen).filter(|(_, chosen)| !**chosen);
                ignored.for_each(|(values, _)| values.fill(0.0));
                values
            }));
        }
        found.sort_by(f64::total_cmp);
        found.dedup_by(|a, b| (*a - *b).abs() < 1e-12 * width);
        found.retain(|&x| x > 1e-9 * width && x < width * (1.0 - 1e-9));
        found
    }

    pub(super) fn straight(&self, axis: usize) -> Vec<f64> {
        self.changes(axis, [0.0; 3], [false; 3])
    }

    /// The ends of the pieces of such a line.
    fn cuts(&self, axis: usize, point: [f64; 3], known: [bool; 3]) -> Vec<f64> {
        let (width, pieces) = (self.size[axis], PIECES[self.size.len() - 2]);
        let mut cuts: Vec<f64> = (0..=pieces).map(|i| width * i as f64 / pieces as f64).collect();
        cuts.extend(self.changes(axis, point, known));
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| (*a - *b).abs() < 1e-13 * width);
        cuts
    }

    /// Quadrature points and weights over all axes but `fixed`, which has the value `level`.
    pub(super) fn across(&self, fixed: usize, level: f64) -> Vec<([f64; 3], f64)> {
        let (mut start, mut known) = ([0.0; 3], [false; 3]);
        (start[fixed], known[fixed]) = (level, true);
        self.over(&ORDER.map(|axis| (axis, axis != fixed)), start, known)
    }

    /// The lines along y, by x and z, with weights.
    pub(super) fn along_y(&self) -> Vec<([f64; 3], f64)> {
        self.over(&ORDER.map(|axis| (axis, axis != 1)), [0.0; 3], [false; 3])
    }

    /// The pieces of a line along y, with additional cuts.
    pub(super) fn on_line(&self, line: [f64; 3], further: &[f64]) -> Vec<(f64, f64)> {
        let mut cuts = self.cuts(1, line, [true, false, true]);
        cuts.extend(further);
        cuts.sort_by(f64::total_cmp);
        on_pieces(&cuts)
    }

    fn over(
        &self,
        axes: &[(usize, bool)],
        start: [f64; 3],
        mut known: [bool; 3],
    ) -> Vec<([f64; 3], f64)> {
        let mut points = vec![(start, 1.0)];
        let taken_axes = axes.iter().filter(|(axis, taken)| *taken && *axis < self.size.len());
        for &(axis, _) in taken_axes {
            let mut next = Vec::new();
            for (point, weight) in points {
                for (place, share) in on_pieces(&self.cuts(axis, point, known)) {
                    let mut point = point;
                    point[axis] = place;
                    next.push((point, weight * share));
                }
            }
            points = next;
            known[axis] = true;
        }
        points
    }
}

fn on_pieces(cuts: &[f64]) -> Vec<(f64, f64)> {
    let rule = gauss_legendre(POINTS);
    let piece = |pair: &[f64]| {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        rule.iter().map(|(x, w)| (middle + half * x, half * w)).collect::<Vec<_>>()
    };
    cuts.windows(2).flat_map(piece).collect()
}
