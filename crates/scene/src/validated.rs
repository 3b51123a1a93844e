//! The scene as validated.

use std::ops::Range;
use std::path::Path;

use toml::de::DeTable;

use fem::space::Element;
use formula::Graph;

use super::abstract_scene::AbstractScene;
use super::contact::Contact;
use super::data::Data;
use super::definitions::parameters;
use super::diagnostic::{Result, SceneError};
use super::discretization::element;
use super::domain::{Domain, with_mesh};
use super::friction::Friction;
use super::heading::{self, Expectation, Hypothesis, SceneKind};
use super::keys;
use super::law::Law;
use super::material::Material;
use super::prediction::Prediction;
use super::reading::Reading;
use super::singular::needs_product_integration;
use super::source::Source;
use super::spans::Spans;
use super::sweep::{Sweep, serves, states_are_known};
use super::time::Time;
use super::wording;

/// A scene that satisfies everything that can be checked without a mesh or a solve.
#[derive(Debug, Clone)]
pub struct Scene {
    pub name: String,
    pub question: String,
    /// 2 for bodies (plane strain); m for an abstract problem in ℝ^m.
    pub dimension: usize,
    /// Whether verdicts are given; otherwise the scene is only measured.
    pub judge: bool,
    pub expect: Expectation,
    /// Runs only on request.
    pub long: bool,
    pub window_n: Option<[u32; 2]>,
    pub window_steps: Option<[u32; 2]>,
    pub violates: Vec<Hypothesis>,
    pub source: Source,
    pub spans: Spans,
    pub time: Time,
    pub body: Body,
    pub predicts: Vec<Prediction>,
    /// None where the scene asks for no sweep.
    pub sweep: Option<Sweep>,
    /// Owns every formula of the scene.
    pub formulas: Graph,
}

/// The problem of a scene.
#[derive(Debug, Clone)]
pub enum Body {
    /// Problem 12.
    Contact(Box<ContactScene>),
    /// Problem 1 in ℝ^m.
    Abstract(Box<AbstractScene>),
}

/// A body in contact.
#[derive(Debug, Clone)]
pub struct ContactScene {
    pub domain: Domain,
    pub material: Material,
    pub contact: Option<Contact>,
    pub data: Data,
    pub element: Element,
}

impl ContactScene {
    /// The normal law on Γ3.
    pub fn law(&self) -> Option<&Law> {
        self.contact.as_ref()?.law.as_ref()
    }

    /// Friction on Γ3.
    pub fn friction(&self) -> Option<&Friction> {
        self.contact.as_ref()?.friction.as_deref()
    }

    /// Whether nothing on Γ3 takes from the monotonicity: no law falls, and no friction follows the normal law.
    pub fn is_monotone(&self) -> bool {
        let friction = self.friction();
        self.law().is_none_or(|law| law.alpha() <= 0.0)
            && friction.is_none_or(|law| law.alpha() <= 0.0 && law.bound.coefficient() <= 0.0)
    }
}

impl Scene {
    /// The body in contact, if the scene is one.
    pub fn as_contact(&self) -> Option<&ContactScene> {
        match &self.body {
            Body::Contact(body) => Some(body),
            Body::Abstract(_) => None,
        }
    }

    /// Reads and validates a file.
    ///
    /// # Errors
    /// The first fault found, with its place and the way out.
    pub fn read(path: &Path) -> Result<Scene> {
        Scene::from_source(Source::read(path)?)
    }

    /// Validates the text of a scene.
    ///
    /// # Errors
    /// The first fault found, with its place and the way out.
    pub fn from_source(source: Source) -> Result<Scene> {
        if is_blank(&source.text) {
            return Err(SceneError::Empty { path: source.path });
        }
        let text = source.text.clone();
        let table = DeTable::parse(&text).map_err(|error| wording::syntax(&source, &error))?;
        let table = table.get_ref();
        let spans = Spans::of(table);
        let source = with_mesh(source, &spans, table)?;
        let mut reading = Reading::new(&source, &spans, table);
        let kind = SceneKind::validate(&reading)?;
        keys::refuse_unknown(&reading, kind)?;
        let name = heading::name(&reading)?;
        let question = reading.required("scene.question")?;
        let dimension = heading::dimension(&reading, kind)?;
        let judge = reading.optional("scene.judge")?.unwrap_or(true);
        let expect = heading::expectation(&reading)?;
        let long = reading.optional("scene.long")?.unwrap_or(false);
        let window_n = reading.window("scene.window_n")?;
        let window_steps = reading.window("scene.window_steps")?;
        reading.violates = heading::violates(&reading)?;
        let Content { time, body, predicts, sweep } = match kind {
            SceneKind::Contact => contact(&mut reading, dimension, judge)?,
            SceneKind::Abstract => abstract_problem(&mut reading, dimension)?,
        };
        let message = "the scene is judged and predicts nothing: there is no order to judge";
        let hint =
            "add [[predicts]] with norm, variable, order and why, or say judge = false in [scene]";
        reading.refuse_if(judge && predicts.is_empty(), "scene.judge", message, hint)?;
        let Reading { violates, formulas, .. } = reading;
        Ok(Scene {
            name,
            question,
            dimension,
            judge,
            expect,
            long,
            window_n,
            window_steps,
            violates,
            source,
            spans,
            time,
            body,
            predicts,
            sweep,
            formulas,
        })
    }

