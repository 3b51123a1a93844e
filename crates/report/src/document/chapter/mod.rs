//! Chapters beside the orders: theory, cost of accuracy, extremes.
//!
//! They are written from the data of scenes, the verdicts, and the studies that other commands wrote into the
//! directory; for a missing study only its command is named.

mod broken;
mod opening;
mod step_size;
#[cfg(test)]
mod tests;

pub(super) use broken::numbered;

use super::content::Report;
use super::{Block, Chapter, Run, Section, StudyDocument, Table, Tone};

pub(super) fn chapters(report: &Report<'_>) -> Vec<Section> {
    let mut pen = Pen { report, sections: Vec::new() };
    opening::bound(&mut pen);
    step_size::write(&mut pen, &report.studies);
    pen.studies(Chapter::Bound);
    opening::gronwall(&mut pen);
    pen.studies(Chapter::Gronwall);
    opening::audit(&mut pen);
    pen.studies(Chapter::Audit);
    pen.studies(Chapter::Ledger);
    broken::write(&mut pen);
    opening::trade(&mut pen);
    pen.studies(Chapter::Trade);
    opening::extremes(&mut pen);
    pen.studies(Chapter::Extremes);
    pen.sections
}

/// Failures found by the studies: a sentence each, with its section.
pub(super) fn failures(studies: &[StudyDocument]) -> Vec<(String, String)> {
    let wrong = studies.iter().filter(|study| !study.holds);
    wrong.map(|study| (failure(study), format!("#{}", id(study)))).collect()
}

fn failure(study: &StudyDocument) -> String {
    let what = match study.chapter {
        Chapter::Bound => "(3.4)",
        Chapter::Gronwall => "Gronwall's inequality",
        Chapter::Audit => "the proof line by line",
        Chapter::Ledger => return "the theorem ledger: not every claim is confirmed".into(),
        Chapter::Trade => "trade",
        Chapter::Extremes => return "extremes: not every rung is as expected".into(),
    };
    format!("{what}, {}: not everything holds", study.scene.as_deref().unwrap_or("no scene"))
}

fn id(study: &StudyDocument) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '-' };
    let name = study.chapter.name();
    match &study.scene {
        Some(scene) => format!("{name}-{}", scene.chars().map(plain).collect::<String>()),
        None => format!("study-{name}"),
    }
}

struct Pen<'a> {
    report: &'a Report<'a>,
    sections: Vec<Section>,
}

impl Pen<'_> {
    fn chapter(&mut self, id: &str, title: &str, text: &str) {
        self.sections.push(Section::new(1, id, title));
        self.words(text);
    }

    fn section(&mut self, id: &str, title: &str) {
        self.sections.push(Section::new(2, id, title));
    }

    fn block(&mut self, block: Block) {
        if let Some(section) = self.sections.last_mut() {
            section.blocks.push(block);
        }
    }

    fn text(&mut self, runs: Vec<Run>) {
        self.block(Block::Text(runs));
    }

    fn words(&mut self, text: &str) {
        self.text(vec![Run::plain(text)]);
    }

    /// A table; heads that begin with `>` are numeric. Omitted without rows.
    fn table(&mut self, caption: &str, heads: &[&str], rows: Vec<Vec<Run>>) {
        if !rows.is_empty() {
            self.block(Block::Table(Table::new(caption, heads, rows)));
        }
    }

    /// The studies of a chapter, a section each, or the command that makes one.
    fn studies(&mut self, chapter: Chapter) {
        let report = self.report;
        let mut studies = report.studies.iter().filter(|study| study.chapter == chapter).peekable();
        if studies.peek().is_none() {
            let what = match chapter {
                Chapter::Bound => "There is no measured contraction factor",
                Chapter::Ledger => "There is no ledger of claims, sharp or slack,",
                _ => "There is no such study",
            };
            self.absent(what, chapter.command());
        }
        for study in studies {
            self.section(&id(study), &study.title);
            self.of_this_text(study);
            study.blocks.iter().for_each(|block| self.block(block.clone()));
        }
    }

    /// Names the command for a missing kind of study.
    fn absent(&mut self, what: &str, command: &str) {
        self.text(vec![
            Run::plain(format!("{what} in the directory of this report: ")),
            Run::code(format!("sweep {command} --out DIR")),
            Run::plain(" adds one, and "),
            Run::code("sweep report DIR"),
            Run::plain(" shows it here."),
        ]);
    }

    /// Notes a study of another text of a scene, which is no evidence for these records.
    fn of_this_text(&mut self, study: &StudyDocument) {
        let Some(scene) = &study.scene else { return };
        let known = self.report.provenance.get("scenes").and_then(|scenes| scenes.get(scene));
        let known = known.and_then(serde_json::Value::as_str);
        if known.is_some_and(|hash| study.fingerprint.as_deref() != Some(hash)) {
            let words = "This study was made with another text of the scene than the records.";
            self.text(vec![Run::of(words, Tone::Miss)]);
        }
    }
}
