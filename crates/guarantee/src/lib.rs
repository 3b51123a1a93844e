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
//! σ is the nearest to 𝒜ε(u^h_n) + H_n in a space of equilibrated stresses (`equilibrium`), linear on parts of the cells: of
//! order h² for smooth solutions, as strains of quadratic elements are, for which the proof is the same. Not bounded: the error in
//! time, rounding, and quadrature of the loads (degree 8 in the cells, 15 on the edges).

mod densities;
mod equilibrium;
mod error;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use self::densities::Densities;
use self::equilibrium::{Equilibrium, Stress, Triangle};
pub use self::error::GuaranteeError;
use self::error::Result;
use algebra::linalg::larger;
use algebra::tensor::contract;
use exact::{Exact, Status, check};
use fem::contact::{Discretization, Model, StepView, weighted_memory};
use fem::space::quadrature::{Rule, triangle_degree_8};
use fem::space::{StrainPoint, StrainShapes};
use formula::BoundProgram;
use nalgebra::Matrix3;
use scene::setup::{MeshData, Setup, side_numbers, sides};
use vhi::Newton;
use vhi::history::TimeGrid;
use vhi::law::{Convolution, FourthOrder, MemoryKernel, TensorField};

/// σ must be in equilibrium to this part of its tractions; a solve leaves some 1e-13.
const BALANCED: f64 = 1e-9;

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
pub fn guarantee(setup: &Setup, n: u32, steps: u32) -> Result<Guarantee> {
    let data = MeshData::new(setup, n, None)?;
    let mut bounding = Bounding::new(setup, &data, steps)?;
    data.march(setup, steps, &Newton::default(), &mut |view| {
        bounding.see(view);
        Ok(())
    })?;
    bounding.finish()
}

/// The bounds of a run that is seen level by level.
pub struct Bounding<'a> {
    model: &'a Model,
    space: &'a Discretization,
    grid: TimeGrid,
    equilibrium: Equilibrium,
    densities: Densities,
    truth: Option<Strains>,
    /// What the stress in equilibrium is to be near to.
    of_cell: OfCell,
    found: Vec<BoundedLevel>,
    failed: Option<GuaranteeError>,
}

/// Bytes beside those of the run, by measurements on meshes of n = 32 to 128: the factor, whose entries a cell grow as the
/// logarithm of their number, and formulas of an exact solution at 16 points a cell. None where there is no bound.
pub fn bytes(setup: &Setup, space: &Discretization) -> f64 {
    if covered(setup).is_err() {
        return 0.0;
    }
    let cells = space.mesh.cell_count() as f64;
    let of_formulas = if setup.exact.is_some() { 5200.0 } else { 0.0 };
    cells * (400.0 * cells.max(2.0).log2() + of_formulas) + equilibrium::bytes_of_shapes(space)
}

/// The hypotheses of the theorem that a scene can fail before it is solved.
fn covered(setup: &Setup) -> Result<()> {
    let scene = &setup.scene;
    let model = &setup.model;
    let falls = model.boundary.iter().any(|b| b.potential.alpha() > 0.0);
    let beyond = [
        (scene.dimension != 2, "it is made for bodies in the plane"),
        (
            model.projection.is_some(),
            "the projection depends on ζ, the whole past, and its term is not convex in u",
        ),
        (model.friction.is_some(), "σ_τ = 0 on Γ3 is assumed; this scene has friction"),
        (
            !setup.body.domain.symmetry.is_empty(),
            "the stress in equilibrium is made for clamped, loaded and contact sides, not for planes of symmetry",
        ),
        (falls, "the law on Γ3 falls somewhere, so the problem is not convex"),
    ];
    let reason = beyond.into_iter().find_map(|(is, reason)| is.then_some(reason));
    reason.map_or(Ok(()), |reason| Err(GuaranteeError::no_bound(reason)))
}

/// f0 and the tractions of an exact solution are all of its load: a stress that jumps inside the body has a part of it on a
/// line, which no density holds.
fn has_densities(setup: &Setup) -> Result<()> {
    let Some(exact) = &setup.exact else { return Ok(()) };
    let mut findings = check(exact, &sides(&setup.body)).into_iter();
    let of_loads = |subject: &str| ["loads", "stress jump"].contains(&subject);
    let other = findings.find(|found| of_loads(&found.subject) && found.status != Status::Verified);
    other.map_or(Ok(()), |finding| Err(GuaranteeError::no_bound(finding.text)))
}

