//! The commands of the studies. Each prints JSON or its document and, with --out, writes files.

use std::path::{Path, PathBuf};

use super::machine::{Common, processors, share_threads};
use super::{CliError, Scenes, note_groups, print_json, print_text, width};
use clap::error::ErrorKind;
use clap::{ArgAction, ArgMatches, Args, Command, FromArgMatches, Subcommand, value_parser};
use files::{counted, make_directory};
use report::{Findings, StudyDocument};
use studies::diagnose::{admit_diagnosis, diagnose};
use studies::extremes::{Ladder, UnderTest, admit, catalogue, climb, found};
use studies::study::{Asked, Study};
use studies::theory::STUDIES;
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

// `sweep audit`, `bound`, `gronwall`: the studies of one scene, each by what it says of itself.

/// One of [`STUDIES`].
pub(crate) struct StudyCommand {
    study: &'static Study,
    arguments: StudyArguments,
}

#[derive(Args)]
struct StudyArguments {
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

impl StudyCommand {
    pub(super) fn execute(self, scenes: &Scenes) -> Result<u8, CliError> {
        share_threads()?;
        let StudyArguments { scene, n, steps, out, common } = self.arguments;
        let scene = scenes.scene(&scene)?;
        note_groups(&scene);
        let asked = Asked { n, steps, limit: common.allowance.limit(), jobs: processors() };
        show(&(self.study.run)(scene, &asked)?, out.as_deref(), common.json)
    }
}

fn command(study: &Study) -> Command {
    let name = study.name;
    let also = if study.files.is_empty() { String::new() } else { format!(", {}", study.files) };
    let help = format!(
        "{}\n\nKeys of --json: docs/JSON.md.\n\nFiles with --out: SCENE-{name}.json, SCENE-{name}-claims.csv{also}.",
        study.help
    );
    // What the options say of themselves as a group comes first, and is replaced.
    let command = StudyArguments::augment_args(Command::default().name(name));
    let command = command.about(study.about).after_help(help);
    [("n", "N", &study.n), ("steps", "STEPS", &study.steps)].into_iter().fold(
        command,
        |command, (option, value, sizes)| {
            let range = i64::from(sizes.least)..=i64::from(sizes.most);
            command.mut_arg(option, |arg| {
                let arg = arg.help(sizes.help).value_parser(value_parser!(u32).range(range));
                match sizes.many {
                    true => arg,
                    false => arg.value_delimiter(None).value_name(value),
                }
            })
        },
    )
}

impl FromArgMatches for StudyCommand {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let chosen = matches.subcommand().and_then(|(name, matches)| {
            Some((STUDIES.into_iter().find(|study| study.name == name)?, matches))
        });
        let Some((study, matches)) = chosen else {
            return Err(clap::Error::new(ErrorKind::InvalidSubcommand));
        };
        Ok(Self { study, arguments: StudyArguments::from_arg_matches(matches)? })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Subcommand for StudyCommand {
    fn augment_subcommands(program: Command) -> Command {
        STUDIES.into_iter().fold(program, |program, study| program.subcommand(command(study)))
    }

    fn augment_subcommands_for_update(program: Command) -> Command {
        Self::augment_subcommands(program)
    }

    fn has_subcommand(name: &str) -> bool {
        STUDIES.into_iter().any(|study| study.name == name)
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
        show(&found(&ladders, &self.ladder, &climbed), self.out.as_deref(), self.common.json)
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
