//! `sweep explain`: what a scene requires, and which algorithm and storage that selects.

use clap::Args;

use super::constants::predicted_constants;
use super::list::{terms, truth};
use super::{CliError, Scenes, abstract_problem, print_json, print_text};
use crate::scene::Memory;
use crate::setup::{Setup, Subject};
use crate::sweep::{Cost, Overrides, ScenePlan, predict};

/// `sweep explain`.
#[derive(Args)]
#[command(
    after_help = "JSON keys with --json: scene, terms, truth, regions (name, eigenvalues: smallest and largest of the elasticity tensor), algorithm, history, reference (n, steps, seconds_predicted, memory_bytes_predicted; null without), cases (n, steps, dofs, history_bytes, norms, seconds_predicted: CPU seconds, memory_bytes_predicted: of a process that runs this case alone), constants (norm, variable, order, predicted: error over step^order of the leading error on the finest case, limit, not_predicted: why there is none)."
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
        let constants = predicted_constants(&plan);
        let (algorithm, history, regions) = (algorithm(setup), history(setup), regions(setup));
        let costs = predict(setup, &plan)?;
        let cases: Vec<_> = plan
            .cases
            .iter()
            .zip(&costs.cases)
            .map(|(case, cost)| {
                serde_json::json!({
                    "n": case.n,
                    "steps": case.steps,
                    "dofs": cost.dofs,
                    "history_bytes": setup.history_vectors(case.steps) * cost.dofs * 8,
                    "norms": case.norms.iter().map(|norm| norm.name()).collect::<Vec<_>>(),
                    "seconds_predicted": cost.seconds,
                    "memory_bytes_predicted": cost.memory_bytes.round() as u64,
                })
            })
            .collect();
        let reference = plan.reference.zip(costs.reference).map(|(reference, cost)| {
            serde_json::json!({
                "n": reference.n,
                "steps": reference.steps,
                "seconds_predicted": cost.seconds,
                "memory_bytes_predicted": cost.memory_bytes.round() as u64,
            })
        });
        if self.json {
            print_json(&serde_json::json!({
                "scene": setup.scene.name,
                "terms": terms(&setup.scene),
                "truth": truth(&setup.scene),
                "regions": regions.iter().map(|(json, _)| json).collect::<Vec<_>>(),
                "algorithm": algorithm,
                "history": history,
                "reference": reference,
                "cases": cases,
                "constants": constants.iter().map(|(_, json)| json).collect::<Vec<_>>(),
            }))?;
            return Ok(0);
        }
        print_text(&format!("{}: {}", setup.scene.name, setup.scene.question));
        print_text(&format!("terms      {}", terms(&setup.scene).join(", ")));
        print_text(&format!("truth      {}", truth(&setup.scene)));
        regions.iter().for_each(|(_, line)| print_text(&format!("region     {line}")));
        print_text(&format!("algorithm  {algorithm}"));
        print_text(&format!("history    {history}"));
        if let (Some(reference), Some(cost)) = (&reference, &costs.reference) {
            let run = format!("n = {}, N = {}", reference["n"], reference["steps"]);
            print_text(&format!("reference  {run}: {}", predicted(cost)));
        }
        for (case, cost) in cases.iter().zip(&costs.cases) {
            print_text(&format!(
                "case       n = {}, N = {}: {} unknowns, {} bytes of history; {}",
                case["n"],
                case["steps"],
                cost.dofs,
                case["history_bytes"],
                predicted(cost)
            ));
        }
        constants.iter().for_each(|(line, _)| print_text(line));
        let sum = costs.cases.iter().chain(&costs.reference).map(|cost| cost.seconds).sum::<f64>();
        print_text(&format!(
            "in all     about {} of CPU time, good to a factor of about 3",
            duration(sum)
        ));
        Ok(0)
    }
}

fn predicted(cost: &Cost) -> String {
    format!("about {} of CPU time, {:.0} MB", duration(cost.seconds), cost.memory_bytes / 1e6)
}

fn duration(seconds: f64) -> String {
    if seconds < 1.0 { format!("{:.1} ms", 1e3 * seconds) } else { format!("{seconds:.1} s") }
}

fn algorithm(setup: &Setup) -> &'static str {
    let model = &setup.model;
    if model.is_linear() && (model.memory.is_empty() || model.memory_multiple().is_some()) {
        "linear, memory a multiple of the elasticity: one factorization; loads that separate in time are solved once"
    } else if model.is_linear() {
        "linear: one factorization, one solve a step"
    } else if model.projection.is_none() {
        "semismooth Newton with active set; the factor is reused while the active set stays"
    } else {
        "semismooth Newton with active set, rank-one zeta piece; one factorization a step, reused by GMRES"
    }
}

/// The named regions with the extreme eigenvalues of 𝒜 there, and what lies outside all of them.
fn regions(setup: &Setup) -> Vec<(serde_json::Value, String)> {
    let material = &setup.body.material;
    if material.regions.is_empty() {
        return Vec::new();
    }
    let named = material.regions.iter().map(|region| (region.name.as_str(), &region.elastic));
    let all = std::iter::once(("elsewhere", &material.elastic)).chain(named);
    all.map(|(name, elastic)| {
        let (low, high) = elastic.eigenvalues(setup.scene.dimension);
        let line =
            format!("{name}: eigenvalues of the elasticity tensor from {low:.4} to {high:.4}");
        (serde_json::json!({ "name": name, "eigenvalues": [low, high] }), line)
    })
    .collect()
}

fn history(setup: &Setup) -> String {
    let of_term = |memory: &Memory| match &memory.exponentials {
        Some(terms) => format!("recursion, {} exponential(s), O(1) a step", terms.len()),
        None => "direct trapezoidal sum, O(n) at step n".into(),
    };
    match &setup.body.material.memory[..] {
        [] => "none".into(),
        [memory] => of_term(memory),
        terms => {
            let each: Vec<String> = terms.iter().map(of_term).collect();
            format!("{} terms: {}", terms.len(), each.join("; "))
        }
    }
}
