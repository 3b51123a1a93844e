//! `[contact]`: gap, shift, law, quadrature and friction on Γ3, all optional, or u_ν = 0 there in place of a normal law;
//! `[[contact]]` with `sides` where sides differ.

use fem::contact::BoundaryRule as ContactQuadrature;
use fem::mesh::Face;
use formula::Node;

use super::domain::{Domain, SAME_NORMAL, Side, place};
use super::friction::Friction;
use super::gap::{finite_on_contact, gap};
use super::law::Law;
use super::law::Scale;
use super::law::has_exact_rule;
use super::reading::{Reading, join};
use super::source::{Result, SceneError};
use super::time::Time;

/// (5.5) on some sides of Γ3: u_ν ≤ g, and ξ ∈ p(u_ν - s); friction in place of (5.6).
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Its key: `contact`, or `contact.0` and so on in a list.
    pub key: String,
    /// Its sides: those of the domain, each in one contact.
    pub sides: Vec<Side>,
    /// g, a formula in x, y and t; None is g = ∞.
    pub gap: Option<Node>,
    /// s, a formula in x, y; None is 0.
    pub shift: Option<Node>,
    pub law: Option<Law>,
    pub quadrature: ContactQuadrature,
    pub friction: Option<Box<Friction>>,
}

/// The tables of contact by their keys: `[contact]`, or each `[[contact]]`.
pub(super) fn tables(reading: &Reading) -> Result<Vec<String>> {
    if !reading.is_list("contact") {
        return Ok(vec!["contact".into()]);
    }
    Ok(reading.entries("contact")?.map(|i| join("contact", &i.to_string())).collect())
}

impl Contact {
    /// α of (2.8c): the steepest descent of the law, 0 without one.
    pub fn alpha(&self) -> f64 {
        self.law.as_ref().map_or(0.0, Law::alpha)
    }

