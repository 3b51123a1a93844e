//! The fields of an exact solution given by formulas, cut where their guards change sign.

use std::sync::Arc;

use super::edges::EdgeSample;
use super::fields::{CellValues, Fields, Forces, Remembered, Volume, sort_interior};
use super::sides::SideEdges;
use super::strips::CellPoints;
use exact::{Exact, sign_changes};
use fem::contact::{Discretization, LoadError};
use formula::{BoundProgram, Program, Variable};
use scene::setup::{Setup, side_numbers};

/// Intervals of the domain's width in which vertical guards are watched.
const WATCHES: usize = 256;
/// A cell counts as crossed if zero is within its range of a guard, widened by this part at both
/// ends: the points do not reach into the corners.
const MARGIN: f64 = 0.25;

/// A smooth truth on one mesh.
pub(crate) struct SmoothFields {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    width: [f64; 2],
    /// Guards that are constant along y: their zeros are vertical lines.
    vertical: Program,
    vertical_count: usize,
    bent_count: usize,
    /// Points of all cells without cuts.
    plain: CellPoints,
    interior: BoundProgram,
    forces: BoundProgram,
    /// All other guards, such as ‖ε^D‖ - κ.
    bent_at_points: BoundProgram,
    nodal: BoundProgram,
    remembered: (Vec<f64>, BoundProgram),
    sides: Vec<SideEdges>,
}

impl SmoothFields {
    pub(crate) fn new(setup: &Setup, exact: &Arc<Exact>, space: &Arc<Discretization>) -> Self {
        let horizon = exact.data.horizon;
        let mut graph = exact.data.graph.clone();
        let mut fields = exact.data.u.clone();
        fields.extend(exact.stress.iter().chain(&exact.body_force));
        let (bent, vertical): (Vec<_>, Vec<_>) = graph
            .guards(&fields)
            .into_iter()
            .filter(|&guard| {
                [Variable::X, Variable::Y, Variable::T].iter().any(|&v| graph.depends_on(guard, v))
            })
            .partition(|&guard| {
                graph.depends_on(guard, Variable::Y) || graph.depends_on(guard, Variable::Zeta)
            });
        let vertical_program = Program::compile(&mut graph, &vertical, horizon);
        let bent_program = Program::compile(&mut graph, &bent, horizon);
        let displacement = Program::compile(&mut graph, &exact.data.u, horizon);
        let mut plain = CellPoints::default();
        for c in 0..space.mesh.cell_count() {
            plain.add(c as u32, &triangle(space, c), &[]);
        }
        let vertices: Vec<[f64; 3]> =
            space.nodes.vertex.iter().map(|&v| space.mesh.point(&[v], &[1.0])).collect();
        let domain = &setup.body.domain;
        let (traction, contact) = (side_numbers(&domain.traction), side_numbers(&domain.contact));
        Self {
            width: domain.width(),
            vertical: vertical_program,
            vertical_count: vertical.len(),
            interior: exact.interior.bind(&plain.points),
            forces: exact.forces.bind(&plain.points),
            bent_at_points: bent_program.bind(&plain.points),
            bent_count: bent.len(),
            nodal: displacement.bind(&vertices),
            remembered: fixed_points(exact, space),
            sides: SideEdges::all(exact, space, &traction, &contact),
            plain,
            exact: exact.clone(),
            space: space.clone(),
        }
    }

    /// Vertical lines on which a field has a kink at t: zeros of the guards now, and at time 0, where
    /// hereditary integrals keep the kink with which a zone began.
    fn cuts(&self, t: f64) -> Vec<f64> {
        let mut cuts = Vec::new();
        for time in [t, 0.0] {
            cuts.extend(sign_changes(self.width[0], self.width[1], WATCHES, |places| {
                let points: Vec<[f64; 3]> = places.iter().map(|&x| [x, 0.0, 0.0]).collect();
                let mut values = vec![Vec::new(); self.vertical_count];
                self.vertical.bind(&points).evaluate(time, 0.0, &mut values);
                values
            }));
        }
        cuts.sort_by(f64::total_cmp);
        cuts
    }

    /// Cells in which a bent guard changes sign.
    fn crossed(&mut self, t: f64, zeta: f64) -> Vec<bool> {
        let cells = self.space.mesh.cell_count();
        let mut crossed = vec![false; cells];
        let mut values = vec![Vec::new(); self.bent_count];
        self.bent_at_points.evaluate(t, zeta, &mut values);
        for guard in &values {
            let mut range = vec![[f64::INFINITY, f64::NEG_INFINITY]; cells];
            for (&c, &value) in self.plain.cells.iter().zip(guard) {
                let [low, high] = &mut range[c as usize];
                (*low, *high) = (low.min(value), high.max(value));
            }
            for (flag, [low, high]) in crossed.iter_mut().zip(range) {
                let margin = MARGIN * (high - low);
                *flag |= low - margin < 0.0 && high + margin > 0.0;
            }
        }
        crossed
    }

    /// The fields at points bound for this time alone.
    fn at(&self, at: CellPoints, t: f64, zeta: f64) -> CellValues {
        if at.points.is_empty() {
            return CellValues::default();
        }
        let mut interior = self.exact.interior.bind(&at.points);
        let mut forces = self.exact.forces.bind(&at.points);
        let outputs = 5 + self.exact.memory.len();
        values(at, outputs, &mut interior, &mut forces, [t, zeta])
    }
}

