//! `[exact]` or `[loads]`: the data of a scene, and the solution to measure against.

use std::collections::BTreeMap;

use exact::LoadForm;
use formula::{Node, Scope, Variable};
use serde::de::DeserializeOwned;

use super::contact::Contact;
use super::definitions::definitions;
use super::domain::{Domain, Side, place};
use super::reading::{Formula, Reading, in_time, join};
use super::source::Result;
use super::time::Time;

pub(super) const AXES: [Variable; 3] = [Variable::X, Variable::Y, Variable::Z];

/// Intervals of each side and of [0, T] at whose ends loads are evaluated.
const SAMPLES: u32 = 8;

/// Data of a scene; formulas in x, y, t, one per component.
#[derive(Debug, Clone, PartialEq)]
pub enum Data {
    /// A known solution; its loads are derived.
    Exact {
        u: Vec<Node>,
        /// λ ≥ 0 by sides, supported where u_ν = g; 0 on others.
        multiplier: Vec<(Side, Node)>,
        /// ξ ∈ p(u_ν - s) by sides where p is set-valued; elsewhere p(u_ν - s) is a number.
        selection: Vec<(Side, Node)>,
        /// s = -σ_τ: in the plane one formula, along the tangent; in space three. None is S u_τ/|u_τ|, and 0 where u_τ
        /// = 0.
        friction: Option<Vec<Node>>,
        /// u(t) is the nodal interpolant of the formula on each mesh.
        interpolated: bool,
        form: LoadForm,
    },
    /// Given loads; errors are measured against a finer run.
    Loads {
        body: Vec<Node>,
        /// f2 on the sides that have one; 0 elsewhere on Γ2.
        traction: Vec<(Side, Vec<Node>)>,
    },
}

impl Data {
    /// Whether u is in V^h: the nodal interpolant of a formula on each mesh, so that another mesh is another problem.
    pub fn is_interpolated(&self) -> bool {
        matches!(self, Self::Exact { interpolated: true, .. })
    }

    pub(super) fn validate(
        reading: &mut Reading,
        domain: &Domain,
        time: &Time,
        contact: &[Contact],
    ) -> Result<Data> {
        match (reading.has("exact"), reading.has("loads")) {
            (true, false) => exact_solution(reading, domain, contact),
            (false, true) => given_loads(reading, domain, time),
            (true, true) => {
                let message =
                    "both [exact] and [loads]: the loads of an exact solution are derived from it";
                Err(reading.error("loads", message, "remove one of the two"))
            }
            (false, false) => {
                let message = "neither [exact] nor [loads]: nothing drives the scene";
                let hint = "add [loads] with body = [\"0\", \"-1\"], or [exact] with u";
                Err(reading.error_at_the_end(message, hint))
            }
        }
    }
}

fn exact_solution(reading: &mut Reading, domain: &Domain, contact: &[Contact]) -> Result<Data> {
    let dimension = domain.dimension();
    let with = |part: fn(&Contact) -> bool| -> Vec<Side> {
        contact.iter().filter(|contact| part(contact)).flat_map(|c| c.sides.clone()).collect()
    };
    let held = with(|contact| contact.gap.is_some());
    let pressed = with(|contact| contact.law.is_some());
    let rubbed = with(|contact| contact.friction.is_some());
    let needs = [
        (
            "exact.multiplier",
            &held,
            "a multiplier needs a finite gap, because otherwise λ (u_ν - g) = 0 allows only λ = 0",
            "give [contact] a gap, or remove the multiplier",
        ),
        (
            "exact.selection",
            &pressed,
            "a selection without a law: there is no set to select from",
            "give [contact] a law, or remove the selection",
        ),
        (
            "exact.friction",
            &rubbed,
            "a friction stress without friction: σ_τ = 0 on the contact sides",
            "add [contact.friction] with a bound, or remove it",
        ),
    ];
    let unfounded = needs.iter().find(|(key, sides, ..)| reading.has(key) && sides.is_empty());
    if let Some((key, _, message, hint)) = unfounded {
        return Err(reading.key_error(key, message, hint));
    }
    let forms = [("weak", LoadForm::Weak), ("strong", LoadForm::Strong)];
    let form = reading.choice_or("exact.form", &forms, LoadForm::Weak)?;
    let scope = definitions(reading, reading.space_and_time(dimension))?;
    let u = reading.vector("exact.u", dimension, &scope)?;
    let mut stated = |key: &str, sides: &[Side], lacks: &str| {
        if reading.has(key) && !reading.has_parts(key) {
            let node = reading.formula(key, &scope)?;
            return Ok(sides.iter().map(|&side| (side, node)).collect());
        }
        by_side(reading, key, domain, (sides, lacks), |reading, key, formula: &Formula, _| {
            reading.compiled(key, formula, &scope)
        })
    };
    let multiplier = stated("exact.multiplier", &held, "has no gap")?;
    let selection = stated("exact.selection", &pressed, "has no law")?;
    let friction = reading
        .if_given("exact.friction", |reading, key| friction(reading, key, dimension, &scope))?;
    let interpolated = reading.optional("exact.interpolated")?.unwrap_or(false);
    Ok(Data::Exact { u, multiplier, selection, friction, interpolated, form })
}

