//! What passes leave: displacements, histories and what an observer sees of levels that are solved.

use std::time::Instant;

use super::{OneMatrix, Pending};
use crate::contact::side::Side;
use crate::contact::strain_norm;
use crate::contact::{CaseError, Observer};
use algebra::linalg::norm;
use vhi::StepInequality;

impl OneMatrix<'_> {
    /// Commits the levels that are solved and shows them, in their order.
    pub(super) fn expand(&mut self, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        for at in 0..std::mem::take(&mut self.solved) {
            let start = Instant::now();
            self.last = at;
            self.commit();
            self.info.work.linear.seconds_solve += start.elapsed().as_secs_f64();
            self.show(observe)?;
        }
        Ok(())
    }

    /// u_n from v_n, committed.
    fn commit(&mut self) {
        if self.volume.beta.is_some() {
            self.histories.recall();
        }
        let dofs = self.space.dofs();
        let Pending { scale, slot, state, .. } = &self.pending[self.last];
        let past = self.volume.beta.zip(self.histories.sums.first());
        let of_level = self.swept.iter().skip(self.last).step_by(self.pending.len());
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
        self.histories.commit(&self.u[..dofs], slot);
        let held = self.histories.bytes() + self.side.as_ref().map_or(0, Side::bytes);
        self.info.peak_history_bytes = self.info.peak_history_bytes.max(held);
    }

    fn show(&mut self, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        let Pending { n, t, force, state, .. } = &self.pending[self.last];
        self.shown.take(&self.u, self.side.as_ref().map(|side| (side.level.graph(), state)));
        let strain_norm = strain_norm(self.space, &self.shown.nodal);
        self.accumulated.commit(self.grid, strain_norm);
        let zeta = self.accumulated.value(self.model.time_rule.as_ref(), self.grid);
        let to = (&mut self.info, observe);
        self.shown.show((*n, *t), self.histories.shown(), [zeta, strain_norm], force, to)?;
        if norm(force) > 2.0 * self.largest_force {
            self.raise_floors();
        }
        Ok(())
    }

    /// Raises the floors to those of the correction that one more solve of the level shown last would make.
    pub(super) fn raise_floors(&mut self) {
        let Pending { force, state, .. } = &self.pending[self.last];
        let size = norm(force);
        self.largest_force = self.largest_force.max(size);
        let (mut unbalanced, mut rounding) = (force.clone(), vec![0.0; state.u.len()]);
        if let Some(side) = &mut self.side {
            self.space.frames.force_on_unknowns(&mut unbalanced);
            side.level.subtract_contact(state, &mut unbalanced);
            side.level.add_rounding(state, &mut rounding);
        }
        let u = [&self.u[..], &self.shown.nodal[..]];
        let sizes = (size, norm(&rounding));
        let side = (self.cut, self.side.as_mut());
        let floors = self.volume.floors(unbalanced, sizes, u, &self.histories.sums, side);
        self.info.floors = self.info.floors.max(floors);
    }
}
