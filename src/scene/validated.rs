//! The scene as validated: what every later part of the program reads.

use std::ops::Range;
use std::path::Path;

use serde::Deserialize;
use toml::de::{DeTable, Deserializer};

use crate::formula::Graph;

use super::contact::Contact;
use super::data::Data;
use super::definitions::parameters;
use super::diagnostic::SceneError;
use super::domain::Domain;
use super::heading::{Expectation, Heading, Hypothesis};
use super::material::Material;
use super::prediction::Prediction;
use super::reading::Reading;
use super::source::Source;
use super::spans::Spans;
use super::sweep::Sweep;
use super::time::Time;
use super::{wording, written};

/// A scene that satisfies everything that can be checked without a mesh and without a solve.
#[derive(Debug, Clone)]
pub struct Scene {
    pub name: String,
    pub question: String,
    /// 2 for now.
    pub dimension: usize,
    /// Whether verdicts are given; else the scene is measured and reported only.
    pub judge: bool,
    pub expect: Expectation,
    /// Runs only when asked for.
    pub long: bool,
    pub window_n: Option<[usize; 2]>,
    pub window_steps: Option<[usize; 2]>,
    pub violates: Vec<Hypothesis>,
    pub source: Source,
    pub spans: Spans,
    pub domain: Domain,
    pub time: Time,
    pub material: Material,
    pub contact: Option<Contact>,
    pub data: Data,
    pub predicts: Vec<Prediction>,
    /// None where the scene asks for no sweep.
    pub sweep: Option<Sweep>,
    /// Owns every formula of the scene.
    pub formulas: Graph,
}

impl Scene {
    /// Reads and validates a file.
    ///
    /// # Errors
    /// The first fault found, with its place and the way out.
    pub fn read(path: &Path) -> Result<Scene, SceneError> {
        Scene::from_source(Source::read(path)?)
    }

    /// Validates the text of a scene.
    ///
    /// # Errors
    /// The first fault found, with its place and the way out.
    pub fn from_source(source: Source) -> Result<Scene, SceneError> {
        if is_blank(&source.text) {
            return Err(SceneError::Empty { path: source.path });
        }
        let (file, spans) = parse(&source)?;
        validate(file, source, spans)
    }

    /// Bytes of the value at a dotted key (`exact.multiplier`), or of the part that would hold it.
    pub fn span(&self, key: &str) -> Range<usize> {
        self.spans.value(key)
    }

    /// An error found later, such as (2.9) violated, that points at a key of this scene.
    pub fn error(
        &self,
        key: &str,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> SceneError {
        SceneError::at(&self.source, self.span(key), message, hint)
    }
}

/// Nothing but white space and comments.
fn is_blank(text: &str) -> bool {
    text.lines().map(str::trim).all(|line| line.is_empty() || line.starts_with('#'))
}

fn parse(source: &Source) -> Result<(written::File, Spans), SceneError> {
    let table = DeTable::parse(&source.text).map_err(|error| wording::syntax(source, &error))?;
    let spans = Spans::of(table.get_ref());
    let file = written::File::deserialize(Deserializer::from(table))
        .map_err(|error| wording::structure(source, &spans, &error))?;
    Ok((file, spans))
}

fn validate(file: written::File, source: Source, spans: Spans) -> Result<Scene, SceneError> {
    let mut reading = Reading::new(&source, &spans);
    let heading = Heading::validate(&reading, &file.scene)?;
    reading.violates.clone_from(&heading.violates);
    let domain = Domain::validate(&reading, &file.domain, heading.dimension)?;
    let time = Time::validate(&reading, &file.time)?;
    let material = Material::validate(&mut reading, &file.material, time.horizon)?;
    reading.parameters = parameters(&mut reading, file.exact.as_ref())?;
    let contact = Contact::validate(&mut reading, file.contact.as_ref(), &domain)?;
    let data = Data::validate(&mut reading, &file, &domain, &time, contact.as_ref())?;
    let predicts = predictions(&reading, &file.predicts, contact.is_some())?;
    let sweep = Sweep::validate(&reading, file.sweep.as_ref(), &domain, contact.is_some())?;
    has_truth(&reading, file.scene.judge, &data, sweep.as_ref())?;
    let formulas = reading.formulas;
    Ok(Scene {
        name: heading.name,
        question: file.scene.question,
        dimension: heading.dimension,
        judge: file.scene.judge,
        expect: heading.expect,
        long: file.scene.long,
        window_n: heading.window_n,
        window_steps: heading.window_steps,
        violates: heading.violates,
        source,
        spans,
        domain,
        time,
        material,
        contact,
        data,
        predicts,
        sweep,
        formulas,
    })
}

fn predictions(
    reading: &Reading,
    written: &[written::Prediction],
    has_contact: bool,
) -> Result<Vec<Prediction>, SceneError> {
    written
        .iter()
        .enumerate()
        .map(|(index, one)| Prediction::validate(reading, index, one, has_contact))
        .collect()
}

/// A scene without an exact solution needs a reference run, unless it is neither judged nor swept.
fn has_truth(
    reading: &Reading,
    judge: bool,
    data: &Data,
    sweep: Option<&Sweep>,
) -> Result<(), SceneError> {
    let reference = sweep.and_then(|sweep| sweep.reference);
    if matches!(data, Data::Exact { .. }) || reference.is_some() || (!judge && sweep.is_none()) {
        return Ok(());
    }
    let message =
        "no exact solution and no reference run: errors have no truth to be measured against";
    let key = if sweep.is_some() { "sweep" } else { "loads" };
    Err(reading.error(key, message, "add to [sweep]: reference = { n = 128, steps = 64 }"))
}
