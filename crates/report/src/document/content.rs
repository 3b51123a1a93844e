//! The sections of a report, from its records and verdicts.

use super::StudyDocument;
use super::chapter::{chapters, failures};
use super::evidence::{cases, points};
use super::{Block, Document, Figure, Run, Section, Table, Tone};
use crate::{Picture, SceneSummary};
use files::{counted, quoted};
use judge::record::{CaseRecord, Status};
use judge::verdict::{Decision, NOTHING_JUDGED, Verdict, cell_texts, exit_code};

/// What a report is made of.
pub(crate) struct Report<'a> {
    pub(crate) scenes: &'a [SceneSummary],
    /// A file name a scene, without ending.
    pub(crate) stems: &'a [String],
    /// File name, caption and SVG of the pictures of each scene.
    pub(crate) pictures: &'a [Vec<Picture>],
    /// What other commands left in the directory.
    pub(crate) studies: Vec<StudyDocument>,
    /// Pictures of single cases that are there.
    pub(crate) of_cases: Vec<Picture>,
    pub(crate) records: &'a [CaseRecord],
    pub(crate) verdicts: &'a [Verdict],
    pub(crate) provenance: &'a serde_json::Value,
}

/// Numbers of tables and figures, counted through the document.
#[derive(Default)]
pub(super) struct Numbers {
    tables: usize,
    figures: usize,
}

impl Numbers {
    pub(super) fn table(&mut self) -> usize {
        self.tables += 1;
        self.tables
    }

    pub(super) fn figure(&mut self) -> usize {
        self.figures += 1;
        self.figures
    }
}

/// The document of a report.
pub(crate) fn document(report: Report<'_>) -> Document {
    let mut numbers = Numbers::default();
    let outcome = outcome(report.records, report.verdicts);
    let mut sections = vec![summary(&report, &outcome, &failures(&report.studies), &mut numbers)];
    if !report.scenes.is_empty() {
        sections.push(introduction());
    }
    let pictures = report.pictures.iter().cloned();
    for ((scene, stem), pictures) in report.scenes.iter().zip(report.stems).zip(pictures) {
        sections.push(of_scene(scene, stem, pictures, &report, &mut numbers));
    }
    sections.extend(chapters(&report, &mut numbers));
    if !report.of_cases.is_empty() {
        sections.push(further(report.of_cases.clone(), &mut numbers));
    }
    sections.push(reproduction(&report, &mut numbers));
    let entry = |key: &str| report.provenance.get(key).and_then(serde_json::Value::as_str);
    let made_by = ["program", "version", "platform"].into_iter().filter_map(entry);
    Document {
        title: "Orders of convergence".into(),
        outcome,
        made_by: made_by.collect::<Vec<_>>().join(" "),
        sections,
    }
}

fn outcome(records: &[CaseRecord], verdicts: &[Verdict]) -> String {
    let met = verdicts.iter().filter(|verdict| verdict.as_expected()).count();
    let failed =
        records.iter().filter(|record| matches!(record.status, Status::Failed { .. })).count();
    let code = exit_code(records, verdicts);
    let judged = match verdicts.len() {
        0 => NOTHING_JUDGED.to_owned(),
        count => format!("{met} of {} as expected", counted(count, "verdict")),
    };
    let cases = counted(records.len(), "case");
    format!("{judged}; {cases}, {failed} of them failed. Exit code {code}.")
}

pub(super) fn tone(verdict: &Verdict) -> Tone {
    if verdict.as_expected() { Tone::Pass } else { Tone::Miss }
}

impl Report<'_> {
    /// The name of a scene's section.
    pub(super) fn stem(&self, scene: &SceneSummary) -> &str {
        let at = self.scenes.iter().position(|own| own.name == scene.name);
        at.map_or("", |at| &self.stems[at])
    }
}

/// The section of a scene by its name.
fn id_of(report: &Report<'_>, name: &str) -> Option<String> {
    let at = report.scenes.iter().position(|scene| scene.name == name)?;
    Some(format!("#{}", report.stems[at]))
}

