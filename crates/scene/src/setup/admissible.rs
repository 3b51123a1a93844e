//! Checks before a solve, beyond the text of a scene: the exact solution satisfies its conditions, and (2.9) holds.

use super::regularity::contact_claims;
use super::{Setup, SetupError, constants};
use crate::{Face, Hypothesis, SceneError, Side};
use exact::{Exact, Sliding};
use formula::{EvaluationPoint, Program};
use vhi::law::Potential;

/// Samples along an edge, along each direction of a face, and in time.
const ALONG: u32 = 64;
const ON_FACE: u32 = 16;
const TIMES: u32 = 32;
/// Rounding of formulas, relative to the numbers compared.
const ROUNDING: f64 = 1e-9;

/// Checks exact data, (2.9), and that what the scene claims to violate is violated.
///
/// # Errors
/// The first violated condition, at its key in the scene.
pub fn admissible(setup: &Setup) -> Result<(), SetupError> {
    representable(setup)?;
    smallness(setup)?;
    if let Some(exact) = &setup.exact {
        clamped(setup, exact)?;
        let domain = &setup.body.domain;
        for face in domain.contact.iter().flat_map(|&side| domain.faces(side)) {
            contact_state(setup, exact, &face)?;
            friction(setup, exact, &face)?;
        }
    }
    contact_claims(setup)
}

/// Range of |Ω| in which measures of cells on all meshes are doubles, with 1e-7 to spare at either end.
const MEASURES: std::ops::RangeInclusive<f64> = 1e-301..=1e301;
/// Range of moduli whose products with strains in any unit are doubles.
const MODULI: std::ops::RangeInclusive<f64> = 1e-152..=1e152;

/// Checks measures and moduli: lengths within 1e±150 in the plane, 1e±100 in space.
fn representable(setup: &Setup) -> Result<(), SetupError> {
    let (scene, domain) = (&setup.scene, &setup.body.domain);
    let measure = domain.measure();
    if !MEASURES.contains(&measure) {
        let message =
            format!("the measure of the domain is {measure:.1e}, outside 1e-301 to 1e301");
        let hint = "state the scene in another unit of length: lengths within 1e-150 to 1e150 in the plane, 1e-100 to 1e100 in space";
        return Err(scene.error("domain", message, hint).into());
    }
    let (_, largest) = setup.model.elasticity.eigenvalues(scene.dimension);
    if !MODULI.contains(&largest) {
        let message = format!("the stiffest modulus is {largest:.1e}, outside 1e-152 to 1e152");
        let hint = "state the scene in another unit of stress";
        return Err(scene.error("material", message, hint).into());
    }
    Ok(())
}

/// (2.9): α_ν c_j² + α_τ c_τ² < m_𝒜, or with friction that follows the normal law its sharp form.
fn smallness(setup: &Setup) -> Result<(), SetupError> {
    let scene = &setup.scene;
    if setup.body.is_monotone() || scene.violates.contains(&Hypothesis::Smallness) {
        return Ok(());
    }
    let constants = constants(setup)?;
    if constants.m0 > 0.0 {
        return Ok(());
    }
    let (by, key, remedy) = match &constants.coulomb {
        Some(_) => (
            "the smallness condition (2.9) fails: A c_nu^2 + B c_tau^2 =",
            "contact.friction.bound.coefficient",
            "lower the coefficient, flatten the normal law or stiffen the body (A and B are explained in docs/CONTACT-LAWS.md)",
        ),
        None if constants.alpha_tau > 0.0 => (
            "the smallness condition (2.9) fails: alpha_nu c_nu^2 + alpha_tau c_tau^2 =",
            "contact.friction.bound",
            "let the bound fall more slowly with the slip, flatten the falling branch of the normal law or stiffen the body",
        ),
        None => (
            "the smallness condition (2.9) fails: alpha_nu c_j^2 =",
            "contact.law",
            "flatten the falling branch of the law or stiffen the body",
        ),
    };
    let [normal, tangential] = constants.coefficients();
    let mut product = format!("{normal:.4} * {:.4}", constants.c_j_squared);
    if by.contains('+') {
        product += &format!(" + {tangential:.4} * {:.4}", constants.c_tau_squared);
    }
    let message = format!(
        "{by} {product} = {:.4} is not below m_A = {:.4}",
        constants.concave(),
        constants.m_elastic
    );
    let hint = format!("{remedy}; or say violates = [\"2.9\"] in [scene] to run it all the same");
    Err(scene.error(key, message, hint).into())
}

