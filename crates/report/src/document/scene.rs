//! The section of a scene: a summary, and the evidence of its verdicts.

use super::chapter::numbered;
use super::content::{Report, tone, verdict_row};
use super::evidence::{cases, points};
use super::verdicts::VERDICT_HEADS;
use super::{Block, Card, Run, Section, Table, Tone};
use judge::verdict::{Verdict, cell_texts};

pub(super) fn of_scene(report: &Report<'_>, at: usize) -> Section {
    let (scene, drawn) = (&report.scenes[at], &report.drawn[at]);
    let mut section = Section::new(3, &drawn.stem, &scene.name);
    let verdicts: Vec<&Verdict> =
        report.verdicts.iter().filter(|v| v.scene == scene.name).collect();
    section.card = Some(Card { verdict: glance(&verdicts), pictures: drawn.card.clone() });
    section.words(&*scene.question);
    scene.remarks.iter().for_each(|remark| section.words(remark));
    if !scene.violates.is_empty() {
        let names: Vec<String> = scene.violates.iter().map(|name| numbered(name)).collect();
        section.words(format!("Broken on purpose: {}.", names.join(", ")));
    }
    if !scene.equations.is_empty() {
        section.blocks.push(Block::Formulas(scene.equations.clone()));
    }
    for verdict in &verdicts {
        section.text(sentence(verdict));
    }
    let rows = verdicts.iter().map(|verdict| verdict_row(verdict, None).split_off(1)).collect();
    let caption = format!("{}: predicted and observed orders.", scene.name);
    section.table(Table::new(caption, &VERDICT_HEADS[1..], rows));
    section.figures(&drawn.figures);
    for verdict in &verdicts {
        section.table(points(verdict));
    }
    section.table(cases(&scene.name, report.records));
    let row = |[part, key, value]: &[String; 3]| {
        vec![Run::plain(part), Run::plain(key), Run::code(value)]
    };
    let caption = format!("{}: data, as the scene file gives them.", scene.name);
    let rows = scene.data.iter().map(row).collect();
    section.table(Table::new(caption, &["part", "key", "value"], rows).evidence());
    section
}

/// A verdict in words, without the name of its scene.
pub(super) fn sentence(verdict: &Verdict) -> Vec<Run> {
    let [_, norm, variable, .., decision, _] = cell_texts(verdict);
    vec![
        Run::of(format!("{norm} in {variable}: "), Tone::Strong),
        Run::of(decision, tone(verdict)),
        Run::plain(format!("; {}.", verdict.reason.trim_end_matches('.'))),
    ]
}

/// All verdicts of a scene in one sentence: the first unexpected one, or the first, and the number of others.
fn glance(verdicts: &[&Verdict]) -> Vec<Run> {
    let wrong: Vec<_> = verdicts.iter().filter(|verdict| !verdict.as_expected()).collect();
    let Some(shown) = wrong.first().copied().or(verdicts.first()) else {
        return vec![Run::plain("Measured, not judged.")];
    };
    let [_, norm, variable, predicted, observed, decision, _] = cell_texts(shown);
    let observed = observed.replace('\n', "; ");
    let mut runs = vec![
        Run::of(decision, tone(shown)),
        Run::plain(format!(": order {observed} for {predicted}, {norm} in {variable}")),
    ];
    let more = verdicts.len() - 1;
    runs.push(match (wrong.len(), more) {
        (_, 0) => Run::plain("."),
        (0, more) => Run::plain(format!("; {more} more as expected.")),
        (wrong, _) => {
            Run::of(format!("; {wrong} of {} not as expected.", verdicts.len()), Tone::Miss)
        }
    });
    runs
}
