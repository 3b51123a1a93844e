//! One time level of Problem 14 without projection, condensed onto Γ3, as a [`StepInequality`].
//!
//! With the volume eliminated the unknowns are those that carry u_ν:
//!
//!   s S u + p(u) + Σ_i w_i c_i s_i e_i = f,   c_i ∈ G_i(s_i u_i),
//!
//! S the Schur complement of the stiffness on them, s a factor of it, f the condensed load; p is the compliance where it
//! is integrated on facets, and the graphs hold the bound alone.

use super::compliance::FacetCompliance;
use super::last_slot::TangentOf;
use super::{Discretization, Model};
use algebra::linalg::{DenseCholesky, FactorError, axpy, norm, root_of_squares};
use vhi::{BoundaryGraph, StepInequality, StepState};

pub(crate) struct CondensedLevel<'a> {
    /// The graphs; their dofs count the unknowns of Γ3.
    graph: BoundaryGraph,
    /// The unknowns of Γ3 in the volume.
    dofs: Vec<u32>,
    /// S, full and symmetric, by columns.
    schur: Vec<f64>,
    /// s.
    pub scale: f64,
    /// f.
    pub load: Vec<f64>,
    tangent: DenseCholesky,
    /// What the factorized tangent was made of, with s for the last slot.
    last: TangentOf<f64>,
    diagonal: Vec<f64>,
    /// Prescribed increments, and what p makes of them on the right side.
    increments: Vec<f64>,
    lifted: Vec<f64>,
    /// p, of the unknowns with a zero behind them.
    compliance: Option<FacetCompliance<'a>>,
    unknowns: Vec<f64>,
}

impl<'a> CondensedLevel<'a> {
    /// The level with the graphs of the volume on the unknowns of Γ3.
    pub(crate) fn new(space: &Discretization, model: &'a Model, mut graph: BoundaryGraph) -> Self {
        let dofs = space.trace.unknowns();
        let size = dofs.len();
        let place = |unknown: u32| dofs.iter().position(|&dof| dof == unknown).unwrap_or(size);
        graph.coordinates.iter_mut().for_each(|at| at.dof = place(at.dof) as u32);
        let compliance = model.boundary.as_ref().and_then(|boundary| {
            FacetCompliance::new(space, boundary, |point| place(point.unknown))
        });
        Self {
            graph,
            dofs,
            schur: vec![0.0; size * size],
            scale: 1.0,
            load: vec![0.0; size],
            tangent: DenseCholesky::new(size),
            last: TangentOf::default(),
            diagonal: vec![0.0; size],
            increments: vec![0.0; size],
            lifted: vec![0.0; size],
            compliance,
            unknowns: vec![0.0; size + 1],
        }
    }

    /// Takes S = L Lᵀ from its factor, full and by columns.
    pub(crate) fn set_schur(&mut self, triangle: &[f64]) {
        let size = self.dofs.len();
        self.schur.fill(0.0);
        for k in 0..size {
            let column = &triangle[size * k..size * (k + 1)];
            for j in k..size {
                axpy(column[j], &column[k..], &mut self.schur[size * j + k..size * (j + 1)]);
            }
        }
        self.last.made = None;
    }

    /// The unknowns of Γ3 in the volume.
    pub(crate) fn unknowns(&self) -> &[u32] {
        &self.dofs
    }

    /// f ← f + α S x.
    pub(crate) fn add_to_load(&mut self, alpha: f64, x: impl Iterator<Item = f64>) {
        let size = self.dofs.len();
        for (j, x) in x.enumerate() {
            axpy(alpha * x, &self.schur[size * j..size * (j + 1)], &mut self.load);
        }
    }

    pub(crate) fn subtract_contact(&mut self, state: &StepState, force: &mut [f64]) {
        for (at, pressure) in self.graph.coordinates.iter().zip(&state.pressure) {
            force[self.dofs[at.dof as usize] as usize] -= at.sign * at.weight * pressure;
        }
        if let Some(compliance) = &self.compliance {
            let mut forces = vec![0.0; self.dofs.len()];
            self.unknowns[..forces.len()].copy_from_slice(&state.u);
            compliance.add_force(&self.unknowns, &mut forces);
            self.dofs.iter().zip(forces).for_each(|(&dof, value)| force[dof as usize] -= value);
        }
    }

    /// The change of v = s u by which the last tangent answers a force; as it is before the first tangent.
    pub(crate) fn correct(&mut self, force: &mut [f64]) {
        if self.last.made.is_none() {
            return;
        }
        for (at, pinned) in self.graph.coordinates.iter().zip(&self.last.prescribed) {
            force[at.dof as usize] *= f64::from(u8::from(!pinned));
        }
        self.tangent.solve(force);
        force.iter_mut().for_each(|value| *value *= self.scale);
    }

