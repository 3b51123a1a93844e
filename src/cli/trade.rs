//! `sweep trade`: speed against accuracy over the knobs of a scene, and the cheapest way to an error.

mod answer;

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::machine::Common;
use super::study::write;
use super::target::Wanted;
use super::{CliError, Scenes, create_dir, print_json, print_text, subject, width};
use answer::Confirmed;
use report::StudyDocument;
use run::sweep::{Overrides, ScenePlan};
use scene::{Extension, Scene};
use studies::trade::{
    Answered, Bench, Knob, Study, Table, TradeRuns, Trial, Variant, admit_trade, element_meshes,
    held, knobs, scene_grid,
};

/// `sweep trade`.
#[derive(Args)]
#[command(
    after_help = "Each case is run --repeats times from nothing (mesh, analysis, loads, march); its time is the least CPU time of the thread, errors are measured in a separate run. Knobs beside h and k are changed one at a time, on three cases, in rounds: each round runs the case as written and with every knob, and a price is the ratio of two times of one round, over --repeats rounds, with its 95 % interval; a ratio whose interval holds 1 is no difference. A round whose case as written takes 1.25 times the least is not believed and is run again. docs/TRADE.md explains every number.\n\nFiles in --out: SCENE-trade.csv (a row as soon as its case ends; failures have status `failed`), SCENE-trade.json, SCENE-trade.svg (error against time), SCENE-trade-memory.svg (error against predicted memory).\n\nJSON keys with --json: scene, fingerprint (of its text), norm, size (largest strain norm of the truth), trials (knob, n, steps, h, k, dofs, error, floor, cpu_seconds, cpu_slowest, repeats, load_share, predicted_bytes, history_bytes, newton_iterations, factorizations, status, reason, tie: a knob that changes neither time nor error by more than 1 %, front: no run is as good in time and error and better in one, errors within 1 % being one, front_memory: nor in time, error and memory), error_model (model, space and time with constant, order, interval; source, residual), cost_model (base, constant, space and time with exponent and interval; residual), composition (seconds per run, per cell, per cell and level, per operation of a factorization, per operation and level), coupling (exponent, factor, space_share, cost_exponent), paths (exponent, modelled, measured), prices (what, n, steps, speed, range: its 95 % interval, error, bytes, words), extrapolation (what, step, rows, orders: last, interval), elements (the other elements: knob, their error_model, cost_model and composition, equal_error: error, the cheapest runs as_written and rival, speed, extrapolates; words), answer (target, n, steps, h, k, knob, error, cpu_seconds, bytes, optimum, extrapolates), confirmed (error, cpu_seconds, cpu_slowest, bytes, ratios). Exit code 2: no error can be measured, or none of the wanted size is in reach."
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
    /// Timed runs per case, and rounds in which knobs are compared
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    repeats: u32,
    /// Predicted CPU seconds that the grid may take; the knobs may take as much again
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    budget: f64,
    /// Say which n, N and knobs reach this error at least cost; `1%` is a hundredth of the largest
    /// strain norm of the truth (V_max alone), a plain number is an error in the norm
    #[arg(long, value_name = "E")]
    target: Option<String>,
    /// Run the answer and print predicted against real (CPU time: the least of five runs)
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
    confirmed: Option<Confirmed>,
}

