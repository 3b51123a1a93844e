//! A guaranteed bound of the error in space, at each node in time, from one run alone (*new*).
//!
//! Let u_n solve the time-discrete problem, exact in space, and u^h_n ∈ U^h be any displacements, here those of the run.
//! H_n = Σ_j W_nj ℬ ε(u^h_j) is the memory of these, e_n = ‖u_n - u^h_n‖ in the norm (𝒜ε(v), ε(v))^{1/2}. Let σ be a
//! symmetric stress with Div σ + f0 = 0, σν = f2 on Γ2, σ_τ = 0 and -σ_ν = p on Γ3. Then, with the laws of a convex
//! problem (∂j_ν monotone, no projection, no friction),
//!
//! ```text
//! e_n² ≤ (ρ_n + o_n + Σ_{j≤n} β_nj e_j) e_n + G_n,
//! ρ_n = ‖σ - 𝒜ε(u^h_n) - H_n‖ in 𝒜⁻¹,     G_n = ∫_{Γ3} ĵ(u^h_ν) + ĵ*(p) - p u^h_ν,     β_nj = |W_nj| ‖𝒜^{-1/2} ℬ 𝒜^{-1/2}‖,
//! ```
//!
//! ĵ being j_ν with the constraint u_ν ≤ g. *Proof.* Put u^h_n into the inequality of u_n, and u_n - u^h_n into the balance
//! of σ; subtract, and use p r ≤ ĵ(r) + ĵ*(p) at r = u_ν. o_n is what σ misses of loads that are no polynomials, with the
//! explicit constants of `oscillation`. The quadratic inequality is solved level by level. Nothing in it is unknown, no
//! constant of a regularity theorem, and β_nn < 1 is all it asks for.
//!
//! σ is the nearest to 𝒜ε(u^h_n) + H_n in a space of equilibrated stresses (`equilibrium`). Not bounded: the error in
//! time, rounding, and quadrature of the loads (degree 8 in the cells, 15 on the edges).

mod densities;
mod edges;
mod equilibrium;
mod inside;
mod on_contact;
mod oscillation;
#[cfg(test)]
mod tests;
mod triangle;
mod truth;

use algebra::linalg::FactorError;
use fem::contact::{CaseError, Discretization, StepView};
use fem::space::strain_of;
use nalgebra::{Matrix3, SymmetricEigen};
use scene::setup::{MeshData, SceneModel, Setup, SetupError, side_numbers};
use vhi::Newton;
use vhi::history::TimeGrid;
use vhi::law::{Convolution, TensorField};

use densities::Densities;
use equilibrium::Equilibrium;

/// σ must be in equilibrium to this part of its tractions; a solve leaves some 1e-13.
const BALANCED: f64 = 1e-9;

/// Why there is no bound.
#[derive(Debug, thiserror::Error)]
pub enum GuaranteeError {
    /// The theorem does not apply.
    #[error("no guaranteed bound: {reason}")]
    Refused {
        /// Which hypothesis fails.
        reason: String,
    },
    /// A load that is not finite.
    #[error("no guaranteed bound: {what} is not finite at t = {t}")]
    NotFinite {
        /// The load.
        what: &'static str,
        /// t_n.
        t: f64,
    },
    /// The mesh could not be had.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The dual problem could not be factorized.
    #[error("the problem of equilibrated stresses: {0}")]
    Factor(#[from] FactorError),
    /// The run failed.
    #[error(transparent)]
    Case(#[from] CaseError),
}

impl GuaranteeError {
    fn refused(reason: impl Into<String>) -> Self {
        Self::Refused { reason: reason.into() }
    }
}

/// The bound at one node in time.
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct BoundedLevel {
    /// n.
    pub n: usize,
    /// t_n.
    pub t: f64,
    /// ρ_n.
    pub residual: f64,
    /// o_n.
    pub oscillation: f64,
    /// G_n.
    pub gap: f64,
    /// The bound of e_n.
    pub bound: f64,
    /// (𝒜ε(u^h_n), ε(u^h_n))^{1/2}.
    pub size: f64,
    /// The distance to the exact solution, where there is one: e_n but for the error in time.
    pub error: Option<f64>,
}

/// The bounds of a run.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Guarantee {
    /// All nodes in time, n = 0 first.
    pub levels: Vec<BoundedLevel>,
}

impl Guarantee {
    /// The level with the largest bound.
    pub fn largest(&self) -> Option<&BoundedLevel> {
        self.levels.iter().max_by(|a, b| a.bound.total_cmp(&b.bound))
    }

