//! Linear scenes with ℬ₀ = β𝒜 or without memory, whose loads separate in time, F(t) = Σ a_i(t) F_i: with
//! w_i = K⁻¹F_i all displacements are u_n = Σ c_i w_i, and
//!
//!   c(n) = (a(t_n) - β Σ_{j<n} W_nj c(j)) / (1 + βW_nn)
//!
//! is a recursion on a few numbers. A level costs sums of a few vectors; strains and stresses are evaluated once,
//! for each w_i, and enter the force balance and ‖ε(u_n)‖ by their linear combinations.

use super::Discretization;
use super::case::StepView;
use super::kkt::internal_force;
use super::model::Model;
use super::nodal_norms::strain_norm;
use super::shown::Shown;
use algebra::in_dimension;
use algebra::linalg::{axpy, is_sound_sum, larger, largest};
use algebra::tensor::contract;

/// The w_i with what is linear in them.
pub(crate) struct Combination {
    /// w_i as nodal vectors.
    solutions: Vec<Vec<f64>>,
    /// ∫ 𝒜ε(w_i) : ε(v) and ∫ ℬ₀ε(w_i) : ε(v), from strains.
    elastic: Vec<Vec<f64>>,
    remembered: Vec<Vec<f64>>,
    /// (ε(w_i), ε(w_j)), row by row.
    gram: Vec<f64>,
}

/// Nodal forces that are summed together: three vectors of them stay in the nearest cache.
const BLOCK: usize = 512;

/// A ‖ε(u)‖² that is this share of the squares it is the sum of has lost digits, and is computed from u.
const CANCELLED: f64 = 1e-4;

impl Combination {
    /// Evaluates what is linear in the solutions.
    pub(crate) fn new(space: &Discretization, model: &Model, solutions: &[Vec<f64>]) -> Self {
        let padded = |vector: &Vec<f64>| {
            let mut nodal = vector.clone();
            nodal.resize(space.nodes.len(), 0.0);
            nodal
        };
        let solutions: Vec<Vec<f64>> = solutions.iter().map(padded).collect();
        let zero = vec![0.0; space.nodes.len()];
        let nothing = Shown::new(space, model);
        let forces = |u: &[f64], history: &[Vec<f64>]| {
            let view = StepView { u, history, ..nothing.view((0, 0.0), &[], [0.0; 2]) };
            internal_force(space, model, &view)
        };
        let elastic = solutions.iter().map(|w| forces(w, &[])).collect();
        let remembered = match model.memory.is_empty() {
            true => Vec::new(),
            false => solutions.iter().map(|w| forces(&zero, std::slice::from_ref(w))).collect(),
        };
        let pairs = solutions.iter().flat_map(|a| solutions.iter().map(move |b| (a, b)));
        let gram = pairs.map(|(a, b)| strain_product(space, a, b)).collect();
        Self { solutions, elastic, remembered, gram }
    }

    /// `out` ← Σ c_i w_i.
    pub(crate) fn combine(&self, c: &[f64], out: &mut [f64]) {
        sum(c.iter().zip(&self.solutions), 0, out);
    }

    /// ‖ε(u)‖ of u = Σ c_i w_i.
    pub(crate) fn strain_norm(&self, space: &Discretization, c: &[f64], u: &[f64]) -> f64 {
        let count = c.len();
        let product = |i: usize, j: usize| c[i] * c[j] * self.gram[count * i + j];
        let square: f64 = (0..count * count).map(|ij| product(ij / count, ij % count)).sum();
        let squares: f64 = (0..count).map(|i| product(i, i)).sum();
        if is_sound_sum(square) && square >= CANCELLED * squares {
            square.sqrt()
        } else {
            strain_norm(space, u)
        }
    }

    /// What [`super::kkt_residual`] is of u = Σ c_i w_i with the history Σ d_i w_i and the load Σ a_i F_i, without
    /// contact.
    pub(crate) fn kkt_residual(
        &self,
        space: &Discretization,
        [c, d]: [&[f64]; 2],
        a: &[f64],
        loads: &[Vec<f64>],
    ) -> f64 {
        let (mut force, mut load) = ([0.0; BLOCK], [0.0; BLOCK]);
        let (mut scale, mut worst) = (0.0, 0.0);
        let (dofs, nodes) = (space.dofs(), space.nodes.len());
        for start in (0..nodes).step_by(BLOCK) {
            let force = &mut force[..BLOCK.min(nodes - start)];
            let inside = dofs.saturating_sub(start).min(force.len());
            let load = &mut load[..inside];
            let parts = c.iter().zip(&self.elastic).chain(d.iter().zip(&self.remembered));
            sum(parts, start, force);
            sum(a.iter().zip(loads), start, load);
            scale = larger(scale, larger(largest(force), largest(load)));
            load.iter_mut().zip(&*force).for_each(|(load, force)| *load -= force);
            worst = larger(worst, largest(load));
        }
        if scale > 0.0 { worst / scale } else { worst }
    }
}

/// `out` ← Σ c_i v_i, of the entries from `start` on.
fn sum<'a>(
    mut parts: impl Iterator<Item = (&'a f64, &'a Vec<f64>)>,
    start: usize,
    out: &mut [f64],
) {
    // Loads end before the clamped nodes do.
    let from = |vector: &'a Vec<f64>| vector.get(start..).unwrap_or_default();
    match parts.next() {
        Some((c, vector)) => {
            out.iter_mut().zip(from(vector)).for_each(|(out, value)| *out = c * value);
        }
        None => out.fill(0.0),
    }
    parts.for_each(|(c, vector)| axpy(*c, from(vector), out));
}

/// (ε(v), ε(w)) of nodal vectors.
fn strain_product(space: &Discretization, v: &[f64], w: &[f64]) -> f64 {
    fn sum<const S: usize>(space: &Discretization, v: &[f64], w: &[f64]) -> f64 {
        space.points().map(|at| at.weight * contract(&at.strain::<S>(v), &at.strain(w))).sum()
    }
    in_dimension!(space.mesh.dimension, D, S => sum::<S>(space, v, w))
}
