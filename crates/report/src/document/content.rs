//! The sections of a report, from its records and verdicts.

use super::StudyDocument;
use super::answers;
use super::chapter::{chapters, failures};
use super::scene::{of_scene, sentence};
use super::verdicts::{VERDICT_HEADS, outcome};
use super::{Block, Document, Figure, Run, Section, Table, Tone};
use crate::{Group, SceneSummary};
use files::quoted;
use judge::record::CaseRecord;
use judge::verdict::{Decision, Verdict, cell_texts, exit_code};
use serde_json::Value;

/// The pictures of a scene.
#[derive(Default)]
pub(crate) struct Drawn {
    /// Its file names without endings.
    pub(crate) stem: String,
    pub(crate) figures: Vec<Figure>,
    /// Small pictures of body and errors.
    pub(crate) card: Vec<Figure>,
}

pub(crate) struct Report<'a> {
    pub(crate) scenes: &'a [SceneSummary],
    /// One per scene.
    pub(crate) drawn: &'a [Drawn],
    /// The forest plot, whole and in pieces.
    pub(crate) forest: Option<&'a Figure>,
    /// Studies found in the directory.
    pub(crate) studies: Vec<StudyDocument>,
    /// Pictures of single cases found in the directory.
    pub(crate) of_cases: Vec<Figure>,
    pub(crate) records: &'a [CaseRecord],
    pub(crate) verdicts: &'a [Verdict],
    pub(crate) provenance: &'a Value,
}

pub(crate) fn document(report: Report<'_>) -> Document {
    let (records, verdicts) = (report.records, report.verdicts);
    let outcome =
        format!("{}. Exit code {}.", outcome(records, verdicts), exit_code(records, verdicts));
    let mut sections = vec![summary(&report, &outcome, &failures(&report.studies))];
    if !report.scenes.is_empty() {
        sections.push(introduction());
    }
    for group in Group::ALL {
        let in_group = |at: &usize| report.group(&report.scenes[*at].name) == group;
        let members: Vec<usize> = (0..report.scenes.len()).filter(in_group).collect();
        if !members.is_empty() {
            let id = format!("group-{group:?}").to_lowercase();
            sections.push(Section::new(2, &id, group.title()));
        }
        sections.extend(members.into_iter().map(|at| of_scene(&report, at)));
    }
    sections.extend(chapters(&report));
    if !report.of_cases.is_empty() {
        let mut further = Section::new(1, "studies", "Further pictures in this directory");
        further.words("Written here by the command that each caption names.");
        further.figures(&report.of_cases);
        sections.push(further);
    }
    sections.push(reproduction(&report));
    number(&mut sections);
    let entry = |key: &str| report.provenance.get(key).and_then(Value::as_str);
    let made_by = ["program", "version", "platform"].into_iter().filter_map(entry);
    Document {
        title: "Orders of convergence".into(),
        outcome,
        made_by: made_by.collect::<Vec<_>>().join(" "),
        sections,
    }
}

/// Numbers tables and figures throughout.
fn number(sections: &mut [Section]) {
    let (mut tables, mut figures) = (1.., 1..);
    for block in sections.iter_mut().flat_map(|section| &mut section.blocks) {
        match block {
            Block::Table(table) => table.number = tables.next().unwrap_or_default(),
            Block::Figure(figure) => figure.number = figures.next().unwrap_or_default(),
            Block::Text(_) | Block::Formulas(_) | Block::Code(_) => {}
        }
    }
}

pub(super) fn tone(verdict: &Verdict) -> Tone {
    if verdict.as_expected() { Tone::Pass } else { Tone::Miss }
}

impl Report<'_> {
    /// The group of a scene: by its terms, or `External`.
    pub(crate) fn group(&self, scene: &str) -> Group {
        group(self.scenes, self.provenance, scene)
    }

    pub(super) fn stem(&self, scene: &SceneSummary) -> &str {
        let at = self.scenes.iter().position(|other| other.name == scene.name);
        at.map_or("", |at| &self.drawn[at].stem)
    }

    /// Whether another program's solver is judged, not the estimates.
    pub(super) fn of_a_solver(&self) -> bool {
        by_verify(self.provenance)
    }

    /// A link to the section of a scene.
    pub(super) fn link(&self, name: &str) -> Option<String> {
        let scene = self.scenes.iter().find(|scene| scene.name == name)?;
        Some(format!("#{}", self.stem(scene)))
    }
}

