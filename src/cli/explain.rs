//! `sweep explain`: what a scene requires, and which algorithm and storage that selects.

use clap::Args;

use super::list::{terms, truth};
use super::{CliError, Scenes, abstract_problem, print_json, print_text};
use crate::setup::{Setup, Subject};
use crate::sweep::{Overrides, ScenePlan};

/// `sweep explain`.
#[derive(Args)]
#[command(
    after_help = "JSON keys with --json: scene, terms, truth, algorithm, history, cases (n, steps, dofs, history_bytes, norms)."
)]
pub struct Explain {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Explain {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let plan = ScenePlan::new(scenes.subject(&self.scene)?, &Overrides::default());
        let Subject::Contact(setup) = &plan.subject else {
            return abstract_problem::explain(&plan, self.json);
        };
        let (algorithm, history) = (algorithm(setup), history(setup));
        let cases: Vec<_> = plan
            .cases
            .iter()
            .map(|case| {
                let dofs = case.n.map_or(0, |n| unknowns(setup, n));
                serde_json::json!({
                    "n": case.n,
                    "steps": case.steps,
                    "dofs": dofs,
                    "history_bytes": history_vectors(setup, case.steps) * dofs * 8,
                    "norms": case.norms.iter().map(|norm| norm.name()).collect::<Vec<_>>(),
                })
            })
            .collect();
        if self.json {
            print_json(&serde_json::json!({
                "scene": setup.scene.name,
                "terms": terms(&setup.scene),
                "truth": truth(&setup.scene),
                "algorithm": algorithm,
                "history": history,
                "cases": cases,
            }))?;
            return Ok(0);
        }
        print_text(&format!("{}: {}", setup.scene.name, setup.scene.question));
        print_text(&format!("terms      {}", terms(&setup.scene).join(", ")));
        print_text(&format!("truth      {}", truth(&setup.scene)));
        print_text(&format!("algorithm  {algorithm}"));
        print_text(&format!("history    {history}"));
        for case in &cases {
            print_text(&format!(
                "case       n = {}, N = {}: {} unknowns, {} bytes of history",
                case["n"], case["steps"], case["dofs"], case["history_bytes"]
            ));
        }
        Ok(0)
    }
}

fn algorithm(setup: &Setup) -> &'static str {
    let model = &setup.model;
    if model.is_linear() && (model.memory.is_none() || model.memory_multiple().is_some()) {
        "linear, memory a multiple of the elasticity: one factorization; loads that separate in time are solved once"
    } else if model.is_linear() {
        "linear: one factorization, one solve a step"
    } else if model.projection.is_none() {
        "semismooth Newton with active set; the factor is reused while the active set stays"
    } else {
        "semismooth Newton with active set, rank-one zeta piece; one factorization a step, reused by GMRES"
    }
}

fn history(setup: &Setup) -> String {
    match &setup.body.material.memory {
        None => "none".into(),
        Some(memory) => match &memory.exponentials {
            Some(terms) => format!("recursion, {} exponential(s), O(1) a step", terms.len()),
            None => "direct trapezoidal sum, O(n) at step n".into(),
        },
    }
}

/// Vectors of unknowns held for the history after N steps.
fn history_vectors(setup: &Setup, steps: u32) -> usize {
    match &setup.body.material.memory {
        None => 0,
        Some(memory) => memory.exponentials.as_ref().map_or(steps as usize + 1, |t| t.len() + 1),
    }
}

/// Unknowns of the rectangle: two a vertex that is not clamped (by counting sides).
fn unknowns(setup: &Setup, n: u32) -> usize {
    setup.space(n).map_or(0, |space| space.dofs())
}
