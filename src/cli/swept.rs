//! A finished sweep, as its commands and GitHub show it.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::{CliError, print_as_it_is, print_text, print_verdicts, prints_all};
use clap::Args;
use files::counted;
use judge::fit::AgainstReference;
use judge::record::CaseRecord;
use judge::verdict::{Comparison, Explanation, Verdict, document, exit_code, failures};
use report::{AnnotationPlace, SceneSummary, annotations, step_summary, write_all, write_junit};
use run::sweep::{OutputDirectory, ScenePlan, reference_in_words};
use serde_json::{Value, json};
use studies::portrait::scene_summary;

/// Records of all cases of the plans, and their verdicts.
#[derive(Default)]
pub(super) struct Swept {
    pub(super) records: Vec<CaseRecord>,
    pub(super) verdicts: Vec<Verdict>,
    pub(super) plans: Vec<ScenePlan>,
    pub(super) provenance: Value,
    pub(super) comparison: Option<Comparison>,
    /// Why a solver under test is wrong.
    pub(super) cause: Option<Explanation>,
    /// Scenes with given loads, and the errors of their reference runs.
    pub(super) references: Vec<(String, AgainstReference)>,
    /// Kept locked until the report is written.
    pub(super) _out: Option<OutputDirectory>,
}

impl Swept {
    /// The exit code of the verdicts; a deviation from the baseline gives at least 1.
    pub(super) fn exit_code(&self) -> u8 {
        let compared = self.comparison.as_ref().map_or(0, Comparison::exit_code);
        exit_code(&self.records, &self.verdicts).max(compared)
    }

    /// Writes the report and everything it links to.
    pub(super) fn write(&self, out: &Path) -> Result<(), CliError> {
        let Self { records, verdicts, provenance, comparison, cause, .. } = self;
        let summary = |plan: &ScenePlan| scene_summary(plan.scene(), Some(&plan.subject));
        let summaries: Vec<SceneSummary> = self.plans.iter().map(summary).collect();
        let compared = comparison.as_ref();
        write_all(out, &summaries, records, verdicts, provenance, compared, cause.as_ref())?;
        Ok(())
    }

    /// The output of --json.
    pub(super) fn document(&self) -> Value {
        let Self { records, verdicts, provenance, comparison, cause, .. } = self;
        let compared = comparison.as_ref();
        let mut document = document(provenance, verdicts, records, compared, cause.as_ref());
        if !self.references.is_empty() {
            document["references"] = json!(self.references);
        }
        document
    }

    pub(super) fn print(&self) {
        print_verdicts(&self.verdicts);
        for (scene, found) in self.references.iter().filter(|_| prints_all(&self.verdicts)) {
            print_text(&reference_in_words(scene, found));
        }
        let failed = failures(&self.records).len();
        let judged = if self.verdicts.is_empty() {
            String::new()
        } else {
            let met = self.verdicts.iter().filter(|verdict| verdict.as_expected()).count();
            format!("; {met} of {} as expected", counted(self.verdicts.len(), "verdict"))
        };
        let cases = counted(self.records.len(), "case");
        print_text(&format!("{cases}, {failed} failed{judged}"));
        if let Some(comparison) = &self.comparison {
            print_text(&comparison.lines().join("\n"));
        }
    }
}

// Verdicts on GitHub Actions: beside the scene file or the table, and in the summary.

/// What continuous integration reads.
#[derive(Args)]
pub(super) struct ForCi {
    /// Write the verdicts as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Print annotations for GitHub Actions, and append the verdicts to the file that
    /// GITHUB_STEP_SUMMARY names; set by GITHUB_ACTIONS=true as well
    #[arg(long)]
    github: bool,
}

impl ForCi {
    /// Writes the file of the option.
    pub(super) fn write_junit(&self, swept: &Swept) -> Result<(), CliError> {
        let Swept { verdicts, provenance, comparison, .. } = swept;
        let Some(path) = &self.junit else { return Ok(()) };
        Ok(write_junit(path, verdicts, provenance, comparison.as_ref())?)
    }

    /// Prints an annotation per verdict that is not a plain pass and per failed case, and the count, if wanted.
    pub(super) fn annotate(&self, swept: &Swept) -> Result<(), CliError> {
        let Swept { plans, records, verdicts, .. } = swept;
        match on_github(self.github) {
            true => announce(records, verdicts, |scene, of| place(plans, scene, of)),
            false => Ok(()),
        }
    }
}

/// Whether annotations are wanted, by the option or because GitHub Actions runs.
pub(super) fn on_github(option: bool) -> bool {
    option || std::env::var_os("GITHUB_ACTIONS").is_some_and(|set| set == "true")
}

/// Prints the annotations, and appends the table to the summary of the step, if there is one.
pub(super) fn announce(
    records: &[CaseRecord],
    verdicts: &[Verdict],
    place: impl Fn(&str, Option<&Verdict>) -> Option<AnnotationPlace>,
) -> Result<(), CliError> {
    print_as_it_is(annotations(records, verdicts, place).trim_end());
    let Some(path) = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|path| !path.is_empty()) else {
        return Ok(());
    };
    let path = Path::new(&path);
    let file = OpenOptions::new().create(true).append(true).open(path);
    file.and_then(|mut file| file.write_all(step_summary(records, verdicts).as_bytes()))
        .map_err(|error| CliError::about(path.display(), error))
}

/// The file of a scene relative to here, and the line of a verdict's prediction, or of the scene's name.
fn place(plans: &[ScenePlan], name: &str, verdict: Option<&Verdict>) -> Option<AnnotationPlace> {
    let scene = plans.iter().map(ScenePlan::scene).find(|scene| scene.name == name)?;
    let predicts = scene.predicts.iter().position(|prediction| {
        let variable = prediction.variable;
        verdict.is_some_and(|v| v.norm == prediction.norm.name() && v.variable == variable)
    });
    let key = match predicts {
        Some(index) => format!("predicts.{index}.order"),
        None => "scene.name".to_owned(),
    };
    let before = &scene.source.text[..scene.span(&key).start];
    // A scene inside the program has no file to annotate.
    let path = Some(&scene.source.path).filter(|path| path.exists())?;
    let here = std::env::current_dir().ok();
    let path = here.and_then(|here| path.strip_prefix(here).ok()).unwrap_or(path);
    Some(in_file(path, 1 + before.matches('\n').count()))
}

/// A line of a file that is named from here.
pub(super) fn in_file(path: &Path, line: usize) -> AnnotationPlace {
    AnnotationPlace { file: path.display().to_string().replace('\\', "/"), line }
}
