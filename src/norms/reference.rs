//! Runs that serve as truth: on the same mesh with more steps, and on a finer nested mesh.

use std::sync::Arc;

use super::moments::{CellConstants, FACET_SAMPLES, Moments, Piecewise, facet_sample};
use crate::contact::{ContactTrace, Discretization, Model, StepView};
use crate::law::Projection;
use crate::mesh::nested;
use crate::space::strain_of;
use crate::tensor::contract;

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

/// Why a reference cannot serve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// The finer mesh must be a refinement of the coarse one.
    #[error(
        "the reference mesh (n = {fine}) is not a refinement of n = {coarse}: choose a multiple"
    )]
    NotNested { coarse: u32, fine: u32 },
    /// The time is not one of the reference's.
    #[error("the reference run has no step at t = {t}: its steps must be a multiple of the case's")]
    NoSuchTime { t: f64 },
}

/// One level of a finer run.
struct Level {
    t: f64,
    u: Vec<f64>,
    /// Stress a cell.
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
    pub fn keep<P: Projection>(&mut self, model: &Model<P>, view: &StepView<'_>) {
        let space = &self.space;
        let gap = |i: usize| {
            let boundary = model.boundary.as_ref()?;
            let x = space.mesh.point(&[space.trace.points[i].vertex], &[1.0]);
            Some((boundary.gap)(x))
        };
        let points = 0..space.trace.points.len();
        let normal: Vec<f64> = points.clone().map(|i| space.trace.normal(i, view.u)).collect();
        let stress = (0..space.mesh.cell_count())
            .flat_map(|c| view.stress::<P, 3>(space, model, c))
            .collect();
        let locked = points
            .clone()
            .map(|i| gap(i).is_some_and(|g| super::is_locked(normal[i], g)))
            .collect();
        let pressure = points.map(|i| view.compliance[i] + view.multiplier[i]).collect();
        self.levels.push(Level { t: view.t, u: view.u.to_vec(), stress, normal, pressure, locked });
    }

    /// The moments of the level at time t on a coarser structured mesh of the same domain.
    ///
    /// # Errors
    /// Meshes that are not nested, a time that was not kept.
    pub fn moments(&self, coarse: &Discretization, t: f64) -> Result<Moments, ReferenceError> {
        let close = |level: &&Level| (level.t - t).abs() <= 1e-9 * t.abs().max(1e-300);
        let level = self.levels.iter().find(close).ok_or(ReferenceError::NoSuchTime { t })?;
        let (n, fine) = (coarse.mesh.n, self.space.mesh.n);
        if fine % n != 0 {
            return Err(ReferenceError::NotNested { coarse: n, fine });
        }
        let own = nested(&self.space.mesh, &coarse.mesh);
        if own.is_none() && self.space.mesh.refinement.is_some() {
            return Err(ReferenceError::NotNested { coarse: n, fine });
        }
        let parent = match &own {
            Some(own) => own.parent.clone(),
            None => parents(&self.space, coarse),
        };
        let along = match &own {
            Some(own) => self.along_refined(coarse, own.ratio),
            None => self.along_structured(coarse),
        };
        let mut moments = Moments::default();
        self.cell_moments(level, coarse, &parent, &mut moments);
        facet_moments(level, coarse, &along, &mut moments);
        Ok(moments)
    }

