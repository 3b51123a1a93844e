//! Chapters beside the orders: theory, cost of accuracy, extremes.
//!
//! They are written from the data of scenes, the verdicts, and the studies that other commands wrote into the
//! directory; for a missing study only its command is named.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use crate::document::content::{Drawn, Report, tone};
use crate::document::{
    Block, Chapter, Equation, Run, Section, StudyDocument, Table, Tone, number, precise,
};
use crate::{StepLimits, plain_name};
use judge::verdict::cell_texts;
use serde::Deserialize;

#[cfg(test)]
mod tests;

/// How a chapter of studies begins.
#[derive(Deserialize)]
struct Opening {
    chapter: Chapter,
    id: String,
    title: String,
    words: String,
    #[serde(default)]
    formulas: Vec<[String; 3]>,
    #[serde(default)]
    more: String,
}

static OPENINGS: LazyLock<Vec<Opening>> = LazyLock::new(|| {
    let text = include_str!("chapters.toml");
    let all: BTreeMap<String, Vec<Opening>> = toml::from_str(text).expect("openings that are read");
    all.into_values().flatten().collect()
});

impl Opening {
    fn section(&self) -> Section {
        let mut section = Section::opening(&self.id, &self.title, &self.words);
        if !self.formulas.is_empty() {
            let formula =
                |[plain, typst, number]: &[String; 3]| Equation::new(plain, typst, number);
            section.blocks.push(Block::Formulas(self.formulas.iter().map(formula).collect()));
        }
        if !self.more.is_empty() {
            section.words(&self.more);
        }
        section
    }
}

/// The chapters that have something to show, and a last section that names the commands of the others.
pub(super) fn chapters(report: &Report<'_>) -> Vec<Section> {
    let (mut all, broken) = (Vec::new(), broken(report));
    for chapter in Chapter::ALL {
        if chapter == Chapter::Trade {
            all.extend(broken.clone());
        }
        let studies = studies(report, chapter);
        // Every scene has its bounds.
        let bounds = (chapter == Chapter::Bound).then(|| step_sizes(report));
        if bounds.is_some() || !studies.is_empty() {
            let opening = OPENINGS.iter().find(|opening| opening.chapter == chapter);
            all.extend(opening.map(Opening::section));
        }
        all.extend(bounds.into_iter().chain(studies));
    }
    all.extend(absent(report, broken.is_none()));
    all
}

/// Failures found by the studies: a sentence each, with its section.
pub(super) fn failures(studies: &[StudyDocument]) -> Vec<(String, String)> {
    let failure = |study: &StudyDocument| {
        let (what, scene) = (study.chapter.subject(), study.scene.as_ref());
        let of = scene.map_or(String::new(), |scene| format!(", {scene}"));
        (format!("{what}{of}: not everything holds"), format!("#{}", id(study)))
    };
    studies.iter().filter(|study| !study.holds).map(failure).collect()
}

fn id(study: &StudyDocument) -> String {
    let name = study.chapter.name();
    match &study.scene {
        Some(scene) => format!("{name}-{}", plain_name(scene)),
        None => format!("study-{name}"),
    }
}

/// The studies of a chapter, a section each.
fn studies(report: &Report<'_>, chapter: Chapter) -> Vec<Section> {
    let of_chapter = report.studies.iter().filter(|study| study.chapter == chapter);
    let section = |study: &StudyDocument| {
        let mut section = Section::new(2, &id(study), &study.title);
        // A study of another text of a scene is no evidence for these records.
        let known =
            study.scene.as_ref().and_then(|scene| report.provenance["scenes"][scene].as_str());
        if known.is_some_and(|hash| study.fingerprint.as_deref() != Some(hash)) {
            let words = "This study was made from a different text of the scene than the records.";
            section.text(vec![Run::of(words, Tone::Miss)]);
        }
        section.blocks.extend(study.blocks.iter().cloned());
        section
    };
    of_chapter.map(section).collect()
}