fn summary(
    report: &Report<'_>,
    outcome: &str,
    failures: &[(String, String)],
    numbers: &mut Numbers,
) -> Section {
    let mut section = Section::new(1, "verdicts", "Verdicts");
    section.text(vec![Run::plain(outcome)]);
    for (failure, target) in failures {
        section.text(vec![Run::of(format!("{failure}."), Tone::Miss).to(target)]);
    }
    if report.verdicts.is_empty() {
        return section;
    }
    let row = |verdict: &Verdict| {
        let [scene, norm, variable, predicted, observed, decision, why] = cell_texts(verdict);
        let target = id_of(report, &verdict.scene);
        let linked = |run: Run| Run { target: target.clone(), ..run };
        vec![
            linked(Run::plain(scene)),
            Run::plain(norm),
            Run::plain(variable),
            Run::plain(predicted),
            Run::plain(observed),
            linked(Run::of(decision, tone(verdict))),
            Run::plain(why),
        ]
    };
    let head = ["scene", "norm", "in", "predicted", "observed", "verdict", "by"];
    section.blocks.push(Block::Table(Table {
        number: numbers.table(),
        caption: "Predicted orders, observed orders with their intervals, and what they say."
            .into(),
        head: head.map(Into::into).into(),
        numeric: vec![false; head.len()],
        rows: report.verdicts.iter().map(row).collect(),
    }));
    let remarkable = |v: &&Verdict| !v.as_expected() || v.decision != Decision::Pass;
    for verdict in report.verdicts.iter().filter(remarkable) {
        section.text(sentence(verdict));
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

/// A verdict in words.
fn sentence(verdict: &Verdict) -> Vec<Run> {
    let [scene, norm, variable, .., decision, _] = cell_texts(verdict);
    vec![
        Run::of(format!("{scene}, {norm} in {variable}: "), Tone::Strong),
        Run::of(decision, tone(verdict)),
        Run::plain(format!(". {}.", verdict.reason.trim_end_matches('.'))),
    ]
}

fn introduction() -> Section {
    let mut section = Section::new(1, "scenes", "Scenes");
    section.text(vec![Run::plain(
        "Each scene asks one question. Errors are maxima over the time levels in the norm named; V_max is the norm of the paper, ‖ε(u − u_h)‖ in L²(Ω). \
         h is 1/n with n cells per unit length, or the longest edge of an imported mesh; k = T/N with N steps. Lengths, stresses and times are in the units of the scene. \
         A local order is that between two neighbouring points that served; a floor is what of an error is not the discretisation.",
    )]);
    section
}

fn of_scene(
    scene: &SceneSummary,
    stem: &str,
    pictures: Vec<Picture>,
    report: &Report<'_>,
    numbers: &mut Numbers,
) -> Section {
    let mut section = Section::new(2, stem, &scene.name);
    section.text(vec![Run::plain(&*scene.question)]);
    for remark in &scene.remarks {
        section.text(vec![Run::plain(remark)]);
    }
    if !scene.equations.is_empty() {
        section.blocks.push(Block::Formulas(scene.equations.clone()));
    }
    let own: Vec<&Verdict> = report.verdicts.iter().filter(|v| v.scene == scene.name).collect();
    for verdict in &own {
        section.text(sentence(verdict));
    }
    if !own.is_empty() {
        let row = |verdict: &&Verdict| {
            let [_, norm, variable, predicted, observed, decision, why] = cell_texts(verdict);
            let plain = [norm, variable, predicted, why, observed].into_iter().map(Run::plain);
            plain.chain([Run::of(decision, tone(verdict))]).collect()
        };
        let head = ["norm", "in", "predicted", "by", "observed", "verdict"];
        section.blocks.push(Block::Table(Table {
            number: numbers.table(),
            caption: format!("{}: predicted and observed orders.", scene.name),
            head: head.map(Into::into).into(),
            numeric: vec![false; head.len()],
            rows: own.iter().map(row).collect(),
        }));
    }
    for verdict in &own {
        section.blocks.push(Block::Table(points(verdict, report.records, numbers.table())));
    }
    for (file, caption, svg) in pictures {
        let number = numbers.figure();
        section.blocks.push(Block::Figure(Figure { number, file, caption, svg }));
    }
    if let Some(table) = cases(&scene.name, report.records, numbers.tables + 1) {
        numbers.tables += 1;
        section.blocks.push(Block::Table(table));
    }
    if !scene.data.is_empty() {
        let row = |[part, key, value]: &[String; 3]| {
            vec![Run::plain(part), Run::plain(key), Run::code(value)]
        };
        section.blocks.push(Block::Table(Table {
            number: numbers.table(),
            caption: format!("{}: data, as the scene file gives them.", scene.name),
            head: ["part", "key", "value"].map(Into::into).into(),
            numeric: vec![false; 3],
            rows: scene.data.iter().map(row).collect(),
        }));
    }
    section
}

fn further(pictures: Vec<Picture>, numbers: &mut Numbers) -> Section {
    let mut section = Section::new(1, "studies", "Further pictures in this directory");
    section.text(vec![Run::plain("Written here by the command that each caption names.")]);
    for (file, caption, svg) in pictures {
        let number = numbers.figure();
        section.blocks.push(Block::Figure(Figure { number, file, caption, svg }));
    }
    section
}

fn reproduction(report: &Report<'_>, numbers: &mut Numbers) -> Section {
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
        "sweep report DIR\nsweep run {scene} --out reports/again\nsweep explain {scene}"
    )));
    section.text(vec![Run::plain(
        "Records are the same, bit for bit, for any number of threads, but for the columns of seconds.",
    )]);
    let text = |value: &serde_json::Value| value.as_str().map_or(value.to_string(), str::to_owned);
    let mut rows = Vec::new();
    for (key, value) in report.provenance.as_object().into_iter().flatten() {
        match value.as_object() {
            Some(inner) => rows.extend(inner.iter().map(|(name, value)| {
                vec![Run::plain(key), Run::plain(name), Run::code(text(value))]
            })),
            None => rows.push(vec![Run::plain(key), Run::plain(""), Run::code(text(value))]),
        }
    }
    if !rows.is_empty() {
        section.blocks.push(Block::Table(Table {
            number: numbers.table(),
            caption: "Provenance: program, and the fingerprint of each scene's text.".into(),
            head: ["what", "of", "value"].map(Into::into).into(),
            numeric: vec![false; 3],
            rows,
        }));
    }
    section
}
