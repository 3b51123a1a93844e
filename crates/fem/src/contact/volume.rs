//! K⁻¹ for K = 𝒜 + Σ W_i ℬ_i of the last slot's weights W_i, or for K = 𝒜 where the memory is a multiple of it: one
//! matrix serves levels until the weights change, by its factor or by conjugate gradients with multigrid.

use std::sync::Arc;
use std::time::Instant;

use super::floor::Accepted;
use super::side::Side;
use super::way::{Way, accepted_residual, size_of_forces};
use super::{Discretization, Floors, LinearSolver, Model, Unknowns, Work};
use algebra::linalg::{
    FactorError, Front, Jacobian, MultigridSequence, SIDES, TangentSolver, axpy, norm,
};
use vhi::law::TensorField;

/// Matrix and solver. Right sides of a pass over a factor are in its order, entry after entry, `width` of each.
pub(super) struct Volume<'a> {
    space: &'a Discretization,
    unknowns: Unknowns,
    /// The largest eigenvalue of 𝒜.
    stiffest: f64,
    /// β of ℬ₀ = β𝒜, 0 without memory; `None` where memory is no multiple.
    pub beta: Option<f64>,
    /// Stiffness of 𝒜, and of each ℬ_i and of K where memory is no multiple.
    pub elastic: Arc<Vec<f64>>,
    by_memory: Vec<Vec<f64>>,
    matrix: Vec<f64>,
    /// Weights that K was made with, `None` before the first; those of the level minus these, zero unless an old
    /// factor serves.
    slot: Option<Vec<f64>>,
    behind: Vec<f64>,
    /// Whether an old factor may serve, the extra passes it has cost, and the passes that a factorization is worth.
    serves: bool,
    extra: u32,
    worth: u32,
    way: Way<'a>,
    /// Of the unknowns in right sides of a pass.
    pub order: Vec<u32>,
    /// Room for a product with ℬ_i, and for its argument.
    product: Vec<f64>,
    change: Vec<f64>,
    work: Work,
}

/// Passes that a level takes with the factor of the level before it, on grids of usual lengths.
const LEAST: u32 = 2;
/// A factorization that costs no more passes is made for every level: from some n = 32 on in the plane it costs more.
const DEAR: u32 = 3;
impl<'a> Volume<'a> {
    /// Before the first weights.
    ///
    /// # Errors
    /// 𝒜 is not positive definite, or the order of unknowns cannot be analysed.
    pub(super) fn new(
        space: &'a Discretization,
        model: &Model,
        solver: LinearSolver,
        unknowns: Unknowns,
        equal_steps: bool,
    ) -> Result<Self, FactorError> {
        let (beta, mut work) = (model.memory_multiple(), Work::default());
        let analysis = space.analysis_of(unknowns)?;
        let stiffness = |tensor: &TensorField| space.stiffness_of(unknowns, tensor);
        let levels = space.levels_of(solver);
        let kept = match (levels, beta) {
            (None, Some(_)) => {
                Some(space.stiffness_factor(&model.elasticity, unknowns, &mut work)?)
            }
            _ => None,
        };
        let start = Instant::now();
        let others = model.memory.iter().filter(|_| beta.is_none());
        let by_memory: Vec<Vec<f64>> = others.map(|term| stiffness(&term.tensor)).collect();
        let elastic = match &kept {
            Some(kept) => kept.values.clone(),
            None => Arc::new(stiffness(&model.elasticity)),
        };
        work.seconds_assemble += start.elapsed().as_secs_f64();
        let dofs = space.dofs();
        let way = match levels {
            Some(levels) => Way::Multigrid {
                sequence: Box::new(MultigridSequence::new(levels, &space.pattern)),
                jacobian: Jacobian::default(),
                room: [(); 4].map(|()| vec![0.0; dofs]),
            },
            None => Way::Factor {
                analysis,
                workspace: kept.is_none().then(|| analysis.workspace()),
                factor: kept.map_or_else(|| Arc::new(analysis.factor()), |k| k.factor.clone()),
                front: Front::default(),
                sides: Front::default(),
            },
        };
        let worth = analysis.passes_of_a_factor();
        let order = match &way {
            Way::Factor { analysis, .. } => analysis.order().to_vec(),
            Way::Multigrid { .. } => (0..dofs as u32).collect(),
        };
        Ok(Self {
            order,
            space,
            unknowns,
            stiffest: model.elasticity.eigenvalues(space.mesh.dimension).1,
            matrix: if by_memory.is_empty() { Vec::new() } else { elastic.to_vec() },
            product: vec![0.0; if by_memory.is_empty() { 0 } else { dofs }],
            slot: None,
            behind: Vec::new(),
            serves: levels.is_none() && beta.is_none() && !equal_steps && worth > DEAR,
            extra: 0,
            worth,
            change: Vec::new(),
            beta,
            elastic,
            by_memory,
            way,
            work,
        })
    }

