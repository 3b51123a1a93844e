//! Runs that serve as truth: on the same mesh with more steps, and on a finer nested mesh.

use std::sync::Arc;

use super::moments::Moments;
use super::nested::{onto_element, onto_strains};
use super::refinement::{ReferenceError, Refinement};
use crate::contact::{Discretization, LevelFields, Model, StepView};
use algebra::in_dimension;

/// Displacements of a run at selected times, as nodal vectors.
#[derive(Debug, Clone, Default)]
pub struct Trajectory {
    /// t_n.
    pub times: Vec<f64>,
    /// u_n.
    pub displacements: Vec<Vec<f64>>,
}

impl Trajectory {
    /// The displacement at time t, if it was kept (to rounding of the time).
    pub fn at(&self, t: f64) -> Option<&[f64]> {
        let close = |s: &f64| (s - t).abs() <= 1e-9 * t.abs().max(1e-300);
        self.times.iter().position(close).map(|i| self.displacements[i].as_slice())
    }
}

/// One level of a finer run.
struct Level {
    t: f64,
    u: Vec<f64>,
    /// σ at the strain points.
    stress: Vec<f64>,
    /// u_ν, ξ + λ and "locked" at the points of the trace.
    normal: Vec<f64>,
    pressure: Vec<f64>,
    locked: Vec<bool>,
}

/// A run on a finer mesh, kept at the times that coarser cases share.
pub struct ReferenceRun {
    space: Arc<Discretization>,
    levels: Vec<Level>,
}

impl ReferenceRun {
    /// An empty run on `space`.
    pub fn new(space: Arc<Discretization>) -> Self {
        Self { space, levels: Vec::new() }
    }

    /// Keeps the level that `view` shows.
    pub fn keep(&mut self, model: &Model, view: &StepView<'_>) {
        let space = &self.space;
        let gap = |i: usize| {
            let point = &space.trace.points[i];
            model.gap(point.side, space.mesh.point(&[point.vertex], &[1.0]), view.t)
        };
        let points = 0..space.trace.points.len();
        let normal: Vec<f64> = points.clone().map(|i| space.trace.normal(i, view.u)).collect();
        let LevelFields { u, stress, pressure } = LevelFields::of(space, model, view);
        let locked = points.map(|i| super::is_locked(normal[i], gap(i))).collect();
        self.levels.push(Level { t: view.t, u, stress, normal, pressure, locked });
    }

    /// Where the run's mesh lies in a coarser one.
    ///
    /// # Errors
    /// Meshes that are not nested.
    pub fn refinement(&self, coarse: &Discretization) -> Result<Refinement, ReferenceError> {
        Refinement::new(&self.space, coarse)
    }

    /// The moments of the level at time t on the coarser mesh of `refinement`.
    ///
    /// # Errors
    /// A time that was not kept.
    pub fn moments(
        &self,
        refinement: &Refinement,
        coarse: &Discretization,
        t: f64,
    ) -> Result<Moments, ReferenceError> {
        let close = |level: &&Level| (level.t - t).abs() <= 1e-9 * t.abs().max(1e-300);
        let level = self.levels.iter().find(close).ok_or(ReferenceError::NoSuchTime { t })?;
        let strain: Vec<f64> = in_dimension!(self.space.mesh.dimension, D, S => {
            self.space.points().flat_map(|at| at.strain::<S>(&level.u)).collect()
        });
        let tensors = |field: &[f64]| onto_strains(&self.space, coarse, &refinement.cells, field);
        let (fine, d) = (&self.space, self.space.mesh.dimension);
        let element = coarse.element;
        let cells = [&fine.geometry.measure[..], &coarse.geometry.measure];
        let facets = [&fine.trace.measure[..], &coarse.trace.measure];
        let displacement =
            |c: usize, node: usize, i: usize| level.u[d * fine.cell_nodes(c)[node] as usize + i];
        let on_trace = |values: &[f64]| {
            let at = |f: usize, node: usize, _| values[fine.trace.facet(f)[node] as usize];
            onto_element(element, &refinement.facets, facets, 1, at)
        };
        let locked = |members: &Vec<u32>| members.iter().all(|&i| level.locked[i as usize]);
        Ok(Moments {
            strain: tensors(&strain),
            stress: tensors(&level.stress),
            displacement: onto_element(element, &refinement.cells, cells, d, displacement),
            normal: on_trace(&level.normal),
            pressure: on_trace(&level.pressure),
            locked: refinement.sample_members.iter().map(locked).collect(),
        })
    }
}