fn values(
    at: CellPoints,
    outputs: usize,
    interior: &mut BoundProgram,
    forces: &mut BoundProgram,
    [t, zeta]: [f64; 2],
) -> CellValues {
    let mut out = vec![Vec::new(); outputs];
    interior.evaluate(t, 0.0, &mut out);
    let (u, strain, history) = sort_interior(out);
    let mut force = [Vec::new(), Vec::new()];
    forces.evaluate(t, zeta, &mut force);
    CellValues { at, u, strain, history, force }
}

impl Fields for SmoothFields {
    fn volume(&mut self, t: f64, zeta: f64) -> Result<Volume, LoadError> {
        let cuts = self.cuts(t);
        let crossed = self.crossed(t, zeta);
        let (mut cut, mut fine, mut coarse) =
            (CellPoints::default(), CellPoints::default(), CellPoints::default());
        let mut elsewhere = vec![false; crossed.len()];
        for (c, crossed) in crossed.iter().enumerate() {
            let corners = triangle(&self.space, c);
            let inside =
                |x: &f64| corners.iter().any(|p| p[0] < *x) && corners.iter().any(|p| p[0] > *x);
            if *crossed {
                fine.add_refined(c as u32, &corners, &cuts, 2);
                coarse.add_refined(c as u32, &corners, &cuts, 1);
            } else if cuts.iter().any(inside) {
                cut.add(c as u32, &corners, &cuts);
            } else {
                continue;
            }
            elsewhere[c] = true;
        }
        let outputs = 5 + self.exact.memory.len();
        let (interior, forces) = (&mut self.interior, &mut self.forces);
        let mut plain = values(self.plain.clone(), outputs, interior, forces, [t, zeta]);
        // Cells with cuts are integrated by the points of their parts.
        for (weight, &c) in plain.at.weights.iter_mut().zip(&plain.at.cells) {
            if elsewhere[c as usize] {
                *weight = 0.0;
            }
        }
        append(&mut plain, self.at(cut, t, zeta));
        Ok(Volume { plain, crossed: self.at(fine, t, zeta), check: self.at(coarse, t, zeta) })
    }

    fn edges(
        &mut self,
        t: f64,
        zeta: f64,
        traces: &[&[f64]],
    ) -> Result<Vec<EdgeSample>, LoadError> {
        let mut samples = Vec::new();
        for side in &self.sides {
            samples.extend(side.samples(&self.exact, &self.space, t, zeta, traces));
        }
        Ok(samples)
    }

    fn interpolant(&mut self, t: f64) -> Result<Vec<f64>, LoadError> {
        let mut out = vec![Vec::new(); 2];
        self.nodal.evaluate(t, 0.0, &mut out);
        let mut nodal: Vec<f64> = out[0].iter().zip(&out[1]).flat_map(|(&x, &y)| [x, y]).collect();
        nodal[self.space.dofs()..].fill(0.0);
        Ok(nodal)
    }

    fn zeta(&mut self, t: f64) -> Result<Option<f64>, LoadError> {
        Ok(Some(self.exact.zeta.at(t)).filter(|zeta| !zeta.is_nan()))
    }

    fn remembered(&mut self, t: f64) -> Result<Remembered, LoadError> {
        let mut out = vec![Vec::new(); 5 + self.exact.memory.len()];
        let (weights, bound) = &mut self.remembered;
        bound.evaluate(t, 0.0, &mut out);
        let (_, strain, history) = sort_interior(out);
        Ok(Remembered { weights: weights.clone(), strain, history })
    }

    fn forces(&self) -> Forces {
        Forces::Strong
    }

    fn nodal_multiplier(&mut self, _: f64) -> Result<Option<Vec<f64>>, LoadError> {
        Ok(None)
    }
}

fn append(to: &mut CellValues, from: CellValues) {
    to.at.points.extend(from.at.points);
    to.at.weights.extend(from.at.weights);
    to.at.cells.extend(from.at.cells);
    let join = |a: &mut [Vec<f64>], b: Vec<Vec<f64>>| {
        for (a, b) in a.iter_mut().zip(b) {
            a.extend(b);
        }
    };
    join(&mut to.u, from.u.into());
    join(&mut to.strain, from.strain.into());
    join(&mut to.history, from.history.into());
    join(&mut to.force, from.force.into());
}

/// Three points per cell, exact for degree 2: enough for the norm of a truncation error.
fn fixed_points(exact: &Exact, space: &Discretization) -> (Vec<f64>, BoundProgram) {
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    let (near, far) = (2.0 / 3.0, 1.0 / 6.0);
    for c in 0..space.mesh.cell_count() {
        for b in [[near, far, far], [far, near, far], [far, far, near]] {
            points.push(space.mesh.point(space.mesh.cell(c), &b));
            weights.push(space.geometry.measure[c] / 3.0);
        }
    }
    (weights, exact.interior.bind(&points))
}

/// Points of all cells without cuts.
pub(super) fn point_count(space: &Discretization) -> usize {
    let mut of_cell = CellPoints::default();
    let count = |c: usize| {
        of_cell.points.clear();
        of_cell.add(c as u32, &triangle(space, c), &[]);
        of_cell.points.len()
    };
    (0..space.mesh.cell_count()).map(count).sum()
}

fn triangle(space: &Discretization, c: usize) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|a| {
        let vertex = space.mesh.vertex(space.mesh.cell(c)[a]);
        [vertex[0], vertex[1]]
    })
}
