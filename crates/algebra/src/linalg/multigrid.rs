//! Geometric multigrid as a preconditioner of conjugate gradients: one symmetric V-cycle.
//!
//! Coarse unknowns are Cartesian displacements of coarse vertices, interpolated by P = M N P₀: P₀ takes the mean of two
//! parents, N maps to the unknowns of oblique vertices, M leaves out held ones (the truncated basis of Kornhuber,
//! Numer. Math. 69 (1994)). Coarse matrices are PᵀAP, so that all features of the tangent (yielded cells, contact
//! slopes, held coordinates) are on all levels. Gauss–Seidel over nodes runs forward before the correction and backward
//! after it: the cycle is symmetric, and positive definite if the matrix is. Sweeps are in single precision, since they
//! are bound by memory. W. Hackbusch, Multi-Grid Methods and Applications (1985).

mod galerkin;
mod gauss_seidel;
mod transfer;

use crate::in_dimension;

use super::cholesky::{Analysis, Factor, FactorError, Workspace};
use super::nested_dissection;
use super::pattern::BlockPattern;
use super::substitution::Front;
use galerkin::galerkin;
use gauss_seidel::Sweeps;
pub use transfer::NodeFrame;
use transfer::{Transfer, Turns};

/// Mesh-dependent data: patterns of the coarse matrices, transfers, analysis of the coarsest.
#[derive(Debug)]
pub struct Levels {
    transfers: Vec<Transfer>,
    patterns: Vec<BlockPattern>,
    coarsest: Analysis,
    frames: Vec<NodeFrame>,
}

impl Levels {
    /// Levels below the matrices of `fine`. `of_vertex` gives the node of a vertex, `parents` the coarse vertices of
    /// each vertex, finest mesh first; `coordinates` are those of the free nodes, `frames` the rotated unknowns of
    /// nodes. None without `parents`.
    ///
    /// # Errors
    /// The analysis of the coarsest matrix.
    pub fn new(
        fine: &BlockPattern,
        of_vertex: &[u32],
        parents: &[Vec<[u32; 2]>],
        coordinates: &[f64],
        frames: Vec<NodeFrame>,
    ) -> Result<Option<Self>, FactorError> {
        let d = fine.dimension();
        let (mut transfers, mut patterns) = (Vec::new(), Vec::<BlockPattern>::new());
        let (mut nodes, mut coordinates) = (of_vertex.to_vec(), coordinates.to_vec());
        for parents in parents {
            let pattern = patterns.last().unwrap_or(fine);
            let (transfer, coarse_nodes) = Transfer::new(parents, &nodes, pattern.nodes());
            let coarse = transfer.coarse_pattern(pattern);
            let twins = transfer.twins.iter().map(|&twin| d * twin as usize);
            coordinates = twins.flat_map(|at| coordinates[at..at + d].to_vec()).collect();
            nodes = coarse_nodes;
            transfers.push(transfer);
            patterns.push(coarse);
        }
        let Some(last) = patterns.last() else { return Ok(None) };
        if last.nodes() == 0 {
            return Ok(None);
        }
        let coarsest = Analysis::new(last, &nested_dissection(last, &coordinates, &[]))?;
        Ok(Some(Self { transfers, patterns, coarsest, frames }))
    }

    /// Unknowns of the coarsest level.
    pub fn coarsest_unknowns(&self) -> usize {
        self.patterns.last().map_or(0, BlockPattern::order)
    }

    /// Number of levels, the finest included.
    pub fn count(&self) -> usize {
        self.patterns.len() + 1
    }
}

/// The parts of a cycle that make it symmetric.
pub(super) trait Parts {
    /// `coarse` ← Pᵀ `rest`.
    fn restrict<const D: usize>(&self, by: (&Transfer, &Turns), rest: &[f32], coarse: &mut [f32]) {
        by.0.restrict::<D>(by.1, rest, coarse);
    }
    /// Post-smoothing.
    fn after<const D: usize>(&self, by: (&Sweeps, &BlockPattern), vectors: &mut Vectors) {
        by.0.backward::<D>(by.1, &vectors.right, &mut vectors.solution, &mut vectors.rest);
    }
}

pub(super) struct Symmetric;

impl Parts for Symmetric {}

/// Vectors of one level, in units of the right side.
#[derive(Default)]
pub(super) struct Vectors {
    right: Vec<f32>,
    solution: Vec<f32>,
    rest: Vec<f32>,
}

/// A V-cycle for one matrix.
pub(super) struct Multigrid<'a, C = Symmetric> {
    parts: C,
    levels: &'a Levels,
    fine: &'a BlockPattern,
    sweeps: Vec<Sweeps>,
    turns: Turns,
    /// Values of the coarse matrices, in the units of the fine one.
    values: Vec<Vec<f64>>,
    vectors: Vec<Vectors>,
    factor: Factor<f64>,
    workspace: Workspace,
    front: Front<f64>,
    coarse: Vec<f64>,
    /// The largest diagonal entry, by which sweeps scale the matrix.
    scale: f64,
}

