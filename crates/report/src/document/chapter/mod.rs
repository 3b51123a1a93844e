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

/// The chapters that have something to show, and a last section that names the commands of the others.
pub(super) fn chapters(report: &Report<'_>) -> Vec<Section> {
    let mut all = Vec::new();
    let broken = broken::chapter(report);
    for chapter in Chapter::ALL {
        if chapter == Chapter::Trade {
            all.extend(broken.clone());
        }
        let studies = studies(report, chapter);
        // The bounds of the scenes are known without a study.
        let bounds = (chapter == Chapter::Bound).then(|| step_size::section(report));
        if bounds.is_some() || !studies.is_empty() {
            all.extend(opening::of(chapter));
        }
        all.extend(bounds.into_iter().chain(studies));
    }
    all.extend(absent(report, broken.is_none()));
    all
}

/// Failures found by the studies: a sentence each, with its section.
pub(super) fn failures(studies: &[StudyDocument]) -> Vec<(String, String)> {
    let wrong = studies.iter().filter(|study| !study.holds);
    wrong.map(|study| (failure(study), format!("#{}", id(study)))).collect()
}

fn failure(study: &StudyDocument) -> String {
    let what = study.chapter.subject();
    match &study.scene {
        Some(scene) => format!("{what}, {scene}: not everything holds"),
        None => format!("{what}: not everything holds"),
    }
}

fn id(study: &StudyDocument) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '-' };
    let name = study.chapter.name();
    match &study.scene {
        Some(scene) => format!("{name}-{}", scene.chars().map(plain).collect::<String>()),
        None => format!("study-{name}"),
    }
}

/// The studies of a chapter, a section each.
fn studies(report: &Report<'_>, chapter: Chapter) -> Vec<Section> {
    let of_chapter = report.studies.iter().filter(|study| study.chapter == chapter);
    let section = |study: &StudyDocument| {
        let mut section = Section::new(2, &id(study), &study.title);
        of_this_text(&mut section, study, report);
        section.blocks.extend(study.blocks.iter().cloned());
        section
    };
    of_chapter.map(section).collect()
}

/// The commands of what is not in the directory of this report; None if nothing is missing.
fn absent(report: &Report<'_>, none_broken: bool) -> Option<Section> {
    let lacks = |kind: &Chapter| report.studies.iter().all(|study| study.chapter != *kind);
    let kinds = Chapter::ALL.into_iter().filter(|kind| opening::of(*kind).is_some());
    let mut commands: Vec<&str> = kinds.filter(lacks).map(Chapter::command).collect();
    commands.extend(none_broken.then_some("run broken-kernel broken-trace"));
    if commands.is_empty() {
        return None;
    }
    let mut section = Section::new(1, "chapter-more", "More");
    let mut runs = vec![Run::plain("What else a report can show: ")];
    for command in commands {
        runs.extend([Run::code(format!("sweep {command} --out DIR")), Run::plain(", ")]);
    }
    runs.pop();
    runs.extend([Run::plain("; then "), Run::code("sweep report DIR"), Run::plain(".")]);
    section.text(runs);
    Some(section)
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
