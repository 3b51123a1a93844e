//! The sections of a report, from its records and verdicts.

use std::collections::BTreeSet;

use crate::convergence::norms;
use crate::document::chapter::{chapters, failures, numbered};
use crate::document::terminal::{VERDICT_HEADS, outcome};
use crate::document::{Block, Card, Document, Figure, Run, Section, StudyDocument, Table, Tone};
use crate::ruler::step_label;
use crate::symbols::symbols;
use crate::{Group, SceneSummary};
use files::{counted, quoted};
use judge::fit::{Direction, Point};
use judge::record::{CaseRecord, Status, V_MAX, is_by_state};
use judge::verdict::{Decision, Explanation, JudgedPoint, Verdict, cell_texts, exit_code};
use serde_json::Value;

/// A scene with its pictures.
pub(crate) struct Drawn<'a> {
    pub(crate) scene: &'a SceneSummary,
    /// By its terms, or [`Group::External`].
    pub(crate) group: Group,
    /// Its file names without endings.
    pub(crate) stem: String,
    pub(crate) figures: Vec<Figure>,
    /// Small pictures of body and errors.
    pub(crate) card: Vec<Figure>,
}

pub(crate) struct Report<'a> {
    pub(crate) scenes: &'a [Drawn<'a>],
    /// The forest plot, whole and in pieces.
    pub(crate) forest: Option<&'a Figure>,
    /// Studies found in the directory.
    pub(crate) studies: Vec<StudyDocument>,
    /// Pictures of single cases found in the directory.
    pub(crate) of_cases: Vec<Figure>,
    pub(crate) records: &'a [CaseRecord],
    pub(crate) verdicts: &'a [Verdict],
    pub(crate) provenance: &'a Value,
    /// Why a solver under test is wrong.
    pub(crate) cause: Option<&'a Explanation>,
}

pub(crate) fn document(report: Report<'_>) -> Document {
    let (records, verdicts) = (report.records, report.verdicts);
    let outcome =
        format!("{}. Exit code {}.", outcome(records, verdicts), exit_code(records, verdicts));
    let mut sections = vec![summary(&report, &outcome, &failures(&report.studies))];
    if !report.scenes.is_empty() {
        sections.push(Section::opening(
            "scenes",
            "Scenes",
            "Each scene asks one question. Errors are maxima over the time levels in the norm named; V_max is the norm of the paper, ‖ε(u − u_h)‖ in L²(Ω). \
             h is 1/n with n cells per unit length, or the longest edge of an imported mesh; k = T/N with N steps. Lengths, stresses and times are in the units of the scene. \
             A local order is that between two neighbouring points that were used; the error floor is the part of an error that does not come from the discretisation.",
        ));
    }
    for group in Group::ALL {
        let mut members = report.scenes.iter().filter(|drawn| drawn.group == group).peekable();
        if members.peek().is_some() {
            let id = format!("group-{group:?}").to_lowercase();
            sections.push(Section::new(2, &id, group.title()));
        }
        sections.extend(members.map(|drawn| of_scene(&report, drawn)));
    }
    sections.extend(chapters(&report));
    if !report.of_cases.is_empty() {
        let words = "Written here by the command that each caption names.";
        let mut further = Section::opening("studies", "Further pictures in this directory", words);
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
            Block::Text(_) | Block::Formulas(_) | Block::Code(_) | Block::Scene(_) => {}
        }
    }
}

pub(super) fn tone(verdict: &Verdict) -> Tone {
    if verdict.as_expected() { Tone::Pass } else { Tone::Miss }
}

impl Report<'_> {
    /// A link to the section of a scene.
    pub(super) fn link(&self, name: &str) -> Option<String> {
        let drawn = self.scenes.iter().find(|drawn| drawn.scene.name == name)?;
        Some(format!("#{}", drawn.stem))
    }
}

/// Whether the records are those of another program's solver, which is judged in place of the estimates.
pub(crate) fn by_verify(provenance: &Value) -> bool {
    let options = provenance.get("run").and_then(|run| run.get("options")).and_then(Value::as_str);
    options.is_some_and(|options| options.split(' ').next() == Some("verify"))
}