impl TradeCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let scene = scenes.scene(&self.scene)?;
        let why = "it compares rules in time that take the value of a kernel at s = t";
        scene.without(&[Extension::SingularKernel], "sweep trade", why)?;
        let plain = as_written(&scene)?;
        let wanted = Wanted::read(&plain.setup, &self.norm, self.target.as_deref())?;
        let norm = wanted.norm;
        let mut plan = self.plan(&plain)?;
        let scene_plan = self.cases(&scene, [&plan.n, &plan.steps])?;
        admit_trade(&scene_plan, 0.0, &self.common.allowance.limit())?;
        self.elements(&mut plan, &plain, &scene_plan)?;
        let mut bench = Bench::new(plain, norm, self.repeats)?;
        create_dir(&self.out)?;
        let table =
            Table::create(self.at(&scene), &scene.name, norm.name()).map_err(CliError::other)?;
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
        let asked = wanted
            .error(study.size)
            .map(|target| self.answer(&mut bench, &plan, target, scenes, &study, &mut document));
        say(&document.text(width(StudyDocument::WIDTH)));
        if let Some((answer, confirmed)) = asked.transpose()? {
            (found.answer, found.confirmed) = (Some(answer), confirmed);
            write(&found, &document, Some(&self.out))?;
        }
        if self.common.json {
            print_json(&found)?;
        }
        say(&format!("table: {}", self.at(&scene).display()));
        Ok(0)
    }

    /// The best n and N for a target, run if it is to be confirmed; the document begins with them.
    fn answer(
        &self,
        bench: &mut Bench,
        plan: &TradeRuns,
        target: f64,
        scenes: &Scenes,
        study: &Study,
        document: &mut StudyDocument,
    ) -> Result<(Answered, Option<Confirmed>), CliError> {
        let answer = Answered::new(bench, study, plan, target, &self.common.allowance.limit())
            .map_err(|none| CliError::other(format!("no answer: {none}")))?;
        *document = study.document(Some(&answer));
        document.answer(answer.words(study));
        if !self.confirm {
            return Ok((answer, None));
        }
        // The words are complete even if the run is refused.
        let scene = match answer.knob {
            Knob::Element(element) => scenes.scene(&self.scene)?.with_element(element)?,
            _ => scenes.scene(&self.scene)?,
        };
        let scene_plan = self.cases(&scene, [&[answer.choice.n], &[answer.choice.steps]])?;
        admit_trade(&scene_plan, 0.0, &self.common.allowance.limit())?;
        let real = Confirmed::run(&answer, bench, scenes, &self.scene)?;
        document.below_answer(real.words());
        Ok((answer, Some(real)))
    }

    fn cases(&self, scene: &Scene, [n, steps]: [&[u32]; 2]) -> Result<ScenePlan, CliError> {
        let overrides = Overrides { n: Some(n.to_vec()), steps: Some(steps.to_vec()) };
        Ok(ScenePlan::new(subject(scene.clone(), &self.common.allowance.limit())?, &overrides))
    }

    /// Adds the other elements of the scene to the plan, with separate meshes; one that does not fit into memory beside
    /// the other runs is left out with a message.
    fn elements(
        &self,
        plan: &mut TradeRuns,
        plain: &Variant,
        written: &ScenePlan,
    ) -> Result<(), CliError> {
        for knob in knobs(&plain.setup) {
            let Knob::Element(element) = knob else { continue };
            let left_out = |why: &str| {
                super::progress::note(&format!("{} left out: {why}", knob.name()));
            };
            let higher = element.degree() > plain.setup.body.element.degree();
            if higher && plain.setup.exact.is_none() {
                left_out("the reference run is of lower degree, and no truth for it");
                continue;
            }
            let n = element_meshes(&plain.setup.scene, &plan.n, element);
            // Also compared on the meshes of the runs as written.
            let both = [&n[..], &plan.n[..]].concat();
            let scene = plain.setup.scene.with_element(element)?;
            let cases = self.cases(&scene, [&both, &plan.steps])?;
            match admit_trade(&cases, held(written), &self.common.allowance.limit()) {
                Ok(()) => plan.elements.push((element, n)),
                Err(refused) => left_out(&refused.to_string()),
            }
        }
        Ok(())
    }

    fn at(&self, scene: &Scene) -> PathBuf {
        self.out.join(format!("{}-trade.csv", scene.name))
    }

    fn plan(&self, plain: &Variant) -> Result<TradeRuns, CliError> {
        let scene = &plain.setup.scene;
        if self.budget.is_nan() || self.budget <= 0.0 {
            return Err(CliError::other(format!("`{}` is no number of seconds", self.budget)));
        }
        let default_grid = match (&self.n, &self.steps) {
            (Some(_), Some(_)) => [Vec::new(), Vec::new()],
            _ => scene_grid(plain, self.repeats + 1, self.budget)?,
        };
        let listed = |given: &Option<Vec<u32>>, defaults: &Vec<u32>| {
            let mut list = given.clone().unwrap_or_else(|| defaults.clone());
            list.sort_unstable();
            list.dedup();
            list
        };
        let plan = TradeRuns {
            n: listed(&self.n, &default_grid[0]),
            steps: listed(&self.steps, &default_grid[1]),
            budget: self.budget,
            elements: Vec::new(),
        };
        scene.check_cases(&plan.n, &plan.steps)?;
        Ok(plan)
    }
}

/// The scene as written, if errors can be measured in it.
fn as_written(scene: &Scene) -> Result<Variant, CliError> {
    let message = "an abstract problem has one step and no mesh to trade against";
    let hint = "sweep run measures its errors over k";
    scene.refuse_if(scene.as_contact().is_none(), "scene.kind", message, hint)?;
    let plain = Variant::new(scene, Knob::AsWritten)?;
    let reference = scene.sweep.as_ref().is_some_and(|sweep| sweep.reference.is_some());
    let unmeasured = plain.setup.exact.is_none() && !reference;
    let message =
        "the scene has neither an exact solution nor a reference run: no error can be measured";
    let hint = "add reference = { n = …, steps = … } to [sweep]; `sweep solve --estimate` estimates the error of one run";
    scene.refuse_if(unmeasured, "scene.name", message, hint)?;
    Ok(plain)
}

/// Prints a finished run on stderr.
fn row(trial: &Trial) -> String {
    let place = format!("{} n={} N={}", trial.knob.name(), trial.n, trial.steps);
    match &trial.outcome {
        Ok(run) => format!("{place} error {:.4e} in {:.4} s", run.error, run.seconds),
        Err(reason) => format!("{place} failed: {reason}"),
    }
}
