//! `[exact]` or `[loads]`: the data of a scene, and the solution to measure against.

use exact::LoadForm;
use formula::{EvaluationPoint, Node, Variable};

use super::contact::Contact;
use super::definitions::definitions;
use super::diagnostic::SceneError;
use super::domain::{Domain, Side, place};
use super::reading::{Reading, evenly};
use super::time::Time;
use super::written;

pub(super) const AXES: [Variable; 3] = [Variable::X, Variable::Y, Variable::Z];

/// Intervals of each side and of [0, T] at whose ends loads are evaluated.
const SAMPLES: u32 = 8;

/// Data of a scene; formulas in x, y, t, one per component.
#[derive(Debug, Clone, PartialEq)]
pub enum Data {
    /// A known solution; its loads are derived.
    Exact {
        u: Vec<Node>,
        /// λ ≥ 0, supported where u_ν = g; None is 0.
        multiplier: Option<Node>,
        /// ξ ∈ p(u_ν - s) where p is set-valued; None if p(u_ν - s) is a number.
        selection: Option<Node>,
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
        file: &written::File,
        domain: &Domain,
        time: &Time,
        contact: Option<&Contact>,
    ) -> Result<Data, SceneError> {
        match (&file.exact, &file.loads) {
            (Some(exact), None) => exact_solution(reading, exact, domain.dimension(), contact),
            (None, Some(loads)) => given_loads(reading, loads, domain, time),
            (Some(_), Some(_)) => {
                let message =
                    "both [exact] and [loads]: the loads of an exact solution are derived from it";
                Err(reading.error("loads", message, "remove one of the two"))
            }
            (None, None) => {
                let end = reading.source.text.trim_end().len();
                let message = "neither [exact] nor [loads]: nothing drives the scene";
                Err(SceneError::at(
                    reading.source,
                    end..end,
                    message,
                    "add [loads] with body = [\"0\", \"-1\"], or [exact] with u",
                ))
            }
        }
    }
}

fn exact_solution(
    reading: &mut Reading,
    written: &written::Exact,
    dimension: usize,
    contact: Option<&Contact>,
) -> Result<Data, SceneError> {
    if written.multiplier.is_some() && contact.is_none_or(|contact| contact.gap.is_none()) {
        let message = "a multiplier without a finite gap: λ (u_ν - g) = 0 leaves only λ = 0";
        return Err(reading.key_error(
            "exact.multiplier",
            message,
            "give [contact] a gap, or remove the multiplier",
        ));
    }
    if written.selection.is_some() && contact.is_none_or(|contact| contact.law.is_none()) {
        let message = "a selection without a law: there is no set to select from";
        return Err(reading.key_error(
            "exact.selection",
            message,
            "give [contact] a law, or remove the selection",
        ));
    }
    if written.friction.is_some() && contact.is_none_or(|contact| contact.friction.is_none()) {
        let message = "a friction stress without friction: σ_τ = 0 on the contact sides";
        return Err(reading.key_error(
            "exact.friction",
            message,
            "add [contact.friction] with a bound, or remove it",
        ));
    }
    let known = [("weak", LoadForm::Weak), ("strong", LoadForm::Strong)];
    let form = reading.choice("exact.form", written.form.as_deref().unwrap_or("weak"), &known)?;
    let scope = definitions(reading, &written.define, dimension)?;
    let u = reading.vector("exact.u", &written.u, dimension, &scope)?;
    let mut optional = |key, formula: &Option<_>| {
        formula.as_ref().map(|formula| reading.formula(key, formula, &scope)).transpose()
    };
    let multiplier = optional("exact.multiplier", &written.multiplier)?;
    let selection = optional("exact.selection", &written.selection)?;
    let friction = written.friction.as_ref();
    let friction = friction.map(|stress| stress.nodes(reading, dimension, &scope)).transpose()?;
    let interpolated = written.interpolated;
    Ok(Data::Exact { u, multiplier, selection, friction, interpolated, form })
}

fn given_loads(
    reading: &mut Reading,
    written: &written::Loads,
    domain: &Domain,
    time: &Time,
) -> Result<Data, SceneError> {
    let dimension = domain.dimension();
    let mut variables = AXES[..dimension].to_vec();
    variables.push(Variable::T);
    let scope = reading.scope(&variables);
    let body = reading.vector("loads.body", &written.body, dimension, &scope)?;
    let inside = grid(domain, time);
    finite(reading, "loads.body", &body, &inside, domain)?;
    let mut traction = Vec::new();
    for (name, formulas) in &written.traction {
        let key = format!("loads.traction.{name}");
        let side = traction_side(reading, &key, name, domain)?;
        let nodes = reading.vector(&key, formulas, dimension, &scope)?;
        finite(reading, &key, &nodes, &along(side, domain, time), domain)?;
        traction.push((side, nodes));
    }
    Ok(Data::Loads { body, traction })
}

fn traction_side(
    reading: &Reading,
    key: &str,
    name: &str,
    domain: &Domain,
) -> Result<Side, SceneError> {
    let side = domain.parse(reading, key, name)?;
    if domain.traction.contains(&side) {
        return Ok(side);
    }
    let message = format!("a traction on the side `{name}`, which is not a traction side");
    Err(reading.key_error(
        key,
        message,
        "list the side in traction = [...] of [domain], or remove its load",
    ))
}

/// Refuses a load that is infinite or undefined at a sample.
fn finite(
    reading: &Reading,
    key: &str,
    load: &[Node],
    points: &[EvaluationPoint],
    domain: &Domain,
) -> Result<(), SceneError> {
    for (index, node) in load.iter().enumerate() {
        if let Some((point, value)) = reading.first_not_finite(*node, points.iter().copied()) {
            let message = format!(
                "the load is {value} at {}, t = {}",
                place(&point, domain.dimension()),
                point.t
            );
            return Err(reading.error(
                &format!("{key}.{index}"),
                message,
                "f0 and f2 must be finite on the domain and on [0, T]",
            ));
        }
    }
    Ok(())
}

fn grid(domain: &Domain, time: &Time) -> Vec<EvaluationPoint> {
    at_all_times(&domain.points(SAMPLES), time)
}

fn along(side: Side, domain: &Domain, time: &Time) -> Vec<EvaluationPoint> {
    at_all_times(&domain.points_on(side, SAMPLES), time)
}

fn at_all_times(places: &[[f64; 3]], time: &Time) -> Vec<EvaluationPoint> {
    let times = evenly(0.0, time.horizon, SAMPLES);
    places
        .iter()
        .flat_map(|&[x, y, z]| {
            times.clone().map(move |t| EvaluationPoint { x, y, z, t, zeta: 0.0 })
        })
        .collect()
}
