//! `[material]`: elasticity, and the optional memory and projection.

use super::diagnostic::SceneError;
use super::memory::Memory;
use super::projection::Projection;
use super::reading::Reading;
use super::written;

/// The law (5.1): 𝒜ε = 2 mu ε + lambda tr(ε) I, with the terms that the scene has.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// First Lamé coefficient λ_L.
    pub lambda: f64,
    /// Second Lamé coefficient μ_L > 0.
    pub mu: f64,
    pub memory: Option<Memory>,
    pub projection: Option<Projection>,
}

impl Material {
    pub(super) fn validate(
        reading: &mut Reading,
        written: &written::Material,
        horizon: f64,
    ) -> Result<Material, SceneError> {
        let [lambda, mu] = lame(reading, written)?;
        let memory = match &written.memory {
            Some(memory) => Some(Memory::validate(reading, memory, horizon)?),
            None => None,
        };
        let projection = match &written.projection {
            Some(projection) => Some(Projection::validate(reading, projection, horizon)?),
            None => None,
        };
        Ok(Material { lambda, mu, memory, projection })
    }
}

/// Exactly one of the pairs (lambda, mu_L) and (E, nu).
fn lame(reading: &Reading, written: &written::Material) -> Result<[f64; 2], SceneError> {
    match (written.lambda, written.mu_l, written.young, written.poisson) {
        (Some(lambda), Some(mu), None, None) => elliptic(reading, lambda, mu),
        (None, None, Some(young), Some(poisson)) => from_young(reading, young, poisson),
        (lambda, mu, young, poisson) => {
            let given = [("lambda", lambda), ("mu_L", mu), ("E", young), ("nu", poisson)];
            let names: Vec<&str> =
                given.iter().filter(|(_, value)| value.is_some()).map(|(name, _)| *name).collect();
            let list = if names.is_empty() { "nothing".to_string() } else { names.join(", ") };
            let message = format!("[material] gives {list}: elasticity needs exactly one pair");
            Err(reading.error("material", message, "give lambda and mu_L, or E and nu"))
        }
    }
}

/// m_𝒜 > 0 in two dimensions: the eigenvalues 2 mu and 2 mu + 2 lambda of 𝒜 on S² are positive.
fn elliptic(reading: &Reading, lambda: f64, mu: f64) -> Result<[f64; 2], SceneError> {
    reading.finite("material.lambda", lambda)?;
    reading.finite("material.mu_L", mu)?;
    if mu <= 0.0 {
        let message = format!(
            "mu_L = {mu} is not positive: the eigenvalue 2 mu_L of the elasticity tensor must be"
        );
        return Err(reading.error("material.mu_L", message, "give mu_L > 0"));
    }
    if lambda + mu <= 0.0 {
        let message = format!(
            "lambda + mu_L = {} is not positive: the eigenvalue 2 mu_L + 2 lambda of the elasticity tensor must be",
            lambda + mu
        );
        return Err(reading.error("material.lambda", message, format!("give lambda > {}", -mu)));
    }
    Ok([lambda, mu])
}

/// Plane strain: λ = E ν/((1+ν)(1-2ν)), μ = E/(2(1+ν)).
fn from_young(reading: &Reading, young: f64, poisson: f64) -> Result<[f64; 2], SceneError> {
    reading.positive("material.E", young)?;
    if !(poisson > -1.0 && poisson < 0.5) {
        let message = format!("nu = {poisson} is outside (-1, 0.5)");
        return Err(reading.error(
            "material.nu",
            message,
            "at 0.5 the material is incompressible: give less, such as 0.3",
        ));
    }
    Ok([
        young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        young / (2.0 * (1.0 + poisson)),
    ])
}