/// The commands of what is not in the directory of this report; None if nothing is missing.
fn absent(report: &Report<'_>, none_broken: bool) -> Option<Section> {
    let kinds = OPENINGS.iter().map(|opening| opening.chapter);
    let missing = kinds.filter(|kind| report.studies.iter().all(|s| s.chapter != *kind));
    let mut commands: Vec<&str> = missing.map(Chapter::command).collect();
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

// The bound (3.4) of every scene, in numbers that follow from its data.

/// Hypotheses necessary for a bound: (2.9) and κ Lipschitz, by their names in scene files.
const NEEDED: [&str; 2] = ["2.9", "5.1"];

fn step_sizes(report: &Report<'_>) -> Section {
    let mut section = Section::new(2, "chapter-step-sizes", "Bounds of all scenes");
    let rows = report.scenes.iter().map(|drawn| row(drawn, report)).collect();
    let bounds =
        [">m0", ">(3.4), paper's norm", ">(3.4)", ">sharpened", ">Λ measured", ">solvable"];
    let heads = [&["scene"][..], &bounds, &[">largest k", "which is"]].concat();
    section.table(Table::new(
        "Step sizes: bounds on k, and the largest k of the records.",
        &heads,
        rows,
    ));
    section
}

fn row(Drawn { scene, stem, .. }: &Drawn<'_>, report: &Report<'_>) -> Vec<Run> {
    let of_scene = report.records.iter().filter(|record| record.scene == scene.name);
    let largest = of_scene.map(|record| record.k).reduce(f64::max);
    let study = |study: &&StudyDocument| {
        study.chapter == Chapter::Bound && study.scene.as_ref() == Some(&scene.name)
    };
    let measured = report.studies.iter().find(study).and_then(|study| {
        Some(Run::plain(study.threshold.as_ref()?).to(format!("#{}", id(study))))
    });
    let measured = measured.unwrap_or_else(|| Run::plain("–"));
    let broken = scene.violates.iter().find(|name| NEEDED.contains(&name.as_str()));
    let limit = |of: fn(&StepLimits) -> f64| match (&scene.step, broken) {
        (Some(limits), None) if of(limits).is_infinite() => Run::plain("every k"),
        (Some(limits), None) => precise(of(limits), 5),
        _ => Run::plain("–"),
    };
    let standing = match (&scene.step, broken) {
        (None, _) => Run::plain("not computed"),
        (_, Some(name)) => Run::plain(format!("without a bound: ({name}) is broken")),
        (Some(limits), None) => match largest {
            None => Run::plain("–"),
            Some(k) if k < limits.theorem => Run::plain("within (3.4)"),
            Some(k) if k < limits.solvable => Run::plain("beyond (3.4), one solution"),
            // Includes NaN limits.
            Some(_) => Run::of("not guaranteed", Tone::Strong),
        },
    };
    vec![
        Run::plain(&*scene.name).to(format!("#{stem}")),
        number(scene.step.map(|limits| limits.m0)),
        limit(|limits| limits.paper),
        limit(|limits| limits.theorem),
        limit(|limits| limits.sharpened),
        measured,
        limit(|limits| limits.solvable),
        number(largest),
        standing,
    ]
}

// Broken hypotheses: the scenes that break one on purpose, and the remaining order.

/// None without such a scene.
fn broken(report: &Report<'_>) -> Option<Section> {
    let breaks = |drawn: &&Drawn<'_>| !drawn.scene.violates.is_empty();
    let broken: Vec<_> = report.scenes.iter().filter(breaks).collect();
    if broken.is_empty() {
        return None;
    }
    let mut section = Section::opening(
        "chapter-broken",
        "Broken hypotheses",
        "A hypothesis is needed if the order is lost without it. These scenes break one on purpose; what is then left was derived beforehand, \
         and is judged like any other prediction.",
    );
    let mut rows = Vec::new();
    for Drawn { scene, stem, .. } in broken {
        let target = format!("#{stem}");
        let first = [
            Run::plain(
                scene.violates.iter().map(|name| numbered(name)).collect::<Vec<_>>().join(", "),
            ),
            Run::plain(&*scene.name).to(target),
        ];
        let of_scene = report.verdicts.iter().filter(|verdict| verdict.scene == scene.name);
        let judged: Vec<Vec<Run>> = of_scene
            .map(|verdict| {
                let [_, norm, variable, predicted, observed, decision, _] = cell_texts(verdict);
                let cells = [format!("{norm} in {variable}"), predicted, observed].map(Run::plain);
                let decision = Run::of(decision, tone(verdict));
                first.iter().cloned().chain(cells).chain([decision]).collect()
            })
            .collect();
        if judged.is_empty() {
            let cells = ["–", "–", "–", "not judged"].map(Run::plain);
            rows.push(first.into_iter().chain(cells).collect());
        }
        rows.extend(judged);
    }
    section.table(Table::new(
        "Scenes that break a hypothesis, by its number in the paper: the order that is derived for it, and the one observed.",
        &["broken", "scene", "error", "predicted", "observed", "verdict"],
        rows,
    ));
    Some(section)
}

/// A hypothesis as named in scene files: a number of the paper, or a word.
pub(super) fn numbered(name: &str) -> String {
    match name.starts_with(|c: char| c.is_ascii_digit()) {
        true => format!("({name})"),
        false => name.replace('_', " "),
    }
}
