//! Verdicts for continuous integration, as JUnit XML.

use std::collections::BTreeMap;
use std::path::Path;

use crate::ReportError;
use crate::document::{outcome, verdict_rows};
use files::{harmless, write_named};
use judge::record::{CaseRecord, Status};
use judge::verdict::{Comparison, Decision, Verdict, cell_texts};
use quick_junit::{NonSuccessKind, Property, Report, TestCase, TestCaseStatus, TestSuite};

/// Writes one suite per scene, one test per verdict. Unresolved is a failure; an expected verdict is a success. A run
/// compared with its baseline has one more test per scene. Properties of each suite give the origin from `provenance`.
/// Deterministic, without clocks.
///
/// # Errors
/// [`ReportError::Xml`], [`ReportError::Io`].
pub fn write_junit(
    path: &Path,
    verdicts: &[Verdict],
    provenance: &serde_json::Value,
    baseline: Option<&Comparison>,
) -> Result<(), ReportError> {
    let text =
        junit_xml(verdicts, provenance, baseline).map_err(|source| ReportError::Xml { source })?;
    Ok(write_named(path, text.as_bytes())?)
}

fn junit_xml(
    verdicts: &[Verdict],
    provenance: &serde_json::Value,
    baseline: Option<&Comparison>,
) -> Result<String, quick_junit::SerializeError> {
    let mut scenes: BTreeMap<&str, Vec<&Verdict>> = BTreeMap::new();
    for verdict in verdicts {
        scenes.entry(&verdict.scene).or_default().push(verdict);
    }
    // Program version and circumstances of the run, as far as known.
    let property = |key: &str, value: &serde_json::Value| {
        Property::new(key, &*value.as_str().map_or(value.to_string(), str::to_owned))
    };
    let run = provenance["run"].as_object().into_iter().flatten();
    let origin = provenance.get("version").map(|version| property("version", version));
    let origin = origin.into_iter().chain(run.map(|(key, value)| property(key, value)));
    let origin: Vec<Property> = origin.collect();
    let suite = |name: &str, cases: Vec<TestCase>| {
        let mut suite = TestSuite::new(name);
        suite.add_test_cases(cases);
        suite.add_properties(origin.iter().cloned());
        suite
    };
    let mut report = Report::new("gronwall");
    report.add_test_suites(
        scenes
            .into_iter()
            .map(|(scene, of)| suite(scene, of.into_iter().map(verdict_case).collect())),
    );
    report.add_test_suites(baseline.map(|comparison| {
        // One scene against its baseline; all deviations are in the text.
        let case = |scene: &String| {
            let of_scene = || comparison.deviations.iter().filter(|d| d.scene == *scene);
            let reasons: Vec<&str> = of_scene().map(|d| d.reason.as_str()).collect();
            let failure = of_scene().next().map(|d| (d.verdict, reasons[0], reasons.join("\n")));
            test_case(scene, "recorded errors and work", failure)
        };
        suite("baseline", comparison.scenes.iter().map(case).collect())
    }));
    report.to_string()
}

fn verdict_case(verdict: &Verdict) -> TestCase {
    let name = format!("{} in {}", verdict.norm, verdict.variable.name());
    let [_, _, _, predicted, observed, decision, why] = cell_texts(verdict);
    let kind = match verdict.decision {
        Decision::Unresolved => Decision::Unresolved,
        Decision::Fail | Decision::Pass => Decision::Fail,
    };
    let said = format!("predicted {predicted} by {why}, observed {observed}: {decision}");
    let failure = (kind, verdict.reason.as_str(), said);
    test_case(&verdict.scene, &name, (!verdict.as_expected()).then_some(failure))
}

/// A test that fails with a kind, a message and a text.
fn test_case(scene: &str, name: &str, failure: Option<(Decision, &str, String)>) -> TestCase {
    let status = failure.map_or_else(TestCaseStatus::success, |(kind, message, text)| {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
        status.set_type(kind.name()).set_message(harmless(message));
        status.set_description(harmless(&text));
        status
    });
    let mut case = TestCase::new(name, status);
    case.set_classname(scene);
    case
}

// Verdicts as workflow commands of GitHub Actions, and as Markdown for its step summary. Deterministic, without clocks.

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AnnotationPlace {
    /// Path of the scene file in the repository.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
}

/// One command a line: an error for every unexpected verdict and failed case, a warning for an expected `fail` or
/// `unresolved`, a notice with the count. `place` finds the file of a scene, and the line of a verdict's prediction.
pub fn annotations(
    records: &[CaseRecord],
    verdicts: &[Verdict],
    place: impl Fn(&str, Option<&Verdict>) -> Option<AnnotationPlace>,
) -> String {
    let mut lines = Vec::new();
    for record in records {
        if let Status::Failed { reason } = &record.status {
            let key = record.key();
            let title = format!("{}: {key} failed", key.scene);
            lines.push(command("error", place(&key.scene, None), &title, reason));
        }
    }
    for verdict in verdicts {
        let level = match (verdict.as_expected(), verdict.decision) {
            (true, Decision::Pass) => continue,
            (true, Decision::Fail | Decision::Unresolved) => "warning",
            (false, _) => "error",
        };
        let [scene, norm, variable, predicted, observed, decision, why] = cell_texts(verdict);
        let title = format!("{scene}: {norm} in {variable}: {decision}");
        let observed = observed.replace('\n', ", ");
        let text =
            format!("predicted {predicted} by {why}, observed {observed}: {}", verdict.reason);
        lines.push(command(level, place(&scene, Some(verdict)), &title, &text));
    }
    lines.push(command("notice", None, "orders of convergence", &outcome(records, verdicts)));
    lines.join("\n") + "\n"
}

/// The verdicts as a Markdown table under a heading.
pub fn step_summary(records: &[CaseRecord], verdicts: &[Verdict]) -> String {
    format!(
        "### Orders of convergence\n\n{}\n\n{}\n",
        outcome(records, verdicts),
        verdict_rows(verdicts)
    )
}

fn command(level: &str, place: Option<AnnotationPlace>, title: &str, text: &str) -> String {
    let place = place.map_or(String::new(), |place| {
        format!("file={},line={},", property(&place.file), place.line)
    });
    format!("::{level} {place}title={}::{}", property(title), data(text))
}

/// Escapes text after the second `::`.
fn data(text: &str) -> String {
    harmless(text).replace('%', "%25").replace('\n', "%0A")
}

/// Escapes a value before it, which colons and commas would end.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_ends_a_command_early() {
        let place = AnnotationPlace { file: "a,b:c%.toml".into(), line: 7 };
        let line = command("error", Some(place), "x: y, z\n", "50 %\r\nof :: all, it");
        assert_eq!(
            line,
            "::error file=a%2Cb%3Ac%25.toml,line=7,title=x%3A y%2C z%0A::50 %25\\u{d}%0Aof :: all, it"
        );
    }
}
