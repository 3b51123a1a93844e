//! `[contact]`: gap, shift, law, quadrature and friction on Γ3, all optional.

use fem::contact::BoundaryRule as ContactQuadrature;
use formula::Node;

use super::curve::has_exact_rule;
use super::diagnostic::SceneError;
use super::domain::Domain;
use super::friction::Friction;
use super::gap::{finite_on_contact, gap};
use super::law::Law;
use super::reading::Reading;
use super::scale::Scale;
use super::time::Time;
use super::written;

/// (5.5) on Γ3: u_ν ≤ g, and ξ ∈ p(u_ν - s); friction in place of (5.6).
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// g, a formula in x, y; None is g = ∞.
    pub gap: Option<Node>,
    /// s, a formula in x, y; None is 0.
    pub shift: Option<Node>,
    pub law: Option<Law>,
    pub quadrature: ContactQuadrature,
    pub friction: Option<Box<Friction>>,
}

impl Contact {
    /// The contact of a scene: present exactly if the domain has contact sides.
    pub(super) fn validate(
        reading: &mut Reading,
        written: Option<&written::Contact>,
        domain: &Domain,
        time: &Time,
    ) -> Result<Option<Contact>, SceneError> {
        match (written, domain.contact.is_empty()) {
            (None, true) => Ok(None),
            (None, false) => {
                let message = "contact sides, but no part [contact]";
                Err(reading.error(
                    "domain.contact",
                    message,
                    "add [contact]; it may be empty: no gap, no law",
                ))
            }
            (Some(_), true) => {
                let message = "[contact] without a contact side";
                Err(reading.error(
                    "contact",
                    message,
                    "name the sides in [domain], contact = [\"bottom\"], or remove [contact]",
                ))
            }
            (Some(written), false) => Contact::parts(reading, written, domain, time).map(Some),
        }
    }

    fn parts(
        reading: &mut Reading,
        written: &written::Contact,
        domain: &Domain,
        time: &Time,
    ) -> Result<Contact, SceneError> {
        let gap = match &written.gap {
            Some(formula) => gap(reading, formula, domain)?,
            None => None,
        };
        let shift = written.shift.as_ref();
        let shift =
            shift.map(|formula| finite_on_contact(reading, "contact.shift", formula, domain));
        let shift = shift.transpose()?;
        let law = written.law.as_ref();
        let law = law.and_then(|law| Law::validate(reading, "contact.law", law).transpose());
        let mut law = law.transpose()?;
        let scale = written.law.as_ref().and_then(|law| law.scale.as_ref());
        if let (Some(law), Some(formula)) = (&mut law, scale) {
            law.scale = Some(Scale::validate(reading, "contact.law.scale", formula, domain)?);
        }
        let word = written.quadrature.as_deref().unwrap_or("vertex");
        let quadrature = quadrature(reading, word, law.as_ref(), domain)?;
        let friction = match &written.friction {
            Some(friction) => {
                let normal = (law.as_ref(), quadrature);
                Some(Box::new(Friction::validate(reading, friction, domain, time, normal)?))
            }
            None => None,
        };
        Ok(Contact { gap, shift, law, quadrature, friction })
    }
}

fn quadrature(
    reading: &Reading,
    word: &str,
    law: Option<&Law>,
    domain: &Domain,
) -> Result<ContactQuadrature, SceneError> {
    let chosen = reading.choice(
        "contact.quadrature",
        word,
        &[
            ("vertex", ContactQuadrature::Vertex),
            ("gauss", ContactQuadrature::Gauss),
            ("exact", ContactQuadrature::Exact),
        ],
    )?;
    if chosen != ContactQuadrature::Vertex && law.is_some_and(Law::is_set_valued) {
        let message = format!(
            "the quadrature `{word}` and a law with a jump: where u_nu stays at the jump along an edge, the pressure is no number at its points"
        );
        let hint = "use quadrature = \"vertex\", which keeps one pressure a vertex, or replace the jump by a steep slope";
        return Err(reading.error("contact.quadrature", message, hint));
    }
    let curve = law.and_then(|law| law.curve);
    if chosen == ContactQuadrature::Exact && curve.is_some_and(|curve| !has_exact_rule(curve)) {
        let message = "the quadrature `exact` integrates powers by Gauss points, exactly for whole exponents up to 14";
        let hint = "use quadrature = \"vertex\" or \"gauss\", or a whole exponent";
        return Err(reading.error("contact.quadrature", message, hint));
    }
    if chosen == ContactQuadrature::Exact && domain.dimension() == 3 {
        let message = "the quadrature `exact` cuts edges; a contact side in space has faces";
        let hint = "use quadrature = \"vertex\" or \"gauss\"";
        return Err(reading.error("contact.quadrature", message, hint));
    }
    Ok(chosen)
}
