//! How perturbations of the load grow: two discrete solutions with loads f and f + δf satisfy
//!
//! ```text
//! m0 ‖u_n - ũ_n‖ ≤ ‖δf_n‖_* + μL_κ√|Ω| Σ' w_nj ‖u_j - ũ_j‖ + Σ' w_nj ‖ℬ(t_n - t_j)‖ ‖u_j - ũ_j‖
//! ```
//!
//! by the argument of (3.19)-(3.21) with both inequalities discrete: the same constants, no
//! truncation, and e_0 > 0 allowed. ‖·‖_* is dual to ‖v‖_V = ‖ε(v)‖_ℋ.

use super::GronwallError;
use super::constants::GronwallConstants;
use super::estimate::{Estimate, effectivities, maximum};
use super::{Envelopes, Violation};
use crate::contact::{Discretization, Load, LoadError, march, strain_distance};
use crate::history::TimeGrid;
use crate::law::Isotropic;
use crate::linalg::{Factor, Workspace, dot, signed_unit};
use crate::setup::{MeshData, Setup, TruthLoad};
use crate::vhi::Newton;

/// How δf depends on time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// δ sin(2πt/T + 1) f(t).
    Smooth,
    /// At each t_n a random vector of dual norm δ max_m ‖f_m‖_*.
    Random,
}

impl Shape {
    /// One word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Random => "random",
        }
    }
}

/// Relative sizes δ of the perturbations. The difference stays far above the floor, and the largest
/// changes contact and yielding states.
pub const SIZES: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// What one perturbation did.
#[derive(Debug, Clone)]
pub struct Perturbation {
    pub shape: Shape,
    /// δ.
    pub size: f64,
    /// max_n ‖δf_n‖_*.
    pub load: f64,
    /// ‖u_n - ũ_n‖ and what bounds it.
    pub estimate: Estimate,
    pub envelopes: Envelopes,
    pub violations: Vec<Violation>,
}

impl Perturbation {
    /// m0 max_n ‖u_n - ũ_n‖/max_n ‖δf_n‖_*: 1 at most without history.
    pub fn growth(&self) -> f64 {
        self.estimate.m0 * maximum(&self.estimate.error) / self.load
    }

    /// The least ratio of the weighted envelope to the measured difference over n ≥ 1.
    pub fn least_effectivity(&self) -> Option<f64> {
        effectivities(&self.envelopes.weighted, &self.estimate)
            .into_iter()
            .flatten()
            .reduce(f64::min)
    }
}

/// ‖F‖_* = sup F(v)/‖ε(v)‖ over V^h, by one solve with the strain stiffness.
pub struct DualNorm<'a> {
    space: &'a Discretization,
    factor: Factor,
    workspace: Workspace,
}

impl<'a> DualNorm<'a> {
    /// Factorizes (ε(u), ε(v)).
    ///
    /// # Errors
    /// The factorization's.
    pub fn new(space: &'a Discretization) -> Result<Self, GronwallError> {
        // 2 μ ε with μ = ½ is the identity.
        let stiffness = space.stiffness(&Isotropic { lambda: 0.0, mu: 0.5 });
        let (mut factor, mut workspace) = (space.analysis.factor(), space.analysis.workspace(1));
        space.analysis.factorize(&space.pattern, &stiffness, &mut factor, &mut workspace)?;
        Ok(Self { space, factor, workspace })
    }

    /// ‖F‖_* of a vector over the unknowns.
    pub fn of(&mut self, load: &[f64]) -> f64 {
        let mut riesz = load.to_vec();
        self.space.analysis.solve(&self.factor, &mut riesz, &mut self.workspace);
        dot(load, &riesz).max(0.0).sqrt()
    }
}

/// f_n + δf_n at the times of a grid.
struct Perturbed<'a> {
    grid: &'a TimeGrid,
    loads: &'a [Vec<f64>],
    changes: &'a [Vec<f64>],
}

