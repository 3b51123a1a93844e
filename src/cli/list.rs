//! `sweep list`: the scenes with their terms and predicted orders.

use clap::Args;

use super::{CliError, Scenes, print_json, print_text};
use crate::scene::{Body, Data, Scene};

/// `sweep list`.
#[derive(Args)]
#[command(
    after_help = "JSON keys with --json: name, question, terms, truth, predicts, long, judge."
)]
pub struct List {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl List {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let all = scenes.select(&[])?;
        if self.json {
            let rows: Vec<_> = all.iter().map(row).collect();
            print_json(&serde_json::Value::Array(rows))?;
            return Ok(0);
        }
        for scene in &all {
            print_text(&format!("{:<16} {}", scene.name, scene.question));
            print_text(&format!("{:<16} terms: {}; {}", "", terms(scene).join(", "), truth(scene)));
            let orders = predictions(scene);
            let orders =
                if orders.is_empty() { "nothing judged".into() } else { orders.join("; ") };
            print_text(&format!("{:<16} {orders}", ""));
        }
        Ok(0)
    }
}

fn row(scene: &Scene) -> serde_json::Value {
    serde_json::json!({
        "name": scene.name,
        "question": scene.question,
        "terms": terms(scene),
        "truth": truth(scene),
        "predicts": predictions(scene),
        "long": scene.long,
        "judge": scene.judge,
    })
}

/// The terms of (5.1)-(5.5) that a scene has.
pub fn terms(scene: &Scene) -> Vec<&'static str> {
    let Some(body) = scene.as_contact() else { return abstract_terms(scene) };
    let contact = body.contact.as_ref();
    let present = [
        (true, "elasticity"),
        (!body.material.regions.is_empty(), "regions"),
        (body.material.is_anisotropic(), "anisotropy"),
        (!body.material.memory.is_empty(), "memory"),
        (body.material.memory.len() > 1, "several kernels"),
        (body.material.projection.is_some(), "projection"),
        (contact.is_some_and(|c| c.law.is_some()), "compliance"),
        (contact.is_some_and(|c| c.gap.is_some()), "gap"),
        (contact.is_some_and(|c| c.shift.is_some()), "shift"),
    ];
    present.into_iter().filter(|(has, _)| *has).map(|(_, name)| name).collect()
}

/// The terms of Problem 1 that an abstract scene has.
fn abstract_terms(scene: &Scene) -> Vec<&'static str> {
    let Body::Abstract(problem) = &scene.body else { return Vec::new() };
    let traces = &problem.traces;
    let present = [
        (problem.nonlinear.is_none(), "linear operator"),
        (problem.nonlinear.is_some(), "nonlinear operator"),
        (!problem.kernels.is_empty(), "history"),
        (problem.force.is_some(), "nonlinear phi"),
        (traces.iter().any(|trace| trace.law.is_some()), "j"),
        (traces.iter().any(|trace| trace.is_bounded()), "constraint"),
    ];
    present.into_iter().filter(|(has, _)| *has).map(|(_, name)| name).collect()
}

/// What errors are measured against.
pub fn truth(scene: &Scene) -> &'static str {
    let Some(body) = scene.as_contact() else { return "exact solution" };
    match &body.data {
        Data::Exact { interpolated: true, .. } => "exact solution in V^h",
        Data::Exact { .. } => "exact solution",
        Data::Loads { .. } => "given loads, reference run",
    }
}

fn predictions(scene: &Scene) -> Vec<String> {
    let line = |p: &crate::scene::Prediction| {
        let variable = match p.variable {
            crate::scene::Direction::H => "h",
            crate::scene::Direction::K => "k",
            crate::scene::Direction::Joint => "h and k",
            crate::scene::Direction::Path => "h on the path",
        };
        format!("{} in {variable}: order {}, by {}", p.norm.name(), p.order, p.why)
    };
    scene.predicts.iter().map(line).collect()
}
