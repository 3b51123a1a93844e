//! The commands of the studies. Each prints JSON or its document and, with --out, writes files.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use super::machine::{Common, processors, share_threads};
use super::{CliError, Scenes, note_groups, print_json, print_text, width};
use clap::{Arg, ArgAction, Args, Subcommand, value_parser};
use files::{counted, make_directory};
use report::{Findings, StudyDocument, json_table};
use serde_json::json;
use studies::diagnose::{admit_diagnosis, diagnose};
use studies::extremes::{Ladder, UnderTest, admit, catalogue, climb, found};
use studies::study::{Asked, Study};
use studies::theory::{audit, bound, estimators, gronwall};
use studies::trade::{Trade, Wanted, measurable, trade};

/// Prints findings, and writes their files if a directory is given. The exit code: 1 unless every claim holds.
pub(super) fn show(findings: &Findings, out: Option<&Path>, as_json: bool) -> Result<u8, CliError> {
    if let Some(dir) = out {
        make_directory(dir)?;
        findings.write(dir)?;
    }
    if as_json {
        print_json(&findings.json())?;
    } else {
        print_text(&findings.document.text(width(StudyDocument::WIDTH)));
    }
    Ok(u8::from(!findings.holds()))
}

// `sweep audit`, `bound`, `gronwall`, `estimators`: the studies of one scene.

#[derive(Subcommand)]
pub(crate) enum StudyCommand {
    /// Check the proofs of Theorems 10 and 11 line by line on real runs
    #[command(
        after_help = "Inequalities of the proofs, (2.9), (4.7), (4.9), (4.14), (4.16), (4.17), (4.19), (4.20) and (5.23), at every level, on the numbers of the solver and of the exact solution, by the boundary rule of the scene; what that rule and the load vector add to (4.9) is E_q. A claim is an inequality in a run, at the level where it is tightest: both sides, what rounding allows, left/right. Exit code 1: an inequality is violated beyond its accuracy or has no defined constant (m0 <= 0).\n\nKeys of --json: docs/JSON.md.\n\nFiles with --out: SCENE-audit.json, SCENE-audit-claims.csv.",
        mut_arg("n", |n| list(n, 1..=512, "Cells per unit length, h = 1/n, in place of the scene's list up to 64")),
        mut_arg("steps", |steps| list(steps, 1..=100_000, "Numbers N of time steps, k = T/N, in place of the scene's list")),
    )]
    Audit(StudyArguments),
    /// Step-size bound (3.4): paper, sharpened, measured, solvability
    #[command(
        after_help = "Every inequality is a claim: measured factors <= sharpened <= (3.15) at each step size of a ladder, thresholds in their order, samples of the law <= what it declares. A step has lost its solution where Newton's method finds none from the solution at the largest smaller k, that of the run and random states, or only one whose tangent is singular or beyond: bisected in k. Exit code 1: a claim does not hold.\n\nKeys of --json: docs/JSON.md.\n\nFiles with --out: SCENE-bound.json, SCENE-bound-claims.csv, SCENE-bound.svg.",
        mut_arg("n", |n| one(n, 2..=128, "Cells per unit length of the mesh on which the factors are measured, h = 1/n [default: 16]")),
        mut_arg("steps", |steps| one(steps, 1..=100_000, "Number N of time steps of the run whose worst level is studied [default: the scene's smallest]")),
    )]
    Bound(StudyArguments),
    /// Gronwall's inequality on runs: envelopes and perturbations
    #[command(
        after_help = "Effectivity = bound / measured error. The chain e <= weighted envelope <= primed envelope <= closed form, primed <= printed envelope <= its closed form is claimed at every n of every run. So is that the difference of two solutions under perturbed loads stays below its recurrence. Exit code 1: a claim fails; it is named with the first n at which it does.\n\nKeys of --json: docs/JSON.md.\n\nFiles with --out: SCENE-gronwall.json, SCENE-gronwall-claims.csv, SCENE-gronwall.csv (every level of every run), SCENE-gronwall-envelope.svg.",
        mut_arg("n", |n| one(n, 1..=4096, "Cells per unit length, h = 1/n; abstract scenes have none [default: the first of the scene's list]")),
        mut_arg("steps", |steps| list(steps, 1..=100_000, "Numbers N of time steps, k = T/N [default: the scene's list up to 1024]")),
    )]
    Gronwall(StudyArguments),
    /// Compare error estimate and guaranteed bound with true errors
    #[command(
        after_help = "Each run of a ladder in h (in k where the scene predicts no order of V_max in h) is estimated from its companions and, where the theorem of the bound covers the scene, bounded. Claims: the bound is not below the error, the interval of the estimate holds it, and no quotient of the two and the error grows under refinement: its order in the step is at least 0, as the judge decides. Exit code 1: a claim fails or is unresolved. Exit code 2: no exact solution, or no three runs.\n\nKeys of --json: docs/JSON.md.\n\nFiles with --out: SCENE-estimators.json, SCENE-estimators-claims.csv, SCENE-estimators.svg.",
        mut_arg("n", |n| list(n, 4..=512, "Cells per unit length, multiples of 4 [default: those of the scene's list up to 64]")),
        mut_arg("steps", |steps| list(steps, 1..=100_000, "Numbers N of time steps, with memory multiples of 4 [default: those of the scene's list up to 256]")),
    )]
    Estimators(StudyArguments),
}

