//! `[contact]`: gap, shift, law, quadrature and friction on Γ3, all optional, or u_ν = 0 there in place of a normal law.

use fem::contact::BoundaryRule as ContactQuadrature;
use formula::Node;

use super::domain::Domain;
use super::friction::Friction;
use super::gap::{finite_on_contact, gap};
use super::law::Law;
use super::law::Scale;
use super::law::has_exact_rule;
use super::reading::Reading;
use super::source::SceneError;
use super::time::Time;

/// (5.5) on Γ3: u_ν ≤ g, and ξ ∈ p(u_ν - s); friction in place of (5.6).
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// g, a formula in x, y and t; None is g = ∞.
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
        domain: &Domain,
        time: &Time,
    ) -> Result<Option<Contact>, SceneError> {
        let (key, message, hint) = match (reading.has("contact"), domain.contact.is_empty()) {
            (false, true) => return Ok(None),
            (true, false) => return Contact::parts(reading, domain, time).map(Some),
            (false, false) => (
                "domain.contact",
                "contact sides, but no part [contact]",
                "add [contact]; it may be empty: no gap, no law",
            ),
            (true, true) => (
                "contact",
                "[contact] without a contact side",
                "name the sides in [domain], contact = [\"bottom\"], or remove [contact]",
            ),
        };
        Err(reading.error(key, message, hint))
    }

    fn parts(reading: &mut Reading, domain: &Domain, time: &Time) -> Result<Contact, SceneError> {
        let gap =
            reading.if_given("contact.gap", |reading, key| gap(reading, key, domain, time))?;
        let shift = reading
            .if_given("contact.shift", |reading, key| finite_on_contact(reading, key, domain))?;
        let law = reading.if_given("contact.law", |reading, key| Law::validate(reading, key))?;
        let mut law = law.flatten();
        if let Some(law) = &mut law {
            law.scale = reading.if_given("contact.law.scale", |reading, key| {
                Scale::validate(reading, key, domain)
            })?;
        }
        let normal = [("gap", gap.is_some()), ("shift", shift.is_some()), ("law", law.is_some())];
        for (key, given) in normal {
            let message = format!("bilateral contact, and `{key}`: u_nu = 0 leaves nothing to it");
            let hint = format!("remove `{key}`, or `bilateral`");
            let given = domain.bilateral && given;
            reading.refuse_if(given, &format!("contact.{key}"), message, hint)?;
        }
        let quadrature = quadrature(reading, law.as_ref(), domain)?;
        let friction = reading.if_given("contact.friction", |reading, _| {
            Friction::validate(reading, domain, time, (law.as_ref(), quadrature)).map(Box::new)
        })?;
        Ok(Contact { gap: gap.flatten(), shift, law, quadrature, friction })
    }
}

fn quadrature(
    reading: &Reading,
    law: Option<&Law>,
    domain: &Domain,
) -> Result<ContactQuadrature, SceneError> {
    let known = [
        ("vertex", ContactQuadrature::Vertex),
        ("gauss", ContactQuadrature::Gauss),
        ("exact", ContactQuadrature::Exact),
    ];
    let chosen = reading.choice_or("contact.quadrature", &known, ContactQuadrature::Vertex)?;
    let (exact, jumps) = (chosen == ContactQuadrature::Exact, law.is_some_and(Law::is_set_valued));
    let curve = law.and_then(|law| law.curve);
    let (message, hint) = match chosen {
        ContactQuadrature::Vertex => return Ok(chosen),
        _ if jumps => (
            "a rule with points between the vertices, and a law with a jump: where u_nu stays at the jump along an edge, the pressure is no number there",
            "use quadrature = \"vertex\", which keeps one pressure a vertex, or replace the jump by a steep slope",
        ),
        _ if exact && curve.is_some_and(|curve| !has_exact_rule(curve)) => (
            "the quadrature `exact` integrates powers by Gauss points, exactly for whole exponents up to 14",
            "use quadrature = \"vertex\" or \"gauss\", or a whole exponent",
        ),
        _ if exact && domain.dimension() == 3 => (
            "the quadrature `exact` cuts edges; a contact side in space has faces",
            "use quadrature = \"vertex\" or \"gauss\"",
        ),
        _ => return Ok(chosen),
    };
    Err(reading.error("contact.quadrature", message, hint))
}