    fn cell_moments(
        &self,
        level: &Level,
        coarse: &Discretization,
        parent: &[u32],
        moments: &mut Moments,
    ) {
        let fine = &self.space;
        let strain: Vec<f64> = (0..fine.mesh.cell_count())
            .flat_map(|c| strain_of::<3>(fine.geometry.gradients(c), fine.cell_nodes(c), &level.u))
            .collect();
        moments.strain = constants(fine, coarse, parent, &strain);
        moments.stress = constants(fine, coarse, parent, &level.stress);
        // u and λ_a are linear on a fine cell: the edge midpoints integrate u λ_a and u² exactly.
        let cells = coarse.mesh.cell_count();
        let (mut moment, mut square) = (vec![0.0; 6 * cells], 0.0);
        for c in 0..fine.mesh.cell_count() {
            let p = parent[c] as usize;
            let (cell, nodes) = (fine.mesh.cell(c), fine.cell_nodes(c));
            let share = fine.geometry.measure[c] / coarse.geometry.measure[p];
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let x = fine.mesh.point(&[cell[a], cell[b]], &[0.5, 0.5]);
                let barycentric = barycentric(coarse, p, &x);
                for i in 0..2 {
                    let value = 0.5
                        * (level.u[2 * nodes[a] as usize + i] + level.u[2 * nodes[b] as usize + i]);
                    for (m, weight) in barycentric.iter().enumerate() {
                        moment[6 * p + 2 * m + i] += share / 3.0 * value * weight;
                    }
                    square += fine.geometry.measure[c] / 3.0 * value * value;
                }
            }
        }
        let mut corner = vec![0.0; 6 * cells];
        for c in 0..cells {
            for i in 0..2 {
                let own = [0, 1, 2].map(|a| moment[6 * c + 2 * a + i]);
                let mut out = [0.0; 3];
                super::linear_projection(&own, &mut out);
                for a in 0..3 {
                    corner[6 * c + 2 * a + i] = out[a];
                    square -= coarse.geometry.measure[c] * own[a] * out[a];
                }
            }
        }
        moments.displacement = Piecewise { corner, rest: square.max(0.0) };
    }

    /// The points of the run's trace along each coarse facet, by place on a rectangle.
    fn along_structured(&self, coarse: &Discretization) -> Vec<Vec<usize>> {
        let along = along_trace(&self.space.mesh, &self.space.trace);
        let index: std::collections::BTreeMap<u64, usize> =
            along.iter().enumerate().map(|(i, x)| (key(x), i)).collect();
        let refinement = (self.space.mesh.n / coarse.mesh.n) as usize;
        let of_facet = |f: usize| {
            let ends: Vec<u32> = coarse
                .trace
                .facet(f)
                .iter()
                .map(|&i| coarse.trace.points[i as usize].vertex)
                .collect();
            let point = |s: f64| coarse.mesh.point(&ends, &[1.0 - s, s]);
            (0..=refinement)
                .map(|s| {
                    let x = point(s as f64 / refinement as f64);
                    index.get(&key(&x)).copied().unwrap_or(0)
                })
                .collect()
        };
        (0..coarse.trace.measure.len()).map(of_facet).collect()
    }

    /// The same by counting, on refinements of one coarse triangulation: a corner of two contact sides
    /// has a point for each.
    fn along_refined(&self, coarse: &Discretization, ratio: usize) -> Vec<Vec<usize>> {
        let trace = &self.space.trace;
        let of_facet = |&facet: &u32| {
            let first = trace.mesh_facet.partition_point(|&own| own < facet * ratio as u32);
            let begin = |s: usize| trace.facet(first + s)[0] as usize;
            let end = trace.facet(first + ratio - 1)[1] as usize;
            (0..ratio).map(begin).chain([end]).collect()
        };
        coarse.trace.mesh_facet.iter().map(of_facet).collect()
    }
}

/// Moments on the facets; `along` are the points of the run's trace along each.
fn facet_moments(
    level: &Level,
    coarse: &Discretization,
    along: &[Vec<usize>],
    moments: &mut Moments,
) {
    let facets = coarse.trace.measure.len();
    let (mut normal, mut pressure) = (Piecewise::default(), Piecewise::default());
    moments.locked = Vec::with_capacity(facets * (FACET_SAMPLES + 1));
    for (f, at) in along.iter().enumerate() {
        let measure = coarse.trace.measure[f];
        project_on_edge(at, &level.normal, measure, &mut normal);
        project_on_edge(at, &level.pressure, measure, &mut pressure);
        for s in 0..=FACET_SAMPLES {
            let place = facet_sample(s)[1] * (at.len() - 1) as f64;
            let (low, high) = (place.floor() as usize, place.ceil() as usize);
            moments.locked.push(level.locked[at[low]] && level.locked[at[high]]);
        }
    }
    moments.normal = normal;
    moments.pressure = pressure;
}

