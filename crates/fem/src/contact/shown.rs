//! A level as an observer sees it.

use super::case::{CaseError, CaseInfo, Observer, StepView};
use super::kkt::kkt_residual_in;
use super::pressures::split_pressures;
use super::{Discretization, Model, friction_graph};
use vhi::law::Projection;
use vhi::{BoundaryGraph, StepState};

pub(super) struct Shown<'a> {
    space: &'a Discretization,
    model: &'a Model,
    /// Displacements of all nodes.
    pub nodal: Vec<f64>,
    compliance: Vec<f64>,
    multiplier: Vec<f64>,
    friction: Vec<f64>,
    /// Room for the balance of forces.
    balance: Vec<f64>,
}

impl<'a> Shown<'a> {
    pub(super) fn new(space: &'a Discretization, model: &'a Model) -> Self {
        let points = space.trace.points.len();
        let tangents = model.friction.as_ref().map_or(0, |_| space.mesh.dimension - 1);
        Self {
            nodal: vec![0.0; space.nodes.len()],
            compliance: vec![0.0; points],
            multiplier: vec![0.0; points],
            friction: vec![0.0; tangents * points],
            balance: Vec::new(),
            space,
            model,
        }
    }

    /// Takes the unknowns of a level and what its graphs on Γ3 carry; without these, displacements.
    pub(super) fn take(&mut self, u: &[f64], contact: Option<(&BoundaryGraph, &StepState)>) {
        self.nodal[..u.len()].copy_from_slice(u);
        let Some((graph, state)) = contact else { return };
        self.space.frames.to_cartesian(&mut self.nodal);
        let pressures = [&mut self.compliance[..], &mut self.multiplier];
        split_pressures(self.space, self.model, graph, state, pressures);
        friction_graph::show(self.space, &state.pressure, &mut self.friction);
    }

    /// The level n at t with its histories, ζ and ‖ε(u)‖.
    pub(super) fn view<'v>(
        &'v self,
        (n, t): (usize, f64),
        history: &'v [Vec<f64>],
        [zeta, strain_norm]: [f64; 2],
    ) -> StepView<'v> {
        StepView {
            n,
            t,
            u: &self.nodal,
            history,
            zeta,
            kappa: self.model.projection.limit().map_or(f64::INFINITY, |l| l.value(zeta)),
            strain_norm,
            compliance: &self.compliance,
            multiplier: &self.multiplier,
            friction: &self.friction,
        }
    }

    /// Shows the level, as [`Self::view`] has it, if it solves the discrete problem with this load.
    pub(super) fn show(
        &mut self,
        at: (usize, f64),
        history: &[Vec<f64>],
        sizes: [f64; 2],
        load: &[f64],
        (info, observe): (&mut CaseInfo, &mut Observer<'_>),
    ) -> Result<(), CaseError> {
        let mut balance = std::mem::take(&mut self.balance);
        let view = self.view(at, history, sizes);
        let residual = kkt_residual_in(self.space, self.model, &view, load, &mut balance);
        info.accept(&view, residual)?;
        observe(&view)?;
        self.balance = balance;
        Ok(())
    }
}
