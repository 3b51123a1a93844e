//! Verdicts as workflow commands of GitHub Actions, and as Markdown for its step summary. Deterministic, without
//! clocks.

use super::document::{outcome, verdict_rows};
use files::harmless;
use judge::record::{CaseRecord, Status};
use judge::verdict::{Decision, Verdict, cell_texts};

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
