//! Cases beyond a scene's grid, added where a verdict names those that would decide it.

use serde::{Deserialize, Serialize};

use super::ScenePlan;
use judge::verdict::{Decision, MeshAndSteps, Verdict};
use scene::setup::SetupError;

/// Rounds of extension per directory. Each refines once; an order that three refinements do not settle needs another
/// scene.
pub const ROUNDS: u32 = 3;

/// An added case with the verdict that asked for it; kept with the records, for resuming and judging.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AddedCase {
    #[serde(flatten)]
    pub case: MeshAndSteps,
    /// 1, 2, …
    pub round: u32,
    /// The open verdict, and why it was open.
    pub why: String,
}

/// What one round does.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// The case is added to the plan of its scene.
    Add {
        scene: String,
        case: MeshAndSteps,
        seconds: f64,
        /// The verdict that asks for it.
        why: String,
    },
    /// Nothing is run.
    Leave { scene: String, why: String },
}

/// Adds to `plans` the cases that open verdicts ask for, while the predicted cost of all added cases stays below
/// `budget` (CPU seconds). Returns a step for every open verdict.
///
/// # Errors
/// A mesh whose cost cannot be predicted.
pub fn extend(
    plans: &mut [ScenePlan],
    verdicts: &[Verdict],
    budget: f64,
) -> Result<Vec<Step>, SetupError> {
    let round = 1 + plans.iter().flat_map(|plan| &plan.added).map(|a| a.round).max().unwrap_or(0);
    let mut left = budget;
    for plan in plans.iter() {
        let added = plan.added.iter().map(|added| case_seconds(plan, &added.case));
        left -= added.sum::<Result<f64, _>>()?;
    }
    let mut steps = Vec::new();
    let open = |v: &&Verdict| v.decision == Decision::Unresolved && !v.as_expected();
    for verdict in verdicts.iter().filter(open) {
        let scene = verdict.scene.clone();
        let Some(plan) = plans.iter_mut().find(|plan| plan.scene().name == scene) else { continue };
        let named = |why: &str| format!("{} in {}: {why}", verdict.norm, verdict.variable.name());
        let leave = |why: String| Step::Leave { scene: scene.clone(), why: named(&why) };
        if verdict.next.is_empty() {
            steps.push(leave(format!("no case would help: {}", verdict.reason)));
            continue;
        }
        if round > ROUNDS {
            steps.push(leave(format!("still open after {ROUNDS} rounds: {}", verdict.reason)));
            continue;
        }
        let new: Vec<MeshAndSteps> =
            verdict.next.iter().copied().filter(|case| !plan.has(case)).collect();
        for case in new {
            let ns: Vec<u32> = case.n.into_iter().collect();
            if let Err(error) = plan.scene().check_cases(&ns, &[case.steps]) {
                let error = error.to_string();
                let reason = error.lines().next().unwrap_or_default();
                steps.push(leave(format!("{case} cannot be run: {reason}")));
                continue;
            }
            let why = named(&verdict.reason);
            plan.add(AddedCase { case, round, why: why.clone() });
            let seconds = case_seconds(plan, &case)?;
            if seconds > left {
                plan.remove(&case);
                steps.push(leave(format!(
                    "{case} would take about {seconds:.1} s of CPU time, {:.1} s are left of the budget",
                    left.max(0.0)
                )));
                continue;
            }
            left -= seconds;
            steps.push(Step::Add { scene: scene.clone(), case, seconds, why });
        }
    }
    Ok(steps)
}

/// Predicted CPU seconds of one case of a plan, including its reference run, which no record keeps.
fn case_seconds(plan: &ScenePlan, case: &MeshAndSteps) -> Result<f64, SetupError> {
    let costs = plan.costs()?;
    let of_case = plan.cases.iter().zip(&costs.cases);
    let of_case = of_case.filter(|(of_case, _)| of_case.place() == *case);
    Ok(costs.reference_seconds() + of_case.map(|(_, cost)| cost.seconds).sum::<f64>())
}
