//! Verdicts for continuous integration, as JUnit XML.

use std::collections::BTreeMap;
use std::path::Path;

use quick_junit::{NonSuccessKind, Property, Report, TestCase, TestCaseStatus, TestSuite};

use super::ReportError;
use files::{harmless, write_named};
use judge::verdict::{Comparison, Decision, Verdict, cell_texts};

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
    let text = junit_xml(verdicts, &origin(provenance), baseline)
        .map_err(|source| ReportError::Xml { source })?;
    Ok(write_named(path, text.as_bytes())?)
}

/// Program version and circumstances of the run, as far as known.
fn origin(provenance: &serde_json::Value) -> Vec<(String, String)> {
    let text = |value: &serde_json::Value| value.as_str().map_or(value.to_string(), str::to_owned);
    let version = provenance.get("version").map(|version| ("version".to_owned(), text(version)));
    let run = provenance["run"].as_object().into_iter().flatten();
    version.into_iter().chain(run.map(|(key, value)| (key.clone(), text(value)))).collect()
}

fn junit_xml(
    verdicts: &[Verdict],
    origin: &[(String, String)],
    baseline: Option<&Comparison>,
) -> Result<String, quick_junit::SerializeError> {
    let mut scenes: BTreeMap<&str, Vec<&Verdict>> = BTreeMap::new();
    for verdict in verdicts {
        scenes.entry(&verdict.scene).or_default().push(verdict);
    }
    let mut report = Report::new("gronwall");
    for (scene, verdicts) in scenes {
        let mut suite = TestSuite::new(scene);
        suite.add_test_cases(verdicts.into_iter().map(test_case));
        suite.add_properties(properties(origin));
        report.add_test_suite(suite);
    }
    if let Some(comparison) = baseline {
        let mut suite = TestSuite::new("baseline");
        suite
            .add_test_cases(comparison.scenes.iter().map(|scene| baseline_case(scene, comparison)));
        suite.add_properties(properties(origin));
        report.add_test_suite(suite);
    }
    report.to_string()
}

fn properties(origin: &[(String, String)]) -> impl Iterator<Item = Property> + '_ {
    origin.iter().map(|(name, value)| Property::new(name.as_str(), value.as_str()))
}

/// One scene against its baseline; all deviations are in the text.
fn baseline_case(scene: &str, comparison: &Comparison) -> TestCase {
    let of_scene: Vec<_> = comparison.deviations.iter().filter(|d| d.scene == scene).collect();
    let status = match of_scene.first() {
        None => TestCaseStatus::success(),
        Some(first) => {
            let lines: Vec<&str> =
                of_scene.iter().map(|deviation| deviation.reason.as_str()).collect();
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_type(first.verdict.name()).set_message(harmless(lines[0]));
            status.set_description(harmless(&lines.join("\n")));
            status
        }
    };
    let mut case = TestCase::new("recorded errors and work", status);
    case.set_classname(scene);
    case
}

fn test_case(verdict: &Verdict) -> TestCase {
    let name = format!("{} in {}", verdict.norm, verdict.variable.name());
    let [_, _, _, predicted, observed, decision, why] = cell_texts(verdict);
    let status = if verdict.as_expected() {
        TestCaseStatus::success()
    } else {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
        let kind = match verdict.decision {
            Decision::Unresolved => "unresolved",
            Decision::Fail | Decision::Pass => "fail",
        };
        let said = format!("predicted {predicted} by {why}, observed {observed}: {decision}");
        let reason = harmless(&verdict.reason);
        status.set_type(kind).set_message(reason).set_description(harmless(&said));
        status
    };
    let mut case = TestCase::new(name, status);
    case.set_classname(verdict.scene.as_str());
    case
}