    fn factorize(&mut self) -> Result<(), FactorError> {
        let size = self.dofs.len();
        let (schur, scale) = (&self.schur, self.scale);
        let (graph, TangentOf { slopes, prescribed, .. }) = (&self.graph, &self.last);
        let (compliance, unknowns) = (&self.compliance, &self.unknowns);
        let (increments, lifted) = (&self.increments, &mut self.lifted);
        let diagonal = &mut self.diagonal;
        lifted.fill(0.0);
        let outcome = self.tangent.factorize(|values| {
            for (value, s) in values.iter_mut().zip(schur) {
                *value = scale * s;
            }
            if let Some(compliance) = compliance {
                compliance.each_tangent(unknowns, |[i, j], value| {
                    values[size * i.min(j) + i.max(j)] += value;
                    if i != j {
                        lifted[i] += value * increments[j];
                        lifted[j] += value * increments[i];
                    }
                });
            }
            for ((at, slope), pinned) in graph.coordinates.iter().zip(slopes).zip(prescribed) {
                let i = at.dof as usize;
                values[size * i + i] += slope;
                if *pinned {
                    // The diagonal stays: any positive number serves.
                    (0..i).for_each(|j| values[size * j + i] = 0.0);
                    (i + 1..size).for_each(|j| values[size * i + j] = 0.0);
                }
            }
            diagonal.iter_mut().enumerate().for_each(|(i, entry)| *entry = values[size * i + i]);
        });
        outcome.map_err(|error| match error {
            FactorError::NotPositiveDefinite { dof } => {
                FactorError::NotPositiveDefinite { dof: self.dofs[dof] as usize }
            }
            other => other,
        })
    }
}

impl StepInequality for CondensedLevel<'_> {
    fn dofs(&self) -> usize {
        self.dofs.len()
    }

    fn graph(&self) -> &BoundaryGraph {
        &self.graph
    }

    fn descent(&self, i: usize) -> f64 {
        let facets = self.compliance.as_ref().map_or(0.0, FacetCompliance::descent);
        self.graph.descent(i).max(facets)
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        for (value, load) in out.iter_mut().zip(&self.load) {
            *value = -load;
        }
        let columns = self.schur.chunks_exact(u.len().max(1));
        for (column, u) in columns.zip(u) {
            axpy(self.scale * u, column, out);
        }
        if let Some(compliance) = &self.compliance {
            self.unknowns[..u.len()].copy_from_slice(u);
            compliance.add_force(&self.unknowns, out);
        }
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        self.increments.fill(0.0);
        for (at, increment) in self.graph.coordinates.iter().zip(prescribed) {
            self.increments[at.dof as usize] = increment.unwrap_or(0.0);
        }
        if !self.last.replace(&self.scale, slopes, prescribed) && self.compliance.is_none() {
            return Ok(());
        }
        self.factorize().inspect_err(|_| self.last.made = None)
    }

    fn solve(&mut self, rhs: &mut [f64], _: f64) -> Result<(), FactorError> {
        let size = self.dofs.len();
        for (j, increment) in self.increments.iter().enumerate().filter(|(_, d)| **d != 0.0) {
            axpy(-self.scale * increment, &self.schur[size * j..size * (j + 1)], rhs);
        }
        axpy(-1.0, &self.lifted, rhs);
        let coordinates = self.graph.coordinates.iter().zip(&self.last.prescribed);
        for (at, _) in coordinates.filter(|(_, pinned)| **pinned) {
            let i = at.dof as usize;
            rhs[i] = self.diagonal[i] * self.increments[i];
        }
        self.tangent.solve(rhs);
        Ok(())
    }

    /// As in the volume, on Γ3 alone: the condensed forces are no larger than those they are made of.
    fn force_scale(&self, u: &[f64]) -> f64 {
        let size = self.dofs.len();
        let product = |(i, u): (usize, &f64)| self.schur[size * i + i] * u;
        let products = root_of_squares(|scale| {
            u.iter().enumerate().map(product).map(|f| (scale * f).powi(2)).sum()
        });
        self.scale * products + norm(&self.load)
    }

    fn add_rounding(&self, state: &StepState, sizes: &mut [f64]) {
        self.graph.add_rounding(state, sizes);
        if let Some(compliance) = &self.compliance {
            compliance.add_rounding(&state.u, sizes);
        }
    }
}
