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
use super::{Chapter, Run, Section, StudyDocument, Tone};

pub(super) fn chapters(report: &Report<'_>) -> Vec<Section> {
    let mut all = vec![opening::bound(), step_size::section(report)];
    add_studies(&mut all, report, Chapter::Bound);
    all.push(opening::gronwall());
    add_studies(&mut all, report, Chapter::Gronwall);
    all.push(opening::audit());
    add_studies(&mut all, report, Chapter::Audit);
    all.extend([broken::chapter(report), opening::trade()]);
    add_studies(&mut all, report, Chapter::Trade);
    all.push(opening::extremes());
    add_studies(&mut all, report, Chapter::Extremes);
    all
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
        Chapter::Audit => "the inequalities of the proof",
        Chapter::Trade => "trade",
        Chapter::Diagnose => "which term is at fault",
        Chapter::Extremes => return "extremes: not every test is as expected".into(),
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

/// The studies of a chapter, a section each, or the command that makes one.
fn add_studies(sections: &mut Vec<Section>, report: &Report<'_>, chapter: Chapter) {
    let before = sections.len();
    for study in report.studies.iter().filter(|study| study.chapter == chapter) {
        let mut section = Section::new(2, &id(study), &study.title);
        of_this_text(&mut section, study, report);
        section.blocks.extend(study.blocks.iter().cloned());
        sections.push(section);
    }
    if before < sections.len() {
        return;
    }
    if let Some(last) = sections.last_mut() {
        let what = match chapter {
            Chapter::Bound => "There is no measured contraction factor",
            _ => "There is no such study",
        };
        absent(last, what, chapter.command());
    }
}

/// Names the command for a missing kind of study.
fn absent(section: &mut Section, what: &str, command: &str) {
    section.text(vec![
        Run::plain(format!("{what} in the directory of this report: ")),
        Run::code(format!("sweep {command} --out DIR")),
        Run::plain(" adds one, and "),
        Run::code("sweep report DIR"),
        Run::plain(" shows it here."),
    ]);
}

/// Notes a study of another text of a scene, which is no evidence for these records.
fn of_this_text(section: &mut Section, study: &StudyDocument, report: &Report<'_>) {
    let Some(scene) = &study.scene else { return };
    let known = report.provenance.get("scenes").and_then(|scenes| scenes.get(scene));
    let known = known.and_then(serde_json::Value::as_str);
    if known.is_some_and(|hash| study.fingerprint.as_deref() != Some(hash)) {
        let words = "This study was made from a different text of the scene than the records.";
        section.text(vec![Run::of(words, Tone::Miss)]);
    }
}
