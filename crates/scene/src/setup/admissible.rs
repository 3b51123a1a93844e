//! Checks before a solve, beyond the text of a scene: the exact solution satisfies its conditions, and (2.9) holds.

use super::constants::{Smallness, needed};
use super::regularity::contact_claims;
use super::{Result, Setup};
use crate::reading::evenly;
use crate::{Face, Hypothesis, SceneError, Side};
use exact::{Exact, Sliding};
use files::digits;
use formula::Program;
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
pub fn admissible(setup: &Setup) -> Result<()> {
    representable(setup)?;
    smallness(setup)?;
    if let Some(exact) = &setup.exact {
        clamped(setup, exact)?;
        symmetric(setup, exact)?;
        let domain = &setup.body.domain;
        for &side in &domain.contact {
            for face in domain.faces(side) {
                contact_state(setup, exact, (side, &face))?;
                friction(setup, exact, (side, &face))?;
            }
        }
    }
    contact_claims(setup)
}

/// Range of |Ω| in which measures of cells on all meshes are doubles, with 1e-7 to spare at either end.
const MEASURES: std::ops::RangeInclusive<f64> = 1e-301..=1e301;
/// Range of moduli whose products with strains in any unit are doubles.
const MODULI: std::ops::RangeInclusive<f64> = 1e-152..=1e152;

/// Checks measures and moduli: lengths within 1e±150 in the plane, 1e±100 in space.
fn representable(setup: &Setup) -> Result<(), SceneError> {
    let (scene, domain) = (&setup.scene, &setup.body.domain);
    let measure = domain.measure();
    let message = format!("the measure of the domain is {measure:.1e}, outside 1e-301 to 1e301");
    let hint = "use another unit of length: lengths must lie within 1e-150 to 1e150 in the plane, 1e-100 to 1e100 in space";
    scene.refuse_if(!MEASURES.contains(&measure), "domain", message, hint)?;
    let (_, largest) = setup.model.elasticity.eigenvalues(scene.dimension);
    let message = format!("the stiffest modulus is {largest:.1e}, outside 1e-152 to 1e152");
    let hint = "state the scene in another unit of stress";
    scene.refuse_if(!MODULI.contains(&largest), "material", message, hint)
}

/// (2.9): α_ν c_j² + α_τ c_τ² < m_𝒜, or with friction that follows the normal law its sharp form.
fn smallness(setup: &Setup) -> Result<()> {
    let scene = &setup.scene;
    if setup.body.is_monotone() || scene.violates.contains(&Hypothesis::Smallness) {
        return Ok(());
    }
    let constants = needed(setup)?;
    // Where it is unknown the run goes on, and says so beside its step sizes.
    if constants.smallness() != Smallness::Fails {
        return Ok(());
    }
    let (by, key, remedy) = match &constants.coulomb {
        Some(_) => (
            "the smallness condition (2.9) fails: A c_nu^2 + B c_tau^2 =",
            "friction.bound.coefficient",
            "lower the coefficient, flatten the normal law or stiffen the body (A and B are explained in docs/CONTACT-LAWS.md)",
        ),
        None if constants.alpha_tau > 0.0 => (
            "the smallness condition (2.9) fails: alpha_nu c_nu^2 + alpha_tau c_tau^2 =",
            "friction.bound",
            "let the bound fall more slowly with the slip, flatten the falling branch of the normal law or stiffen the body",
        ),
        None => (
            "the smallness condition (2.9) fails: alpha_nu c_j^2 =",
            "law",
            "flatten the falling branch of the law or stiffen the body",
        ),
    };
    let [normal, tangential] = constants.coefficients();
    let of = |a: f64, b: f64| format!("{} * {}", digits(a, 5), digits(b, 5));
    let mut product = of(normal, constants.c_nu_squared);
    if by.contains('+') {
        product += &format!(" + {}", of(tangential, constants.c_tau_squared));
    }
    let message = format!(
        "{by} {product} = {} is not below m_A = {}",
        digits(constants.concave(), 5),
        digits(constants.m_elastic, 5)
    );
    let hint = format!("{remedy}; or say violates = [\"2.9\"] in [scene] to run it all the same");
    // At the part that takes most.
    let parts = setup.body.contact.iter();
    let most = parts.max_by(|a, b| a.alpha().total_cmp(&b.alpha()));
    let key = most.map_or_else(String::new, |contact| format!("{}.{key}", contact.key));
    Err(scene.error(&key, message, hint).into())
}

fn samples_along(setup: &Setup) -> u32 {
    if setup.scene.dimension == 2 { ALONG } else { ON_FACE }
}

