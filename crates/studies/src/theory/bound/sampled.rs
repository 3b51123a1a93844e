//! The constants of a scene, and the declared ones against samples: (2.5b), (2.7b), (2.8b), (2.8c), L_κ and the Lipschitz
//! constant of S on random states of a small mesh. A sample can refute a constant, not prove it.

use super::super::norms::{DualNorm, remembered, stress_norm};
use super::BoundError;
use Obtained::{Computed, Declared, Extrapolated, Proved};
use algebra::in_dimension;
use algebra::linalg::{FactorError, larger, signed_unit};
use algebra::tensor::contract;
use fem::contact::{
    Discretization, MemoryTerm, TraceMass, TracePart, strain_norm, stress_force, trace_constants,
};
use files::digits;
use judge::claim::{Claim, Place, Statement};
use nalgebra::DVector;
use scene::setup::{
    AbstractConstants, Constants, Setup, TraceConstant, trace_constant, with_trace_constants,
};
use serde::Serialize;
use vhi::finite::FiniteModel;
use vhi::history::{Accumulated, Memory, TimeGrid, Trapezoid};
use vhi::law::{AnyProjection, Potential, Projection, TensorField};

/// Rounding of a quotient of sums over a small mesh.
const ROUNDING: f64 = 1e-10;
const SAMPLES: u32 = 200;
/// Pairs of arguments of a law.
const PAIRS: u32 = 20_000;
/// Relative distance of a close pair: within 2 % of its steepest place a smooth law is as steep to 1e-3.
const CLOSE: f64 = 0.02;
/// Least distance (a length): over less, the rounding of pressures of size 1 counts.
const APART: f64 = 1e-5;

/// The worst need of so many samples is no larger than the declared constant.
fn sampled(what: &'static str, declared: f64, needed: f64, samples: u32) -> Claim {
    let statement = Statement { source: what, says: "needed <= declared" };
    let place = Place { at: format!("{samples} samples"), ..Place::default() };
    Claim::at_most(statement, place, [needed, declared], ROUNDING * declared.abs().max(1.0))
}

/// The constants of a scene on samples.
///
/// # Errors
/// A stiffness matrix that cannot be factorized.
pub fn sample(
    setup: &Setup,
    constants: &Constants,
    space: &Discretization,
) -> Result<Vec<Claim>, BoundError> {
    let mut rows = Vec::new();
    if let Some(boundary) = &setup.model.boundary {
        rows.extend(law(&*boundary.potential));
        if boundary.scale.is_some() {
            // α_ν of the scene against the descents of the law at the vertices of Γ3.
            let vertices = &space.trace.points;
            let needed = vertices.iter().map(|point| {
                let x = space.mesh.point(&[point.vertex], &[1.0]);
                law(&boundary.potential_at(x))[1].left
            });
            let (needed, count) = (needed.fold(0.0, larger), vertices.len() as u32 * PAIRS);
            rows.push(sampled(
                "(2.8c): alpha_j with the factor",
                constants.alpha_nu,
                needed,
                count,
            ));
        }
    }
    in_dimension!(space.mesh.dimension, D, S => {
        let fields = RandomStates::<D, S>::new(space);
        fields.map_err(|e| BoundError::Constant(e.into()))?.add(setup, constants, &mut rows);
    });
    Ok(rows)
}

/// (2.8b) and (2.8c) of a law, pointwise, which gives them on Γ3 by integration. The law is sampled
/// at, between and beyond its points, at all scales; every other pair is close, so that a smooth law shows
/// its slopes.
pub fn law(potential: &dyn Potential) -> [Claim; 2] {
    let mut seed = 41;
    let mut place = || {
        let scale = 10f64.powf(2.0 * signed_unit(&mut seed) - 1.0);
        let offset = potential.jumps().first().copied().unwrap_or(0.0);
        let whole = signed_unit(&mut seed) * scale;
        if whole > 0.5 * scale { offset } else { whole }
    };
    let (c0, c1) = potential.growth();
    let (mut growth, mut descent) = (0f64, 0f64);
    for pair in 0..PAIRS {
        let (r, mut s) = (place(), place());
        let close = r * (1.0 + CLOSE);
        if pair % 2 == 1 && (close - r).abs() > APART {
            s = close;
        }
        let ends = |r: f64| <[f64; 2]>::from(potential.subdifferential(r));
        for xi in ends(r) {
            growth = larger(growth, (xi.abs() - c1 * r.abs()).max(0.0));
            for eta in ends(s) {
                if r != s {
                    descent = larger(descent, -(xi - eta) / (r - s));
                }
            }
        }
    }
    [
        sampled("(2.8b): |dj_nu(r)| - c1 |r| <= c0", c0, growth, PAIRS),
        sampled("(2.8c): alpha_j", potential.alpha(), descent, PAIRS),
    ]
}

