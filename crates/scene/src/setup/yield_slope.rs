//! L_κ: a proved bound of |κ'| for all ζ ≥ 0, or else for the ζ that a run can reach.
//!
//! *A priori bound of ζ.* If 0 ∈ U at all times, test (5.14) with v = 0. The projection stress is monotone and vanishes at 0, and by (2.8c)
//! -j⁰(u_ν; -u_ν) ≥ -α_ν u_ν² - |ξ_0||u_ν| with ξ_0 ∈ ∂j_ν(0); the same holds of friction. With e(t) = ‖ε(u(t))‖,
//!
//! m0 e(t) ≤ M(t) + ∫_0^t ‖ℬ(t - s)‖ e(s) ds,   M = ‖F‖_* + c_j ‖ξ_0‖_{L²(Γ3)}.
//!
//! With E_j a bound of e up to t_j = jh, b_i one of ‖ℬ‖ on [(i-1)h, ih], this is m0 E_j = max M + h Σ_{i≤j} b_i E_{j-i+1}, and
//! ζ ≤ h Σ E_j. ‖F‖_* is computed on a coarse mesh at some times; a factor of 2 is left for that and for the scheme, and
//! every run compares its ζ with the bound.

use formula::{Interval, Variable};

use super::constants::{Constants, Memory, constants};
use super::{MeshData, Result, Setup, SetupError};
use crate::{Face, Hypothesis};
use algebra::linalg::{dot, larger};
use fem::contact::StiffnessInverse;
use files::digits;
use vhi::law::{Potential, TensorField};

/// The bound of |κ'| in the constants of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YieldSlope {
    /// L_κ; 0 without projection.
    pub lipschitz: f64,
    /// It holds for ζ up to this.
    pub zeta: f64,
    pub from: ZetaFrom,
}

/// Where the largest ζ of a [`YieldSlope`] comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ZetaFrom {
    /// The bound holds for all ζ ≥ 0.
    Everywhere,
    /// Twice the ζ of the exact solution.
    Exact,
    /// Twice the a priori bound from the loads.
    Loads,
}

impl YieldSlope {
    /// How the number was obtained.
    pub fn how(&self) -> String {
        let zeta = digits(self.zeta, 5);
        match self.from {
            ZetaFrom::Everywhere if self.lipschitz.is_finite() => {
                "proved: bound of |kappa'| for all zeta >= 0".into()
            }
            ZetaFrom::Everywhere => {
                "kappa is not Lipschitz, or no zeta is known up to which".into()
            }
            ZetaFrom::Exact => format!(
                "proved for zeta <= {zeta}, twice the zeta of the exact solution; a run beyond fails"
            ),
            ZetaFrom::Loads => format!(
                "proved for zeta <= {zeta}, twice an a priori bound from the loads; a run beyond fails"
            ),
        }
    }
}

/// Room for the scheme, and for what a coarse mesh misses of the loads.
const MARGIN: f64 = 2.0;
/// Times at which loads are taken, and the first and last number of intervals h of [0, T].
const TIMES: u32 = 64;
const INTERVALS: [u32; 2] = [256, 4096];
/// Cells of the mesh on which loads are taken, if a coarser one satisfies it.
const MOST_CELLS: f64 = 16_384.0;

/// L_κ of a scene.
///
/// # Errors
/// κ without a bound of |κ'| for all ζ, where no ζ is known that a run can reach.
pub(super) fn yield_slope(setup: &Setup) -> Result<YieldSlope> {
    let projection = setup.body.material.projection.as_ref().filter(|given| given.mu > 0.0);
    let lipschitz = projection.map_or(0.0, |given| given.lipschitz);
    let everywhere = YieldSlope { lipschitz, zeta: f64::INFINITY, from: ZetaFrom::Everywhere };
    let scene = &setup.scene;
    let violates = |hypothesis| scene.violates.contains(&hypothesis);
    let Some(projection) = projection.filter(|given| given.lipschitz.is_infinite()) else {
        return Ok(everywhere);
    };
    if violates(Hypothesis::LipschitzKappa) || violates(Hypothesis::Smallness) {
        return Ok(everywhere);
    }
    let horizon = scene.time.horizon;
    let (zeta, from) = match &setup.exact {
        Some(exact) => (exact.zeta.at(horizon), ZetaFrom::Exact),
        None => (a_priori(setup)?, ZetaFrom::Loads),
    };
    let zeta = MARGIN * zeta;
    let mut graph = scene.formulas.clone();
    let slope = graph.derivative(projection.kappa, Variable::Zeta);
    let over = Interval::new(0.0, zeta);
    let found = graph.largest_modulus(slope, Variable::Zeta, over);
    let message = format!(
        "|kappa'| has no bound for all zeta >= 0, nor for zeta up to {}, which a run can reach",
        digits(zeta, 5)
    );
    let known = zeta.is_finite() && found.bound.is_finite();
    let hint = "hold the slope from some zeta on, as in 0.02 + 0.4*min(zeta, 1)^2";
    scene.refuse_if(!known, "material.projection.kappa", message, hint)?;
    Ok(YieldSlope { lipschitz: found.bound, zeta, from })
}

