//! Chapters beside the orders: what the theory asks and gives, what accuracy costs, where numbers end.
//!
//! Each is written from numbers that follow from the data of a scene, from the verdicts, and from the studies that other
//! commands wrote into the directory; a study that is not there is not mentioned but for the command that makes one.

mod audit;
mod broken;
mod extremes;
mod gronwall;
mod step_size;
#[cfg(test)]
mod tests;
mod trade;

use super::content::{Numbers, Report};
use super::{Block, Equation, Figure, Run, Section, Table, Tone};
use crate::Picture;
use crate::studies::{Number, Studies};

/// All chapters in their order; pictures that they show are taken out of the studies.
pub(super) fn chapters(
    report: &Report<'_>,
    studies: &mut Studies,
    numbers: &mut Numbers,
) -> Vec<Section> {
    let mut pen = Pen { report, numbers, sections: Vec::new() };
    step_size::write(&mut pen, studies);
    gronwall::write(&mut pen, studies);
    audit::write(&mut pen, studies);
    broken::write(&mut pen);
    trade::write(&mut pen, studies);
    extremes::write(&mut pen, studies);
    pen.sections
}

/// What the studies found that should not be: a sentence each, with the section that has the numbers.
pub(super) fn failures(studies: &Studies) -> Vec<(String, String)> {
    let bounds = studies.bounds.iter().filter(|bound| !step_size::holds(bound));
    let bounds = bounds.map(|bound| ("(3.4)", "bound", &bound.scene));
    let chains = studies.gronwall.iter().filter(|study| !gronwall::holds(study));
    let chains = chains.map(|study| ("Gronwall's inequality", "gronwall", &study.scene));
    let audits = studies.audits.iter().filter(|audit| !audit::holds(audit));
    let audits = audits.map(|audit| ("the proof line by line", "audit", &audit.scene));
    let of_scene = bounds.chain(chains).chain(audits).map(|(what, kind, scene)| {
        (format!("{what}, {scene}: not everything holds"), format!("#{}", id(kind, scene)))
    });
    let ledger = studies.ledger.iter().any(|claim| !claim.confirmed);
    let ledger = ledger.then(|| {
        ("the theorem ledger: not every claim is confirmed".into(), "#chapter-ledger".into())
    });
    let extremes = studies.extremes.iter().filter(|study| !extremes::holds(study));
    let extremes = extremes.map(|_| {
        ("extremes: not every rung is as expected".to_owned(), "#chapter-extremes".to_owned())
    });
    of_scene.chain(ledger).chain(extremes).collect()
}

/// The section of a study of a scene.
fn id(kind: &str, scene: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '-' };
    format!("{kind}-{}", scene.chars().map(plain).collect::<String>())
}

/// A document in writing.
struct Pen<'a> {
    report: &'a Report<'a>,
    numbers: &'a mut Numbers,
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

    fn formulas(&mut self, formulas: Vec<Equation>) {
        self.block(Block::Formulas(formulas));
    }

    /// A table; heads that begin with `>` are those of numbers. Without rows there is none.
    fn table(&mut self, caption: impl Into<String>, heads: &[&str], rows: Vec<Vec<Run>>) {
        if rows.is_empty() {
            return;
        }
        let table = Table {
            number: self.numbers.table(),
            caption: caption.into(),
            head: heads.iter().map(|head| head.trim_start_matches('>').to_owned()).collect(),
            numeric: heads.iter().map(|head| head.starts_with('>')).collect(),
            rows,
        };
        self.block(Block::Table(table));
    }

    fn figures(&mut self, pictures: Vec<Picture>) {
        for (file, caption, svg) in pictures {
            let number = self.numbers.figure();
            self.block(Block::Figure(Figure { number, file, caption, svg }));
        }
    }

    /// Where there is no study of a kind.
    fn absent(&mut self, what: &str, command: &str) {
        self.text(vec![
            Run::plain(format!("{what} in the directory of this report: ")),
            Run::code(format!("sweep {command} --out DIR")),
            Run::plain(" adds one, and "),
            Run::code("sweep report DIR"),
            Run::plain(" shows it here."),
        ]);
    }

    /// A study of another text of a scene that is in the records is no evidence for them.
    fn of_this_text(&mut self, scene: &str, fingerprint: &str) {
        let known = self.report.provenance.get("scenes").and_then(|scenes| scenes.get(scene));
        if known.and_then(serde_json::Value::as_str).is_some_and(|own| own != fingerprint) {
            let words = "This study was made with another text of the scene than the records.";
            self.text(vec![Run::of(words, Tone::Miss)]);
        }
    }
}

/// The verdict on a study: what holds in words, or each failure.
fn outcome(pen: &mut Pen<'_>, holds: bool, all: &str, failures: Vec<String>) {
    if holds {
        pen.text(vec![Run::of(all, Tone::Pass)]);
        return;
    }
    let failures = if failures.is_empty() { vec!["nothing was compared".into()] } else { failures };
    for failure in failures {
        pen.text(vec![Run::of("Does not hold: ", Tone::Miss), Run::plain(failure)]);
    }
}

/// holds, or not, in a cell.
fn held(holds: bool) -> Run {
    if holds { Run::of("holds", Tone::Pass) } else { Run::of("does not hold", Tone::Miss) }
}

/// Five significant digits, without zeros at the end.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let exponent = value.abs().log10().floor();
    if !(-3.0..5.0).contains(&exponent) {
        return if value.is_finite() { format!("{value:.3e}") } else { "–".into() };
    }
    let text = format!("{value:.*}", (4.0 - exponent).max(0.0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn number(value: Number) -> Run {
    Run::plain(value.map_or_else(|| "–".to_owned(), digits))
}

/// Two sides of what does not hold.
fn sides(left: Number, right: Number) -> String {
    let side = |value: Number| value.map_or_else(|| "no number".to_owned(), |v| format!("{v:.9e}"));
    format!("{} against {}", side(left), side(right))
}
