//! What passes leave: displacements, histories and what an observer sees of levels that are solved.

use std::time::Instant;

use super::{OneMatrix, Pending};
use crate::contact::kkt::kkt_residual_in;
use crate::contact::pressures::split_pressures;
use crate::contact::side::Side;
use crate::contact::strain_norm;
use crate::contact::{CaseError, Observer, StepView};
use algebra::linalg::{axpy, norm};
use vhi::StepInequality;
use vhi::history::Memory;

impl OneMatrix<'_> {
    /// Commits the levels that are solved and shows them, in their order.
    pub(super) fn expand(&mut self, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        for at in 0..std::mem::take(&mut self.solved) {
            let start = Instant::now();
            self.shown = at;
            self.commit();
            self.info.work.linear.seconds_solve += start.elapsed().as_secs_f64();
            self.show(observe)?;
        }
        Ok(())
    }

    /// u_n from v_n, committed.
    fn commit(&mut self) {
        if self.volume.beta.is_some() {
            self.recall();
        }
        let dofs = self.space.dofs();
        let Pending { scale, slot, state, .. } = &self.pending[self.shown];
        let past = self.volume.beta.zip(self.history.first());
        let of_level = self.swept.iter().skip(self.shown).step_by(self.pending.len());
        for (&value, &dof) in of_level.zip(&self.volume.order) {
            let dof = dof as usize;
            self.u[dof] = match past {
                Some((beta, past)) => (value - beta * past[dof]) / scale,
                None => value,
            };
        }
        // Values that a graph holds stay exact.
        let unknowns = self.side.as_ref().map_or(&[][..], |side| side.level.unknowns());
        for (&dof, u) in unknowns.iter().zip(&state.u) {
            self.u[dof as usize] = *u;
        }
        for ((memory, history), last_weight) in
            self.memory.iter_mut().zip(&mut self.history).zip(slot)
        {
            memory.commit(self.grid, &self.u[..dofs]);
            axpy(*last_weight, &self.u[..dofs], &mut history[..dofs]);
        }
        let held = self.memory.iter().map(Memory::bytes).sum::<usize>()
            + self.side.as_ref().map_or(0, Side::bytes);
        self.info.peak_history_bytes = self.info.peak_history_bytes.max(held);
    }

    fn show(&mut self, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        self.nodal.copy_from_slice(&self.u);
        let Pending { n, t, force, state, .. } = &self.pending[self.shown];
        if let Some(side) = &self.side {
            self.space.frames.to_cartesian(&mut self.nodal);
            split_pressures(
                self.space,
                self.model,
                side.level.graph(),
                state,
                [&mut self.compliance, &mut self.multiplier],
            );
        }
        for (shown, history) in self.shown_history.iter_mut().zip(&self.history) {
            shown.copy_from_slice(history);
            self.space.frames.to_cartesian(shown);
        }
        let framed = !self.shown_history.is_empty();
        let strain_norm = strain_norm(self.space, &self.nodal);
        self.accumulated.commit(self.grid, strain_norm);
        let view = StepView {
            n: *n,
            t: *t,
            u: &self.nodal,
            history: if framed { &self.shown_history } else { &self.history },
            zeta: self.accumulated.value(self.model.time_rule.as_ref(), self.grid),
            kappa: f64::INFINITY,
            strain_norm,
            compliance: &self.compliance,
            multiplier: &self.multiplier,
            friction: &[],
        };
        let residual = kkt_residual_in(self.space, self.model, &view, force, &mut self.balance);
        self.info.accept(&view, residual)?;
        observe(&view)?;
        // Floors grow with the load: levels of twice the largest load so far are few.
        if norm(force) > 2.0 * self.largest_force {
            self.raise_floors();
        }
        Ok(())
    }

    /// Raises the floors to those of the correction that one more solve of the level shown last would make.
    pub(super) fn raise_floors(&mut self) {
        let Pending { force, state, .. } = &self.pending[self.shown];
        let size = norm(force);
        self.largest_force = self.largest_force.max(size);
        let mut unbalanced = force.clone();
        if let Some(side) = &mut self.side {
            self.space.frames.force_on_unknowns(&mut unbalanced);
            side.level.subtract_contact(state, &mut unbalanced);
        }
        let u = [&self.u[..], &self.nodal[..]];
        let floors = self.volume.floors(unbalanced, size, u, &self.history);
        self.info.floors = self.info.floors.max(floors);
    }
}