    /// Right sides of a pass: several where no level asks for the displacements of the one before it.
    pub(super) fn width(&self) -> usize {
        let together = self.beta.is_some() && matches!(self.way, Way::Factor { .. });
        if together { SIDES } else { 1 }
    }

    /// Takes weights of a level; whether K is made anew of them. Where weights change, an old factor serves until
    /// its extra passes have cost a new one: at most twice the least cost, whatever comes.
    ///
    /// # Errors
    /// K is not positive definite.
    pub(super) fn set(&mut self, slot: &[f64]) -> Result<bool, FactorError> {
        if let Some(known) = &self.slot {
            let known = known.iter().zip(slot);
            self.behind.clear();
            self.behind.extend(known.map(|(known, new)| new - known));
            let same = self.beta.is_some() || !self.is_behind();
            if same || (self.serves && self.extra < self.worth) {
                return Ok(false);
            }
        }
        self.renew(slot)
    }

    /// Makes K of these weights, whatever serves.
    ///
    /// # Errors
    /// As [`Self::set`].
    pub(super) fn renew(&mut self, slot: &[f64]) -> Result<bool, FactorError> {
        self.behind.clear();
        self.extra = 0;
        let start = Instant::now();
        if !self.by_memory.is_empty() {
            self.matrix.copy_from_slice(&self.elastic);
            for (matrix, weight) in self.by_memory.iter().zip(slot) {
                axpy(*weight, matrix, &mut self.matrix);
            }
        }
        let matrix = if self.by_memory.is_empty() { &self.elastic } else { &self.matrix };
        match &mut self.way {
            Way::Factor { analysis, factor, workspace: Some(workspace), .. } => {
                // Nobody else has it: no copy is made.
                let factor = Arc::make_mut(factor);
                self.work.linear.factorizations += 1;
                analysis.factorize(&self.space.pattern, matrix, factor, workspace)?;
                self.work.linear.seconds_factor += start.elapsed().as_secs_f64();
            }
            Way::Factor { workspace: None, .. } => {}
            Way::Multigrid { sequence, jacobian, .. } => {
                jacobian.values.clone_from(matrix);
                sequence.prepare(jacobian, false)?;
            }
        }
        match &mut self.slot {
            Some(known) => known.copy_from_slice(slot),
            none => *none = Some(slot.to_vec()),
        }
        Ok(true)
    }

    pub(super) fn serves(&self) -> bool {
        self.serves
    }

    /// Whether K is that of other weights: what a pass takes for u then belongs to the right side.
    pub(super) fn is_behind(&self) -> bool {
        self.beta.is_none() && self.behind.iter().any(|lacking| *lacking != 0.0)
    }

    /// Subtracts the forces that K lacks at `u`.
    pub(super) fn subtract_behind(&mut self, u: &[f64], forces: &mut [f64]) {
        for (matrix, lacking) in self.by_memory.iter().zip(&self.behind) {
            self.space.pattern.multiply(matrix, u, &mut self.product);
            axpy(-lacking, &self.product, forces);
        }
    }

    /// Counts passes that a level took.
    pub(super) fn count(&mut self, passes: u32) {
        self.extra += passes.saturating_sub(LEAST);
    }

    /// Whether `u`, found by a pass that assumed `taken`, solves a level with the load `force`; `left` becomes its
    /// residual.
    pub(super) fn is_solved(
        &mut self,
        u: &[f64],
        taken: &[f64],
        force: &[f64],
        left: &mut [f64],
    ) -> bool {
        let mut change = std::mem::take(&mut self.change);
        change.clear();
        change.extend(u.iter().zip(taken).map(|(u, taken)| u - taken));
        left.fill(0.0);
        self.subtract_behind(&change, left);
        self.change = change;
        norm(left) <= accepted_residual(self.forces(u) + norm(force))
    }

    /// ‖diag(K) u‖ of the elastic K.
    fn forces(&self, u: &[f64]) -> f64 {
        size_of_forces(self.space, &self.elastic, u)
    }

