//! Verdicts for continuous integration, as JUnit XML.

use std::collections::BTreeMap;
use std::path::Path;

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::ReportError;
use crate::record::replace_file;
use crate::verdict::{Comparison, Decision, Verdict, cell_texts};

/// Writes one suite a scene, one test a verdict. Unresolved is a failure; a verdict that the
/// scene expects is a success. A run that was compared with its baseline has one test more for each
/// scene. Without clocks: equal verdicts give equal bytes.
///
/// # Errors
/// [`ReportError::Xml`], [`ReportError::Io`].
pub fn write_junit(
    path: &Path,
    verdicts: &[Verdict],
    baseline: Option<&Comparison>,
) -> Result<(), ReportError> {
    let text = junit_xml(verdicts, baseline).map_err(|source| ReportError::Xml { source })?;
    replace_file(path, text.as_bytes())
        .map_err(|source| ReportError::Io { path: path.to_owned(), source })
}

fn junit_xml(
    verdicts: &[Verdict],
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
        report.add_test_suite(suite);
    }
    if let Some(comparison) = baseline {
        let mut suite = TestSuite::new("baseline");
        suite
            .add_test_cases(comparison.scenes.iter().map(|scene| baseline_case(scene, comparison)));
        report.add_test_suite(suite);
    }
    report.to_string()
}

/// One scene against its baseline; all of its deviations in the text.
fn baseline_case(scene: &str, comparison: &Comparison) -> TestCase {
    let own: Vec<_> = comparison.deviations.iter().filter(|d| d.scene == scene).collect();
    let status = match own.first() {
        None => TestCaseStatus::success(),
        Some(first) => {
            let lines: Vec<&str> = own.iter().map(|deviation| deviation.reason.as_str()).collect();
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_type(first.verdict.name()).set_message(lines[0]);
            status.set_description(lines.join("\n"));
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
        status.set_type(kind).set_message(verdict.reason.as_str()).set_description(format!(
            "predicted {predicted} by {why}, observed {observed}: {decision}"
        ));
        status
    };
    let mut case = TestCase::new(name, status);
    case.set_classname(verdict.scene.as_str());
    case
}
