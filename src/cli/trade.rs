//! `sweep trade`: speed against accuracy over the settings of a scene, and the cheapest run with an error.

use std::convert::Infallible;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use serde_json::Value;

use super::machine::Common;
use super::study::write;
use super::target::Wanted;
use super::{CliError, Scenes, create_dir, print_json, print_text, width};
use report::StudyDocument;
use run::sweep::{Overrides, ScenePlan};
use scene::setup::Setup;
use scene::{Change, Extension, Scene};
use studies::trade::{
    Answered, Bench, Study, Table, TradeRuns, Trial, admit_trade, element_meshes, elements,
    scene_grid,
};

/// `sweep trade`.
#[derive(Args)]
#[command(
    after_help = "Each case is run once from nothing (mesh, analysis, loads, march): its error and its CPU seconds, those of one thread of this machine, without what measures the error. Settings beside h and k are those that the scene file may say otherwise, changed one at a time on three cases; times of two runs that differ by less than 1.25 times are no difference. docs/TRADE.md explains every number.\n\nFiles in --out: SCENE-trade.csv (a row as soon as its case ends; failures have status `failed`), SCENE-trade.json, SCENE-trade.svg (error against time).\n\nJSON keys with --json: scene, fingerprint (of its text), norm, size (largest strain norm of the truth), trials (change: what is different from the scene as written, n, steps, h, k, dofs, error, floor, cpu_seconds, load_share, predicted_bytes, history_bytes, newton_iterations, factorizations, status, reason, tie: a setting that moves neither time by 1.25 times nor error by 1 %, front: no run is as good in time and error and better in one, errors within 1 % being one), error_model (model, space and time with constant, order, interval; source, residual), cost_model (parts: seconds per run, per cell, per cell and level, per operation of a factorization, per operation and level; residual), coupling (exponent, factor, space_share, cost_exponent), prices (what, n, steps, speed, error, bytes, words), extrapolation (what, step, rows, orders: last, interval), elements (the other elements: change, their error_model and cost_model, equal_error: error, the cheapest runs as_written and rival, speed, extrapolates; words), answer (target, n, steps, h, k, change, error, cpu_seconds, bytes, extrapolates), confirmed (error, cpu_seconds, ratios: predicted over real). Exit code 2: no error can be measured, or none of the wanted size is in reach."
)]
pub(crate) struct TradeCommand {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Cells per unit length [default: the scene's, completed to three and cut to --budget]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=4096))]
    n: Option<Vec<u32>>,
    /// Numbers N of time steps [default: likewise]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<Vec<u32>>,
    /// Norm of the errors: V_max, L2_max, trace_L2_max, pressure_L2_max or stress_L2_max
    #[arg(long, default_value = "V_max")]
    norm: String,
    /// Predicted CPU seconds that the grid may take; the settings may take as much again
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    budget: f64,
    /// Say which n, N and setting reach this error at least cost; `1%` is a hundredth of the largest
    /// strain norm of the truth (V_max alone), a plain number is an error in the norm
    #[arg(long, value_name = "E")]
    target: Option<String>,
    /// Run the answer and print predicted against real
    #[arg(long, requires = "target")]
    confirm: bool,
    #[command(flatten)]
    common: Common,
    /// Directory for table, JSON and picture
    #[arg(long, value_name = "DIR", default_value = "reports/latest/trade")]
    out: PathBuf,
}

#[derive(Serialize)]
struct Found<'a> {
    #[serde(flatten)]
    study: &'a Study,
    #[serde(skip_serializing_if = "Option::is_none")]
    answer: Option<Answered>,
    #[serde(skip_serializing_if = "Option::is_none")]
    confirmed: Option<Value>,
}

