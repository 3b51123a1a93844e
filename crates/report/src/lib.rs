//! Records and verdicts as files: the table of cases, `verdict.json`, pictures, a page, JUnit.
//!
//! Everything is rebuilt from records and verdicts; equal input gives equal bytes. A picture is a [`Chart`] (series
//! over two axes) or a [`Map`].

mod backend;
mod body;
mod canvas;
mod chart;
mod convergence;
mod document;
mod forest;
mod junit;
mod map;
mod palette;
mod ruler;
mod sheet;
mod symbols;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub use body::{Arrow, Cell as BodyCell, Deformed, Ink, Panel, Sketch, SpaceTime, Stroke, Zone};
pub use chart::{Axis, Chart, Datum, Mark, Part, Series, Slope};
pub use convergence::convergence_svg;
#[cfg(feature = "pdf")]
pub use document::pdf;
pub use document::{
    Chapter, Equation, Findings, Group, Run, StudyDocument, Terms, Tone, answers, beside, digits,
    equations, json_table, verdict_table,
};
pub use junit::{AnnotationPlace, annotations, step_summary, write_junit};
pub use map::{Cell, Map, Shade, split_svg};
pub use ruler::Scale;
pub use symbols::escaped;

use document::{
    DATA, Drawn, Figure, Report, TEMPLATE, by_verify, data, document, markdown, of_cases, page,
    tables,
};
use files::{FileError, ListError, make_directory, write_listed};
use judge::fit::Direction;
use judge::record::{CaseRecord, RecordError, write_sorted};
use judge::verdict::{Comparison, DocumentError, Explanation, Verdict, write_json};

/// A scene in a report, beside its results.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneSummary {
    pub name: String,
    pub question: String,
    pub group: Group,
    /// Its body with the parts of the boundary, as SVG.
    pub picture: Option<String>,
    /// Remarks: a broken hypothesis, a verdict that is not given.
    pub remarks: Vec<String>,
    pub equations: Vec<Equation>,
    /// The text of its file.
    pub text: String,
    /// The hypotheses that it breaks on purpose, as scene files name them.
    pub violates: Vec<String>,
    /// None if it could not be computed.
    pub step: Option<StepLimits>,
}