fn lipschitz_kappa(limit: &dyn vhi::law::YieldLimit, declared: f64, most: f64) -> Claim {
    let mut seed = 43;
    let mut place = || most * 10f64.powf(2.0 * signed_unit(&mut seed) - 2.0);
    let mut needed = 0f64;
    for _ in 0..10 * SAMPLES {
        let (r, s) = (place(), place());
        if r != s {
            needed = larger(needed, (limit.value(r) - limit.value(s)).abs() / (r - s).abs());
        }
    }
    sampled("L_kappa", declared, needed, 10 * SAMPLES)
}

/// Random states on a mesh in dimension D, with strains of S numbers (Mandel) and Riesz representatives
/// in V^h.
pub(crate) struct RandomStates<'a, const D: usize, const S: usize> {
    space: &'a Discretization,
    dual: DualNorm<'a>,
    seed: u64,
}

/// A tensor per strain point.
type Tensors<const S: usize> = Vec<[f64; S]>;

impl<'a, const D: usize, const S: usize> RandomStates<'a, D, S> {
    /// On a mesh of dimension D.
    ///
    /// # Errors
    /// The factorization of the strain products.
    pub(crate) fn new(space: &'a Discretization) -> Result<Self, FactorError> {
        Ok(Self { space, dual: DualNorm::new(space)?, seed: 47 })
    }

    fn unit(&mut self) -> f64 {
        signed_unit(&mut self.seed)
    }

    /// A nodal vector with strains of size 10^[-2, 1].
    fn displacement(&mut self) -> Vec<f64> {
        let mut u = vec![0.0; self.space.nodes.len()];
        for value in &mut u[..self.space.dofs()] {
            *value = signed_unit(&mut self.seed);
        }
        let size = 10f64.powf(1.5 * self.unit() - 0.5) / strain_norm(self.space, &u);
        u.iter_mut().for_each(|value| *value *= size);
        u
    }

    fn strains(&self, u: &[f64]) -> Tensors<S> {
        self.space.points().map(|at| at.strain(u)).collect()
    }

    fn product(&self, a: &Tensors<S>, b: &Tensors<S>) -> f64 {
        let pairs = a.iter().zip(b).zip(self.space.points());
        pairs.map(|((a, b), at)| at.weight * contract(a, b)).sum()
    }

    fn size(&self, a: &Tensors<S>) -> f64 {
        self.product(a, a).sqrt()
    }

    /// sup over v ∈ V^h of (τ, ε(v))/‖v‖, attained at the Riesz representative.
    fn dual_norm(&mut self, tau: &Tensors<S>) -> f64 {
        let space = self.space;
        let mut force = vec![0.0; space.nodes.len()];
        for (at, tensor) in space.points().zip(tau) {
            let stress = tensor.map(|t| t * at.weight);
            stress_force::<D, S>(at.gradients, at.nodes, &stress, &mut force);
        }
        self.dual.of(&force[..space.dofs()])
    }

    fn add(&mut self, setup: &Setup, constants: &Constants, rows: &mut Vec<Claim>) {
        let (model, horizon) = (&setup.model, setup.scene.time.horizon);
        rows.extend(self.elasticity(&model.elasticity, constants));
        rows.extend(self.phi(&model.projection, setup.projection_mu(), constants));
        let limit = model.projection.limit();
        let declared = constants.lipschitz_kappa;
        // Up to the ζ for which it is declared.
        let most = (100.0 * horizon).min(setup.kappa.zeta);
        rows.extend(limit.map(|kappa| lipschitz_kappa(kappa, declared, most)));
        rows.push(self.history(&model.memory, horizon, 1.0 + constants.memory.operator));
    }

