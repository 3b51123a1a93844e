//! The histories of vectors, one per term of the memory, and ζ: of the levels of a run, or of vectors that are given.

use super::MemoryTerm;
use algebra::linalg::axpy;
use vhi::history::{Accumulated, Memory, TimeGrid, TimeRule, last_weight};

/// The histories of vectors that come level after level: unknowns, nodal vectors, or strains at points.
pub struct Histories<'a> {
    terms: &'a [MemoryTerm],
    rule: &'a dyn TimeRule,
    memories: Vec<Memory>,
    accumulated: Accumulated,
}

impl<'a> Histories<'a> {
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

    /// `sums` ← Σ_{j<n} W_nj v_j of each term for the next level n; gives ζ_n without its last part.
    pub(super) fn past(&mut self, grid: &TimeGrid, sums: &mut [Vec<f64>]) -> f64 {
        let terms = self.terms.iter().zip(&mut self.memories).zip(sums);
        terms.for_each(|((term, memory), sum)| memory.past(&*term.kernel, self.rule, grid, sum));
        self.accumulated.past(self.rule, grid)
    }

    /// Takes v_n and ‖ε_n‖, and adds W_nn v_n to the sums of [`Self::past`], by the weights of each term.
    pub(super) fn commit(
        &mut self,
        grid: &TimeGrid,
        (v, norm): (&[f64], f64),
        last_weights: &[f64],
        sums: &mut [Vec<f64>],
    ) {
        for ((memory, sum), last_weight) in self.memories.iter_mut().zip(sums).zip(last_weights) {
            memory.commit(grid, v);
            axpy(*last_weight, v, sum);
        }
        self.accumulated.commit(grid, norm);
    }

    /// Takes v_n and ‖ε_n‖ of level n; gives Σ_{j≤n} W_nj v_j of each term, and ζ_n.
    pub fn level(
        &mut self,
        (grid, n): (&TimeGrid, usize),
        v: &[f64],
        norm: f64,
    ) -> (Vec<Vec<f64>>, f64) {
        let weight = |term: &MemoryTerm| last_weight(&*term.kernel, self.rule, grid, n);
        let last_weights: Vec<f64> = self.terms.iter().map(weight).collect();
        let mut sums = vec![vec![0.0; v.len()]; self.terms.len()];
        let zeta = self.past(grid, &mut sums) + self.rule.weight(grid, n, n) * norm;
        self.commit(grid, (v, norm), &last_weights, &mut sums);
        (sums, zeta)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.memories.iter().map(Memory::bytes).sum()
    }
}