fn side_points(setup: &Setup, side: Side) -> Vec<[f64; 3]> {
    setup.body.domain.points_on(side, samples_along(setup))
}

fn samples_along(setup: &Setup) -> u32 {
    if setup.scene.dimension == 2 { ALONG } else { ON_FACE }
}

/// Calls `visit` with place, time and the values of all outputs at every sample.
fn visit(
    program: &Program,
    outputs: usize,
    points: &[[f64; 3]],
    horizon: f64,
    mut visit: impl FnMut(&EvaluationPoint, &[f64]) -> Result<(), SetupError>,
) -> Result<(), SetupError> {
    let mut bound = program.bind(points);
    let mut values = vec![Vec::new(); outputs];
    for n in 0..=TIMES {
        let t = horizon * f64::from(n) / f64::from(TIMES);
        bound.evaluate(t, 0.0, &mut values);
        for (p, &[x, y, z]) in points.iter().enumerate() {
            let at: Vec<f64> = values.iter().map(|field| field[p]).collect();
            visit(&EvaluationPoint { x, y, z, t, zeta: 0.0 }, &at)?;
        }
    }
    Ok(())
}

fn place(setup: &Setup, at: &EvaluationPoint) -> String {
    let coordinates = [at.x, at.y, at.z].map(|x| format!("{x:.4}"));
    format!("at ({}), t = {:.4}", coordinates[..setup.scene.dimension].join(", "), at.t)
}

/// u = 0 on Γ1.
fn clamped(setup: &Setup, exact: &Exact) -> Result<(), SetupError> {
    let (horizon, count) = (setup.scene.time.horizon, exact.data.u.len());
    let graph = exact.data.graph.clone();
    let program = Program::compile(&graph, &exact.data.u, horizon);
    let mut size = 0.0f64;
    visit(&program, count, &interior(setup), horizon, |_, u| {
        size = u.iter().fold(size, |size, u| size.max(u.abs()));
        Ok(())
    })?;
    let allowed = ROUNDING * size.max(f64::MIN_POSITIVE);
    for &side in &setup.body.domain.clamped {
        visit(&program, count, &side_points(setup, side), horizon, |at, u| {
            let Some(component) = u.iter().position(|u| u.is_nan() || u.abs() > allowed) else {
                return Ok(());
            };
            let key = format!("exact.u.{component}");
            let value = u[component];
            let message = format!(
                "the exact displacement is {value:.3e} {} on a clamped side",
                place(setup, at)
            );
            let hint = "multiply it by a function that vanishes there, such as (1 - y)";
            Err(setup.scene.error(&key, message, hint).into())
        })?;
    }
    Ok(())
}

fn interior(setup: &Setup) -> Vec<[f64; 3]> {
    setup.body.domain.inner_points(6)
}

