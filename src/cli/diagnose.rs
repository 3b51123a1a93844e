//! `sweep diagnose`: finds the term whose removal restores the expected behaviour.

use clap::Args;

use super::machine::{Common, processors, share_threads};
use super::{CliError, Scenes, print_json, print_text, verdict_table, width};
use files::counted;
use studies::diagnose::{EXACT_WITHIN, Finding, Outcome, Question, admit_diagnosis, diagnose};

const WIDTH: u16 = 100;

/// `sweep diagnose`.
#[derive(Args)]
#[command(
    after_help = "Exit code: 0 nothing to diagnose, or with --always nothing found; 1 a verdict is not as expected, or a trial fails; 2 the scene cannot be diagnosed.\n\nJSON keys with --json: scene, verdicts (as in verdict.json), trials (name, terms, removed, question: \"order\" or \"exact\", verdict, observed, interval, predicted, norm, error: relative, reason, suspects), culprits (names of terms, or prediction), sentence."
)]
pub(crate) struct DiagnoseCommand {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Run the trials even if every verdict is as expected
    #[arg(long)]
    always: bool,
    #[command(flatten)]
    common: Common,
}

impl DiagnoseCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        share_threads()?;
        let scene = scenes.scene(&self.scene)?;
        admit_diagnosis(&scene, processors(), &self.common.allowance.limit())?;
        let cases = scene.sweep.as_ref().map_or(0, |sweep| sweep.n.len() * sweep.steps.len());
        super::progress::note(&format!(
            "running {} of the scene, then its variants",
            counted(cases, "case")
        ));
        let diagnosis = diagnose(&scene, &|setup| setup, self.always)?;
        if self.common.json {
            print_json(&serde_json::json!({
                "scene": diagnosis.scene,
                "verdicts": diagnosis.verdicts,
                "trials": diagnosis.outcomes,
                "culprits": diagnosis.finding.as_ref().map_or(Vec::new(), Finding::culprits),
                "sentence": diagnosis.sentence,
            }))?;
        } else {
            if !diagnosis.verdicts.is_empty() {
                print_text(&verdict_table(&diagnosis.verdicts));
            }
            if !diagnosis.outcomes.is_empty() {
                print_text(&trials(&diagnosis.outcomes));
            }
            print_text(&diagnosis.sentence);
        }
        let judged = diagnosis.verdicts.iter().all(|verdict| verdict.as_expected());
        let quiet = matches!(diagnosis.finding, None | Some(Finding::NothingFails));
        Ok(u8::from(!(judged && quiet)))
    }
}

fn trials(outcomes: &[Outcome]) -> String {
    let row = |of: &Outcome| {
        vec![of.name.clone(), of.terms.clone(), asked(of), observed(of), of.decision.name().into()]
    };
    let rows: Vec<Vec<String>> = outcomes.iter().map(row).collect();
    let heads = ["trial", "terms", "must show", "observed", "verdict"];
    report::text_table(&heads, &rows, width(WIDTH))
}

/// What a trial had to show.
fn asked(outcome: &Outcome) -> String {
    match (&outcome.question, &outcome.norm, outcome.predicted.zip(outcome.variable)) {
        (Question::Exact, ..) => format!("error below {EXACT_WITHIN:.0e}"),
        (Question::Order, Some(norm), Some((order, variable))) => {
            format!("{norm} order ≥ {order} in {}", variable.name())
        }
        _ => "an order".into(),
    }
}

/// What it showed: an order with its interval, a relative error with its norm, or why neither.
fn observed(outcome: &Outcome) -> String {
    match (&outcome.norm, outcome.error, outcome.observed.zip(outcome.interval)) {
        (Some(norm), Some(relative), _) => format!("{norm} {relative:.1e}"),
        (.., Some((order, [lo, hi]))) => format!("{order:.2} [{lo:.2}, {hi:.2}]"),
        _ => outcome.reason.clone(),
    }
}