/// Place and time of a sample.
struct Sample<'a> {
    place: [f64; 3],
    t: f64,
    setup: &'a Setup,
}

impl std::fmt::Display for Sample<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let coordinates = self.place.map(|x| digits(x, 5));
        let place = coordinates[..self.setup.scene.dimension].join(", ");
        write!(f, "at ({place}), t = {}", digits(self.t, 5))
    }
}

/// Calls `visit` with the values of all outputs at every sample.
fn visit(
    setup: &Setup,
    program: &Program,
    outputs: usize,
    points: &[[f64; 3]],
    mut visit: impl FnMut(Sample<'_>, &[f64]) -> Result<(), SceneError>,
) -> Result<(), SceneError> {
    let mut bound = program.bind(points);
    let mut values = vec![Vec::new(); outputs];
    for t in evenly(0.0, setup.scene.time.horizon, TIMES) {
        bound.evaluate(t, 0.0, &mut values);
        for (p, &place) in points.iter().enumerate() {
            let at: Vec<f64> = values.iter().map(|field| field[p]).collect();
            visit(Sample { place, t, setup }, &at)?;
        }
    }
    Ok(())
}

/// u = 0 on Γ1.
fn clamped(setup: &Setup, exact: &Exact) -> Result<(), SceneError> {
    let (domain, count) = (&setup.body.domain, exact.data.u.len());
    let graph = exact.data.graph.clone();
    let program = Program::compile(&graph, &exact.data.u, setup.scene.time.horizon);
    let mut size = 0.0f64;
    visit(setup, &program, count, &domain.inner_points(6), |_, u| {
        size = u.iter().fold(size, |size, u| size.max(u.abs()));
        Ok(())
    })?;
    let allowed = ROUNDING * size.max(f64::MIN_POSITIVE);
    for &side in &domain.clamped {
        let points = domain.points_on(side, samples_along(setup));
        visit(setup, &program, count, &points, |at, u| {
            let Some(component) = u.iter().position(|u| u.is_nan() || u.abs() > allowed) else {
                return Ok(());
            };
            let key = format!("exact.u.{component}");
            let value = u[component];
            let message = format!("the exact displacement is {value:.3e} {at} on a clamped side");
            let hint = "multiply it by a function that vanishes there, such as (1 - y)";
            Err(setup.scene.error(&key, message, hint))
        })?;
    }
    Ok(())
}

/// u_ν = 0 and σ_τ = 0 on planes of symmetry, u_ν = 0 where contact is bilateral.
fn symmetric(setup: &Setup, exact: &Exact) -> Result<(), SceneError> {
    let (scene, domain) = (&setup.scene, &setup.body.domain);
    let inside = domain.inner_points(6);
    let times = evenly(0.0, scene.time.horizon, TIMES);
    // Sizes that count as rounding of zero, from the body: strains are derivatives, and lose half of the digits at most.
    let largest = times.clone().fold([0.0f64; 2], |largest, t| exact.sizes(&inside, t, largest));
    let [least_u, least_sigma] = [ROUNDING * largest[0], ROUNDING.sqrt() * largest[1]];
    let faces = |side| domain.faces(side).into_iter().map(move |face| (side, face));
    for (side, face) in domain.held().into_iter().flat_map(faces) {
        let (what, hint) = match domain.contact.contains(&side) {
            true => (
                "with bilateral contact",
                "there the component along the normal is zero: multiply it by a function that vanishes there, or remove `bilateral`",
            ),
            false => (
                "on a plane of symmetry",
                "there the component along the normal is zero: let it be odd across that plane",
            ),
        };
        let points = face.points(samples_along(setup));
        for t in times.clone() {
            let across = exact.across(&face.normal, &points, t);
            for (&place, [u, traction]) in points.iter().zip(across) {
                let at = Sample { place, t, setup };
                let message = format_args!("u_nu is {u:.3e} {at} {what}");
                let moves = u.is_nan() || u.abs() > least_u.max(f64::MIN_POSITIVE);
                scene.refuse_if(moves, "exact.u", message, hint)?;
                if domain.contact.contains(&side) {
                    continue;
                }
                let message =
                    format_args!("|sigma_tau| is {traction:.3e} {at} on a plane of symmetry");
                let hint =
                    "no traction acts along it: let the other components be even across that plane";
                let sheared = traction.is_nan() || traction > least_sigma.max(f64::MIN_POSITIVE);
                scene.refuse_if(sheared, "exact.u", message, hint)?;
            }
        }
    }
    Ok(())
}

/// u_ν ≤ g, λ ≥ 0, λ(g - u_ν) = 0, ξ ∈ ∂j_ν(u_ν) on a plane piece of Γ3.
fn contact_state(
    setup: &Setup,
    exact: &Exact,
    (side, face): (Side, &Face),
) -> Result<(), SceneError> {
    let formulas = exact.boundary(side.0, &face.normal[..setup.scene.dimension]);
    visit(setup, &formulas.program, 5, &face.points(samples_along(setup)), |at, values| {
        let &[u_nu, _, gap, xi, lambda] = values else { return Ok(()) };
        let scene = &setup.scene;
        let message = format_args!("the multiplier is {lambda:.3e} {at}: it must not be negative");
        let hint = "a multiplier is a pressure: lambda >= 0, and it vanishes where u_nu < g";
        let negative = lambda.is_nan() || lambda < 0.0;
        scene.refuse_if(negative, "exact.multiplier", message, hint)?;
        let [normal, bound] = [u_nu, gap].map(|value| digits(value, 7));
        let message = format_args!(
            "the exact solution violates u_nu <= g: u_nu = {normal}, g = {bound} {at}"
        );
        let hint = "lower the displacement on the contact side or raise the gap";
        let beyond = u_nu.is_nan() || u_nu - gap > ROUNDING * gap.abs().max(f64::MIN_POSITIVE);
        scene.refuse_if(beyond, "exact.u", message, hint)?;
        let message = format_args!(
            "the multiplier is {lambda:.3e} where u_nu = {normal} is below g = {bound}, {at}"
        );
        let hint = "complementarity: lambda (u_nu - g) = 0, so lambda > 0 only where u_nu = g";
        let below = gap.is_finite() && lambda > 0.0 && gap - u_nu > ROUNDING * gap.abs();
        scene.refuse_if(below, "exact.multiplier", message, hint)?;
        selection(side, &at, u_nu, xi)
    })
}

/// s ∈ S ∂|u_τ| on a plane piece of Γ3.
fn friction(setup: &Setup, exact: &Exact, (side, face): (Side, &Face)) -> Result<(), SceneError> {
    let d = setup.scene.dimension;
    let Some(friction) = exact.friction(side.0, &face.normal[..d]) else { return Ok(()) };
    let points = face.points(samples_along(setup));
    visit(setup, &friction.program, Sliding::numbers(d), &points, |at, values| {
        let sliding = Sliding::new(friction.tangents, d, |i| values[i]);
        // In the plane with its sign.
        let sign = if d == 2 { sliding.s[0].signum() } else { 1.0 };
        let (scene, s, bound) = (&setup.scene, sign * sliding.size(), sliding.bound);
        let slack = ROUNDING * bound.abs().max(f64::MIN_POSITIVE);
        let [stress, most] = [s, bound].map(|value| digits(value, 7));
        let message = format_args!("the friction stress is {stress} {at}, beyond the bound {most}");
        let hint = "state exact.friction with |s| <= S on every contact side";
        let beyond = s.is_nan() || bound.is_nan() || s.abs() > bound + slack;
        scene.refuse_if(beyond, "exact.friction", message, hint)?;
        let u_tau = if d == 2 { sliding.slip[0] } else { sliding.slipped() };
        let message = format_args!(
            "the friction stress is {stress} where u_tau = {u_tau:.3e} slips and the bound is {most}, {at}"
        );
        let hint = match d {
            2 => "s = S sign(u_tau) wherever u_tau is not zero, and u_tau = 0 wherever |s| < S",
            _ => "s = S u_tau/|u_tau| wherever u_tau is not zero, and u_tau = 0 wherever |s| < S",
        };
        let turned = sliding.unaligned() > ROUNDING * bound * u_tau.abs().max(ROUNDING);
        scene.refuse_if(turned, "exact.friction", message, hint)
    })
}

/// ξ ∈ ∂j_ν(u_ν - s), if the scene states ξ.
fn selection(side: Side, at: &Sample<'_>, u_nu: f64, xi: f64) -> Result<(), SceneError> {
    let Some(boundary) = at.setup.model.boundary_on(side.0) else { return Ok(()) };
    let x = at.place;
    let (lo, hi) = boundary.potential_at(x).subdifferential(u_nu - (boundary.shift)(x));
    let slack = ROUNDING * lo.abs().max(hi.abs()).max(f64::MIN_POSITIVE);
    let within = xi >= lo - slack && xi <= hi + slack;
    let [inside, low, high, normal] = [xi, lo, hi, u_nu].map(|value| digits(value, 7));
    let message = format_args!(
        "xi = {inside} is not in the subdifferential [{low}, {high}] at u_nu = {normal}, {at}"
    );
    let hint = "state exact.selection within the interval of the law at u_nu - shift";
    at.setup.scene.refuse_if(!within, "exact.selection", message, hint)
}
