//! How perturbations of the load grow: two discrete solutions with loads f and f + δf satisfy
//!
//! ```text
//! m0 ‖u_n - ũ_n‖ ≤ ‖δf_n‖_* + Σ_p ω_p Σ'_j w_nj κ_p(n, j) ‖u_j - ũ_j‖
//! ```
//!
//! by the argument of (3.19)-(3.21) with both inequalities discrete: the same constants, no
//! truncation, and e_0 > 0 allowed. ‖·‖_* is dual to ‖·‖_X; for a body ‖v‖_V = ‖ε(v)‖_ℋ.

use super::GronwallError;
use super::estimate::{Effectivity, Estimate, Judged};
use super::in_time::InTime;
use algebra::linalg::{largest, signed_unit};
use serde::Serialize;
use vhi::history::TimeGrid;

/// How δf depends on time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LoadShape {
    /// δ sin(2πt/T + 1) f(t).
    Smooth,
    /// At each t_n a random vector of dual norm δ max_m ‖f_m‖_*.
    Random,
}

impl LoadShape {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Random => "random",
        }
    }
}

/// Relative sizes δ of the perturbations. The difference stays far above the floor, and the largest
/// changes contact and yielding states.
pub(crate) const SIZES: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// What one perturbation did.
#[derive(Serialize)]
pub struct Perturbation {
    pub shape: LoadShape,
    /// δ.
    pub size: f64,
    /// max_n ‖δf_n‖_*.
    pub load: f64,
    /// N.
    pub steps: usize,
    /// max_n ‖u_n - ũ_n‖.
    pub difference: f64,
    /// m0 max_n ‖u_n - ũ_n‖/max_n ‖δf_n‖_*: 1 at most without history.
    pub growth: f64,
    /// The largest values of two envelopes.
    pub weighted: f64,
    pub primed: f64,
    /// The least ratio of the weighted envelope to the measured difference over n ≥ 1.
    pub least_effectivity: Option<f64>,
    /// ‖u_n - ũ_n‖ and what bounds it.
    #[serde(skip)]
    pub judged: Judged,
}

impl Perturbation {
    fn new((shape, size): (LoadShape, f64), estimate: Estimate) -> Result<Self, GronwallError> {
        let judged = Judged::new(estimate)?;
        let (estimate, envelopes) = (&judged.estimate, &judged.envelopes);
        let (load, difference) = (largest(&estimate.source), largest(&estimate.error));
        Ok(Self {
            shape,
            size,
            load,
            steps: estimate.grid.steps(),
            difference,
            growth: estimate.m0 * difference / load,
            weighted: largest(&envelopes.weighted),
            primed: largest(&envelopes.primed),
            least_effectivity: Effectivity::new(&envelopes.weighted, estimate).least,
            judged,
        })
    }
}

/// Perturbs the load of a scene in every shape and size and measures the difference of the solutions.
///
/// # Errors
/// A load or a run fails.
pub(crate) fn perturbations(
    scene: &dyn InTime,
    steps: u32,
) -> Result<Vec<Perturbation>, GronwallError> {
    let grid = scene.grid(steps);
    let loads = scene.loads(&grid)?;
    let size = largest(&scene.dual_norms(&loads)?);
    let (undisturbed, floor) = scene.solutions(&grid, &loads)?;
    let blank = scene.blank(&grid);
    let mut found = Vec::new();
    for shape in [LoadShape::Smooth, LoadShape::Random] {
        let unit = directions(scene, shape, &grid, &loads, size)?;
        for size in SIZES {
            let changes: Vec<Vec<f64>> =
                unit.iter().map(|v| v.iter().map(|x| size * x).collect()).collect();
            let changed: Vec<Vec<f64>> = loads
                .iter()
                .zip(&changes)
                .map(|(f, d)| f.iter().zip(d).map(|(f, d)| f + d).collect())
                .collect();
            let (disturbed, other) = scene.solutions(&grid, &changed)?;
            let pairs = undisturbed.iter().zip(&disturbed);
            let source = scene.dual_norms(&changes)?;
            let estimate = Estimate {
                error: pairs.map(|(u, v)| scene.distance(u, v)).collect(),
                weighted_source: source.clone(),
                source,
                floor: floor + other,
                ..blank.clone()
            };
            found.push(Perturbation::new((shape, size), estimate)?);
        }
    }
    Ok(found)
}

/// δf for δ = 1.
fn directions(
    scene: &dyn InTime,
    shape: LoadShape,
    grid: &TimeGrid,
    loads: &[Vec<f64>],
    largest: f64,
) -> Result<Vec<Vec<f64>>, GronwallError> {
    match shape {
        LoadShape::Smooth => {
            let horizon = grid.time(grid.steps());
            let one = |(load, t): (&Vec<f64>, &f64)| {
                let factor = (std::f64::consts::TAU * t / horizon + 1.0).sin();
                load.iter().map(|f| factor * f).collect()
            };
            Ok(loads.iter().zip(grid.times()).map(one).collect())
        }
        LoadShape::Random => {
            let mut state = 1;
            let mut noise: Vec<Vec<f64>> = loads
                .iter()
                .map(|load| load.iter().map(|_| signed_unit(&mut state)).collect())
                .collect();
            let norms = scene.dual_norms(&noise)?;
            for (vector, norm) in noise.iter_mut().zip(norms) {
                vector.iter_mut().for_each(|x| *x *= largest / norm);
            }
            Ok(noise)
        }
    }
}