/// Cell means over the coarse cells of a field that is constant on fine cells.
fn constants(
    fine: &Discretization,
    coarse: &Discretization,
    parent: &[u32],
    field: &[f64],
) -> CellConstants {
    let mut mean = vec![0.0; 3 * coarse.mesh.cell_count()];
    for (c, value) in field.chunks_exact(3).enumerate() {
        let p = parent[c] as usize;
        let share = fine.geometry.measure[c] / coarse.geometry.measure[p];
        for i in 0..3 {
            mean[3 * p + i] += share * value[i];
        }
    }
    let mut rest = 0.0;
    for (c, value) in field.chunks_exact(3).enumerate() {
        let p = parent[c] as usize;
        let difference: [f64; 3] = std::array::from_fn(|i| value[i] - mean[3 * p + i]);
        rest += fine.geometry.measure[c] * contract(&difference, &difference);
    }
    CellConstants { mean, rest }
}

/// L² projection onto linears of a function that is linear between equidistant points of an edge.
fn project_on_edge(at: &[usize], values: &[f64], measure: f64, out: &mut Piecewise) {
    let pieces = at.len() - 1;
    let (mut moment, mut square) = ([0.0; 2], 0.0);
    for s in 0..pieces {
        let (a, b) = (values[at[s]], values[at[s + 1]]);
        // Simpson's rule is exact for the product of two linear functions.
        for (place, weight) in [(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)] {
            let value = a + place * (b - a);
            let x = (s as f64 + place) / pieces as f64;
            moment[0] += weight / pieces as f64 * value * (1.0 - x);
            moment[1] += weight / pieces as f64 * value * x;
            square += weight / pieces as f64 * value * value;
        }
    }
    let mut corner = [0.0; 2];
    super::linear_projection(&moment, &mut corner);
    let projected = moment[0] * corner[0] + moment[1] * corner[1];
    out.rest += measure * (square - projected).max(0.0);
    out.corner.extend(corner);
}

/// The coarse cell that holds each fine cell, by centroids on the structured mesh.
fn parents(fine: &Discretization, coarse: &Discretization) -> Vec<u32> {
    let n = f64::from(coarse.mesh.n);
    let width =
        (0..coarse.mesh.vertices()).map(|v| coarse.mesh.vertex(v as u32)[0]).fold(0.0, f64::max);
    let columns = (width * n).round() as u32;
    (0..fine.mesh.cell_count())
        .map(|c| {
            let third = 1.0 / 3.0;
            let x = fine.mesh.point(fine.mesh.cell(c), &[third, third, third]);
            let (i, j) = ((x[0] * n).floor(), (x[1] * n).floor());
            let upper = u32::from(x[1] * n - j > x[0] * n - i);
            2 * (j as u32 * columns + i as u32) + upper
        })
        .collect()
}

fn barycentric(space: &Discretization, c: usize, x: &[f64; 3]) -> [f64; 3] {
    let gradients = space.geometry.gradients(c);
    let origin = space.mesh.vertex(space.mesh.cell(c)[0]);
    let mut out = [0.0; 3];
    for a in 1..3 {
        out[a] = (0..2).map(|i| gradients[2 * a + i] * (x[i] - origin[i])).sum();
    }
    out[0] = 1.0 - out[1] - out[2];
    out
}

fn along_trace(mesh: &crate::mesh::Mesh, trace: &ContactTrace) -> Vec<[f64; 3]> {
    trace.points.iter().map(|point| mesh.point(&[point.vertex], &[1.0])).collect()
}

/// A key of a point that two nested meshes agree on, whatever their rounding.
fn key(x: &[f64; 3]) -> u64 {
    let digit = |v: f64| ((v * 1e7).round() as i64 as u64) & 0xffff_ffff;
    digit(x[0]) << 32 | digit(x[1])
}
