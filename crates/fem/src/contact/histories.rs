//! The histories of a run, one per term of its memory, and those of vectors that are given.

use super::{Discretization, MemoryTerm, Model};
use algebra::linalg::axpy;
use vhi::history::{Accumulated, Memory, TimeGrid, TimeRule, last_weight};

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

/// The histories of vectors that are given level after level: nodal ones, or strains at points.
pub struct GivenHistories<'a> {
    terms: &'a [MemoryTerm],
    rule: &'a dyn TimeRule,
    memories: Vec<Memory>,
    accumulated: Accumulated,
}

impl<'a> GivenHistories<'a> {
    /// Before level 0 of vectors of this length.
    pub fn new(
        terms: &'a [MemoryTerm],
        rule: &'a dyn TimeRule,
        grid: &TimeGrid,
        length: usize,
    ) -> Self {
        let memory = |term: &MemoryTerm| Memory::new(&*term.kernel, rule, grid, length);
        let memories = terms.iter().map(memory).collect();
        Self { terms, rule, memories, accumulated: Accumulated::default() }
    }

    /// Takes v_n and ‖ε_n‖ of level n; gives Σ_{j≤n} W_nj v_j of each term, and ζ_n.
    pub fn level(
        &mut self,
        (grid, n): (&TimeGrid, usize),
        v: &[f64],
        norm: f64,
    ) -> (Vec<Vec<f64>>, f64) {
        let rule = self.rule;
        let sum = |(term, memory): (&MemoryTerm, &mut Memory)| {
            let (kernel, mut sum) = (&*term.kernel, vec![0.0; v.len()]);
            memory.past(kernel, rule, grid, &mut sum);
            axpy(last_weight(kernel, rule, grid, n), v, &mut sum);
            memory.commit(grid, v);
            sum
        };
        let sums = self.terms.iter().zip(&mut self.memories).map(sum).collect();
        let zeta = self.accumulated.past(rule, grid) + rule.weight(grid, n, n) * norm;
        self.accumulated.commit(grid, norm);
        (sums, zeta)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.memories.iter().map(Memory::bytes).sum()
    }
}
