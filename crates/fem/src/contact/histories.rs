//! The histories of a run, one per term of its memory.

use super::{Discretization, Model};
use algebra::linalg::axpy;
use vhi::history::{Memory, TimeGrid};

pub(super) struct Histories<'a> {
    space: &'a Discretization,
    model: &'a Model,
    grid: &'a TimeGrid,
    memory: Vec<Memory>,
    /// Σ_{j<n} W_nj u_j while a level is open, Σ'_{j≤n} W_nj u_j after its commit, of unknowns padded to all nodes.
    pub sums: Vec<Vec<f64>>,
    /// The sums as displacements, where these differ from the unknowns.
    rotated: Option<Vec<Vec<f64>>>,
}

impl<'a> Histories<'a> {
    /// Of unknowns as the frames of `space` have them.
    pub(super) fn new(space: &'a Discretization, model: &'a Model, grid: &'a TimeGrid) -> Self {
        let rule = model.time_rule.as_ref();
        let terms = model.memory.iter();
        let memory = terms.map(|term| Memory::new(&*term.kernel, rule, grid, space.dofs()));
        let sums = vec![vec![0.0; space.nodes.len()]; model.memory.len()];
        let rotated = (!space.frames.is_empty()).then(|| sums.clone());
        Self { space, model, grid, memory: memory.collect(), sums, rotated }
    }

    /// The past of the level that opens.
    pub(super) fn recall(&mut self) {
        let (dofs, rule) = (self.space.dofs(), self.model.time_rule.as_ref());
        let terms = self.model.memory.iter().zip(&mut self.memory).zip(&mut self.sums);
        for ((term, memory), sum) in terms {
            memory.past(&*term.kernel, rule, self.grid, &mut sum[..dofs]);
        }
    }

    /// Takes the unknowns of the open level, which have these weights in it.
    pub(super) fn commit(&mut self, u: &[f64], last_weights: &[f64]) {
        let memories = self.memory.iter_mut().zip(&mut self.sums);
        for ((memory, sum), last_weight) in memories.zip(last_weights) {
            memory.commit(self.grid, u);
            axpy(*last_weight, u, &mut sum[..u.len()]);
        }
        for (rotated, sum) in self.rotated.iter_mut().flatten().zip(&self.sums) {
            rotated.copy_from_slice(sum);
            self.space.frames.to_cartesian(rotated);
        }
    }

    /// The sums of the last committed level as displacements.
    pub(super) fn shown(&self) -> &[Vec<f64>] {
        self.rotated.as_ref().unwrap_or(&self.sums)
    }

    pub(super) fn bytes(&self) -> usize {
        self.memory.iter().map(Memory::bytes).sum()
    }
}
