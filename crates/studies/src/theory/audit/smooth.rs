//! The fields of an exact solution given by formulas, cut where their guards change sign.

use std::sync::Arc;

use super::edges::EdgeSample;
use super::fields::{CellValues, Fields, Volume, sort_interior, vectors};
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
    /// Of the points of all cells without cuts, and all other guards there, such as ‖ε^D‖ - κ.
    cells: Vec<u32>,
    bent: BoundProgram,
    nodal: BoundProgram,
    remembered: (CellPoints, BoundProgram),
    sides: Vec<SideEdges>,
}

impl SmoothFields {
    pub(crate) fn new(setup: &Setup, exact: &Arc<Exact>, space: &Arc<Discretization>) -> Self {
        let horizon = exact.data.horizon;
        let graph = exact.data.graph.clone();
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
        let displacement = Program::compile(&graph, &exact.data.u, horizon);
        let mut whole = CellPoints::default();
        for c in 0..space.mesh.cell_count() {
            whole.add(c as u32, &triangle(space, c), &[]);
        }
        let vertices: Vec<[f64; 3]> =
            space.nodes.vertex.iter().map(|&v| space.mesh.point(&[v], &[1.0])).collect();
        let domain = &setup.body.domain;
        let (traction, contact) = (side_numbers(&domain.traction), side_numbers(&domain.contact));
        Self {
            width: domain.width(),
            vertical: Program::compile(&graph, &vertical, horizon),
            bent: Program::compile(&graph, &bent, horizon).bind(&whole.points),
            cells: whole.cells,
            nodal: displacement.bind(&vertices),
            remembered: fixed_points(exact, space),
            sides: SideEdges::all(exact, space, &traction, &contact),
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
                self.vertical.values(&points, time, 0.0)
            }));
        }
        cuts.sort_by(f64::total_cmp);
        cuts
    }

    /// Cells in which a bent guard changes sign.
    fn crossed(&mut self, t: f64, zeta: f64) -> Vec<bool> {
        let cells = self.space.mesh.cell_count();
        let mut crossed = vec![false; cells];
        for guard in self.bent.values_at(t, zeta) {
            let mut range = vec![[f64::INFINITY, f64::NEG_INFINITY]; cells];
            for (&c, &value) in self.cells.iter().zip(&guard) {
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

    fn at(&self, at: CellPoints, t: f64, zeta: f64) -> CellValues {
        if at.points.is_empty() {
            return CellValues::default();
        }
        let (u, strain, history) = sort_interior(&self.exact.interior.values(&at.points, t, 0.0));
        let force = vectors(&self.exact.forces.values(&at.points, t, zeta));
        CellValues { at, u, strain, history, force }
    }
}

impl Fields for SmoothFields {
    fn volume(&mut self, t: f64, zeta: f64) -> Result<Volume, LoadError> {
        let cuts = self.cuts(t);
        let crossed = self.crossed(t, zeta);
        let [mut plain, mut fine, mut coarse] = [(); 3].map(|()| CellPoints::default());
        for (c, crossed) in crossed.into_iter().enumerate() {
            let corners = triangle(&self.space, c);
            if crossed {
                fine.add_refined(c as u32, &corners, &cuts, 2);
                coarse.add_refined(c as u32, &corners, &cuts, 1);
            } else {
                plain.add(c as u32, &corners, &cuts);
            }
        }
        let [plain, crossed, check] = [plain, fine, coarse].map(|points| self.at(points, t, zeta));
        Ok(Volume { plain, crossed, check })
    }

    fn edges(
        &mut self,
        t: f64,
        zeta: f64,
        traces: &[&[f64]],
    ) -> Result<Vec<EdgeSample>, LoadError> {
        Ok(self.sides.iter().flat_map(|side| side.samples(t, zeta, traces)).collect())
    }

    fn interpolant(&mut self, t: f64) -> Result<Vec<f64>, LoadError> {
        let mut nodal = vectors(&self.nodal.values_at(t, 0.0)).concat();
        nodal[self.space.dofs()..].fill(0.0);
        Ok(nodal)
    }

    fn zeta(&mut self, t: f64) -> Result<Option<f64>, LoadError> {
        Ok(Some(self.exact.zeta.at(t)).filter(|zeta| !zeta.is_nan()))
    }

    fn remembered(&mut self, t: f64) -> Result<CellValues, LoadError> {
        let (at, bound) = &mut self.remembered;
        let (u, strain, history) = sort_interior(&bound.values_at(t, 0.0));
        Ok(CellValues { at: at.clone(), u, strain, history, force: Vec::new() })
    }

    fn nodal_multiplier(&mut self, _: f64) -> Result<Option<Vec<f64>>, LoadError> {
        Ok(None)
    }
}

/// Three points per cell, exact for degree 2: enough for the norm of a truncation error.
fn fixed_points(exact: &Exact, space: &Discretization) -> (CellPoints, BoundProgram) {
    let mut fixed = CellPoints::default();
    let (near, far) = (2.0 / 3.0, 1.0 / 6.0);
    for c in 0..space.mesh.cell_count() {
        for b in [[near, far, far], [far, near, far], [far, far, near]] {
            fixed.points.push(space.mesh.point(space.mesh.cell(c), &b));
            fixed.weights.push(space.geometry.measure[c] / 3.0);
        }
    }
    let bound = exact.interior.bind(&fixed.points);
    (fixed, bound)
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