    /// m_A and L_A of A = 𝒜 + μ, which is linear.
    fn elasticity(&mut self, elastic: &TensorField, constants: &Constants) -> [Claim; 2] {
        let (mut least, mut most) = (f64::INFINITY, 0f64);
        for _ in 0..SAMPLES {
            let u = self.displacement();
            let strain = self.strains(&u);
            let mu = constants.alpha_phi;
            let stress: Tensors<S> = strain
                .iter()
                .zip(self.space.points())
                .map(|(e, at)| {
                    let s = elastic.on(self.space.region(at.cell)).apply(e);
                    std::array::from_fn(|i| s[i] + mu * e[i])
                })
                .collect();
            let size = self.size(&strain);
            let quotient = self.product(&stress, &strain) / (size * size);
            least = if quotient.is_nan() { f64::NAN } else { least.min(quotient) };
            most = larger(most, self.dual_norm(&stress) / size);
        }
        [
            // Turned round, so that as everywhere the declared number is the larger one.
            sampled("(2.5b): -m_A", -constants.m_a, -least, SAMPLES),
            sampled("L_A", constants.l_a, most, SAMPLES),
        ]
    }

    /// (2.7b) of φ(y, u, v) = (θ - μ P_{M(κ(r))} ε(u), ε(v)), y = (r, θ): its left side is
    /// (τ1 - τ2, ε(v2 - v1)) with τ = θ - μPε(u), largest at the Riesz representative.
    fn phi(&mut self, p: &Option<AnyProjection>, mu: f64, c: &Constants) -> [Claim; 2] {
        let (mut of_u, mut of_y) = (0f64, 0f64);
        for sample in 0..SAMPLES {
            let (u1, mut u2) = (self.displacement(), self.displacement());
            if sample % 2 == 0 {
                // Close states, where the derivative counts.
                u2.iter_mut().zip(&u1).for_each(|(b, a)| *b = a + 1e-2 * *b);
            }
            let (e1, e2) = (self.strains(&u1), self.strains(&u2));
            let (r1, r2) = (1.0 + self.unit(), 1.0 + self.unit());
            let theta = self.displacement();
            let theta = self.strains(&theta);
            let (s11, s12) = (projected(p, mu, &e1, r1), projected(p, mu, &e1, r2));
            let s21 = projected(p, mu, &e2, r1);
            let apart = self.size(&subtract(&e1, &e2));
            of_u = larger(of_u, self.dual_norm(&subtract(&s11, &s21)) / apart);
            of_y = larger(of_y, self.dual_norm(&subtract(&s11, &s12)) / (r1 - r2).abs());
            of_y = larger(of_y, self.dual_norm(&theta) / self.size(&theta));
        }
        [
            sampled("(2.7b): alpha_phi, same y", c.alpha_phi, of_u, SAMPLES),
            sampled("(2.7b): beta_phi, same u", c.beta_phi, of_y, SAMPLES),
        ]
    }

    /// ‖S_n u1 - S_n u2‖_Y ≤ L Σ' k ‖u1_j - u2_j‖ by the history sums of the solver.
    fn history(&mut self, memory: &[MemoryTerm], horizon: f64, declared: f64) -> Claim {
        let mut needed = 0f64;
        let samples = 40;
        for sample in 0..samples {
            let grid = TimeGrid::random(horizon, 6, u64::from(sample));
            needed = larger(needed, self.history_ratio(memory, &grid, sample % 2 == 0));
        }
        sampled("Lipschitz constant of S", declared, needed, samples)
    }