    /// The contact of a scene: none exactly if the domain has no contact sides.
    pub(super) fn validate(
        reading: &mut Reading,
        domain: &Domain,
        time: &Time,
    ) -> Result<Vec<Contact>> {
        let (key, message, hint) = match (reading.has("contact"), domain.contact.is_empty()) {
            (false, true) => return Ok(Vec::new()),
            (true, false) => {
                let tables = tables(reading)?;
                let all: Vec<Contact> = tables
                    .iter()
                    .map(|key| Contact::parts(reading, (key, tables.len()), domain, time))
                    .collect::<Result<_>>()?;
                each_side_once(reading, domain, &all)?;
                apart(reading, domain, &all)?;
                return Ok(all);
            }
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

    fn parts(
        reading: &mut Reading,
        (table, count): (&str, usize),
        domain: &Domain,
        time: &Time,
    ) -> Result<Contact> {
        let key = |name: &str| join(table, name);
        let sides = sides(reading, (table, count), domain)?;
        let domain = &Domain { contact: sides.clone(), ..domain.clone() };
        let gap = reading.if_given(&key("gap"), |reading, key| gap(reading, key, domain, time))?;
        let shift = reading
            .if_given(&key("shift"), |reading, key| finite_on_contact(reading, key, domain))?;
        let mut law = Law::validate(reading, &key("law"))?;
        if let Some(law) = &mut law {
            law.scale = reading.if_given(&key("law.scale"), |reading, key| {
                Scale::validate(reading, key, domain)
            })?;
        }
        let in_a_list = table != "contact" && reading.has(&key("bilateral"));
        let message = "bilateral contact holds on all contact sides";
        let hint = "use one [contact] for all contact sides, or remove `bilateral`";
        reading.refuse_if(in_a_list, &key("bilateral"), message, hint)?;
        let normal = [("gap", gap.is_some()), ("shift", shift.is_some()), ("law", law.is_some())];
        for (name, given) in normal {
            let message = format!("bilateral contact, and `{name}`: u_nu = 0 leaves nothing to it");
            let hint = format!("remove `{name}`, or `bilateral`");
            reading.refuse_if(domain.bilateral && given, &key(name), message, hint)?;
        }
        let quadrature = quadrature(reading, &key("quadrature"), law.as_ref(), domain)?;
        let friction = reading.if_given(&key("friction"), |reading, key| {
            let message = "friction beside other contact sides with a law of their own";
            let hint = "use one [contact] for all contact sides, or remove the friction";
            reading.refuse_if(count > 1, key, message, hint)?;
            Friction::validate(reading, key, domain, time, (law.as_ref(), quadrature)).map(Box::new)
        })?;
        Ok(Contact {
            key: table.to_string(),
            sides,
            gap: gap.flatten(),
            shift,
            law,
            quadrature,
            friction,
        })
    }
}

/// `sides`, all contact sides where there is but one table.
fn sides(reading: &Reading, (table, count): (&str, usize), domain: &Domain) -> Result<Vec<Side>> {
    let key = join(table, "sides");
    if !reading.has(&key) && count == 1 {
        return Ok(domain.contact.clone());
    }
    reading.some_entries(&key)?;
    let sides = domain.listed(reading, &key)?;
    for (index, side) in sides.iter().enumerate() {
        let message = format!("`{}` is not a contact side", domain.name(*side));
        let hint = "list it in contact = [...] of [domain], or remove it here";
        let other = !domain.contact.contains(side);
        reading.refuse_if(other, &format!("{key}.{index}"), message, hint)?;
    }
    Ok(sides)
}

/// Each contact side in exactly one table, and one quadrature for all.
fn each_side_once(reading: &Reading, domain: &Domain, all: &[Contact]) -> Result<()> {
    let mut seen: Vec<Side> = Vec::new();
    for part in all {
        for (index, &side) in part.sides.iter().enumerate() {
            let message =
                format!("the contact side `{}` has two tables [[contact]]", domain.name(side));
            let key = format!("{}.sides.{index}", part.key);
            let hint = "name each contact side in one of them";
            reading.refuse_if(seen.contains(&side), &key, message, hint)?;
            seen.push(side);
        }
        let message = "contact sides with different quadratures";
        let hint = "use one for all of them";
        let differs = part.quadrature != all[0].quadrature;
        reading.refuse_if(differs, &join(&part.key, "quadrature"), message, hint)?;
    }
    let Some(&missing) = domain.contact.iter().find(|side| !seen.contains(side)) else {
        return Ok(());
    };
    let name = domain.name(missing);
    let message = format!("the contact side `{name}` is in no table [[contact]]");
    let hint = format!("add [[contact]] with sides = [\"{name}\"]; it may hold no more than that");
    Err(reading.error("contact", message, hint))
}

/// Contacts that meet do so at an angle: on one line or plane their common vertices would have two laws and one u_ν.
fn apart(reading: &Reading, domain: &Domain, all: &[Contact]) -> Result<()> {
    let faces = |part: &Contact| -> Vec<Face> {
        part.sides.iter().flat_map(|&side| domain.faces(side)).collect()
    };
    let along = |a: &Face, b: &Face| {
        let turn = (0..3).map(|i| (a.normal[i] - b.normal[i]).abs()).fold(0.0, f64::max);
        turn <= SAME_NORMAL
    };
    for (i, part) in all.iter().enumerate() {
        let of_part = faces(part);
        for other in all[..i].iter().flat_map(faces) {
            let straight = of_part.iter().filter(|face| along(face, &other));
            let common = straight.flat_map(|face| face.corners()).find(|p| other.has_corner(*p));
            if let Some(p) = common {
                let message = format!(
                    "contact sides with two laws meet at {} and go straight on: one vertex there has both",
                    place(&p.into(), domain.dimension())
                );
                let hint = "use one [[contact]] for both sides, with `scale` in its law where only a factor differs, or put another side between them";
                return Err(reading.error(&part.key, message, hint));
            }
        }
    }
    Ok(())
}

fn quadrature(
    reading: &Reading,
    key: &str,
    law: Option<&Law>,
    domain: &Domain,
) -> Result<ContactQuadrature, SceneError> {
    let known = [
        ("vertex", ContactQuadrature::Vertex),
        ("gauss", ContactQuadrature::Gauss),
        ("exact", ContactQuadrature::Exact),
    ];
    let chosen = reading.choice_or(key, &known, ContactQuadrature::Vertex)?;
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
    Err(reading.error(key, message, hint))
}
