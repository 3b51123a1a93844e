//! Broken hypotheses: the scenes that break one on purpose, and the remaining order.

use super::Report;
use crate::document::content::tone;
use crate::document::{Run, Section, Table};
use judge::verdict::cell_texts;

/// None without such a scene.
pub(super) fn chapter(report: &Report<'_>) -> Option<Section> {
    let broken: Vec<_> = report.scenes.iter().filter(|scene| !scene.violates.is_empty()).collect();
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
    for scene in &broken {
        let target = format!("#{}", report.stem(scene));
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
        match judged.is_empty() {
            false => rows.extend(judged),
            true => {
                let cells = ["–", "–", "–", "not judged"].map(Run::plain);
                rows.push(first.into_iter().chain(cells).collect());
            }
        }
    }
    section.table(Table::new(
        "Scenes that break a hypothesis, by its number in the paper: the order that is derived for it, and the one observed.",
        &["broken", "scene", "error", "predicted", "observed", "verdict"],
        rows,
    ));
    Some(section)
}

/// A hypothesis as named in scene files: a number of the paper, or a word.
pub(in crate::document) fn numbered(name: &str) -> String {
    match name.starts_with(|c: char| c.is_ascii_digit()) {
        true => format!("({name})"),
        false => name.replace('_', " "),
    }
}