/// A stress on one cell.
type OfCell = fn(&Discretization, &Model, &StepView<'_>, usize) -> Stress;

/// 𝒜ε(u^h) + H on a cell, constant or linear as strains are.
fn of_run(space: &Discretization, model: &Model, view: &StepView<'_>, c: usize) -> Stress {
    if space.geometry.shares.len() == 1 {
        return Triangle::constant(&view.stress(space, model, c));
    }
    let stress = |at: StrainPoint<'_>| view.stress_of(space, model, &at, &at.strain(view.u));
    let values: Vec<[f64; 3]> = space.points_of(c).map(stress).collect();
    let shapes = StrainShapes::new(space.element, 2);
    Triangle::linear(|b| shapes.tensor(b, &values))
}

impl<'a> Bounding<'a> {
    /// Before the first level of a run on these data with `steps` steps.
    ///
    /// # Errors
    /// A scene that the theorem does not cover.
    pub fn new(setup: &'a Setup, data: &'a MeshData, steps: u32) -> Result<Self> {
        covered(setup)?;
        has_densities(setup)?;
        let (space, elasticity) = (&*data.space, &setup.model.elasticity);
        let clamped = side_numbers(&setup.body.domain.clamped);
        let equilibrium = Equilibrium::new(space, elasticity, &clamped).map_err(|source| {
            unbalanced(format!("{source} in the problem of equilibrated stresses"), elasticity)
        })?;
        Ok(Self {
            model: &setup.model,
            space,
            grid: setup.grid(steps),
            densities: Densities::new(setup, space, &equilibrium.edges)?,
            equilibrium,
            truth: setup.exact.as_ref().map(|exact| Strains::new(exact, space)),
            of_cell: of_run,
            found: Vec::new(),
            failed: None,
        })
    }

    /// Bounds the next level.
    pub fn see(&mut self, view: &StepView<'_>) {
        if self.failed.is_none() {
            self.failed = self.add(view).err();
        }
    }

    /// What was found.
    ///
    /// # Errors
    /// A bound that is infinite.
    pub fn finish(self) -> Result<Guarantee> {
        self.failed.map_or(Ok(Guarantee { levels: self.found }), Err)
    }

    fn add(&mut self, view: &StepView<'_>) -> Result<()> {
        let (space, model) = (self.space, self.model);
        let elasticity = &model.elasticity;
        let start = |c: usize| (self.of_cell)(space, model, view, c);
        let start: Vec<Stress> = (0..space.mesh.cell_count()).map(start).collect();
        let edges = &self.equilibrium.edges;
        let mut loads = self.densities.at(space, edges, view.t)?;
        let mut gap = 0.0;
        if !model.boundary.is_empty() {
            let pressure = densities::pressures(space, model, view);
            let pressure = densities::along_edges(space, &pressure);
            gap = densities::duality_gap(space, model, view, &pressure);
            densities::add_pressures(space, edges, &pressure, &mut loads.given.tractions);
        }
        let stresses = self.equilibrium.nearest(&start, &loads.given);
        let imbalance = self.equilibrium.imbalance(&stresses, &loads.given);
        if imbalance.is_nan() || imbalance > BALANCED {
            let what = format!(
                "at t = {} the stresses are in equilibrium to {imbalance:.1e} of their tractions only",
                view.t
            );
            return Err(unbalanced(what, elasticity));
        }
        let square = self.equilibrium.distance(&stresses, &start);
        let residual = square.max(0.0).sqrt();
        let oscillation = loads.oscillation(space, &self.equilibrium, elasticity);
        let bound = self.bound(view.n, residual + oscillation, gap)?;
        let error =
            self.truth.as_mut().map(|truth| truth.distance(space, elasticity, view.u, view.t));
        self.found.push(BoundedLevel {
            n: view.n,
            t: view.t,
            residual,
            oscillation,
            gap,
            bound,
            size: energy_norm(space, elasticity, view.u),
            error,
        });
        Ok(())
    }

    /// The larger zero of (1 - β_nn) e² - a e - G, a = `estimate` + Σ_{j<n} β_nj e_j.
    fn bound(&self, n: usize, estimate: f64, gap: f64) -> Result<f64> {
        let weights = weights(self.model, &self.grid, n);
        let last = weights.last().copied().unwrap_or(0.0);
        let t = self.grid.time(n);
        if last.is_nan() || last >= 1.0 {
            return Err(GuaranteeError::no_bound(format!(
                "the memory of the step that ends at t = {t} has the weight {last:.2}, which must be below 1: take smaller steps"
            )));
        }
        let past: f64 =
            weights.iter().zip(&self.found).map(|(weight, level)| weight * level.bound).sum();
        let linear = estimate + past;
        let keep = 1.0 - last;
        let bound = (linear + (linear * linear + 4.0 * keep * gap).sqrt()) / (2.0 * keep);
        if !bound.is_finite() {
            return Err(GuaranteeError::no_bound(format!(
                "at t = {t} the computed u_ν exceeds the gap between nodes, or the law never has the computed pressure"
            )));
        }
        Ok(bound)
    }
}

/// Why equilibrium is not found, with what may be the cause of it.
fn unbalanced(what: String, elasticity: &TensorField) -> GuaranteeError {
    let (least, largest) = elasticity.eigenvalues(2);
    let ratio = largest / least;
    GuaranteeError::no_bound(format!(
        "{what}; the largest stiffness is {ratio:.1e} times the least"
    ))
}

/// (𝒜ε(v), ε(v))^{1/2} of a nodal vector.
fn energy_norm(space: &Discretization, elasticity: &TensorField, v: &[f64]) -> f64 {
    let energy = |at: StrainPoint<'_>| {
        let strain = at.strain::<3>(v);
        at.weight * contract(&elasticity.on(space.region(at.cell)).apply(&strain), &strain)
    };
    space.points().map(energy).sum::<f64>().sqrt()
}