    fn history_ratio(&mut self, memory: &[MemoryTerm], grid: &TimeGrid, still: bool) -> f64 {
        let length = self.space.nodes.len();
        let mut zeta = [Accumulated::default(), Accumulated::default()];
        let each = memory.iter().map(|term| Memory::new(&*term.kernel, &Trapezoid, grid, length));
        let mut past: Vec<Memory> = each.collect();
        let mut distance = Accumulated::default();
        let mut needed = 0f64;
        let (fixed, direction) = (self.displacement(), self.displacement());
        for n in 0..=grid.steps() {
            // The same pair at all times adds up without cancelling, random ones do not.
            let (u, d) = if still {
                (fixed.clone(), direction.clone())
            } else {
                (self.displacement(), self.displacement())
            };
            let other: Vec<f64> = u.iter().zip(&d).map(|(u, d)| u + d).collect();
            zeta[0].commit(grid, strain_norm(self.space, &u));
            zeta[1].commit(grid, strain_norm(self.space, &other));
            distance.commit(grid, strain_norm(self.space, &d));
            let sums = remembered(memory, &mut past, &Trapezoid, (grid, n), &d);
            if n > 0 {
                let value = |sum: &Accumulated| sum.value(&Trapezoid, grid);
                let left = (value(&zeta[0]) - value(&zeta[1])).abs()
                    + stress_norm(self.space, memory, &sums);
                needed = larger(needed, left / value(&distance));
            }
        }
        needed
    }
}

/// μ P_{M(κ(r))} ε at the strain points: μ ε minus the projection stress μ(ε - Pε).
fn projected<const S: usize>(
    p: &Option<AnyProjection>,
    mu: f64,
    strain: &Tensors<S>,
    r: f64,
) -> Tensors<S> {
    let kappa = p.limit().map_or(f64::INFINITY, |limit| limit.value(r));
    let tensor = |e: &[f64; S]| {
        let rest = p.stress(e, kappa).unwrap_or([0.0; S]);
        std::array::from_fn(|i| mu * e[i] - rest[i])
    };
    strain.iter().map(tensor).collect()
}

fn subtract<const S: usize>(a: &Tensors<S>, b: &Tensors<S>) -> Tensors<S> {
    a.iter().zip(b).map(|(a, b)| std::array::from_fn(|i| a[i] - b[i])).collect()
}

/// Pairs of random states in ℝ^m, with components that are at most so large, as in the samples of slopes.
const FINITE_SAMPLES: u32 = 2000;
const FINITE_REACH: f64 = 10.0;

/// Constants against random pairs of states.
pub(super) fn finite(model: &FiniteModel, c: &AbstractConstants) -> Vec<Claim> {
    let m = model.dimension();
    let mut seed = 7;
    let mut draw = || DVector::from_fn(m, |_, _| FINITE_REACH * signed_unit(&mut seed));
    let gram = model.inner_product.clone().cholesky();
    let dual = |f: &DVector<f64>| {
        gram.as_ref().map_or(f64::NAN, |gram| f.dot(&gram.solve(f)).max(0.0).sqrt())
    };
    let (mut monotone, mut lipschitz, mut by_state, mut by_history) = (f64::MIN, 0f64, 0f64, 0f64);
    // A NaN must not vanish in a maximum.
    for _ in 0..FINITE_SAMPLES {
        let (u, v, y, z) = (draw(), draw(), draw(), draw());
        let (off, force) = (&u - &v, model.operator(&u) - model.operator(&v));
        let size = model.norm(&off);
        monotone = larger(monotone, -force.dot(&off) / (size * size));
        lipschitz = larger(lipschitz, dual(&force) / size);
        let moved = model.force_of(&y, &u) - model.force_of(&y, &v);
        by_state = larger(by_state, dual(&moved) / size);
        let moved = model.force_of(&y, &u) - model.force_of(&z, &u);
        by_history = larger(by_history, dual(&moved) / dual(&(&y - &z)));
    }
    vec![
        sampled("(2.5b): -m_A", -c.m_a, monotone, FINITE_SAMPLES),
        sampled("L_A", c.l_a, lipschitz, FINITE_SAMPLES),
        sampled("(2.7b): alpha_phi, same y", c.alpha_phi, by_state, FINITE_SAMPLES),
        sampled("(2.7b): beta_phi, same u", c.beta_phi, by_history, FINITE_SAMPLES),
    ]
}

// The constants of a scene as a table: name, value, how it was obtained, what it is; and those of one mesh.

/// How a number was obtained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Obtained {
    /// By an argument on paper.
    Proved,
    /// As a number: of one mesh to rounding, or as the largest of many samples.
    Computed,
    /// As the limit of numbers of several meshes.
    Extrapolated,
    /// By the scene or the law, and checked by samples.
    Declared,
}