    /// Bytes of the value at a dotted key (`exact.multiplier`), or of the part that would contain it.
    pub(crate) fn span(&self, key: &str) -> Range<usize> {
        self.spans.value(key)
    }

    /// Refuses what [`Self::error`] underlines if it is at fault.
    ///
    /// # Errors
    /// [`Self::error`].
    pub fn refuse_if(
        &self,
        fault: bool,
        key: &str,
        message: impl ToString,
        hint: impl Into<String>,
    ) -> Result<()> {
        if fault { Err(self.error(key, message.to_string(), hint)) } else { Ok(()) }
    }

    /// An error found later, such as (2.9) violated, at a key of this scene.
    pub fn error(
        &self,
        key: &str,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> SceneError {
        SceneError::at(&self.source, self.span(key), message, hint)
    }
}

/// Only white space and comments.
fn is_blank(text: &str) -> bool {
    text.lines().map(str::trim).all(|line| line.is_empty() || line.starts_with('#'))
}

/// The parts of a scene besides its heading.
struct Content {
    time: Time,
    body: Body,
    predicts: Vec<Prediction>,
    sweep: Option<Sweep>,
}

fn contact(reading: &mut Reading, dimension: usize, judge: bool) -> Result<Content> {
    let domain = Domain::validate(reading, dimension)?;
    let time = Time::validate(reading)?;
    let material = Material::validate(reading, time.horizon, &domain)?;
    needs_product_integration(reading, &time, material.singular_key())?;
    reading.parameters = parameters(reading)?;
    let contact = Contact::validate(reading, &domain, &time)?;
    let data = Data::validate(reading, &domain, &time, contact.as_ref())?;
    let predicts = predictions(reading, contact.is_some())?;
    let sweep = reading
        .if_given("sweep", |reading, _| Sweep::validate(reading, &domain, contact.is_some()))?;
    sweep.iter().try_for_each(|sweep| time.serves(reading, sweep))?;
    serves(reading, sweep.as_ref(), &predicts)?;
    let known = matches!(data, Data::Exact { .. }) && contact.is_some() && dimension == 2;
    states_are_known(reading, known, sweep.as_ref(), &predicts)?;
    has_truth(reading, judge, &data, sweep.as_ref())?;
    let mut body = ContactScene { domain, material, contact, data, element: Element::P1 };
    body.element = element(reading, &body)?;
    Ok(Content { time, body: Body::Contact(Box::new(body)), predicts, sweep })
}

fn abstract_problem(reading: &mut Reading, dimension: usize) -> Result<Content> {
    let time = Time::validate(reading)?;
    reading.parameters = parameters(reading)?;
    let body = AbstractScene::validate(reading, time.horizon, dimension)?;
    needs_product_integration(reading, &time, body.singular_key())?;
    let predicts = predictions(reading, !body.traces.is_empty())?;
    for (index, prediction) in predicts.iter().enumerate() {
        prediction.only_in_time(reading, index)?;
    }
    let sweep = reading.if_given("sweep", |reading, _| Sweep::in_time(reading))?;
    sweep.iter().try_for_each(|sweep: &Sweep| time.serves(reading, sweep))?;
    Ok(Content { time, body: Body::Abstract(Box::new(body)), predicts, sweep })
}

fn predictions(reading: &Reading, has_contact: bool) -> Result<Vec<Prediction>> {
    let one = |index| Prediction::validate(reading, index, has_contact);
    reading.entries("predicts")?.map(one).collect()
}

/// A scene without an exact solution needs a reference run, unless it is neither judged nor swept.
fn has_truth(reading: &Reading, judge: bool, data: &Data, sweep: Option<&Sweep>) -> Result<()> {
    let reference = sweep.and_then(|sweep| sweep.reference);
    let truth = matches!(data, Data::Exact { .. }) || reference.is_some();
    let message =
        "there is neither an exact solution nor a reference run, so errors cannot be measured";
    let hint = "add to [sweep]: reference = { n = 128, steps = 64 }";
    let key = if sweep.is_some() { "sweep" } else { "loads" };
    reading.refuse_if(!truth && (judge || sweep.is_some()), key, message, hint)
}
