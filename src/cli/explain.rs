//! `sweep explain`: what a scene requires, and the algorithm and storage that follow.

use std::collections::BTreeSet;

use clap::Args;

use super::constants::predicted_constants;
use super::list::{terms, truth};
use super::machine::Common;
use super::{
    CliError, Scenes, TABLE_WIDTH, meshes_fit, print_beside, print_json, print_text, width,
};
use fem::contact::Plan;
use run::sweep::{CasePlan, Cost, Overrides, PlanCost, ScenePlan};
use scene::setup::{Setup, Subject};
use scene::{Data, RelaxationTerm};
use studies::theory::corner::{Corner, corners};
use vhi::history::FastConvolution;
use vhi::law::INTERPOLATED_TO;

/// `sweep explain`.
#[derive(Args)]
#[command(
    after_help = "JSON keys with --json: scene, terms, truth, regions (name, eigenvalues: smallest and largest of the elasticity tensor), algorithm, rule (in time, with its weights), history, reference (n, steps, plan, seconds_predicted, memory_bytes_predicted; null without), cases (n, steps, dofs, plan: linear, condensed or newton, factorizations and solves: of the march, null where the run decides, history_bytes, norms, seconds_predicted: CPU seconds, memory_bytes_predicted: of a process that runs this case alone), corners (of a scene with given loads: place, sides, singular: the power of r with which u leaves the corner, order in h), constants (norm, variable, order, predicted: error over step^order of the leading error on the finest case, limit, not_predicted: why there is none)."
)]
pub(crate) struct Explain {
    /// Name of a scene, or path of a TOML file
    scene: String,
    #[command(flatten)]
    common: Common,
}

impl Explain {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let limit = self.common.allowance.limit();
        let plan = ScenePlan::new(scenes.subject(&self.scene, &limit)?, &Overrides::default());
        let asked = match &plan.subject {
            Subject::Contact(setup) => {
                meshes_fit(setup, &limit)?;
                Asked {
                    regions: regions(setup),
                    corners: under_loads(setup),
                    history: history(setup),
                }
            }
            Subject::Abstract(_) => Asked {
                regions: Vec::new(),
                corners: Vec::new(),
                history: "direct sum, O(n) at step n".into(),
            },
        };
        let (constants, costs) = (predicted_constants(&plan), plan.costs()?);
        let algorithm = of_meshes(&plan, &costs, |cost| algorithm(&plan.subject, cost.plan));
        let rows = plan.cases.iter().zip(&costs.cases);
        let cases: Vec<_> = rows.map(|(case, cost)| case_json(&plan, case, cost)).collect();
        let reference = plan.reference.zip(costs.reference);
        let reference = reference.map(|(run, cost)| run_json(Some(run.n), run.steps, &cost));
        let Asked { regions, corners, history } = &asked;
        let scene = plan.scene();
        if self.common.json {
            print_json(&serde_json::json!({
                "scene": scene.name,
                "terms": terms(scene),
                "truth": truth(scene),
                "regions": regions.iter().map(|(json, _)| json).collect::<Vec<_>>(),
                "algorithm": algorithm,
                "rule": scene.time.rule.in_words(),
                "history": history,
                "reference": reference,
                "cases": cases,
                "corners": corners.iter().map(row).collect::<Vec<_>>(),
                "constants": constants.iter().map(|(_, json)| json).collect::<Vec<_>>(),
            }))?;
            return Ok(0);
        }
        let constants: Vec<&str> = constants.iter().map(|(line, _)| line.as_str()).collect();
        print_in_words(&plan, &costs, &asked, (&algorithm, &constants));
        Ok(0)
    }
}

fn run_json(n: Option<u32>, steps: u32, cost: &Cost) -> serde_json::Value {
    serde_json::json!({
        "n": n,
        "steps": steps,
        "plan": cost.plan.name(),
        "seconds_predicted": cost.seconds,
        "memory_bytes_predicted": cost.memory_bytes.round() as u64,
    })
}

fn case_json(plan: &ScenePlan, case: &CasePlan, cost: &Cost) -> serde_json::Value {
    let mut json = run_json(case.n, case.steps, cost);
    json["dofs"] = cost.dofs.into();
    json["factorizations"] = cost.work.map(|[factorizations, _]| factorizations).into();
    json["solves"] = cost.work.map(|[_, solves]| solves).into();
    json["history_bytes"] = history_bytes(&plan.subject, case.steps, cost.dofs).into();
    json["norms"] = case.norms.iter().map(|norm| norm.name()).collect();
    json
}

/// Prints the scene's totals first, its cases last.
fn print_in_words(
    plan: &ScenePlan,
    costs: &PlanCost,
    Asked { regions, corners, history }: &Asked,
    (algorithm, constants): (&str, &[&str]),
) {
    let scene = plan.scene();
    let say = |label: &str, words: &str| print_beside(label, LABEL, words);
    print_beside("", 0, &format!("{}: {}", scene.name, scene.question));
    let sum = costs.cases.iter().chain(&costs.reference).map(|cost| cost.seconds).sum::<f64>();
    let all = format!("about {} of CPU time, to the order of magnitude", duration(sum));
    say("in all", &all);
    say("terms", &terms(scene).join(", "));
    say("truth", truth(scene));
    regions.iter().for_each(|(_, line)| say("region", line));
    say("algorithm", algorithm);
    say("rule", &scene.time.rule.in_words());
    say("history", history);
    if let (Some(reference), Some(cost)) = (&plan.reference, &costs.reference) {
        let [seconds, memory] = predicted(cost);
        let run = format!("n = {}, N = {}", reference.n, reference.steps);
        say("reference", &format!("{run}: about {seconds} of CPU time, {memory}"));
    }
    constants.iter().for_each(|line| say("constant", line));
    for corner in corners {
        say("corner", &corner.in_words());
    }
    if let Some(order) = corners.iter().map(Corner::order).reduce(f64::min) {
        let words = format!(
            "order in h at least {order:.4} by the corners, and (5.26) promises 1 for u in H2 alone; loads that do not excite the strongest term do better"
        );
        say("", &words);
    }
    print_text(&case_table(plan, costs));
}

