//! The commands of the studies. Each prints JSON or its document and, with --out, writes files.

use std::path::{Path, PathBuf};

use super::machine::{Common, processors, share_threads};
use super::{CliError, Scenes, no_case, print_json, print_text, width};
use clap::Args;
use files::{counted, make_directory};
use report::{Findings, StudyDocument};
use run::sweep::{Overrides, admit_constants};
use scene::setup::{Setup, Subject};
use scene::{Extension, Scene};
use studies::diagnose::{admit_diagnosis, diagnose};
use studies::extremes::{Ladder, UnderTest, admit, catalogue, climb, found};
use studies::theory::audit::{audit, audit_runs};
use studies::theory::bound::{self, BoundStudy};
use studies::theory::gronwall::{self, StudyRuns};
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

// `sweep bound`: the step-size bound (3.4) in four numbers, with its constants.

/// `sweep bound`.
#[derive(Args)]
#[command(
    after_help = "Every inequality is a claim: measured factors <= sharpened <= (3.15) at each step size of a ladder, thresholds in their order, samples of the law <= what it declares. A step has lost its solution where Newton's method finds none from the solution at the largest smaller k, that of the run and random states, or only one whose tangent is singular or beyond: bisected in k. \
Keys of --json: docs/JSON.md. Files with --out: SCENE-bound.json, SCENE-bound-claims.csv, SCENE-bound.svg. Exit code 1: a claim does not hold."
)]
pub(crate) struct BoundCommand {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Cells per unit length of the mesh on which the factors are measured, h = 1/n [default: 16]
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=128))]
    n: Option<u32>,
    /// Number N of time steps of the run whose worst level is studied [default: the scene's smallest]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<u32>,
    /// Write SCENE-bound.json, its claims as CSV and its picture into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// Default mesh of the measured factors.
const MESH: u32 = 16;

impl BoundCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let subject = scenes.subject(&self.scene, &self.common.allowance.limit())?;
        let scene = subject.scene();
        let singular = "it puts sup |q| beside k, not k^(1-a)";
        scene.without(&[Extension::SingularKernel], "sweep bound", singular)?;
        let fewest = scene.sweep.as_ref().and_then(|sweep| sweep.steps.iter().min().copied());
        let steps = self.steps.or(fewest).unwrap_or(8);
        scene.check_steps(&[steps])?;
        let bound = match &subject {
            Subject::Contact(setup) => {
                let n = self.n.unwrap_or(MESH);
                scene.check_cells(n)?;
                bound::study_runs(setup, n, steps).admit(&self.common.allowance.limit())?;
                BoundStudy::new(setup, n, steps)
            }
            // An abstract problem keeps a few numbers per level.
            Subject::Abstract(setup) => {
                super::abstract_problem::no_mesh(scene, self.n)?;
                BoundStudy::of_abstract(setup, steps)
            }
        }
        .map_err(|error| CliError::about(&scene.name, error))?;
        show(&bound.findings(), self.out.as_deref(), self.common.json)
    }
}

// `sweep gronwall`: truncation errors, envelopes and their effectivities, perturbations.

/// `sweep gronwall`.
#[derive(Args)]
#[command(
    after_help = "Effectivity = bound / measured error. The chain e <= weighted envelope <= primed envelope <= closed form, primed <= printed envelope <= its closed form is claimed at every n of every run. So is that the difference of two solutions under perturbed loads stays below its recurrence. Exit code 1: a claim fails; it is named with the first n at which it does.\n\nKeys of --json: docs/JSON.md.\n\nFiles with --out: SCENE-gronwall.csv (every level of every run), SCENE-gronwall.json, SCENE-gronwall-claims.csv, SCENE-gronwall-envelope.svg."
)]
pub(crate) struct Gronwall {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Cells per unit length, h = 1/n; abstract scenes have none [default: the first of the scene's list]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=4096))]
    n: Option<u32>,
    /// Numbers N of time steps, k = T/N [default: the scene's list up to 1024]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<Vec<u32>>,
    /// Directory for SCENE-gronwall.csv, SCENE-gronwall.json, its claims as CSV and the pictures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// Most steps taken from the scene's list: the weighted envelope takes O(N²).
const MOST_STEPS: u32 = 1024;

impl Gronwall {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let scene = scenes.scene(&self.scene)?;
        let plan = self.plan(&scene)?;
        if let Some(n) = plan.n.filter(|_| scene.as_contact().is_some()) {
            scene.check_cells(n)?;
        }
        scene.check_steps(&plan.steps)?;
        admit_constants(&scene, true, &self.common.allowance.limit())?;
        let subject = Subject::new(scene)?;
        // An abstract problem keeps a few numbers per level.
        if let (Subject::Contact(setup), Some(n)) = (&subject, plan.n) {
            gronwall::study_runs(setup, n, &plan).admit(&self.common.allowance.limit())?;
        }
        let found = gronwall::study(&subject, &plan)?;
        show(&found, self.out.as_deref(), self.common.json)
    }

    fn plan(&self, scene: &Scene) -> Result<StudyRuns, CliError> {
        let sweep = scene.sweep.as_ref();
        let n = self.n.or_else(|| sweep.and_then(|sweep| sweep.n.first().copied()));
        let admitted =
            |list: &Vec<u32>| list.iter().copied().filter(|&steps| steps <= MOST_STEPS).collect();
        let steps = self.steps.clone().or_else(|| sweep.map(|sweep| admitted(&sweep.steps)));
        let Some(mut steps) = steps.filter(|steps| !steps.is_empty()) else {
            return Err(CliError::other("no numbers of steps: give --steps 16,32,64"));
        };
        steps.sort_unstable();
        steps.dedup();
        Ok(StudyRuns { n, steps })
    }
}

// `sweep audit`: the inequalities of the proofs of Theorems 10 and 11, on real runs.

/// Largest n taken from a scene's list.
const FINEST: u32 = 64;

/// `sweep audit`.
#[derive(Args)]
#[command(
    after_help = "Eight inequalities of the proofs, (2.9), (4.7), (4.9), (4.14), (4.16), (4.17), (4.20) and (5.23), at every level, on the numbers of the solver and of the exact solution, by the boundary rule of the scene; what that rule and the load vector add to (4.9) is E_q. A claim is an inequality in a run, at the level where it is tightest: both sides, what rounding allows, left/right. \
Keys of --json: docs/JSON.md. Files with --out: SCENE-audit.json, SCENE-audit-claims.csv. \
Exit code 1: an inequality is violated beyond its accuracy or has no defined constant (m0 <= 0)."
)]
pub(crate) struct Audit {
    /// Name of a scene with an exact solution, or path of a TOML file
    scene: String,
    /// Cells per unit length, h = 1/n, in place of the scene's list up to 64
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=512))]
    n: Option<Vec<u32>>,
    /// Numbers N of time steps, k = T/N, in place of the scene's list
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<Vec<u32>>,
    /// Write SCENE-audit.json and SCENE-audit-claims.csv into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

