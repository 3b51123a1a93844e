//! Constants of the contact problem (THEORY: section 3 of the paper's application), each with how
//! it was obtained.

use super::{Setup, SetupError};
use crate::contact::Discretization;
use crate::formula::Point;
use crate::law::Isotropic;
use crate::linalg::{FactorError, dot};
use crate::scene::Side;

/// Constants that the step-size bound and the smallness condition need.
#[derive(Debug, Clone, PartialEq)]
pub struct Constants {
    /// m_𝒜, smallest eigenvalue of 𝒜 on S^d (a stress).
    pub m_elastic: f64,
    /// m_A = m_𝒜 + μ.
    pub m_a: f64,
    /// L_A = largest eigenvalue of 𝒜, plus μ.
    pub l_a: f64,
    /// α_φ = μ.
    pub alpha_phi: f64,
    /// α_ν of (2.8c) (a stiffness).
    pub alpha_nu: f64,
    /// c_j² (a length): extrapolated from meshes, no bound.
    pub c_j_squared: f64,
    /// A proved upper bound of c_j²: the distance of Γ3 from a clamped parallel side.
    pub c_j_squared_bound: Option<f64>,
    /// m0 = m_𝒜 - α_ν c_j² with the extrapolated c_j².
    pub m0: f64,
    /// β_φ = max(μ L_κ √|Ω|, 1).
    pub beta_phi: f64,
    /// ‖ℬ‖ = max over [0, T] of the operator norm of ℬ(t) on S^d.
    pub memory_norm: f64,
    /// The step-size bound (3.4), k < m0/(β_φ (1 + ‖ℬ‖)).
    pub step_bound: f64,
    /// The sharpened bound 2 m0/(μ L_κ √|Ω| + ‖ℬ(0)‖).
    pub sharpened_step_bound: f64,
}

/// Meshes on which c_j² is computed before extrapolation.
const LEVELS: [u32; 3] = [8, 16, 32];
/// Samples of the kernel on [0, T].
const KERNEL_SAMPLES: u32 = 512;

/// The constants of a scene.
///
/// # Errors
/// A mesh whose stiffness matrix cannot be factorized.
pub fn constants(setup: &Setup) -> Result<Constants, SetupError> {
    let scene = &setup.scene;
    let material = &setup.body.material;
    let elastic = Isotropic { lambda: material.lambda, mu: material.mu };
    let (m_elastic, largest) = elastic.eigenvalues(scene.dimension);
    let mu = setup.projection_mu();
    let law = setup.body.contact.as_ref().and_then(|contact| contact.law.as_ref());
    let alpha_nu = law.map_or(0.0, crate::scene::Law::alpha);
    let c_j_squared =
        if setup.body.domain.contact.is_empty() { 0.0 } else { trace_constant(setup)? };
    let m0 = m_elastic - alpha_nu * c_j_squared;
    let lipschitz = material.projection.as_ref().map_or(0.0, |projection| projection.lipschitz);
    let area: f64 = setup.body.domain.size.iter().product();
    let yielding = mu * lipschitz * area.sqrt();
    let (memory_norm, memory_at_zero) = memory_norms(setup);
    let beta_phi = yielding.max(1.0);
    Ok(Constants {
        m_elastic,
        m_a: m_elastic + mu,
        l_a: largest + mu,
        alpha_phi: mu,
        alpha_nu,
        c_j_squared,
        c_j_squared_bound: proved_bound(setup),
        m0,
        beta_phi,
        memory_norm,
        step_bound: m0 / (beta_phi * (1.0 + memory_norm)),
        sharpened_step_bound: 2.0 * m0 / (yielding + memory_at_zero),
    })
}

/// max_t ‖ℬ(t)‖ and ‖ℬ(0)‖, operator norms on S^d.
fn memory_norms(setup: &Setup) -> (f64, f64) {
    let scene = &setup.scene;
    let Some(memory) = &setup.body.material.memory else { return (0.0, 0.0) };
    let tensor = Isotropic { lambda: memory.lambda, mu: memory.mu };
    let (low, high) = tensor.eigenvalues(scene.dimension);
    let size = low.abs().max(high.abs());
    let kernel =
        |t: f64| scene.formulas.evaluate(memory.kernel, &Point { t, ..Point::default() }).abs();
    let step = scene.time.horizon / f64::from(KERNEL_SAMPLES);
    let largest = (0..=KERNEL_SAMPLES).map(|i| kernel(step * f64::from(i))).fold(0.0, f64::max);
    (size * largest, size * kernel(0.0))
}

