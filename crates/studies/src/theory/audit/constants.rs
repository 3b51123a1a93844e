//! The constants that the bounds take, with whether each is a proved upper bound.

use scene::Face;
use scene::setup::{Setup, SetupError, constants};
use serde::{Serialize, Serializer};
use vhi::monotonicity;

/// Constants of the proofs of Theorems 10 and 11 for one scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AuditConstants {
    /// m_A of (4.7) (a stress).
    #[serde(rename = "m_A")]
    pub m_a: f64,
    /// L_A of (4.17).
    #[serde(rename = "L_A")]
    pub l_a: f64,
    /// α_φ and β_φ of (4.14).
    pub alpha_phi: f64,
    /// β_φ.
    pub beta_phi: f64,
    /// α_j of (4.16) (a stiffness).
    pub alpha_j: f64,
    /// c_j², bounding ‖v_ν‖² by c_j²‖v‖_V² (a length).
    pub c_j_squared: f64,
    /// Whether that is proved; otherwise it is extrapolated from meshes, and no bound.
    #[serde(rename = "c_j_source", serialize_with = "source")]
    pub c_j_proved: bool,
    /// c0 of (4.16): c̄0 √|Γ3|.
    pub c0: f64,
    /// c1 of (4.16).
    pub c1: f64,
    /// ‖R‖‖q‖ of (4.20) as the Lipschitz constant of S: 1 for ζ (where it matters) plus ‖ℬ‖.
    pub history: f64,
}

/// Where c_j² comes from.
pub(super) fn c_j_source(proved: bool) -> &'static str {
    if proved { "proved upper bound" } else { "extrapolated from meshes, no upper bound" }
}

fn source<S: Serializer>(proved: &bool, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(c_j_source(*proved))
}

impl AuditConstants {
    /// The constants of a scene.
    ///
    /// # Errors
    /// As [`constants`].
    pub fn new(setup: &Setup) -> Result<Self, SetupError> {
        let known = constants(setup)?;
        let contact = setup.body.contact.as_ref();
        let factor = contact.and_then(|contact| contact.law.as_ref()?.scale);
        let factor = factor.map_or(1.0, |scale| scale.largest);
        let law = setup.model.boundary.as_ref().map(|boundary| boundary.potential.growth());
        let (c0, c1) = law.unwrap_or_default();
        Ok(Self {
            m_a: known.m_a,
            l_a: known.l_a,
            alpha_phi: known.alpha_phi,
            beta_phi: known.beta_phi,
            alpha_j: known.alpha_nu,
            c_j_squared: known.c_j_squared_bound.unwrap_or(known.c_j_squared),
            c_j_proved: known.c_j_squared_bound.is_some(),
            c0: factor * c0 * contact_length(setup).sqrt(),
            c1: factor * c1,
            history: 1.0 + known.memory.operator,
        })
    }

    /// m0 of (2.9).
    pub fn m0(&self) -> f64 {
        monotonicity(self.m_a, self.alpha_phi + self.alpha_j * self.c_j_squared)
    }
}

/// |Γ3|.
fn contact_length(setup: &Setup) -> f64 {
    let domain = &setup.body.domain;
    let area = |face: Face| face.measure();
    domain.contact.iter().flat_map(|side| domain.faces(*side)).map(area).sum()
}