#[derive(Args)]
pub(crate) struct StudyArguments {
    /// Name of a scene, or path of a TOML file
    scene: String,
    #[arg(long, value_name = "LIST", value_delimiter = ',', action = ArgAction::Set)]
    n: Option<Vec<u32>>,
    #[arg(long, value_name = "LIST", value_delimiter = ',', action = ArgAction::Set)]
    steps: Option<Vec<u32>>,
    /// Write the JSON, its claims as CSV and the pictures into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// What `--n` or `--steps` of a study takes.
fn list(sizes: Arg, range: RangeInclusive<i64>, help: &'static str) -> Arg {
    sizes.help(help).value_parser(value_parser!(u32).range(range))
}

/// One number in place of a list.
fn one(size: Arg, range: RangeInclusive<i64>, help: &'static str) -> Arg {
    let name = if size.get_id() == "n" { "N" } else { "STEPS" };
    list(size, range, help).value_delimiter(None).value_name(name)
}

impl StudyCommand {
    pub(super) fn execute(self, scenes: &Scenes) -> Result<u8, CliError> {
        let (study, arguments): (Study, _) = match self {
            Self::Audit(arguments) => (audit::of_scene, arguments),
            Self::Bound(arguments) => (bound::of_scene, arguments),
            Self::Gronwall(arguments) => (gronwall::of_scene, arguments),
            Self::Estimators(arguments) => (estimators::of_scene, arguments),
        };
        share_threads()?;
        let StudyArguments { scene, n, steps, out, common } = arguments;
        let scene = scenes.scene(&scene)?;
        note_groups(&scene);
        let asked = Asked { n, steps, limit: common.allowance.limit(), jobs: processors() };
        show(&study(scene, &asked)?, out.as_deref(), common.json)
    }
}

// `sweep trade`: speed against accuracy over the settings of a scene, and the cheapest run with an error.

/// `sweep trade`.
#[derive(Args)]
#[command(
    after_help = "Each case is run once from the mesh to the last step. Its error is recorded, and its CPU seconds on one thread of this machine, without the time to measure the error. Settings and elements are changed one at a time on the same grid. A factor below 1.25 between two times is no difference. docs/TRADE.md explains every number.\n\nFiles in --out: SCENE-trade.csv (a row a case; failures have status `failed`), SCENE-trade-claims.csv, SCENE-trade.json, SCENE-trade.svg (error against time).\n\nKeys of --json: docs/JSON.md. Exit code 1: a run fails or has no error but rounding, the model of the error is off by more than a fourth at a run, or the run of --confirm misses the target by more than that. Exit code 2: no error can be measured, or none of the wanted size is in reach."
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
    /// Budget for all runs in predicted CPU seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    budget: f64,
    /// Find the n, N and setting that reach this error at the lowest cost. `1%` is a hundredth of the largest
    /// strain norm of the truth (V_max alone), a plain number is an error in the norm
    #[arg(long, value_name = "E")]
    target: Option<String>,
    /// Run the recommended case and compare the prediction with the result
    #[arg(long, requires = "target")]
    confirm: bool,
    /// Directory for tables, JSON and picture
    #[arg(long, value_name = "DIR", default_value = "reports/latest/trade")]
    out: PathBuf,
    #[command(flatten)]
    common: Common,
}