/// A constant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Constant {
    /// Its symbol.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// How far off it may be; none if it is exact to rounding or a bound.
    pub uncertainty: Option<f64>,
    /// How it was obtained.
    pub how: Obtained,
    /// Whether the true constant is certainly on the safe side of it: an upper bound, or for m_A, m0 a
    /// lower one.
    pub safe: bool,
    /// What it is, or the argument.
    pub note: String,
}

impl Obtained {
    /// In a table.
    pub fn words(self) -> &'static str {
        match self {
            Proved => "proved",
            Computed => "computed",
            Extrapolated => "limit of meshes",
            Declared => "declared, checked by samples",
        }
    }
}

/// Constants in the order of a table.
#[derive(Default)]
pub(super) struct Rows(pub Vec<Constant>);

impl Rows {
    /// Adds a constant that is safe where it is proved or declared: what is computed of one mesh or of samples, and limits of
    /// those, may lie on either side.
    fn add(
        &mut self,
        name: impl Into<String>,
        value: f64,
        how: Obtained,
        note: impl Into<String>,
    ) -> &mut Constant {
        let safe = matches!(how, Proved | Declared);
        let (at, name, note) = (self.0.len(), name.into(), note.into());
        self.0.push(Constant { name, value, uncertainty: None, how, safe, note });
        &mut self.0[at]
    }
}

/// A trace constant, and what it is on a mesh.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OnMesh {
    /// None where it is that of a tensor that varies: meshes for constants do not follow regions.
    pub limit: Option<TraceConstant>,
    /// By the consistent mass, and by the vertex rule.
    pub values: [f64; 2],
}

/// The trace constants of a contact scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TraceConstants {
    /// The mesh.
    pub n: u32,
    /// sup ‖v_ν‖²/‖ε(v)‖².
    pub strain: OnMesh,
    /// sup ‖v_ν‖²/(𝒜ε(v), ε(v)).
    energy: OnMesh,
    /// sup ‖v_τ‖²/‖ε(v)‖², where there is friction.
    tangential: Option<OnMesh>,
}

impl TraceConstants {
    /// Those of a scene and a mesh of it; none without contact sides.
    ///
    /// # Errors
    /// A stiffness matrix that cannot be factorized.
    pub(super) fn new(setup: &Setup, space: &Discretization) -> Result<Option<Self>, BoundError> {
        let domain = &setup.body.domain;
        if domain.contact.is_empty() {
            return Ok(None);
        }
        let of = |tensor: &TensorField, part| -> Result<OnMesh, BoundError> {
            let squares = [TraceMass::Consistent, TraceMass::Lumped].map(|mass| (part, mass));
            let values = trace_constants(space, tensor, squares)?.map(|found| found.value);
            let limit = tensor.is_uniform().then(|| trace_constant(domain, tensor, part));
            Ok(OnMesh { limit: limit.transpose()?, values })
        };
        let strain = TensorField::identity();
        let tangential = setup.model.friction.as_ref().map(|_| of(&strain, TracePart::Tangential));
        Ok(Some(Self {
            n: space.mesh.n,
            strain: of(&strain, TracePart::Normal)?,
            energy: of(&setup.model.elasticity, TracePart::Normal)?,
            tangential: tangential.transpose()?,
        }))
    }

    /// The constants that judge the discrete problem on the mesh: c_j² is the largest of what it may be and the values of
    /// both masses.
    pub(super) fn on_mesh(&self, setup: &Setup) -> Constants {
        let largest = |of: &OnMesh| {
            let most = of.limit.as_ref().map_or(0.0, |limit| limit.range()[1]);
            TraceConstant::exactly(of.values.into_iter().fold(most, f64::max))
        };
        let tangential = self.tangential.as_ref().map_or(TraceConstant::ZERO, largest);
        with_trace_constants(setup, &largest(&self.strain), &tangential)
    }

