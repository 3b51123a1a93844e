//! Verdicts on GitHub Actions: beside the scene file or the table, and in the summary.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;

use super::{CliError, print_as_it_is};
use judge::record::CaseRecord;
use judge::verdict::Verdict;
use report::{AnnotationPlace, annotations, step_summary};
use run::sweep::ScenePlan;

/// Whether annotations are wanted, by the option or because GitHub Actions runs.
pub(super) fn on_github(option: bool) -> bool {
    option || std::env::var_os("GITHUB_ACTIONS").is_some_and(|set| set == "true")
}

/// Prints an annotation per verdict that is not a plain pass and per failed case, and the count; appends the table to
/// the summary of the step, if there is one.
pub(crate) fn annotate(
    plans: &[ScenePlan],
    records: &[CaseRecord],
    verdicts: &[Verdict],
) -> Result<(), CliError> {
    announce(records, verdicts, |scene, of| place(plans, scene, of))
}

/// The same for verdicts of whatever origin.
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
    let before = &scene.source.text[..scene.spans.value(&key).start];
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
