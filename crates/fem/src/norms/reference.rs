//! Runs that serve as truth: on the same mesh with more steps, and on a finer nested mesh.

use std::sync::Arc;

use super::moments::{AtPoints, Moments, Piecewise};
use super::refinement::{Parents, ReferenceError, Refinement};
use crate::contact::{Discretization, Model, StepView};
use crate::space::strain_of;
use vhi::law::Projection;

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
    /// Stress per cell.
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
        let cells = 0..space.mesh.cell_count();
        let stress = match space.mesh.dimension {
            2 => cells.flat_map(|c| view.stress::<P, 3>(space, model, c)).collect(),
            _ => cells.flat_map(|c| view.stress::<P, 6>(space, model, c)).collect(),
        };
        let locked = points
            .clone()
            .map(|i| gap(i).is_some_and(|g| super::is_locked(normal[i], g)))
            .collect();
        let pressure = points.map(|i| view.compliance[i] + view.multiplier[i]).collect();
        self.levels.push(Level { t: view.t, u: view.u.to_vec(), stress, normal, pressure, locked });
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
        let strain = match self.space.mesh.dimension {
            2 => self.strains::<3>(level),
            _ => self.strains::<6>(level),
        };
        let constants = |field: &[f64]| self.constants(refinement, coarse, field);
        let (fine, d) = (&self.space, self.space.mesh.dimension);
        let cells = Pieces {
            parents: &refinement.cells,
            measure: &fine.geometry.measure,
            coarse: &coarse.geometry.measure,
        };
        let facets = Pieces {
            parents: &refinement.facets,
            measure: &fine.trace.measure,
            coarse: &coarse.trace.measure,
        };
        let displacement = |c: usize, corner: usize, i: usize| {
            level.u[d * fine.cell_nodes(c)[corner] as usize + i]
        };
        let on_trace = |values: &[f64]| {
            let at = |f: usize, corner: usize, _| values[fine.trace.facet(f)[corner] as usize];
            facets.project(1, at)
        };
        let locked = |members: &Vec<u32>| members.iter().all(|&i| level.locked[i as usize]);
        Ok(Moments {
            strain: constants(&strain),
            stress: constants(&level.stress),
            displacement: cells.project(d, displacement),
            normal: on_trace(&level.normal),
            pressure: on_trace(&level.pressure),
            locked: refinement.sample_members.iter().map(locked).collect(),
        })
    }

    fn strains<const S: usize>(&self, level: &Level) -> Vec<f64> {
        let fine = &self.space;
        let strain = |c| strain_of::<S>(fine.geometry.gradients(c), fine.cell_nodes(c), &level.u);
        (0..fine.mesh.cell_count()).flat_map(strain).collect()
    }

    /// Cell means over the coarse cells of a tensor field that is constant on fine cells.
    fn constants(
        &self,
        refinement: &Refinement,
        coarse: &Discretization,
        field: &[f64],
    ) -> AtPoints {
        let (fine, parent) = (&self.space, &refinement.cells.of);
        let numbers = field.len() / fine.mesh.cell_count();
        let mut at = vec![0.0; numbers * coarse.mesh.cell_count()];
        let own = |p: u32| numbers * p as usize..numbers * (p as usize + 1);
        for (c, value) in field.chunks_exact(numbers).enumerate() {
            let share = fine.geometry.measure[c] / coarse.geometry.measure[parent[c] as usize];
            at[own(parent[c])].iter_mut().zip(value).for_each(|(m, v)| *m += share * v);
        }
        let mut rest = 0.0;
        for (c, value) in field.chunks_exact(numbers).enumerate() {
            let differences = value.iter().zip(&at[own(parent[c])]).map(|(v, m)| v - m);
            rest += fine.geometry.measure[c] * differences.map(|d| d * d).sum::<f64>();
        }
        AtPoints { at, rest }
    }
}

/// Corners of a tetrahedron.
const MOST_CORNERS: usize = 4;

/// Fine simplices in coarse ones.
struct Pieces<'a> {
    parents: &'a Parents,
    measure: &'a [f64],
    /// Measures of the coarse simplices.
    coarse: &'a [f64],
}

impl Pieces<'_> {
    /// L² projection onto linears on the coarse simplices of a field with `components` numbers per point that is
    /// linear on the fine ones; `value` gives the one at a corner of a fine simplex.
    ///
    /// Both f and λ_a are linear on a fine simplex of N corners, where the mean of a product f g is
    /// (Σ f_i g_i + Σ f_i Σ g_i)/(N(N+1)).
    fn project(&self, components: usize, value: impl Fn(usize, usize, usize) -> f64) -> Piecewise {
        let corners = self.parents.corners;
        if corners == 0 {
            return Piecewise::default();
        }
        let scale = 1.0 / (corners * (corners + 1)) as f64;
        let product = |f: &[f64], g: &[f64]| {
            let sums = f.iter().sum::<f64>() * g.iter().sum::<f64>();
            scale * (f.iter().zip(g).map(|(f, g)| f * g).sum::<f64>() + sums)
        };
        let mut moment = vec![0.0; components * corners * self.coarse.len()];
        let (mut square, mut own, mut out) = (0.0, [0.0; MOST_CORNERS], [0.0; MOST_CORNERS]);
        let (own, out) = (&mut own[..corners], &mut out[..corners]);
        let hats = self.parents.hats.chunks_exact(corners * corners);
        for (s, (&parent, hats)) in self.parents.of.iter().zip(hats).enumerate() {
            let share = self.measure[s] / self.coarse[parent as usize];
            let first = components * corners * parent as usize;
            for i in 0..components {
                own.iter_mut().enumerate().for_each(|(corner, own)| *own = value(s, corner, i));
                square += self.measure[s] * product(own, own);
                for (a, hat) in hats.chunks_exact(corners).enumerate() {
                    moment[first + components * a + i] += share * product(own, hat);
                }
            }
        }
        let mut corner = vec![0.0; moment.len()];
        for (p, measure) in self.coarse.iter().enumerate() {
            for i in 0..components {
                let place = |a: usize| components * (corners * p + a) + i;
                own.iter_mut().enumerate().for_each(|(a, own)| *own = moment[place(a)]);
                super::linear_projection(own, out);
                for a in 0..corners {
                    corner[place(a)] = out[a];
                    square -= measure * own[a] * out[a];
                }
            }
        }
        Piecewise { node: corner, rest: square.max(0.0) }
    }
}
