//! A finished sweep, as its commands show it.

use std::path::Path;

use serde_json::{Value, json};

use super::{CliError, print_text, print_verdicts, verdict_table};
use files::counted;
use judge::fit::AgainstReference;
use judge::record::CaseRecord;
use judge::verdict::{Comparison, Verdict, document, exit_code, failures};
use report::{SceneSummary, write_all};
use run::sweep::{OutputDirectory, ScenePlan, reference_in_words};
use studies::portrait::scene_summary;

/// Records of all cases of the plans, and their verdicts.
#[derive(Default)]
pub(super) struct Swept {
    pub(super) records: Vec<CaseRecord>,
    pub(super) verdicts: Vec<Verdict>,
    pub(super) plans: Vec<ScenePlan>,
    pub(super) provenance: Value,
    pub(super) comparison: Option<Comparison>,
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
        let Self { records, verdicts, provenance, comparison, .. } = self;
        let summary = |plan: &ScenePlan| scene_summary(plan.scene(), Some(&plan.subject));
        let summaries: Vec<SceneSummary> = self.plans.iter().map(summary).collect();
        write_all(out, &summaries, records, verdicts, provenance, comparison.as_ref())?;
        Ok(())
    }

    /// The output of --json.
    pub(super) fn document(&self) -> Value {
        let Self { records, verdicts, provenance, comparison, .. } = self;
        let mut document = document(provenance, verdicts, records, comparison.as_ref());
        if !self.references.is_empty() {
            document["references"] = json!(self.references);
        }
        document
    }

    pub(super) fn print(&self) {
        print_verdicts(&verdict_table(&self.verdicts));
        for (scene, found) in &self.references {
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