/// Bounds on the step size from the data of a scene, each a time, or infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepLimits {
    /// m0 of (2.9), a stress.
    pub m0: f64,
    /// (3.4) with the norm that the paper takes of ℬ.
    pub paper: f64,
    /// (3.4) with the operator norm.
    pub theorem: f64,
    /// With the weight k/2 of the last slot, part by part.
    pub sharpened: f64,
    /// Below it each step is a strongly monotone problem.
    pub solvable: f64,
}

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    #[error(transparent)]
    Io(#[from] FileError),
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error("a table of claims: {0}")]
    Claims(#[from] csv::Error),
    /// An invalid study in the directory.
    #[error("{}:{line}: {reason}; write this study again by `sweep {command} --out DIR`, or delete the file", path.display())]
    Study {
        path: PathBuf,
        line: usize,
        reason: String,
        /// The command that writes such files.
        command: String,
    },
    #[error(transparent)]
    Listed(#[from] ListError),
    #[error("typesetting: {what}")]
    Typesetting { what: String },
    #[error("JUnit: {source}")]
    Xml { source: quick_junit::SerializeError },
    /// Two scenes whose names differ only in characters that file names do not keep.
    #[error("the scenes {first:?} and {second:?} would share the file name {stem:?}")]
    SharedName {
        first: String,
        second: String,
        /// Their common file name.
        stem: String,
    },
}

/// Writes cases.csv, verdict.json, the pages and the pictures `SCENE-h.svg`, `SCENE-k.svg`, `SCENE-hk.svg`,
/// `SCENE-scene.svg`, `SCENE-errors.svg`, `forest.svg` and its pieces `forest-1.svg` and on into `dir`, which is created if
/// necessary. Pages are index.html, report.md, tables.tex, and report.typ with report.json. Obsolete files of an earlier report
/// are removed, foreign ones stay.
///
/// # Errors
/// [`ReportError`]; files written before stay.
pub fn write_all(
    dir: &Path,
    scenes: &[SceneSummary],
    records: &[CaseRecord],
    verdicts: &[Verdict],
    provenance: &serde_json::Value,
    baseline: Option<&Comparison>,
    cause: Option<&Explanation>,
) -> Result<(), ReportError> {
    make_directory(dir)?;
    let external = by_verify(provenance);
    let with_stems = scenes.iter().zip(stems(scenes)?);
    let drawn: Vec<Drawn<'_>> = with_stems
        .map(|(scene, stem)| {
            let group = if external { Group::External } else { scene.group };
            drawn((scene, group), stem, records, verdicts)
        })
        .collect();
    let forest = forest(&drawn, verdicts);
    let document = document(Report {
        scenes: &drawn,
        forest: forest.as_ref(),
        studies: StudyDocument::read_all(dir)?,
        of_cases: of_cases(dir)?,
        records,
        verdicts,
        provenance,
        cause,
    });
    write_sorted(&dir.join("cases.csv"), records)?;
    write_json(&dir.join("verdict.json"), provenance, verdicts, records, baseline, cause)?;
    let pages = [
        ("index.html", page(&document)),
        ("report.md", markdown(&document)),
        ("tables.tex", tables(&document)),
        ("report.typ", TEMPLATE.to_owned()),
        (DATA, data(&document)),
    ];
    let figures = drawn.iter().flat_map(|drawn| drawn.figures.iter().chain(&drawn.card));
    let figures = figures.chain(&forest).chain(forest.iter().flat_map(|forest| &forest.pieces));
    let figures = figures.map(|figure| (figure.file.clone(), &*figure.svg));
    let pages = pages.iter().map(|(name, text)| ((*name).to_owned(), text.as_str()));
    let files: Vec<(String, &str)> = figures.chain(pages).collect();
    Ok(write_listed(dir, &files)?)
}

/// The forest plot of all verdicts in two columns, and in pieces.
fn forest(scenes: &[Drawn<'_>], verdicts: &[Verdict]) -> Option<Figure> {
    let lines = forest::lines(verdicts, |name| {
        let drawn = scenes.iter().find(|drawn| drawn.scene.name == name);
        drawn.map_or(Group::default(), |drawn| drawn.group)
    });
    let count = if lines.len() > forest::PIECE { 2 } else { 1 };
    let svg = forest::svg(&forest::columns(&lines, count))?;
    let caption = "Observed minus predicted order, with its 95 % interval, of every norm judged in h or k. Grey: the tolerance of a prediction; \
                   right: the order predicted; filled: pass; orange: not as expected.";
    let piece = |(i, svg)| Figure::new(format!("forest-{i}.svg"), caption, svg);
    let pieces = (1..).zip(forest::pieces(&lines)).map(piece).collect();
    Some(Figure { pieces, ..Figure::new("forest.svg", caption, svg) })
}

/// The pictures of a scene, as far as there is something to draw.
fn drawn<'a>(
    (scene, group): (&'a SceneSummary, Group),
    stem: String,
    records: &[CaseRecord],
    verdicts: &[Verdict],
) -> Drawn<'a> {
    let figure = |(suffix, caption, svg): (&str, &str, Option<String>)| {
        let caption = format!("{}: {caption}", scene.name);
        Some(Figure::new(format!("{stem}-{suffix}.svg"), caption, svg?))
    };
    let along = |direction| convergence_svg(scene, records, verdicts, direction);
    let figures = [
        ("h", "error against h, at the number N of time steps named.", along(Direction::Space)),
        ("k", "error against k, on the mesh n named.", along(Direction::Time)),
        ("hk", "error over h and k, and which of them it is of.", split_svg(scene, records)),
    ];
    let errors = convergence::thumbnail_svg(scene, records, verdicts);
    let card = [
        ("scene", "the body with the parts of its boundary", scene.picture.clone()),
        ("errors", "errors judged, with the observed order", errors),
    ];
    let figures = figures.into_iter().filter_map(figure).collect();
    let card = card.into_iter().filter_map(figure).collect();
    Drawn { scene, group, stem, figures, card }
}

/// A name in file names and links: letters, digits, dot, dash and underscore.
pub(crate) fn plain_name(name: &str) -> String {
    name.replace(|c: char| !(c.is_alphanumeric() || "-_.".contains(c)), "-")
}

/// File names of the scenes.
fn stems(scenes: &[SceneSummary]) -> Result<Vec<String>, ReportError> {
    let mut owners: BTreeMap<String, &str> = BTreeMap::new();
    let mut stems = Vec::new();
    for scene in scenes {
        let stem = plain_name(&scene.name);
        if let Some(first) = owners.insert(stem.clone(), &scene.name) {
            let (first, second) = (first.to_owned(), scene.name.clone());
            return Err(ReportError::SharedName { first, second, stem });
        }
        stems.push(stem);
    }
    Ok(stems)
}

#[cfg(test)]
mod tests;