    fn add_to(&self, rows: &mut Rows, c: &Constants) {
        let korn = "sup |v_tau|^2/|eps(v)|^2: Korn's inequality is in it";
        let tangential = self.tangential.as_ref().map(|of| ("c_tau^2", of, korn));
        let normal = [
            ("c_j^2", &self.strain, "sup |v_nu|^2/|eps(v)|^2"),
            ("energy constant", &self.energy, "sup |v_nu|^2/(A eps(v), eps(v))"),
        ];
        for (symbol, of, meaning) in normal.into_iter().chain(tangential) {
            let [consistent, lumped] = of.values;
            let name = format!("{symbol}, n = {}", self.n);
            rows.add(
                format!("{name}, consistent mass"),
                consistent,
                Computed,
                "not above the limit",
            );
            rows.add(format!("{name}, vertex rule"), lumped, Computed, "no side is sure");
            let Some(limit) = &of.limit else { continue };
            let note = format!("{meaning}, {}", limit.how());
            let row = rows.add(format!("{symbol}, limit"), limit.value, Extrapolated, note);
            row.uncertainty = Some(limit.uncertainty);
        }
        if let Some(bound) = c.c_j_squared_bound {
            rows.add("c_j^2, bound", bound, Proved, "distance of Gamma3 from the clamped side");
        }
        if let Some(energy) = &self.energy.limit {
            let asked = digits(c.m_elastic / c.c_j_squared, 7);
            let note = format!(
                "1/energy constant: steeper laws lose uniqueness; (2.9) asks alpha_j < {asked}"
            );
            let row = rows.add("alpha_j lost, k -> 0", 1.0 / energy.value, Extrapolated, note);
            row.uncertainty = Some(energy.uncertainty / (energy.value * energy.value));
        }
    }
}

/// `c` are the constants of the problem, `m0_on_mesh` that of the discrete one.
pub(super) fn table(
    setup: &Setup,
    c: &Constants,
    m0_on_mesh: f64,
    traces: Option<&TraceConstants>,
) -> Vec<Constant> {
    let potential = setup.model.boundary.as_ref().map(|boundary| &*boundary.potential);
    let (c0, c1) = potential.map_or((0.0, 0.0), Potential::growth);
    let alpha = potential.map_or(0.0, Potential::alpha);
    // A law with a factor c(x): (2.8b) and (2.8c) hold on all of Γ3 with the largest c.
    let law = setup.body.contact.as_ref().and_then(|contact| contact.law.as_ref());
    let largest = law.and_then(|law| law.scale).map_or(1.0, |scale| scale.largest);
    let mut rows = Rows::default();
    let note = "smallest eigenvalue of the elasticity tensor (of all regions) + mu";
    rows.add("m_A", c.m_a, Proved, note);
    let note = "largest eigenvalue of the elasticity tensor (of all regions) + mu";
    rows.add("L_A", c.l_a, Proved, note);
    let limits = "mu + mu_f L_p c_j c_tau, with the limits";
    match c.coulomb {
        None => rows.add("alpha_phi", c.alpha_phi, Proved, "mu: the projection is nonexpansive"),
        Some(_) => rows.add("alpha_phi", c.alpha_phi_as_printed(), Extrapolated, limits),
    };
    let note = "max(mu L_kappa sqrt|Omega|, 1), for |r| + |theta| on Y";
    rows.add("beta_phi", c.beta_phi, Proved, note);
    rows.add("c_phi", 0.0, Proved, "(4.1): phi is linear in its last argument");
    rows.add("sqrt|Omega|", c.root_area, Proved, "");
    rows.add("L_kappa", c.lipschitz_kappa, Proved, setup.kappa.how());
    let note = "|dj_nu(r)| <= c0 + c1 |r|; in (2.8b) it counts c0 sqrt|Gamma3|";
    rows.add("c0", largest * c0, Declared, note);
    let note = "steepest slope of the law at infinity; the same in (2.8b)";
    rows.add("c1", largest * c1, Declared, note);
    let note = "steepest descent of the law (2.8c), with the largest factor on Gamma3";
    rows.add("alpha_j", largest * alpha, Declared, note);
    if setup.model.friction.is_some() {
        let note = "steepest descent of the friction bound over the slip";
        rows.add("alpha_tau", c.alpha_tau, Declared, note);
    }
    if let Some(friction) = &c.coulomb {
        rows.add("mu_f", friction.coefficient, Declared, "S = mu_f p(u_nu)");
        rows.add("L_p", friction.rise, Declared, "steepest rise of p");
    }
    traces.inspect(|traces| traces.add_to(&mut rows, c));
    // m0 of (2.9).
    let other = c.alpha_tau > 0.0 || c.coulomb.is_some();
    let monotone = c.alpha_nu == 0.0 && !other;
    let note = match setup.model.friction {
        None => "m_A - alpha_phi - alpha_j c_j^2 (2.9)",
        Some(_) if c.coulomb.is_some() => "m_A - mu - A c_j^2 - B c_tau^2 (docs/CONTACT-LAWS.md)",
        Some(_) => "m_A - alpha_phi - alpha_j c_j^2 - alpha_tau c_tau^2",
    };
    let off = c.m0_range.map(|end| (end - c.m0).abs()).into_iter().reduce(f64::max);
    let m0 = rows.add("m0", c.m0, if monotone { Proved } else { Extrapolated }, note);
    m0.uncertainty = off.filter(|_| !monotone);
    if let Some(bound) = c.c_j_squared_bound.filter(|_| c.alpha_nu > 0.0 && !other) {
        let value = c.m_elastic - c.alpha_nu * bound;
        rows.add("m0, proved", value, Proved, "with the proved bound of c_j^2");
    }
    if let Some(TraceConstants { n, .. }) = traces {
        let note = "the same with the largest c_j^2 and c_tau^2 of this table, for the bounds on this mesh";
        rows.add(format!("m0, n = {n}"), m0_on_mesh, Extrapolated, note);
    }
    let [operator, entries] = [c.memory.operator, c.memory.entries];
    rows.add("|B|", operator, Proved, "largest operator norm on S^d on [0, T]");
    rows.add("|B|_Q", entries, Proved, "the paper's norm: sum of |entries|");
    rows.add("|B(0)|", c.memory.at_zero, Proved, "operator norm on S^d");
    let least = c.memory.spectrum_at_zero.0;
    rows.add("lambda_min B(0)", least, Proved, "smallest eigenvalue on S^d");
    rows.add("|R||q|", 1.0 + operator, Proved, "Lipschitz constant of S: 1 + |B|");
    rows.add("|R||q|_Q", 1.0 + entries, Proved, "the same with the paper's norm");
    rows.0
}