/// The a priori bound of ζ(T), infinite if 0 ∉ U or m0 ≤ 0.
fn a_priori(setup: &Setup) -> Result<f64> {
    let found = constants(setup)?;
    // Of a coarse mesh: the margin makes up for what it misses of the loads.
    let mut n = if setup.scene.dimension == 3 { 2 } else { 8 };
    while n > 1 && setup.body.domain.cells(n) > MOST_CELLS {
        n /= 2;
    }
    let data = MeshData::new(setup, n, None)?;
    let of_mesh =
        |source: algebra::linalg::FactorError| SetupError::Constant { n, source: source.into() };
    let mut gram =
        StiffnessInverse::passing(&data.space, &TensorField::identity()).map_err(of_mesh)?;
    let horizon = setup.scene.time.horizon;
    let mut largest = 0.0f64;
    for i in 0..=TIMES {
        let t = horizon * f64::from(i) / f64::from(TIMES);
        let load = data.truth.load(t).map_err(|error| SetupError::Reference(error.into()))?;
        let mut riesz = load.to_vec();
        gram.solve(&mut riesz);
        largest = larger(largest, dot(&load, &riesz).max(0.0).sqrt());
    }
    let Some(at_rest) = pressure_at_rest(setup, &data) else { return Ok(f64::INFINITY) };
    largest += at_rest * found.c_j_range[1].sqrt();
    let memory = Memory::every(setup);
    let mut intervals = INTERVALS[0];
    while intervals <= INTERVALS[1] {
        if let Some(zeta) = accumulated(&found, &memory, largest, (horizon, intervals)) {
            return Ok(zeta);
        }
        intervals *= 4;
    }
    Ok(f64::INFINITY)
}

/// ‖ξ_0‖ on Γ3 with the least ξ_0 ∈ ∂j_ν(-s) at the vertices; None if 0 ∉ U at some time.
fn pressure_at_rest(setup: &Setup, data: &MeshData) -> Option<f64> {
    let (mut largest, horizon) = (0.0f64, setup.scene.time.horizon);
    for point in &data.space.trace.points {
        let boundary = setup.model.boundary_on(point.side);
        let Some(boundary) = boundary else { continue };
        let x = data.space.mesh.point(&[point.vertex], &[1.0]);
        let opens = |n| (boundary.gap)(x, horizon * f64::from(n) / f64::from(TIMES)) >= 0.0;
        if !(0..=TIMES).all(opens) {
            return None;
        }
        let (low, high) = boundary.potential_at(x).subdifferential(-(boundary.shift)(x));
        largest = largest.max(low.max(-high).max(0.0));
    }
    let domain = &setup.body.domain;
    let faces = domain.contact.iter().flat_map(|&side| domain.faces(side));
    Some(largest * faces.map(|face: Face| face.measure()).sum::<f64>().sqrt())
}

/// h Σ E_j; None if h is too large for it, or m0 ≤ 0.
fn accumulated(
    found: &Constants,
    memory: &[Memory],
    load: f64,
    (horizon, intervals): (f64, u32),
) -> Option<f64> {
    let h = horizon / f64::from(intervals);
    // ∫ ‖ℬ‖ over the i-th interval.
    let share = |i: u32| -> f64 {
        let [from, to] = [i, i + 1].map(|i| h * f64::from(i));
        let one = |of_power: &Memory| {
            let rest = 1.0 - of_power.power;
            of_power.within(Interval::new(from, to)) * (to.powf(rest) - from.powf(rest)) / rest
        };
        memory.iter().map(one).sum()
    };
    let shares: Vec<f64> = (0..intervals).map(share).collect();
    let m0 = found.m0_range[0];
    let left = m0 - shares[0];
    if left.is_nan() || left <= 0.1 * m0 {
        return None;
    }
    let mut bounds: Vec<f64> = Vec::new();
    for j in 0..intervals as usize {
        let past: f64 = (1..=j).map(|i| shares[i] * bounds[j - i]).sum();
        bounds.push((load + past) / left);
    }
    Some(h * bounds.iter().sum::<f64>())
}