impl Audit {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        share_threads()?;
        let scene = scenes.scene(&self.scene)?;
        admit_constants(&scene, true, &self.common.allowance.limit())?;
        let setup = Setup::new(scene)?;
        let (ns, steps) = self.grids(&setup)?;
        audit_runs(&setup, &ns, &steps, processors()).admit(&self.common.allowance.limit())?;
        let findings = audit(&setup, &ns, &steps)?;
        show(&findings, self.out.as_deref(), self.common.json)
    }

    fn grids(&self, setup: &Setup) -> Result<(Vec<u32>, Vec<u32>), CliError> {
        let scene = &setup.scene;
        Overrides { n: self.n.clone(), steps: self.steps.clone() }.check(scene)?;
        let mut own = scene.sweep.clone().unwrap_or_default();
        own.n.retain(|n| *n <= FINEST);
        let ns = self.n.clone().unwrap_or(own.n);
        let steps = self.steps.clone().unwrap_or(own.steps);
        if ns.is_empty() || steps.is_empty() {
            return Err(no_case(scene, "audit"));
        }
        Ok((ns, steps))
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
        super::output::note(&format!(
            "running {} of the scene, then its variants",
            counted(cases, "case")
        ));
        let findings = diagnose(&scene, &|setup| setup, self.always)?.findings();
        show(&findings, None, self.common.json)
    }
}

// `sweep extremes`: ladders from ordinary to extreme parameters, each rung against its expectation.

const WIDTH: u16 = 132;

/// `sweep extremes`.
#[derive(Args)]
#[command(
    after_help = "Exit codes: 0 every rung (one value of a ladder's parameter) is as expected; 1 a rung is not; 2 there is no such ladder, or --out cannot be written.\n\nKeys of --json: docs/JSON.md.\n\nFiles with --out: extremes-claims.csv, extremes.json, extremes.svg (the map)."
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
    /// Directory for extremes-claims.csv, extremes.json and extremes.svg, which replace those of an earlier run
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

impl Extremes {
    pub(super) fn execute(&self) -> Result<u8, CliError> {
        let ladders = self.chosen()?;
        if self.list {
            print_text(&listed(&ladders));
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
        show(&found(&ladders, &climbed), self.out.as_deref(), self.common.json)
    }

    fn chosen(&self) -> Result<Vec<Ladder>, CliError> {
        let all = catalogue(self.long);
        let names: Vec<&str> = all.iter().map(|ladder| ladder.name).collect();
        if let Some(unknown) = self.ladder.iter().find(|name| !names.contains(&name.as_str())) {
            let message = format!("no ladder `{unknown}`; there are {}", names.join(", "));
            return Err(CliError::other(message));
        }
        let named = |ladder: &Ladder| {
            self.ladder.is_empty() || self.ladder.iter().any(|name| name == ladder.name)
        };
        Ok(all.into_iter().filter(named).collect())
    }
}

fn listed(ladders: &[Ladder]) -> String {
    let row = |ladder: &Ladder| {
        let rungs = ladder.rungs.len().to_string();
        [ladder.name, ladder.parameter, &rungs, ladder.quantity, ladder.why].map(str::to_owned)
    };
    let rows: Vec<Vec<String>> = ladders.iter().map(|ladder| row(ladder).into()).collect();
    let heads = ["ladder", "parameter", ">rungs", "measured", "expected because"];
    report::text_table(&heads, &rows, width(WIDTH))
}
