//! Source: (2.5b), (2.7b), L_κ and the Lipschitz constant of S, for any pair of states.
//! Goal: the constants that are proved of a scene are not refuted by random states of a small mesh; constants that are too good are.
//! Data: random states; the scenes are those of the tests that ask.

use algebra::in_dimension;
use algebra::linalg::{FactorError, larger, signed_unit};
use algebra::tensor::contract;
use fem::contact::{Discretization, Histories, MemoryTerm, strain_norm, stress_force};
use judge::claim::Claim;
use nalgebra::DVector;
use scene::setup::{AbstractConstants, Constants, Setup};
use studies::theory::bound::sampled::{declared, sampled};
use studies::theory::norms::{DualNorm, stress_norm};
use vhi::finite::FiniteModel;
use vhi::history::{Accumulated, TimeGrid, Trapezoid};
use vhi::law::{AnyProjection, Projection, TensorField};

const SAMPLES: u32 = 200;

/// The constants of a scene on samples.
pub fn sample(setup: &Setup, constants: &Constants, space: &Discretization) -> Vec<Claim> {
    let mut rows = declared(setup, constants, space);
    in_dimension!(space.mesh.dimension, D, S => {
        let fields = RandomStates::<D, S>::new(space);
        fields.expect("the factors of the strain products").add(setup, constants, &mut rows);
    });
    rows
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
struct RandomStates<'a, const D: usize, const S: usize> {
    space: &'a Discretization,
    dual: DualNorm<'a>,
    seed: u64,
}

/// A tensor per strain point.
type Tensors<const S: usize> = Vec<[f64; S]>;

impl<'a, const D: usize, const S: usize> RandomStates<'a, D, S> {
    /// On a mesh of dimension D.
    fn new(space: &'a Discretization) -> Result<Self, FactorError> {
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
        let mut past = Histories::new(memory, &Trapezoid, grid, length);
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
            let (sums, distance) = past.level((grid, n), &d, strain_norm(self.space, &d));
            if n > 0 {
                let value = |sum: &Accumulated| sum.value(&Trapezoid, grid);
                let left = (value(&zeta[0]) - value(&zeta[1])).abs()
                    + stress_norm(self.space, memory, &sums);
                needed = larger(needed, left / distance);
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
pub fn finite(model: &FiniteModel, c: &AbstractConstants) -> Vec<Claim> {
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