impl TradeCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        if self.budget.is_nan() || self.budget <= 0.0 {
            return Err(CliError::other(format!("`{}` is no number of seconds", self.budget)));
        }
        let setup = measurable(&scenes.scene(&self.scene)?)?;
        let wanted = Wanted::read(&setup, &self.norm, self.target.as_deref());
        let asked = Trade {
            setup: &setup,
            wanted: wanted?,
            n: self.n.clone(),
            steps: self.steps.clone(),
            budget: self.budget,
            confirm: self.confirm,
            limit: self.common.allowance.limit(),
        };
        let (findings, refused) = trade(&asked, &super::output::note)?;
        let code = show(&findings, Some(&self.out), self.common.json)?;
        refused.map_or(Ok(code), |none| Err(CliError::other(format!("no answer: {none}"))))
    }
}

// `sweep diagnose`: finds the term whose removal restores the expected behaviour.

/// `sweep diagnose`.
#[derive(Args)]
#[command(
    after_help = "Exit codes: 0 there is nothing to diagnose, or with --always nothing was found; 1 a verdict is not as expected, or a trial fails; 2 the scene cannot be diagnosed.\n\nKeys of --json: docs/JSON.md."
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
        let cases = counted(cases, "case");
        super::output::note(&format!("running {cases} of the scene, then its variants"));
        let findings = diagnose(&scene, &|setup| setup, self.always)?.findings();
        show(&findings, None, self.common.json)
    }
}

// `sweep extremes`: ladders from ordinary to extreme parameters, each rung against its expectation.

/// `sweep extremes`.
#[derive(Args)]
#[command(
    after_help = "Exit codes: 0 every rung (one value of a ladder's parameter) is as expected; 1 a rung is not; 2 there is no such ladder, or --out cannot be written.\n\nKeys of --json: docs/JSON.md.\n\nFiles with --out: extremes-claims.csv, extremes.json, extremes.svg (the map); of named ladders LADDER-extremes and so on."
)]
pub(crate) struct Extremes {
    /// Ladders (one parameter taken to its extreme) to run [default: all]; --list names them
    ladder: Vec<String>,
    /// Also run the largest meshes, which takes some minutes
    #[arg(long)]
    long: bool,
    /// List the ladders and what they expect, without running them
    #[arg(long)]
    list: bool,
    /// Directory for extremes-claims.csv, extremes.json and extremes.svg
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

impl Extremes {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        let mut ladders = catalogue(self.long);
        let names: Vec<&str> = ladders.iter().map(|ladder| ladder.name).collect();
        if let Some(unknown) = self.ladder.iter().find(|name| !names.contains(&name.as_str())) {
            let message = format!("no ladder `{unknown}`; there are {}", names.join(", "));
            return Err(CliError::other(message));
        }
        let named = |ladder: &Ladder| self.ladder.iter().any(|name| name == ladder.name);
        ladders.retain(|ladder| self.ladder.is_empty() || named(ladder));
        if self.list {
            let row =
                |of: &Ladder| json!([of.name, of.parameter, of.rungs.len(), of.quantity, of.why]);
            let rows = ladders.iter().map(row).collect();
            let columns =
                "ladder = 0; parameter = 1; >rungs = 2; measured = 3; expected because = 4";
            print_text(&json_table(&rows, columns, width(StudyDocument::WIDTH)));
            return Ok(0);
        }
        let under_test = UnderTest::default();
        let limit = self.common.allowance.limit();
        for ladder in &ladders {
            ladder.rungs.iter().try_for_each(|rung| admit(ladder, rung, &under_test, &limit))?;
        }
        let mut climbed = Vec::new();
        for ladder in &ladders {
            let rungs = counted(ladder.rungs.len(), "rung");
            super::output::note(&format!("{}: {rungs}", ladder.name));
            climbed.extend(ladder.rungs.iter().map(|rung| climb(ladder, rung, &under_test)));
        }
        show(&found(&ladders, &self.ladder, &climbed), self.out.as_deref(), self.common.json)
    }
}