    /// The median of bound over error, where the exact solution is known.
    pub fn effectivity(&self) -> Option<f64> {
        let quotients = self.levels.iter().filter_map(|level| {
            level.error.filter(|error| *error > 0.0).map(|error| level.bound / error)
        });
        let mut quotients: Vec<f64> = quotients.collect();
        quotients.sort_by(f64::total_cmp);
        quotients.get(quotients.len() / 2).copied()
    }
}

/// Solves the scene with n cells per unit length and `steps` steps, and bounds the error of each level.
///
/// # Errors
/// A scene that the theorem does not cover, a bound that is infinite, errors of the run.
pub fn guarantee(setup: &Setup, n: u32, steps: u32) -> Result<Guarantee, GuaranteeError> {
    covered(setup)?;
    let data = MeshData::new(setup, n, None)?;
    let model = &setup.model;
    let mut levels = Levels::new(setup, &data.space, setup.grid(steps))?;
    let mut failed = None;
    data.march(setup, steps, &Newton::default(), &mut |view| {
        if failed.is_none() {
            failed = levels.add(model, view).err();
        }
        Ok(())
    })?;
    match failed {
        Some(error) => Err(error),
        None => Ok(Guarantee { levels: levels.found }),
    }
}

/// Bytes beside those of the run, by measurements on meshes of n = 32 to 128: the factor, whose entries a cell grow as the
/// logarithm of their number, and formulas of an exact solution at 16 points a cell. None where there is no bound.
pub(crate) fn bytes(setup: &Setup, cells: usize) -> f64 {
    if covered(setup).is_err() {
        return 0.0;
    }
    let cells = cells as f64;
    let of_formulas = if setup.exact.is_some() { 5200.0 } else { 0.0 };
    cells * (400.0 * cells.max(2.0).log2() + of_formulas)
}

/// The hypotheses of the theorem that a scene can fail before it is solved.
fn covered(setup: &Setup) -> Result<(), GuaranteeError> {
    setup.scene.with_linear_elements("the guaranteed bound").map_err(SetupError::from)?;
    let refuse = |reason: &str| Err(GuaranteeError::refused(reason));
    let model = &setup.model;
    if setup.scene.dimension != 2 {
        return refuse("it is made for bodies in the plane");
    }
    if model.projection.is_some() {
        return refuse(
            "the projection depends on ζ, the whole past, and its term is not convex in u",
        );
    }
    if model.friction.is_some() {
        return refuse("σ_τ = 0 on Γ3 is assumed; this scene has friction");
    }
    let falls = |boundary: &fem::contact::Boundary| boundary.potential.alpha() > 0.0;
    if model.boundary.as_ref().is_some_and(falls) {
        return refuse("the law on Γ3 falls somewhere, so the problem is not convex");
    }
    Ok(())
}

/// The levels bounded so far, with what the next one needs.
struct Levels<'a> {
    space: &'a Discretization,
    grid: TimeGrid,
    equilibrium: Equilibrium<'a>,
    densities: Densities,
    truth: Option<truth::Strains>,
    /// The smallest eigenvalue of 𝒜 by regions.
    least: Vec<f64>,
    found: Vec<BoundedLevel>,
}

