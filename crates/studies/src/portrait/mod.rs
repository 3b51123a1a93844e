//! A scene as a report shows it: equations, data and remarks.

mod picture;

pub use picture::scene_picture;

use report::{Group, SceneSummary, StepLimits, Terms, equations};
use scene::setup::{Subject, subject_bounds};
use scene::{Body, Data, Expectation, Scene};

/// Parts of a scene file that a report shows elsewhere.
const SAID_ELSEWHERE: [&str; 2] = ["scene", "predicts"];

/// A scene's summary for a report; without a subject, the step size is omitted.
pub fn scene_summary(scene: &Scene, subject: Option<&Subject>) -> SceneSummary {
    SceneSummary {
        name: scene.name.clone(),
        question: scene.question.clone(),
        group: Group::of(terms(scene), is_about_a_hypothesis(scene)),
        remarks: remarks(scene),
        // If the body cannot be drawn, the picture is omitted.
        picture: Some(scene_picture(scene)),
        equations: equations(terms(scene)),
        data: data(&scene.source.text),
        violates: scene.violates.iter().map(|hypothesis| hypothesis.name().to_owned()).collect(),
        step: subject.and_then(step),
    }
}

/// Whether a scene breaks a hypothesis or reaches its limit: the limiting scenes of docs/BROKEN-HYPOTHESES.md are named
/// after the others and read beside them.
fn is_about_a_hypothesis(scene: &Scene) -> bool {
    !scene.violates.is_empty() || scene.name.starts_with("broken-")
}

/// The bounds on the step size, without a solve in time.
fn step(subject: &Subject) -> Option<StepLimits> {
    let bounds = subject_bounds(subject).ok()?;
    Some(StepLimits {
        m0: bounds.m0,
        paper: bounds.paper_limit(),
        theorem: bounds.limit(),
        sharpened: bounds.sharpened_limit(),
        solvable: bounds.solvable_limit(),
    })
}

fn terms(scene: &Scene) -> Terms {
    match &scene.body {
        Body::Contact(body) => Terms {
            is_abstract: false,
            projection: body.material.projection.is_some(),
            memory: !body.material.memory.is_empty(),
            contact: body.contact.is_some(),
            gap: body.contact.as_ref().is_some_and(|contact| contact.gap.is_some()),
            law: body.law().is_some(),
            friction: body.friction().is_some(),
            quadratic: body.element.degree() > 1,
        },
        Body::Abstract(problem) => {
            Terms { is_abstract: true, memory: !problem.kernels.is_empty(), ..Terms::default() }
        }
    }
}

fn remarks(scene: &Scene) -> Vec<String> {
    let truth = match scene.as_contact().map(|body| &body.data) {
        Some(Data::Loads { .. }) => {
            "The loads are given and no solution is known, so errors are measured against a run on a finer grid."
        }
        Some(Data::Exact { interpolated: true, .. }) => {
            "The exact solution is the nodal interpolant of a known displacement on each mesh, so all errors are errors in time."
        }
        Some(Data::Exact { .. }) => {
            "The solution is known in closed form; the loads are derived from it."
        }
        None => "The solution is known; the problem has no body and no mesh.",
    };
    let mut remarks = vec![truth.to_owned()];
    remarks.extend(match (scene.judge, scene.expect) {
        (false, _) => Some("It is measured but not judged, because the theory promises no order here.".into()),
        (true, Expectation::Pass) => None,
        (true, Expectation::Fail) => {
            Some("This scene shows that the predicted order is not reached, so the expected verdict is fail.".into())
        }
        (true, Expectation::Unresolved) => {
            Some("Its cases cannot decide, so the expected verdict is unresolved.".into())
        }
    });
    remarks
}

/// The keys of a scene file in order, with their values as written.
fn data(text: &str) -> Vec<[String; 3]> {
    // Parsed and validated before.
    let Ok(table) = text.parse::<toml::Table>() else { return Vec::new() };
    let mut rows = Vec::new();
    for (part, value) in &table {
        if !SAID_ELSEWHERE.contains(&part.as_str()) {
            collect(part, value, &mut rows);
        }
    }
    rows
}

/// Tables become parts `a.b`; everything else is a value.
fn collect(part: &str, value: &toml::Value, rows: &mut Vec<[String; 3]>) {
    match value {
        toml::Value::Table(table) => {
            let (nested, values): (Vec<_>, Vec<_>) =
                table.iter().partition(|(_, value)| is_part(value));
            rows.extend(
                values.iter().map(|(key, value)| [part.into(), (*key).clone(), written(value)]),
            );
            nested.iter().for_each(|(key, value)| collect(&format!("{part}.{key}"), value, rows));
        }
        toml::Value::Array(parts) => {
            for (index, value) in parts.iter().enumerate() {
                collect(&format!("{part} {}", index + 1), value, rows);
            }
        }
        other => rows.push([part.into(), String::new(), written(other)]),
    }
}

/// A table with more than a few keys, or a list of tables; small tables stay on one line.
fn is_part(value: &toml::Value) -> bool {
    match value {
        toml::Value::Table(table) => !table.contains_key("kind"),
        toml::Value::Array(values) => values.iter().any(toml::Value::is_table),
        _ => false,
    }
}

/// A formula without its quotes, anything else as TOML spells it.
fn written(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_are_the_keys_of_the_file() {
        let text = "[scene]\nname = \"a\"\n[time]\nhorizon = 1.0\ngrid = { kind = \"uniform\" }\n[material.memory]\nkernel = \"-exp(-t)\"\n\
                    [[material.region]]\nname = \"stiff\"\n[[predicts]]\norder = 1.0\n";
        let rows = data(text);
        let has = |row: [&str; 3]| rows.contains(&row.map(str::to_owned));
        assert!(has(["time", "horizon", "1.0"]) && has(["material.memory", "kernel", "-exp(-t)"]));
        assert!(has(["material.region 1", "name", "stiff"]), "{rows:?}");
        assert!(rows.iter().any(|[_, key, value]| key == "grid" && value.contains("uniform")));
        assert_eq!(rows.len(), 4, "{rows:?}");
    }
}