/// What is made of each entry of a table by sides, `multiplier = { left = "0.1*t" }`, which names some of the given sides;
/// `lacks` says what is wrong with others.
fn by_side<T: DeserializeOwned, R>(
    reading: &mut Reading,
    key: &str,
    domain: &Domain,
    (sides, lacks): (&[Side], &str),
    read: impl Fn(&mut Reading, &str, &T, Side) -> Result<R>,
) -> Result<Vec<(Side, R)>> {
    let written: Option<BTreeMap<String, T>> = reading.optional(key)?;
    let mut found = Vec::new();
    for (name, value) in written.iter().flatten() {
        let key = join(key, name);
        let side = reading.named(&key, name, &domain.known())?;
        if !sides.contains(&side) {
            let hint = "name another side, or give it in [domain] or [contact] what it lacks";
            return Err(reading.key_error(&key, format!("the side `{name}` {lacks}"), hint));
        }
        found.push((side, read(reading, &key, value, side)?));
    }
    Ok(found)
}

/// One formula along the tangent in the plane, a vector in space: `friction = "0.1"`, `friction = ["0.1", "0", "0.05"]`.
fn friction(
    reading: &mut Reading,
    key: &str,
    dimension: usize,
    scope: &Scope,
) -> Result<Vec<Node>> {
    let (message, hint) = match dimension {
        2 => (
            "a friction stress of several components",
            "in the plane it is one formula, along the tangent: friction = \"0.1\"",
        ),
        _ => (
            "a friction stress of one component",
            "in space it is a vector: friction = [\"0.1\", \"0\", \"0\"]",
        ),
    };
    let vector = reading.has_parts(key);
    reading.refuse_if(vector != (dimension == 3), key, message, hint)?;
    if vector { reading.vector(key, 3, scope) } else { Ok(vec![reading.formula(key, scope)?]) }
}

fn given_loads(reading: &mut Reading, domain: &Domain, time: &Time) -> Result<Data> {
    let dimension = domain.dimension();
    let scope = reading.space_and_time(dimension);
    let body = reading.vector("loads.body", dimension, &scope)?;
    finite(reading, "loads.body", &body, &domain.points(SAMPLES), time)?;
    let free = (&domain.traction[..], "is not a traction side");
    let of_side = |reading: &mut Reading, key: &str, formulas: &Vec<Formula>, side| {
        let nodes = reading.components(key, formulas, dimension, &scope)?;
        finite(reading, key, &nodes, &domain.points_on(side, SAMPLES), time)?;
        Ok(nodes)
    };
    let traction = by_side(reading, "loads.traction", domain, free, of_side)?;
    Ok(Data::Loads { body, traction })
}

/// Refuses a load that is infinite or undefined at a sample.
fn finite(
    reading: &Reading,
    key: &str,
    load: &[Node],
    places: &[[f64; 3]],
    time: &Time,
) -> Result<()> {
    load.iter().enumerate().try_for_each(|(index, &node)| {
        let key = format!("{key}.{index}");
        let points = in_time(places, time.horizon, SAMPLES);
        reading.everywhere((&key, node), points, f64::is_finite, |at, value| {
            let message = format!("the load is {value} at {}, t = {}", place(at, load.len()), at.t);
            (message, "f0 and f2 must be finite on the domain and on [0, T]")
        })
    })
}