impl<'a> Levels<'a> {
    fn new(
        setup: &'a Setup,
        space: &'a Discretization,
        grid: TimeGrid,
    ) -> Result<Self, GuaranteeError> {
        let elasticity = &setup.model.elasticity;
        let clamped = side_numbers(&setup.body.domain.clamped);
        let equilibrium = Equilibrium::new(space, elasticity, &clamped)?;
        let densities = Densities::new(setup, space, &equilibrium.edges)?;
        let truth = setup.exact.as_ref().map(|exact| truth::Strains::new(exact, space));
        let least = elasticity.regions().iter().map(|tensor| tensor.eigenvalues(2).0).collect();
        Ok(Self { space, grid, equilibrium, densities, truth, least, found: Vec::new() })
    }

    fn add(&mut self, model: &SceneModel, view: &StepView<'_>) -> Result<(), GuaranteeError> {
        let (space, elasticity) = (self.space, &model.elasticity);
        let strain = |c: usize, u: &[f64]| {
            strain_of::<3>(space.geometry.gradients(c), space.cell_nodes(c), u)
        };
        let elastic = |c: usize| elasticity.on(space.region(c)).apply(&strain(c, view.u));
        let start: Vec<[f64; 3]> = (0..space.mesh.cell_count())
            .map(|c| {
                let mut stress = elastic(c);
                for (term, history) in model.memory.iter().zip(view.history) {
                    let own = term.tensor.on(space.region(c)).apply(&strain(c, history));
                    (0..3).for_each(|i| stress[i] += own[i]);
                }
                stress
            })
            .collect();
        let size: f64 = (0..space.mesh.cell_count())
            .map(|c| {
                space.geometry.measure[c]
                    * algebra::tensor::contract(&elastic(c), &strain(c, view.u))
            })
            .sum();
        let edges = &self.equilibrium.edges;
        let mut loads = self.densities.at(space, edges, view.t)?;
        let mut gap = 0.0;
        if let Some(boundary) = &model.boundary {
            let pressure = pressures(space, boundary, view);
            gap = on_contact::duality_gap(space, boundary, view.u, &pressure);
            add_pressures(space, edges, &pressure, &mut loads.given.tractions);
        }
        let stresses = self.equilibrium.nearest(&start, &loads.given);
        let imbalance = self.equilibrium.imbalance(&stresses, &loads.given);
        if imbalance.is_nan() || imbalance > BALANCED {
            return Err(GuaranteeError::refused(format!(
                "at t = {} the stresses are in equilibrium to {imbalance:.1e} of their tractions only",
                view.t
            )));
        }
        let square = self.equilibrium.distance(&stresses, &start, &loads.corners);
        let residual = square.max(0.0).sqrt();
        let least = |c: usize| *self.least.get(space.region(c)).unwrap_or(&self.least[0]);
        let oscillation =
            self.densities.oscillation(space, &self.equilibrium.edges, &loads, &least);
        let bound = self.bound(model, view.n, residual + oscillation, gap)?;
        let error =
            self.truth.as_mut().map(|truth| truth.distance(space, elasticity, view.u, view.t));
        self.found.push(BoundedLevel {
            n: view.n,
            t: view.t,
            residual,
            oscillation,
            gap,
            bound,
            size: size.max(0.0).sqrt(),
            error,
        });
        Ok(())
    }

    /// The larger zero of (1 - β_nn) e² - a e - G, a = `own` + Σ_{j<n} β_nj e_j.
    fn bound(
        &self,
        model: &SceneModel,
        n: usize,
        own: f64,
        gap: f64,
    ) -> Result<f64, GuaranteeError> {
        let weights = self.memory_weights(model, n);
        let last = weights.last().copied().unwrap_or(0.0);
        let t = self.grid.time(n);
        if last.is_nan() || last >= 1.0 {
            return Err(GuaranteeError::refused(format!(
                "the memory of the step that ends at t = {t} has the weight {last:.2}, which must be below 1: take smaller steps"
            )));
        }
        let past: f64 =
            weights.iter().zip(&self.found).map(|(weight, level)| weight * level.bound).sum();
        let linear = own + past;
        let keep = 1.0 - last;
        let bound = (linear + (linear * linear + 4.0 * keep * gap).sqrt()) / (2.0 * keep);
        if !bound.is_finite() {
            return Err(GuaranteeError::refused(format!(
                "at t = {t} the computed u_ν exceeds the gap between vertices, or the law never has the computed pressure"
            )));
        }
        Ok(bound)
    }