struct Asked {
    regions: Vec<(serde_json::Value, String)>,
    corners: Vec<Corner>,
    history: String,
}

/// The corners of a scene with given loads; they do not matter for an exact solution.
pub(super) fn under_loads(setup: &Setup) -> Vec<Corner> {
    match &setup.body.data {
        Data::Loads { .. } => corners(&setup.body),
        Data::Exact { .. } => Vec::new(),
    }
}

fn row(corner: &Corner) -> serde_json::Value {
    serde_json::json!({
        "place": corner.place,
        "sides": corner.sides,
        "singular": corner.in_words(),
        "order": corner.order(),
    })
}

fn predicted(cost: &Cost) -> [String; 2] {
    [duration(cost.seconds), format!("{:.0} MB", cost.memory_bytes / 1e6)]
}

const LABEL: usize = 11;

/// The cases with their predicted costs.
fn case_table(plan: &ScenePlan, costs: &PlanCost) -> String {
    let row = |(case, cost): (&CasePlan, &Cost)| {
        let history = history_bytes(&plan.subject, case.steps, cost.dofs);
        let n = case.n.map_or_else(|| "-".into(), |n| n.to_string());
        let numbers = [n, case.steps.to_string(), cost.dofs.to_string()];
        let [seconds, memory] = predicted(cost);
        numbers.into_iter().chain([seconds, memory, history.to_string()]).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<String>> = plan.cases.iter().zip(&costs.cases).map(row).collect();
    let heads = [">n", ">N", ">unknowns", ">CPU time", ">memory", ">bytes of history"];
    report::text_table(&heads, &rows, width(TABLE_WIDTH))
}

/// A property common to all runs, or the meshes with each value of it.
fn of_meshes(plan: &ScenePlan, costs: &PlanCost, words: impl Fn(&Cost) -> &'static str) -> String {
    let mesh_sizes = plan.cases.iter().map(|case| case.n.unwrap_or_default());
    let ns = mesh_sizes.chain(plan.reference.map(|reference| reference.n));
    let mut found: Vec<(&'static str, BTreeSet<u32>)> = Vec::new();
    for (n, cost) in ns.zip(costs.cases.iter().chain(&costs.reference)) {
        let name = words(cost);
        match found.iter_mut().find(|(known, _)| *known == name) {
            Some((_, meshes)) => _ = meshes.insert(n),
            None => found.push((name, BTreeSet::from([n]))),
        }
    }
    if let [(name, _)] = found[..] {
        return name.to_string();
    }
    let each = found.iter().map(|(name, meshes)| {
        let list: Vec<String> = meshes.iter().map(u32::to_string).collect();
        format!("{name} for n = {}", list.join(", "))
    });
    each.collect::<Vec<_>>().join("; ")
}

/// Bytes of the vectors of unknowns in a history.
fn history_bytes(subject: &Subject, steps: u32, dofs: usize) -> usize {
    let vectors = match subject {
        Subject::Contact(setup) => setup.history_vectors(steps),
        Subject::Abstract(_) => steps as usize + 1,
    };
    vectors * dofs * size_of::<f64>()
}

pub(super) fn duration(seconds: f64) -> String {
    if seconds < 1.0 { format!("{:.1} ms", 1e3 * seconds) } else { format!("{seconds:.1} s") }
}

fn algorithm(subject: &Subject, plan: Plan) -> &'static str {
    let Subject::Contact(setup) = subject else {
        return "semismooth Newton with active set, dense LU";
    };
    let model = &setup.model;
    match plan {
        Plan::Linear if Plan::changes_factor(model) => {
            "linear: one Cholesky factor for each weight of the last slot (two on equal steps by the trapezoidal rule), one solve per level"
        }
        Plan::Linear => {
            "linear, memory a multiple of the elasticity or absent: one Cholesky factor, one solve per level"
        }
        Plan::Condensed if Plan::changes_factor(model) => {
            "contact condensed onto Gamma3: one Cholesky factor for each weight of the last slot (two on equal steps by the trapezoidal rule), semismooth Newton with active set on the unknowns of Gamma3, one solve per level in the volume"
        }
        Plan::Condensed => {
            "contact condensed onto Gamma3: one Cholesky factor, semismooth Newton with active set on the unknowns of Gamma3, one solve per level in the volume"
        }
        Plan::Newton if model.projection.is_none() => {
            "semismooth Newton with active set; the Cholesky factor is kept while the active set stays, and preconditions BiCGStab after"
        }
        Plan::Newton => {
            "semismooth Newton with active set, rank-one zeta piece; a Cholesky factor preconditions BiCGStab until its extra iterations have cost a new one"
        }
    }
}

/// The named regions with the extreme eigenvalues of 𝒜, and the rest of the body.
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
    let trapezoidal = setup.model.time_rule.is_trapezoidal();
    let of_term = |memory: &RelaxationTerm| match &memory.exponentials {
        Some(terms) if trapezoidal => {
            format!("recursion, {} exponential(s), O(1) per step", terms.len())
        }
        None if trapezoidal => format!(
            "direct trapezoidal sum, O(n) at step n; from {} steps on O(1) per step by interpolation of the kernel to {INTERPOLATED_TO:.0e}, where it is smooth",
            FastConvolution::foreseen_from(INTERPOLATED_TO)
        ),
        _ => "direct sum by the rule's own weights, O(n) at step n".into(),
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