/// Whether the records are those of another program's solver.
fn by_verify(provenance: &Value) -> bool {
    let options = provenance.get("run").and_then(|run| run.get("options")).and_then(Value::as_str);
    options.is_some_and(|options| options.split(' ').next() == Some("verify"))
}

/// The group of a scene by its name.
pub(crate) fn group(scenes: &[SceneSummary], provenance: &Value, scene: &str) -> Group {
    if by_verify(provenance) {
        return Group::External;
    }
    scenes
        .iter()
        .find(|summary| summary.name == scene)
        .map_or(Group::default(), |summary| summary.group)
}

/// A verdict as a row: scene, norm, variable, prediction, observation, decision and reason; the first and the decision
/// are linked.
pub(super) fn verdict_row(verdict: &Verdict, target: Option<String>) -> Vec<Run> {
    let mut row = cell_texts(verdict).map(Run::plain);
    row[5].tone = tone(verdict);
    (row[0].target, row[5].target) = (target.clone(), target);
    row.into()
}

fn summary(report: &Report<'_>, outcome: &str, failures: &[(String, String)]) -> Section {
    let mut section = Section::new(1, "verdicts", "Verdicts");
    section.words(outcome);
    for (failure, target) in failures {
        section.text(vec![Run::of(format!("{failure}."), Tone::Miss).to(target)]);
    }
    if report.verdicts.is_empty() {
        return section;
    }
    answers::write(&mut section, report);
    section.figures(report.forest.map_or(&[], std::slice::from_ref));
    let row = |verdict: &Verdict| verdict_row(verdict, report.link(&verdict.scene));
    let rows = report.verdicts.iter().map(row).collect();
    let caption = "Predicted and observed orders with their intervals, and the verdicts.";
    section.table(Table::new(caption, &VERDICT_HEADS, rows).evidence());
    let remarkable = |v: &&Verdict| !v.as_expected() || v.decision != Decision::Pass;
    for verdict in report.verdicts.iter().filter(remarkable) {
        let mut runs = vec![Run::of(format!("{}, ", verdict.scene), Tone::Strong)];
        runs.extend(sentence(verdict));
        section.text(runs);
    }
    section.text(vec![
        Run::plain("Every number: "),
        Run::plain("cases.csv").to("cases.csv"),
        Run::plain(", "),
        Run::plain("verdict.json").to("verdict.json"),
        Run::plain("."),
    ]);
    section
}

fn introduction() -> Section {
    let mut section = Section::new(1, "scenes", "Scenes");
    section.words(
        "Each scene asks one question. Errors are maxima over the time levels in the norm named; V_max is the norm of the paper, ‖ε(u − u_h)‖ in L²(Ω). \
         h is 1/n with n cells per unit length, or the longest edge of an imported mesh; k = T/N with N steps. Lengths, stresses and times are in the units of the scene. \
         A local order is that between two neighbouring points that were used; the error floor is the part of an error that does not come from the discretisation.",
    );
    section
}

fn reproduction(report: &Report<'_>) -> Section {
    let mut section = Section::new(1, "reproduce", "How to reproduce");
    section.text(vec![
        Run::plain("The records hold every number, and "),
        Run::code("provenance.json"),
        Run::plain(
            " the text of every scene. From the directory of this report its pages are made again without solving, and a scene is solved again, by",
        ),
    ]);
    let scene = report.scenes.first().map_or("SCENE".into(), |scene| quoted(&scene.name));
    section.blocks.push(Block::Code(format!(
        "sweep report DIR\nsweep run {scene} --out reports/again\nsweep check {scene}"
    )));
    section.words(
        "Records do not depend on the number of threads, bit for bit, except for the columns of seconds.",
    );
    let text = |value: &Value| value.as_str().map_or(value.to_string(), str::to_owned);
    let mut rows = Vec::new();
    for (key, value) in report.provenance.as_object().into_iter().flatten() {
        match value.as_object() {
            Some(inner) => rows.extend(inner.iter().map(|(name, value)| {
                vec![Run::plain(key), Run::plain(name), Run::code(text(value))]
            })),
            None => rows.push(vec![Run::plain(key), Run::plain(""), Run::code(text(value))]),
        }
    }
    let caption = "Provenance: program, and the fingerprint of each scene's text.";
    section.table(Table::new(caption, &["what", "of", "value"], rows).evidence());
    section
}