impl<'a, C: Parts> Multigrid<'a, C> {
    /// A cycle of `parts` for matrices with the pattern `fine`; no matrix yet.
    pub(super) fn new(parts: C, levels: &'a Levels, fine: &'a BlockPattern) -> Self {
        let all = || std::iter::once(fine).chain(&levels.patterns);
        let vectors = |pattern: &BlockPattern| Vectors {
            right: vec![0.0; pattern.order()],
            solution: vec![0.0; pattern.order()],
            rest: vec![0.0; pattern.order()],
        };
        Self {
            sweeps: all().take(levels.patterns.len()).map(Sweeps::new).collect(),
            turns: Turns::default(),
            values: levels.patterns.iter().map(|p| vec![0.0; p.entries()]).collect(),
            vectors: all().map(vectors).collect(),
            factor: levels.coarsest.factor(),
            workspace: levels.coarsest.workspace(),
            front: Front::default(),
            coarse: vec![0.0; levels.coarsest_unknowns()],
            scale: 1.0,
            parts,
            levels,
            fine,
        }
    }

    /// Takes the matrix with these lower-triangle `values`; rows and columns of the unknowns `held` are zero off the
    /// diagonal.
    ///
    /// # Errors
    /// [`FactorError::NotPositiveDefinite`] if the block of a node on any level, or the coarsest matrix, is
    /// not; it names the fine unknown at the same vertex.
    pub(super) fn set(&mut self, values: &[f64], held: &[usize]) -> Result<(), FactorError> {
        in_dimension!(self.fine.dimension(), D => self.set_in::<D>(values, held))
    }

    fn set_in<const D: usize>(
        &mut self,
        values: &[f64],
        held: &[usize],
    ) -> Result<(), FactorError> {
        let diagonal = |dof: usize| values[self.fine.diagonal(dof)].abs();
        self.scale = (0..self.fine.order()).map(diagonal).fold(f64::MIN_POSITIVE, f64::max);
        if !self.scale.is_finite() {
            return Err(FactorError::NotFinite);
        }
        self.turns.set(D, self.fine.nodes(), &self.levels.frames, held);
        for level in 0..self.levels.patterns.len() {
            let (done, rest) = self.values.split_at_mut(level);
            let (pattern, finer) = match done.last() {
                Some(coarse) => (&self.levels.patterns[level - 1], coarse.as_slice()),
                None => (self.fine, values),
            };
            let indefinite = |dof| self.levels.indefinite(level, D, dof);
            self.sweeps[level].set::<D>(pattern, finer, self.scale).map_err(indefinite)?;
            let none = Turns::default();
            let turns = if level == 0 { &self.turns } else { &none };
            let coarse = &self.levels.patterns[level];
            galerkin::<D>(
                (pattern, finer),
                &self.levels.transfers[level],
                turns,
                (coarse, &mut rest[0]),
            );
        }
        let (Some(last), Some(values)) = (self.levels.patterns.last(), self.values.last()) else {
            return Ok(());
        };
        self.levels.coarsest.factorize(last, values, &mut self.factor, &mut self.workspace).map_err(
            |error| match error {
                FactorError::NotPositiveDefinite { dof } => {
                    self.levels.indefinite(self.levels.patterns.len(), D, dof)
                }
                other => other,
            },
        )
    }

    /// x ← B x, B ≈ A⁻¹ symmetric.
    pub(super) fn cycle(&mut self, x: &mut [f64]) {
        let size = x.iter().fold(0.0f64, |size, value| size.max(value.abs()));
        if size == 0.0 || !size.is_finite() {
            return;
        }
        for (right, value) in self.vectors[0].right.iter_mut().zip(&*x) {
            *right = (value / size) as f32;
        }
        in_dimension!(self.fine.dimension(), D => self.descend::<D>(0));
        for (value, solution) in x.iter_mut().zip(&self.vectors[0].solution) {
            *value = f64::from(*solution) * (size / self.scale);
        }
    }

    fn descend<const D: usize>(&mut self, level: usize) {
        let Some(sweeps) = self.sweeps.get(level) else { return self.solve_coarsest() };
        let pattern = if level == 0 { self.fine } else { &self.levels.patterns[level - 1] };
        let (finer, coarser) = self.vectors.split_at_mut(level + 1);
        let Vectors { right, solution, rest } = &mut finer[level];
        sweeps.forward::<D>(pattern, right, solution, rest);
        let (transfer, none) = (&self.levels.transfers[level], Turns::default());
        let turns = if level == 0 { &self.turns } else { &none };
        self.parts.restrict::<D>((transfer, turns), rest, &mut coarser[0].right);
        self.descend::<D>(level + 1);
        let (finer, coarser) = self.vectors.split_at_mut(level + 1);
        let turns = if level == 0 { &self.turns } else { &none };
        transfer.add_interpolated::<D>(turns, &coarser[0].solution, &mut finer[level].solution);
        self.parts.after::<D>((&self.sweeps[level], pattern), &mut finer[level]);
    }

    fn solve_coarsest(&mut self) {
        let Some(Vectors { right, solution, .. }) = self.vectors.last_mut() else { return };
        for (value, right) in self.coarse.iter_mut().zip(&*right) {
            *value = f64::from(*right) * self.scale;
        }
        self.levels.coarsest.solve(&self.factor, &mut self.coarse, &mut self.front);
        for (solution, value) in solution.iter_mut().zip(&self.coarse) {
            *solution = *value as f32;
        }
    }
}

impl Levels {
    /// The error for an unknown of a level, named by the fine unknown at the same vertex.
    fn indefinite(&self, level: usize, d: usize, dof: usize) -> FactorError {
        let up = |node: u32, transfer: &Transfer| transfer.twins[node as usize];
        let node = self.transfers[..level].iter().rev().fold((dof / d) as u32, up);
        FactorError::NotPositiveDefinite { dof: d * node as usize + dof % d }
    }
}

#[cfg(test)]
mod tests;