    /// The factor of the Schur complement on the unknowns from `cut` on, see [`Analysis::last_triangle`].
    pub(super) fn last_triangle(&self, cut: usize) -> Vec<f64> {
        self.way.last_triangle(cut)
    }

    /// The forward pass in the rows before `cut`; `width` right sides.
    pub(super) fn forward(&mut self, cut: usize, width: usize, x: &mut [f64]) {
        let start = Instant::now();
        self.way.forward(cut, width, x);
        self.work.linear.seconds_solve += start.elapsed().as_secs_f64();
    }

    /// The backward pass, by which `levels` of the right sides become solutions; all of the solve without a factor.
    ///
    /// # Errors
    /// The multigrid iteration does not converge.
    pub(super) fn backward(
        &mut self,
        cut: usize,
        width: usize,
        x: &mut [f64],
        levels: usize,
    ) -> Result<(), FactorError> {
        if matches!(self.way, Way::Multigrid { .. }) {
            return self.solve(x);
        }
        let start = Instant::now();
        self.way.backward(cut, width, x);
        self.work.linear.solves += levels as u32;
        self.work.linear.seconds_solve += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// K⁻¹x in place to rounding, over the unknowns.
    ///
    /// # Errors
    /// The multigrid iteration does not converge.
    pub(super) fn solve(&mut self, x: &mut [f64]) -> Result<(), FactorError> {
        let start = Instant::now();
        self.way.solve(self.space, x)?;
        if matches!(self.way, Way::Factor { .. }) {
            self.work.linear.solves += 1;
            self.work.linear.seconds_solve += start.elapsed().as_secs_f64();
        }
        Ok(())
    }

    /// Subtracts the forces of the memory, by its sums over the past or with the last slot; nothing where it is a
    /// multiple.
    pub(super) fn subtract_memory(&mut self, history: &[Vec<f64>], forces: &mut [f64]) {
        for (matrix, history) in self.by_memory.iter().zip(history) {
            self.space.pattern.multiply(matrix, &history[..forces.len()], &mut self.product);
            axpy(-1.0, &self.product, forces);
        }
    }

    /// Floors from the correction that one more solve would make of a level: `force` are its load and contact on the
    /// unknowns, `size` their size, `u` and `history` unknowns, `nodal` displacements. Γ3 from `cut` on answers by its own
    /// tangent, where a stiff law holds what rounding of its forces would move; `rounding` is how large that is.
    pub(super) fn floors(
        &mut self,
        mut force: Vec<f64>,
        (size, rounding): (f64, f64),
        [u, nodal]: [&[f64]; 2],
        history: &[Vec<f64>],
        (cut, side): (usize, Option<&mut Side<'_>>),
    ) -> Floors {
        let (space, dofs) = (self.space, self.space.dofs());
        // K acts on u + β history; or 𝒜 on u, and each ℬ_i on its history, which holds u.
        let mut v = u[..dofs].to_vec();
        if let (Some(beta), Some(history)) = (self.beta, history.first()) {
            axpy(beta, &history[..dofs], &mut v);
        }
        let mut product = vec![0.0; dofs];
        space.pattern.multiply(&self.elastic, &v, &mut product);
        axpy(-1.0, &product, &mut force);
        self.subtract_memory(history, &mut force);
        let tolerance = accepted_residual(self.forces(&v) + size + rounding);
        let accepted = Accepted { residual: norm(&force), tolerance };
        match side {
            None => self.way.estimate(&mut force),
            Some(side) => {
                let mut ordered: Vec<f64> =
                    self.order.iter().map(|&dof| force[dof as usize]).collect();
                self.way.forward(cut, 1, &mut ordered);
                side.level.correct(&mut ordered[cut..]);
                self.way.backward(cut, 1, &mut ordered);
                let places = self.order.iter().zip(ordered);
                places.for_each(|(&dof, value)| force[dof as usize] = value);
            }
        }
        force.resize(space.nodes.len(), 0.0);
        if self.unknowns == Unknowns::ContactLast {
            space.frames.to_cartesian(&mut force);
        }
        Floors::new(space, &force, nodal, accepted, self.stiffest)
    }

    pub(super) fn work(&self) -> Work {
        match &self.way {
            Way::Factor { .. } => self.work,
            Way::Multigrid { sequence, .. } => Work { linear: sequence.work, ..self.work },
        }
    }
}
