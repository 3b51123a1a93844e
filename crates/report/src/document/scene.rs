//! The section of a scene: a summary, and the evidence of its verdicts.

use super::chapter::numbered;
use super::content::{Numbers, Report, tone};
use super::evidence::{cases, points};
use super::{Block, Card, Figure, Run, Section, Table, Tone};
use judge::verdict::{Verdict, cell_texts};

pub(super) fn of_scene(report: &Report<'_>, at: usize, numbers: &mut Numbers) -> Section {
    let scene = &report.scenes[at];
    let mut section = Section::new(3, &report.stems[at], &scene.name);
    let verdicts: Vec<&Verdict> =
        report.verdicts.iter().filter(|v| v.scene == scene.name).collect();
    let pictures = report.cards[at].iter().cloned().map(Figure::new).collect();
    section.card = Some(Card { verdict: glance(&verdicts), pictures });
    section.text(vec![Run::plain(&*scene.question)]);
    for remark in &scene.remarks {
        section.text(vec![Run::plain(remark)]);
    }
    if !scene.violates.is_empty() {
        let names: Vec<String> = scene.violates.iter().map(|name| numbered(name)).collect();
        section.text(vec![Run::plain(format!("Broken on purpose: {}.", names.join(", ")))]);
    }
    if !scene.equations.is_empty() {
        section.blocks.push(Block::Formulas(scene.equations.clone()));
    }
    for verdict in &verdicts {
        section.text(sentence(verdict));
    }
    let table = |table: Table| Block::Table(table);
    if !verdicts.is_empty() {
        let row = |verdict: &&Verdict| {
            let [_, norm, variable, predicted, observed, decision, why] = cell_texts(verdict);
            let plain = [norm, variable, predicted, why, observed].into_iter().map(Run::plain);
            plain.chain([Run::of(decision, tone(verdict))]).collect()
        };
        let heads = ["norm", "in", "predicted", "by", "observed", "verdict"];
        let caption = format!("{}: predicted and observed orders.", scene.name);
        section.blocks.push(table(Table::new(caption, &heads, verdicts.iter().map(row).collect())));
    }
    let pictures = report.pictures[at].iter().cloned();
    section.blocks.extend(pictures.map(Figure::new).map(Block::Figure));
    section.blocks.extend(verdicts.iter().map(|verdict| table(points(verdict, report.records))));
    section.blocks.extend(cases(&scene.name, report.records).map(table));
    if !scene.data.is_empty() {
        let row = |[part, key, value]: &[String; 3]| {
            vec![Run::plain(part), Run::plain(key), Run::code(value)]
        };
        let caption = format!("{}: data, as the scene file gives them.", scene.name);
        let rows = scene.data.iter().map(row).collect();
        let data = Table::new(caption, &["part", "key", "value"], rows).evidence();
        section.blocks.push(table(data));
    }
    numbers.given_all(section)
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