    /// β_nj, j = 0, …, n; empty without memory.
    fn memory_weights(&self, model: &SceneModel, n: usize) -> Vec<f64> {
        let rule = model.time_rule.as_ref();
        let Some(first) = model.memory.first() else { return Vec::new() };
        let weight = |j: usize| {
            let own = |term: &fem::contact::MemoryTerm| {
                rule.kernel_weight(&Convolution(&*term.kernel), &self.grid, n, j)
            };
            let mut sum = first.tensor.scaled(own(first));
            for term in &model.memory[1..] {
                sum.add(own(term), &term.tensor, 2);
            }
            relative_norm(&sum, &model.elasticity)
        };
        (0..=n).map(weight).collect()
    }
}

/// ‖𝒜^{-1/2} ℬ 𝒜^{-1/2}‖, the largest of all regions.
fn relative_norm(tensor: &TensorField, elasticity: &TensorField) -> f64 {
    let regions = tensor.regions().len().max(elasticity.regions().len());
    let matrix = |field: &TensorField, region: usize| {
        let rows = field.on(region).matrix::<3>();
        Matrix3::from_fn(|i, j| rows[i][j])
    };
    let own = |region: usize| {
        let Some(root) = matrix(elasticity, region).cholesky() else { return f64::NAN };
        let Some(inverse) = root.l().try_inverse() else { return f64::NAN };
        let scaled = inverse * matrix(tensor, region) * inverse.transpose();
        SymmetricEigen::new(scaled).eigenvalues.amax()
    };
    (0..regions).map(own).fold(0.0, algebra::linalg::larger)
}

/// ξ + λ at the points of the trace; at a clamped one the pressure of the graph that is nearest to its neighbour's.
fn pressures(
    space: &Discretization,
    boundary: &fem::contact::Boundary,
    view: &StepView<'_>,
) -> Vec<f64> {
    use vhi::law::Potential;
    let trace = &space.trace;
    let mut pressure: Vec<f64> =
        view.compliance.iter().zip(view.multiplier).map(|(xi, lambda)| xi + lambda).collect();
    for f in 0..trace.measure.len() {
        let ends = [trace.facet(f)[0] as usize, trace.facet(f)[1] as usize];
        for (own, other) in [(ends[0], ends[1]), (ends[1], ends[0])] {
            if !trace.points[own].clamped {
                continue;
            }
            let x = space.mesh.point(&[trace.points[own].vertex], &[1.0]);
            let (lo, hi) = boundary.potential_at(x).subdifferential(-(boundary.shift)(x));
            let hi = if (boundary.gap)(x) > 0.0 { hi } else { f64::INFINITY };
            pressure[own] = pressure[other].max(lo).min(hi);
        }
    }
    pressure
}

/// Adds -p ν on Γ3.
fn add_pressures(
    space: &Discretization,
    edges: &edges::Edges,
    pressure: &[f64],
    tractions: &mut [f64],
) {
    let trace = &space.trace;
    for (f, &facet) in trace.mesh_facet.iter().enumerate() {
        let Some((free, ends)) = edges.on_facet(facet) else { continue };
        for &point in trace.facet(f) {
            let own = &trace.points[point as usize];
            let end = usize::from(ends[1] == own.vertex);
            for i in 0..2 {
                tractions[4 * free as usize + 2 * end + i] -=
                    pressure[point as usize] * own.normal[i];
            }
        }
    }
}