impl TradeCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let scene = scenes.scene(&self.scene)?;
        let limit = self.common.allowance.limit();
        let why = "its extrapolation takes the order of the time rule for granted";
        scene.without(&[Extension::SingularKernel], "sweep trade", why)?;
        let setup = measurable(&scene)?;
        let wanted = Wanted::read(&setup, &self.norm, self.target.as_deref())?;
        let mut plan = self.plan(&setup)?;
        self.admit(&scene, &plan.n, &plan.steps)?;
        plan.elements = self.elements(&plan, &setup)?;
        let mut bench = Bench::new(setup, wanted.norm)?;
        create_dir(&self.out)?;
        let path = self.out.join(format!("{}-trade.csv", scene.name));
        let table =
            Table::create(path.clone(), &scene.name, wanted.norm).map_err(CliError::other)?;
        let mut heard = |trial: &Trial| super::progress::note(&row(trial));
        let study = Study::run(&mut bench, &plan, &table, &mut heard).map_err(CliError::other)?;
        let mut document = study.document(None);
        let mut found = Found { study: &study, answer: None, confirmed: None };
        // Measurements are on disk before a target can be refused.
        write(&found, &document, Some(&self.out))?;
        let say = |text: &str| {
            if !self.common.json {
                print_text(text);
            }
        };
        let answer =
            wanted.error(study.size).map(|target| Answered::new(&bench, &study, target, &limit));
        let confirmed = match &answer {
            Some(Ok(answer)) => {
                document = study.document(Some(answer));
                document.answer(answer.words(&study));
                self.confirm.then(|| self.confirm(&scene, answer, &mut bench)).transpose()
            }
            _ => Ok(None),
        };
        if let Ok(Some((words, _))) = &confirmed {
            document.below_answer(words);
        }
        // The words are complete even if the answer is refused, or its run.
        say(&document.text(width(StudyDocument::WIDTH)));
        let none = |none| CliError::other(format!("no answer: {none}"));
        if let Some(answer) = answer.transpose().map_err(none)? {
            found.answer = Some(answer);
            found.confirmed = confirmed?.map(|(_, real)| real);
            write(&found, &document, Some(&self.out))?;
        }
        if self.common.json {
            print_json(&found)?;
        }
        say(&format!("table: {}", path.display()));
        Ok(0)
    }

    /// Runs the answer: predicted against real, in words and for JSON.
    fn confirm(
        &self,
        scene: &Scene,
        answer: &Answered,
        bench: &mut Bench,
    ) -> Result<(String, Value), CliError> {
        let Answered { choice, change, .. } = answer;
        self.admit(&change.of(scene)?, &[choice.n], &[choice.steps])?;
        let mut found = None;
        let Ok(()) = bench.runs(change, choice.n, &[choice.steps], &mut |trial| {
            found = Some(trial.outcome);
            Ok::<(), Infallible>(())
        });
        let run = found.unwrap_or_else(|| Err("no run".into()));
        let run = run.map_err(|why| CliError::other(format!("the answer does not run: {why}")))?;
        let ratios = [choice.error / run.error, choice.seconds / run.seconds];
        let [error, seconds] = ratios.map(|ratio| format!("{:+.0} %", 100.0 * (ratio - 1.0)));
        let words = format!(
            "real: error {:.4e} ({error}), {:.3} CPU s ({seconds}); in brackets: predicted over real, less one",
            run.error, run.seconds
        );
        let real = serde_json::json!({
            "error": run.error,
            "cpu_seconds": run.seconds,
            "ratios": { "error": ratios[0], "cpu_seconds": ratios[1] },
        });
        Ok((words, real))
    }

    /// Refuses cases of a scene that do not fit into memory.
    fn admit(&self, scene: &Scene, n: &[u32], steps: &[u32]) -> Result<(), CliError> {
        let overrides = Overrides { n: Some(n.to_vec()), steps: Some(steps.to_vec()) };
        let limit = self.common.allowance.limit();
        let plan = ScenePlan::new(super::subject(scene.clone(), &limit)?, &overrides);
        Ok(admit_trade(&plan, &limit)?)
    }

    /// The other elements of the scene with their meshes; one that does not fit into memory is left out with a message.
    fn elements(
        &self,
        plan: &TradeRuns,
        setup: &Setup,
    ) -> Result<Vec<(Change, Vec<u32>)>, CliError> {
        let mut found = Vec::new();
        for (element, change) in elements(setup) {
            let left_out = |why: &str| {
                super::progress::note(&format!("{} left out: {why}", change.words()));
            };
            let higher = element.degree() > setup.body.element.degree();
            if higher && setup.exact.is_none() {
                left_out("the reference run is of lower degree, and no truth for it");
                continue;
            }
            let n = element_meshes(&setup.scene, &plan.n, element);
            // It is compared on the meshes of the scene as written, too.
            let all = [&n[..], &plan.n[..]].concat();
            match self.admit(&change.of(&setup.scene)?, &all, &plan.steps) {
                Ok(()) => found.push((change, n)),
                Err(refused) => left_out(&refused.to_string()),
            }
        }
        Ok(found)
    }

    fn plan(&self, setup: &Setup) -> Result<TradeRuns, CliError> {
        if self.budget.is_nan() || self.budget <= 0.0 {
            return Err(CliError::other(format!("`{}` is no number of seconds", self.budget)));
        }
        let [n, steps] = match (&self.n, &self.steps) {
            (Some(n), Some(steps)) => [n.clone(), steps.clone()],
            (n, steps) => {
                let [of_scene, own_steps] = scene_grid(setup, self.budget)?;
                [n.clone().unwrap_or(of_scene), steps.clone().unwrap_or(own_steps)]
            }
        };
        let [n, steps] = [n, steps].map(|mut list| {
            list.sort_unstable();
            list.dedup();
            list
        });
        setup.scene.check_cases(&n, &steps)?;
        Ok(TradeRuns { n, steps, budget: self.budget, elements: Vec::new() })
    }
}

/// The scene set up, if errors can be measured in it.
fn measurable(scene: &Scene) -> Result<Setup, CliError> {
    let message = "an abstract problem has one step and no mesh to trade against";
    let hint = "sweep run measures its errors over k";
    scene.refuse_if(scene.as_contact().is_none(), "scene.kind", message, hint)?;
    let setup = Setup::new(scene.clone())?;
    let reference = scene.sweep.as_ref().is_some_and(|sweep| sweep.reference.is_some());
    let unmeasured = setup.exact.is_none() && !reference;
    let message =
        "the scene has neither an exact solution nor a reference run: no error can be measured";
    let hint = "add reference = { n = …, steps = … } to [sweep]; `sweep solve --estimate` estimates the error of one run";
    scene.refuse_if(unmeasured, "scene.name", message, hint)?;
    Ok(setup)
}

/// A finished run in words.
fn row(trial: &Trial) -> String {
    let place = format!("{} n={} N={}", trial.change, trial.n, trial.steps);
    match &trial.outcome {
        Ok(run) => format!("{place} error {:.4e} in {:.4} s", run.error, run.seconds),
        Err(reason) => format!("{place} failed: {reason}"),
    }
}