/// The constants of an abstract problem with how each was obtained.
pub fn table_of_finite(c: &AbstractConstants, model: &FiniteModel) -> Vec<Constant> {
    // Eigenvalues are exact to rounding; norms and slopes are bounds where they hold for all arguments.
    let everywhere = c.slopes_up_to == f64::INFINITY;
    let slopes = match everywhere {
        true => "; slopes for all arguments".into(),
        false => format!("; slopes for |r|, |y| <= {}", c.slopes_up_to),
    };
    let (bent, forced) = (!model.nonlinear.is_empty(), !model.force.is_empty());
    let mut rows = Rows::default();
    for (name, value, by_slopes, note) in [
        ("m_A", c.m_a, bent, "smallest eigenvalue of the symmetric part in X"),
        ("L_A", c.l_a, bent, "norm X -> X*"),
        ("alpha_phi", c.alpha_phi, forced, "slopes of N in u"),
        ("beta_phi", c.beta_phi, forced, "slopes of N in y"),
        ("alpha_j", c.alpha_j, false, "steepest descent of the laws (2.8c)"),
        ("c_j^2", c.c_j_squared, false, "largest eigenvalue of sum w_i a_i a_i^T in X"),
        ("m0", c.m0, bent || forced, "m_A - alpha_phi - alpha_j c_j^2 (2.9)"),
        ("|R|", c.r_norm, false, "norm on X*"),
    ] {
        let (how, by) = if by_slopes { (Proved, &*slopes) } else { (Computed, "") };
        rows.add(name, value, how, format!("{note}{by}")).safe = !by_slopes || everywhere;
    }
    rows.add("|q|", c.q_norm, Proved, "largest norm X -> X* over 0 <= s <= t <= T");
    rows.add("|q(t,t)|", c.q_norm_now, Proved, "the same over s = t");
    rows.0
}