// β_nj = |W_nj| ‖𝒜^{-1/2} ℬ 𝒜^{-1/2}‖: what the errors of earlier levels are to that of level n.

/// β_nj, j = 0, …, n; zeros without memory.
fn weights(model: &Model, grid: &TimeGrid, n: usize) -> Vec<f64> {
    let weight = |j: usize| {
        let of = |kernel: &dyn MemoryKernel| {
            model.time_rule.kernel_weight(&Convolution(kernel), grid, n, j)
        };
        let sum = weighted_memory(&model.memory, of, 2);
        sum.map_or(0.0, |sum| quotient(&sum, &model.elasticity))
    };
    (0..=n).map(weight).collect()
}

// The distance of a run to the exact solution in the energy norm, by a rule that is not the assembly's.

/// ε of the exact solution at the points of a mesh.
struct Strains {
    rule: Rule,
    fields: BoundProgram,
}

impl Strains {
    /// Binds the formulas.
    fn new(exact: &Arc<Exact>, space: &Discretization) -> Self {
        let (rule, mesh) = (triangle_degree_8(), &space.mesh);
        let points = mesh.points_of(&mesh.cells(), &rule.points);
        Self { rule, fields: exact.interior.bind(&points) }
    }

    /// (𝒜ε(u - u^h), ε(u - u^h))^{1/2} at t.
    fn distance(
        &mut self,
        space: &Discretization,
        elasticity: &TensorField,
        u: &[f64],
        t: f64,
    ) -> f64 {
        let values = self.fields.values_at(t, 0.0);
        let count = self.rule.weights.len();
        let mut sum = 0.0;
        let shapes = StrainShapes::new(space.element, 2);
        for c in 0..space.mesh.cell_count() {
            let strains: Vec<[f64; 3]> = space.points_of(c).map(|at| at.strain(u)).collect();
            let tensor = elasticity.on(space.region(c));
            for (q, weight) in self.rule.weights.iter().enumerate() {
                let at = count * c + q;
                let [xx, xy, yy] = [2, 3, 4].map(|output| values[output][at]);
                let exact = [xx, yy, std::f64::consts::SQRT_2 * xy];
                let computed = shapes.tensor(&self.rule.points[q], &strains);
                let off: [f64; 3] = std::array::from_fn(|i| exact[i] - computed[i]);
                sum += weight
                    * space.geometry.measure[c]
                    * algebra::tensor::contract(&tensor.apply(&off), &off);
            }
        }
        sum.max(0.0).sqrt()
    }
}

/// The largest eigenvalue of 𝒜⁻¹𝒞 on S² in all regions, by size.
fn quotient(tensor: &TensorField, elastic: &TensorField) -> f64 {
    let count = tensor.regions().len().max(elastic.regions().len());
    let dense = |tensor: &FourthOrder| Matrix3::from(tensor.matrix::<3>());
    // That of L⁻¹𝒞L⁻ᵀ with 𝒜 = LLᵀ.
    let on_region = |region: usize| {
        let inverse = dense(elastic.on(region)).cholesky()?.l().try_inverse()?;
        let both = inverse * dense(tensor.on(region)) * inverse.transpose();
        Some(both.symmetric_eigenvalues().amax())
    };
    (0..count).filter_map(on_region).fold(0.0, larger)
}