/// A verdict as a row: scene, norm, variable, prediction, observation, decision and reason; the first and the decision
/// are linked.
pub(super) fn verdict_row(verdict: &Verdict, target: Option<String>) -> Vec<Run> {
    let mut row = cell_texts(verdict).map(Run::plain);
    row[5].tone = tone(verdict);
    row[6].text = symbols(&row[6].text);
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
    first_answers(&mut section, report);
    section.figures(report.forest.map_or(&[], std::slice::from_ref));
    let row = |verdict: &Verdict| verdict_row(verdict, report.link(&verdict.scene));
    let rows = report.verdicts.iter().map(row).collect();
    let caption = "Predicted and observed orders with their intervals, and the verdicts.";
    section.table(Table::new(caption, &VERDICT_HEADS, rows).evidence());
    for verdict in report.verdicts.iter().filter(|verdict| !verdict.is_plain_pass()) {
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

fn reproduction(report: &Report<'_>) -> Section {
    let mut section = Section::new(1, "reproduce", "How to reproduce");
    section.text(vec![
        Run::plain("The records hold every number, and "),
        Run::code("provenance.json"),
        Run::plain(
            " the text of every scene. From the directory of this report its pages are made again without solving, and a scene is solved again, by",
        ),
    ]);
    let scene = report.scenes.first().map_or("SCENE".into(), |drawn| quoted(&drawn.scene.name));
    let again = match by_verify(report.provenance) {
        true => format!("sweep verify {scene} --solver COMMAND --out reports/again"),
        false => format!("sweep run {scene} --out reports/again"),
    };
    section.blocks.push(Block::Code(format!("sweep report DIR\n{again}\nsweep check {scene}")));
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

// The first answers: did the estimates, or the solver under test, hold; what is least certain; what was broken on purpose.

/// Claims that readers know by name, spelt as in the reasons of predictions.
const CLAIMS: [&str; 3] = ["(5.26)", "Theorem 7", "(5.24)"];

fn first_answers(section: &mut Section, report: &Report<'_>) {
    let of_a_solver = by_verify(report.provenance);
    let link = |scene: &str| report.link(scene);
    let [held, failed, closest] = three_answers(report.verdicts, of_a_solver, link);
    held.into_iter().for_each(|runs| section.text(runs));
    if let Some(cause) = report.cause {
        section.text(vec![
            Run::of("What is wrong? ", Tone::Strong),
            Run::of(cause.in_words(), Tone::Miss),
            Run::plain(format!(". {}.", cause.numbers)),
        ]);
    }
    failed.into_iter().chain(closest).for_each(|runs| section.text(runs));
    broken(section, report);
}

/// Whether the orders hold, what is not as expected, and what is least certain.
fn three_answers(
    verdicts: &[Verdict],
    of_a_solver: bool,
    link: impl Fn(&str) -> Option<String>,
) -> [Option<Vec<Run>>; 3] {
    let least = least_certain(verdicts).map(|verdict| closest(verdict, link(&verdict.scene)));
    [Some(by_claim(verdicts, of_a_solver)), failed(verdicts, of_a_solver, link), least]
}

/// The first answers, on the estimates, in a line each.
pub fn answers(verdicts: &[Verdict]) -> Vec<String> {
    let text = |runs: Vec<Run>| runs.iter().map(|run| run.text.as_str()).collect();
    three_answers(verdicts, false, |_| None).into_iter().flatten().map(text).collect()
}

fn held(judged: &[&Verdict]) -> Run {
    let met = judged.iter().filter(|verdict| verdict.as_expected()).count();
    let tone = if met == judged.len() { Tone::Pass } else { Tone::Miss };
    Run::of(format!("{met} of {}", judged.len()), tone)
}

fn by_claim(verdicts: &[Verdict], of_a_solver: bool) -> Vec<Run> {
    // Another program's solver is what `sweep verify` judges; the estimates are known to hold on its scene.
    let question = match of_a_solver {
        true => "Does the solver have the predicted orders? ",
        false => "Did the estimates hold? ",
    };
    let mut by_claim = vec![Run::of(question, Tone::Strong)];
    for claim in CLAIMS {
        let of_claim: Vec<&Verdict> = verdicts.iter().filter(|v| v.why.contains(claim)).collect();
        if !of_claim.is_empty() {
            let claim = Run::plain(format!("{claim}: "));
            by_claim.extend([claim, held(&of_claim), Run::plain("; ")]);
        }
    }
    let all = held(&verdicts.iter().collect::<Vec<_>>());
    by_claim.extend([Run::plain("all orders: "), all, Run::plain(" as expected.")]);
    by_claim
}

/// The first verdict that is not as expected, with its reason, and the number of others; and of a failed scene of this
/// program what finds the term at fault.
fn failed(
    verdicts: &[Verdict],
    of_a_solver: bool,
    link: impl Fn(&str) -> Option<String>,
) -> Option<Vec<Run>> {
    let mut wrong = verdicts.iter().filter(|verdict| !verdict.as_expected());
    let (first, others) = (wrong.next()?, wrong.count());
    let mut runs = vec![
        Run::of("What is not as expected? ", Tone::Strong),
        Run { target: link(&first.scene), ..Run::plain(first.scene.clone()) },
        Run::plain(", "),
    ];
    runs.extend(sentence(first));
    runs.extend((others > 0).then(|| Run::plain(format!(" So are {others} more."))));
    let diagnose = || Run::plain(format!(" Next: sweep diagnose {}.", quoted(&first.scene)));
    runs.extend((first.decision == Decision::Fail && !of_a_solver).then(diagnose));
    Some(runs)
}

/// Certain by a convention: the probability of a miss is that of one interval in twenty.
const CERTAIN: f64 = 0.95;

/// The verdict closest to being another one: the prediction holds with little more than needed for a pass, or misses it
/// by little. An unresolved one is closest. A scene that fails because it was built to is no warning, and a certain failure
/// is no doubt.
fn least_certain(verdicts: &[Verdict]) -> Option<&Verdict> {
    let by_constant = |verdict: &Verdict| verdict.constant.as_ref().is_some_and(|c| c.decides);
    let certainty = |verdict: &Verdict| match (verdict.decision, verdict.probability) {
        (Decision::Pass, _) if by_constant(verdict) => 1.0,
        (Decision::Pass, Some(probability)) => probability,
        (Decision::Fail, Some(probability)) => 1.0 - probability,
        // Without a probability cases are missing: that is certain.
        (Decision::Pass | Decision::Fail, None) => 1.0,
        (Decision::Unresolved, _) => 0.0,
    };
    let in_doubt = |verdict: &&Verdict| match verdict.decision {
        Decision::Pass => true,
        _ => !verdict.as_expected() && certainty(verdict) < CERTAIN,
    };
    verdicts.iter().filter(in_doubt).min_by(|a, b| certainty(a).total_cmp(&certainty(b)))
}

/// A verdict with its numbers, linked to its scene.
fn closest(verdict: &Verdict, link: Option<String>) -> Vec<Run> {
    let [scene, norm, variable, predicted, observed, decision, _] = cell_texts(verdict);
    let certain = match verdict.probability {
        Some(probability) => format!("holds with probability {probability:.2}"),
        None => "has no probability".into(),
    };
    let observed = observed.replace('\n', "; ");
    vec![
        Run::of("Which is least certain? ", Tone::Strong),
        Run { target: link, ..Run::plain(scene) },
        Run::plain(format!(", {norm} in {variable}: {observed} for {predicted} {certain}, ")),
        Run::of(decision, tone(verdict)),
        Run::plain("."),
    ]
}

fn broken(section: &mut Section, report: &Report<'_>) {
    let scenes = report.scenes.iter().map(|drawn| drawn.scene);
    let scenes: Vec<_> = scenes.filter(|scene| !scene.violates.is_empty()).collect();
    if scenes.is_empty() {
        return;
    }
    let hypotheses: BTreeSet<&String> = scenes.iter().flat_map(|scene| &scene.violates).collect();
    let hypotheses: Vec<String> = hypotheses.into_iter().map(|name| numbered(name)).collect();
    let is_broken = |verdict: &&Verdict| scenes.iter().any(|scene| scene.name == verdict.scene);
    let broken: Vec<&Verdict> = report.verdicts.iter().filter(is_broken).collect();
    section.text(vec![
        Run::of("What was broken on purpose? ", Tone::Strong),
        Run::plain("hypotheses").to("#chapter-broken"),
        Run::plain(format!(" {} in {}; ", hypotheses.join(", "), counted(scenes.len(), "scene"))),
        held(&broken),
        Run::plain(" orders are those that were derived for it."),
    ]);
}

// The section of a scene: a summary, and the evidence of its verdicts.

fn of_scene(report: &Report<'_>, drawn: &Drawn<'_>) -> Section {
    let scene = drawn.scene;
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
    section.figures(&drawn.figures);
    for verdict in &verdicts {
        section.table(points(verdict));
    }
    section.table(cases(&scene.name, report.records));
    if !scene.text.is_empty() {
        section.blocks.push(Block::Scene(scene.text.clone()));
    }
    section
}

/// A verdict in words, without the name of its scene.
pub(super) fn sentence(verdict: &Verdict) -> Vec<Run> {
    let [_, norm, variable, predicted, observed, decision, why] = cell_texts(verdict);
    vec![
        Run::of(format!("{norm} in {variable}: "), Tone::Strong),
        Run::of(decision, tone(verdict)),
        Run::plain(format!(
            ", {} for {predicted} by {}",
            observed.replace('\n', "; "),
            symbols(&why)
        )),
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

// Evidence of a verdict: its points, and the scene's cases, as tables.

/// Norms in the table of cases that fit a page; cases.csv has all.
const NORM_COLUMNS: usize = 4;

/// A cell of what there may be.
fn or_dash(cell: Option<impl ToString>) -> String {
    cell.map_or("–".into(), |cell| cell.to_string())
}

fn scientific(value: f64) -> String {
    or_dash(value.is_finite().then(|| format!("{value:.3e}")))
}

/// A step, as a fraction if possible.
fn step(value: f64) -> String {
    or_dash(value.is_finite().then(|| step_label(value)))
}

/// The points of a verdict, coarse to fine, with the orders between used neighbours.
pub(super) fn points(verdict: &Verdict) -> Table {
    let mut points: Vec<&JudgedPoint> =
        verdict.points_used.iter().chain(&verdict.points_left_out).collect();
    let direction = verdict.variable.direction();
    let along = |point: &Point| direction.unwrap_or(Direction::Space).step(point);
    points.sort_by(|a, b| {
        let (a, b) = (&a.point, &b.point);
        along(b).total_cmp(&along(a)).then(b.k.total_cmp(&a.k))
    });
    let mut before: Option<(f64, f64)> = None;
    let mut rows = Vec::new();
    for JudgedPoint { point, place, reason } in points {
        let at = along(point);
        let order = before.filter(|_| reason.is_none() && direction.is_some());
        let order = order.map(|(step, other)| (other / point.error).ln() / (step / at).ln());
        if reason.is_none() {
            before = Some((at, point.error));
        }
        let use_of =
            reason.as_ref().map_or_else(|| "used".into(), |why| format!("left out: {why}"));
        let cells = [
            or_dash(place.n),
            place.steps.to_string(),
            step(point.h),
            step(point.k),
            scientific(point.error),
            or_dash(order.map(|order| format!("{order:.3}"))),
            or_dash((point.floor > 0.0).then(|| scientific(point.floor))),
            use_of,
        ];
        rows.push(cells.map(Run::plain).into());
    }
    let (norm, variable) = (&verdict.norm, verdict.variable.name());
    let caption = format!("{}: points of the verdict on {norm} in {variable}.", verdict.scene);
    let heads = [">n", ">N", ">h", ">k", ">error", ">local order", ">floor", "use"];
    Table::new(caption, &heads, rows).evidence()
}

/// All cases of a scene with their sizes and errors.
pub(super) fn cases(scene: &str, records: &[CaseRecord]) -> Table {
    let of_scene: Vec<&CaseRecord> = records.iter().filter(|r| r.scene == scene).collect();
    let mut norms = norms(of_scene.iter().copied());
    norms.retain(|norm| *norm == V_MAX || !is_by_state(norm));
    let rest = norms.split_off(norms.len().min(NORM_COLUMNS));
    let row = |record: &&CaseRecord| {
        let ended = match &record.status {
            Status::Converged => Run::plain("converged"),
            Status::Failed { .. } => Run::of("failed", Tone::Miss),
            Status::Skipped => Run::plain("skipped"),
        };
        let error = |norm: &&str| record.norm(norm).and_then(|entry| entry.error);
        let cells = norms.iter().map(|norm| or_dash(error(norm).map(scientific)));
        let sizes = [
            or_dash(record.n),
            record.steps.to_string(),
            record.dofs.to_string(),
            record.newton_iterations.to_string(),
        ];
        let plain = sizes.into_iter().chain(cells).map(Run::plain);
        plain.chain([ended]).collect::<Vec<Run>>()
    };
    let rows: Vec<Vec<Run>> = of_scene.iter().map(row).collect();
    let sizes = [">n", ">N", ">unknowns", ">Newton"].map(str::to_owned);
    let named = norms.iter().map(|norm| format!(">{norm}"));
    let heads: Vec<String> = sizes.into_iter().chain(named).chain(["status".into()]).collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let more = match rest.is_empty() {
        true => String::new(),
        false => format!(" Also in cases.csv: {}.", rest.join(", ")),
    };
    let caption = format!(
        "{scene}: all cases; unknowns of a time level, Newton iterations over all levels, errors in the norms named.{more}"
    );
    Table::new(caption, &heads, rows).evidence()
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::verdict::{ConstantClaim, Prediction, Variable};

    fn verdict(scene: &str, expect: Decision, decision: Decision, probability: f64) -> Verdict {
        let prediction = Prediction::new("V_max", Variable::H, 1.0);
        let open = Verdict::open(scene, &prediction, expect);
        Verdict { decision, probability: Some(probability), ..open }
    }

    #[test]
    fn a_failure_on_purpose_is_not_the_least_certain() {
        use Decision::{Fail, Pass, Unresolved};
        let mut verdicts = vec![
            verdict("built-to-fail", Fail, Fail, 0.0),
            verdict("clear", Pass, Pass, 0.99),
            verdict("close", Pass, Pass, 0.80),
            verdict("defect", Pass, Fail, 0.01),
        ];
        let least = |verdicts: &[Verdict]| least_certain(verdicts).map(|v| v.scene.clone());
        assert_eq!(least(&verdicts).as_deref(), Some("close"));
        // Its constant shows the order, whatever the slopes say.
        let claim = |decides| {
            Some(ConstantClaim {
                name: "C_k",
                decision: Pass,
                reason: String::new(),
                owed: false,
                decides,
            })
        };
        verdicts
            .push(Verdict { constant: claim(true), ..verdict("by-constant", Pass, Pass, 0.06) });
        assert_eq!(least(&verdicts).as_deref(), Some("close"));
        verdicts.push(verdict("open", Pass, Unresolved, 0.9));
        assert_eq!(least(&verdicts).as_deref(), Some("open"));
        assert_eq!(least(&verdicts[..1]), None);
        // A certain failure is no doubt; what failed is said instead, and that nothing is certain of an open one.
        let sure = [verdicts[3].clone(), verdict("other", Pass, Fail, 0.001)];
        assert_eq!(least(&sure), None);
        let said = answers(&sure).join("\n");
        assert!(said.contains("not as expected? defect, V_max in h: fail"), "{said}");
        assert!(said.contains("1 more") && !said.contains("least certain"), "{said}");
        assert!(!answers(&verdicts[..3]).join("\n").contains("not as expected"));
    }
}