/// u_ν ≤ g, λ ≥ 0, λ(g - u_ν) = 0, ξ ∈ ∂j_ν(u_ν) on a plane piece of Γ3.
fn contact_state(setup: &Setup, exact: &Exact, face: &Face) -> Result<(), SetupError> {
    let formulas = exact.boundary(&face.normal[..setup.scene.dimension]);
    let (points, horizon) = (face.points(samples_along(setup)), setup.scene.time.horizon);
    visit(&formulas.program, 5, &points, horizon, |at, values| {
        let &[u_nu, _, gap, xi, lambda] = values else { return Ok(()) };
        let scene = &setup.scene;
        if lambda.is_nan() || lambda < 0.0 {
            let message = format!(
                "the multiplier is {lambda:.3e} {}: it must not be negative",
                place(setup, at)
            );
            let hint = "a multiplier is a pressure: lambda >= 0, and it vanishes where u_nu < g";
            return Err(scene.error("exact.multiplier", message, hint).into());
        }
        if u_nu.is_nan() || u_nu - gap > ROUNDING * gap.abs().max(f64::MIN_POSITIVE) {
            let message = format!(
                "the exact solution violates u_nu <= g: u_nu = {u_nu:.6}, g = {gap:.6} {}",
                place(setup, at)
            );
            let hint = "lower the displacement on the contact side or raise the gap";
            return Err(scene.error("exact.u", message, hint).into());
        }
        if gap.is_finite() && lambda > 0.0 && gap - u_nu > ROUNDING * gap.abs() {
            let message = format!(
                "the multiplier is {lambda:.3e} where u_nu = {u_nu:.6} is below g = {gap:.6}, {}",
                place(setup, at)
            );
            let hint = "complementarity: lambda (u_nu - g) = 0, so lambda > 0 only where u_nu = g";
            return Err(scene.error("exact.multiplier", message, hint).into());
        }
        Ok(selection(setup, at, u_nu, xi)?)
    })
}

/// s ∈ S ∂|u_τ| on a plane piece of Γ3.
fn friction(setup: &Setup, exact: &Exact, face: &Face) -> Result<(), SetupError> {
    let Some(friction) = exact.friction(&face.normal[..setup.scene.dimension]) else {
        return Ok(());
    };
    let (points, horizon) = (face.points(samples_along(setup)), setup.scene.time.horizon);
    let d = setup.scene.dimension;
    visit(&friction.program, Sliding::numbers(d), &points, horizon, |at, values| {
        let sliding = Sliding::new(friction.tangents, d, |i| values[i]);
        // In the plane with its sign.
        let sign = if d == 2 { sliding.s[0].signum() } else { 1.0 };
        let (scene, s, bound) = (&setup.scene, sign * sliding.size(), sliding.bound);
        let slack = ROUNDING * bound.abs().max(f64::MIN_POSITIVE);
        if s.is_nan() || bound.is_nan() || s.abs() > bound + slack {
            let message = format!(
                "the friction stress is {s:.6} {}, beyond the bound {bound:.6}",
                place(setup, at)
            );
            let hint = "state exact.friction with |s| <= S on every contact side";
            return Err(scene.error("exact.friction", message, hint).into());
        }
        let u_tau = if d == 2 { sliding.slip[0] } else { sliding.slipped() };
        if sliding.unaligned() > ROUNDING * bound * u_tau.abs().max(ROUNDING) {
            let message = format!(
                "the friction stress is {s:.6} where u_tau = {u_tau:.3e} slips and the bound is {bound:.6}, {}",
                place(setup, at)
            );
            let hint = match d {
                2 => "s = S sign(u_tau) wherever u_tau is not zero, and u_tau = 0 wherever |s| < S",
                _ => {
                    "s = S u_tau/|u_tau| wherever u_tau is not zero, and u_tau = 0 wherever |s| < S"
                }
            };
            return Err(scene.error("exact.friction", message, hint).into());
        }
        Ok(())
    })
}

/// ξ ∈ ∂j_ν(u_ν - s), if the scene states ξ.
fn selection(setup: &Setup, at: &EvaluationPoint, u_nu: f64, xi: f64) -> Result<(), SceneError> {
    let Some(boundary) = &setup.model.boundary else { return Ok(()) };
    let x = [at.x, at.y, at.z];
    let (lo, hi) = boundary.potential_at(x).subdifferential(u_nu - (boundary.shift)(x));
    let slack = ROUNDING * lo.abs().max(hi.abs()).max(f64::MIN_POSITIVE);
    if xi >= lo - slack && xi <= hi + slack {
        return Ok(());
    }
    let message = format!(
        "xi = {xi:.6} is not in the subdifferential [{lo:.6}, {hi:.6}] at u_nu = {u_nu:.6}, {}",
        place(setup, at)
    );
    let hint = "state exact.selection within the interval of the law at u_nu - shift";
    Err(setup.scene.error("exact.selection", message, hint))
}