impl Load for Perturbed<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        let found = self.grid.times().iter().position(|own| *own == t);
        let Some(n) = found else { return Err(LoadError::NoTruth { t }) };
        for (target, (f, change)) in out.iter_mut().zip(self.loads[n].iter().zip(&self.changes[n]))
        {
            *target = f + change;
        }
        Ok(())
    }
}

/// Perturbs the load of a scene in every shape and size and measures the difference of the solutions.
///
/// # Errors
/// Those of loads and runs.
pub fn perturbations(
    setup: &Setup,
    data: &MeshData,
    constants: &GronwallConstants,
    steps: u32,
) -> Result<Vec<Perturbation>, GronwallError> {
    let grid = setup.grid(steps);
    let mut loads = Vec::new();
    for t in grid.times() {
        let mut load = vec![0.0; data.space.dofs()];
        TruthLoad(&*data.truth).assemble(*t, &mut load)?;
        loads.push(load);
    }
    let mut dual = DualNorm::new(&data.space)?;
    let norms: Vec<f64> = loads.iter().map(|load| dual.of(load)).collect();
    let none = vec![vec![0.0; data.space.dofs()]; loads.len()];
    let run = |changes: &[Vec<f64>]| {
        let load = Perturbed { grid: &grid, loads: &loads, changes };
        displacements(setup, data, load, steps)
    };
    let (undisturbed, floor) = run(&none)?;
    let mut found = Vec::new();
    for shape in [Shape::Smooth, Shape::Random] {
        for size in SIZES {
            let changes = changes(shape, size, &grid, &loads, maximum(&norms), &mut dual);
            let (disturbed, other) = run(&changes)?;
            let pairs = undisturbed.iter().zip(&disturbed);
            let source: Vec<f64> = changes.iter().map(|change| dual.of(change)).collect();
            let estimate = Estimate {
                grid: grid.clone(),
                error: pairs.map(|(u, v)| strain_distance(&data.space, u, v)).collect(),
                weighted_source: source.clone(),
                source: source.clone(),
                m0: constants.m0,
                beta: constants.beta,
                parts: constants.parts(setup, &grid),
                floor: floor + other,
            };
            let envelopes =
                estimate.envelopes().map_err(|source| GronwallError::Step { steps, source })?;
            let violations = envelopes.violations(&estimate);
            let load = maximum(&source);
            found.push(Perturbation { shape, size, load, estimate, envelopes, violations });
        }
    }
    Ok(found)
}

fn changes(
    shape: Shape,
    size: f64,
    grid: &TimeGrid,
    loads: &[Vec<f64>],
    largest: f64,
    dual: &mut DualNorm<'_>,
) -> Vec<Vec<f64>> {
    let horizon = grid.time(grid.steps());
    let mut state = 1;
    let one = |(n, load): (usize, &Vec<f64>)| -> Vec<f64> {
        match shape {
            Shape::Smooth => {
                let phase = std::f64::consts::TAU * grid.time(n) / horizon + 1.0;
                load.iter().map(|f| size * phase.sin() * f).collect()
            }
            Shape::Random => {
                let noise: Vec<f64> = load.iter().map(|_| signed_unit(&mut state)).collect();
                let scale = size * largest / dual.of(&noise);
                noise.iter().map(|r| scale * r).collect()
            }
        }
    };
    loads.iter().enumerate().map(one).collect()
}

/// u_0, …, u_N and the floor of the run.
fn displacements(
    setup: &Setup,
    data: &MeshData,
    mut load: Perturbed<'_>,
    steps: u32,
) -> Result<(Vec<Vec<f64>>, f64), GronwallError> {
    let mut found = Vec::new();
    let (model, newton) = (&setup.model, Newton::default());
    let info = march(&data.space, model, load.grid, &mut load, &newton, &mut |view| {
        found.push(view.u.to_vec());
        Ok(())
    })
    .map_err(|source| GronwallError::Case { steps, source })?;
    Ok((found, info.floors.v))
}