/// If Γ3 lies opposite to a clamped parallel side at distance H, then for v = 0 there
/// |v_ν(x, 0)|² ≤ H ∫_0^H |∂_y v_y|² dy, so c_j² ≤ H.
fn proved_bound(setup: &Setup) -> Option<f64> {
    let domain = &setup.body.domain;
    let [side] = domain.contact[..] else { return None };
    let (opposite, distance) = match side {
        Side::Bottom => (Side::Top, domain.size[1]),
        Side::Top => (Side::Bottom, domain.size[1]),
        Side::Left => (Side::Right, domain.size[0]),
        Side::Right => (Side::Left, domain.size[0]),
    };
    domain.clamped.contains(&opposite).then_some(distance)
}

/// c_j² = sup ‖v_ν‖²_{L²(Γ3)}/‖ε(v)‖², extrapolated (Aitken) from nested meshes on which the
/// discrete values grow from below.
///
/// # Errors
/// A mesh whose stiffness matrix cannot be factorized.
pub fn trace_constant(setup: &Setup) -> Result<f64, SetupError> {
    let mut values = Vec::new();
    for n in LEVELS {
        let space = setup.space(n)?;
        let value = largest_trace_ratio(&space).map_err(|source| SetupError::Mesh { n, source })?;
        values.push(value);
    }
    let (first, second) = (values[1] - values[0], values[2] - values[1]);
    let shrinks = second.abs() < first.abs() && first != 0.0;
    Ok(if shrinks { values[2] + second * second / (first - second) } else { values[2] })
}

/// Power iteration for K v = θ⁻¹ M v with the strain product K and the consistent trace mass M.
fn largest_trace_ratio(space: &Discretization) -> Result<f64, FactorError> {
    let identity = Isotropic { lambda: 0.0, mu: 0.5 };
    let stiffness = space.stiffness(&identity);
    let (mut factor, mut workspace) = (space.analysis.factor(), space.analysis.workspace(1));
    space.analysis.factorize(&space.pattern, &stiffness, &mut factor, &mut workspace)?;
    let mut v = vec![0.0; space.nodes.len()];
    for point in &space.trace.points {
        v[point.component as usize] = point.sign;
    }
    v[space.dofs()..].fill(0.0);
    let mut ratio = 0.0;
    // The gap to the second eigenvalue is large: 1e-12 comes within some 30 rounds.
    for _ in 0..200 {
        let mut mass = trace_mass(space, &v);
        let top = dot(&mass, &v);
        mass.truncate(space.dofs());
        space.analysis.solve(&factor, &mut mass, &mut workspace);
        // x = K⁻¹Mv: the quotient (Mv·x)/(v·Mv) is the generalized Rayleigh quotient at v.
        let next = dot(&trace_mass(space, &v)[..space.dofs()], &mass) / top;
        let scale = mass.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        for (target, value) in v.iter_mut().zip(&mass) {
            *target = value / scale;
        }
        if (next - ratio).abs() <= 1e-13 * next {
            return Ok(next);
        }
        ratio = next;
    }
    Ok(ratio)
}

/// M v over all nodes: ∫_{Γ3} v_ν φ_ν with the consistent mass of linear facets.
fn trace_mass(space: &Discretization, v: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; v.len()];
    let corners = space.trace.stride as f64;
    for f in 0..space.trace.measure.len() {
        let members = space.trace.facet(f);
        let total: f64 = members.iter().map(|&i| space.trace.normal(i as usize, v)).sum();
        for &i in members {
            let point = space.trace.points[i as usize];
            let own = space.trace.normal(i as usize, v);
            out[point.component as usize] +=
                point.sign * space.trace.measure[f] * (own + total) / (corners * (corners + 1.0));
        }
    }
    out[space.dofs()..].fill(0.0);
    out
}
