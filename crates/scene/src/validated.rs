//! The scene as validated.

use super::abstract_scene::{AbstractScene, MOST};
use super::contact::{self, Contact};
use super::data::Data;
use super::definitions::parameters;
use super::domain::{Domain, Side, with_mesh};
use super::friction::Friction;
use super::keys::{Part, SceneKind};
use super::law::Law;
use super::material::Material;
use super::memory::has_a_rule;
use super::reading::{Reading, placed, syntax};
use super::source::{Result, SceneError, Source};
use super::sweep::{Prediction, Sweep, serves};
use super::time::Time;
use crate::ContactQuadrature;
use fem::space::Element;
use formula::{Graph, Variable};
/// The verdict that a scene must reach.
pub use judge::verdict::Decision as Expectation;
use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use toml::de::DeTable;

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
    /// Each contact side is in one of them; none without contact.
    pub contact: Vec<Contact>,
    pub data: Data,
    pub element: Element,
}

impl ContactScene {
    /// What a contact side has.
    pub fn contact_on(&self, side: Side) -> Option<&Contact> {
        self.contact.iter().find(|contact| contact.sides.contains(&side))
    }

    /// The normal laws on Γ3.
    pub fn laws(&self) -> impl Iterator<Item = &Law> {
        self.contact.iter().filter_map(|contact| contact.law.as_ref())
    }

    /// Whether there is a finite gap.
    pub fn has_gap(&self) -> bool {
        self.contact.iter().any(|contact| contact.gap.is_some())
    }

    /// Whether a gap depends on t.
    pub fn gap_moves(&self, formulas: &Graph) -> bool {
        let mut gaps = self.contact.iter().filter_map(|contact| contact.gap);
        gaps.any(|gap| formulas.depends_on(gap, Variable::T))
    }

    /// Friction on Γ3: one law for all contact sides.
    pub fn friction(&self) -> Option<&Friction> {
        self.contact.iter().find_map(|contact| contact.friction.as_deref())
    }

    /// Whether nothing on Γ3 takes from the monotonicity: no law falls, and no friction follows the normal law.
    pub fn is_monotone(&self) -> bool {
        let friction = self.friction();
        self.laws().all(|law| law.alpha() <= 0.0)
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
        let mut lines = source.text.lines().map(str::trim);
        if lines.all(|line| line.is_empty() || line.starts_with('#')) {
            return Err(SceneError::Empty { path: source.path });
        }
        let text = source.text.clone();
        let table = DeTable::parse(&text).map_err(|error| syntax(&source, &error))?;
        let table = table.get_ref();
        let source = with_mesh(source, table)?;
        let (violates, formulas, parameters) = (Vec::new(), Graph::new(), Vec::new());
        let mut reading = Reading { source: &source, table, violates, formulas, parameters };
        let kind = SceneKind::validate(&reading)?;
        refuse_unknown(&reading, kind)?;
        let name: String = reading.required("scene.name")?;
        let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        let odd = name.is_empty() || name.len() > LONGEST_NAME || !name.chars().all(allowed);
        let message = format!("`{name}`, {} characters, cannot name a scene", name.len());
        let hint = format!(
            "use letters, digits, - and _, at most {LONGEST_NAME} of them: the name becomes part of file names"
        );
        reading.refuse_if(odd, "scene.name", message, hint)?;
        let question = reading.required("scene.question")?;
        let (known, fault) = match kind {
            SceneKind::Abstract => {
                (1..=MOST, "is no dimension of an abstract problem: X = R^m with m from 1 to 256")
            }
            SceneKind::Contact => {
                (2..=3, "is no dimension of a contact problem: 2 is plane strain, 3 is space")
            }
        };
        let dimension = reading.whole("scene.dimension", known, fault)?;
        let judge = reading.optional("scene.judge")?.unwrap_or(true);
        let known = [Expectation::Pass, Expectation::Fail, Expectation::Unresolved];
        let known = known.map(|verdict| (verdict.name(), verdict));
        let expect = reading.choice_or("scene.expect", &known, Expectation::Pass)?;
        let long = reading.optional("scene.long")?.unwrap_or(false);
        let window_n = reading.window("scene.window_n")?;
        let window_steps = reading.window("scene.window_steps")?;
        let one = |index| reading.choice(&format!("scene.violates.{index}"), &Hypothesis::NAMES);
        reading.violates = reading.entries("scene.violates")?.map(one).collect::<Result<_>>()?;
        let (time, body, predicts, sweep) = match kind {
            SceneKind::Contact => in_contact(&mut reading, dimension, judge)?,
            SceneKind::Abstract => abstract_problem(&mut reading, dimension)?,
        };
        let message = "the scene is judged and predicts nothing: there is no order to judge";
        let hint =
            "add [[predicts]] with norm, variable, order and why, or say judge = false in [scene]";
        reading.refuse_if(judge && predicts.is_empty(), "scene.judge", message, hint)?;
        let Reading { violates, formulas, .. } = reading;
        let scene = Scene {
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
            time,
            body,
            predicts,
            sweep,
            formulas,
        };
        let element = scene.as_contact().map_or(Element::P1, |body| body.element);
        scene.with_element(element)
    }

    /// Bytes of the value at a dotted key (`exact.multiplier`), or of the part that would contain it.
    pub fn span(&self, key: &str) -> Range<usize> {
        let table = DeTable::parse(&self.source.text);
        table.map_or(0..0, |table| placed(table.get_ref(), key).value)
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
        hint: impl ToString,
    ) -> Result<()> {
        if fault { Err(self.error(key, message, hint)) } else { Ok(()) }
    }

    /// An error found later, such as (2.9) violated, at a key of this scene.
    pub fn error(&self, key: &str, message: impl ToString, hint: impl ToString) -> SceneError {
        SceneError::at(&self.source, self.span(key), message, hint)
    }
}

/// The parts of a scene besides its heading.
type Content = (Time, Body, Vec<Prediction>, Option<Sweep>);

fn in_contact(reading: &mut Reading, dimension: usize, judge: bool) -> Result<Content> {
    let domain = Domain::validate(reading, dimension)?;
    let time = Time::validate(reading)?;
    let material = Material::validate(reading, time.horizon, &domain)?;
    has_a_rule(reading, &time, [material.singular_key(), material.nested_key()])?;
    reading.parameters = parameters(reading)?;
    let contact = Contact::validate(reading, &domain, &time)?;
    let data = Data::validate(reading, &domain, &time, &contact)?;
    let on_contact = !contact.is_empty();
    let states = matches!(data, Data::Exact { .. }) && on_contact && dimension == 2;
    let predicts = predictions(reading, [on_contact, states])?;
    let sweep = reading
        .if_given("sweep", |reading, _| Sweep::validate(reading, &domain, [on_contact, states]))?;
    sweep.iter().try_for_each(|sweep| time.serves(reading, sweep))?;
    serves(reading, sweep.as_ref(), &predicts)?;
    let reference = sweep.as_ref().and_then(|sweep| sweep.reference);
    let truth = matches!(data, Data::Exact { .. }) || reference.is_some();
    let message =
        "there is neither an exact solution nor a reference run, so errors cannot be measured";
    let hint = "add to [sweep]: reference = { n = 128, steps = 64 }";
    let key = if sweep.is_some() { "sweep" } else { "loads" };
    reading.refuse_if(!truth && (judge || sweep.is_some()), key, message, hint)?;
    let known = Element::ALL.map(|known| (known.name(), known));
    let element = reading.choice_or(KEY, &known, Element::P1)?;
    let body = ContactScene { domain, material, contact, data, element };
    Ok((time, Body::Contact(Box::new(body)), predicts, sweep))
}

fn abstract_problem(reading: &mut Reading, dimension: usize) -> Result<Content> {
    let time = Time::validate(reading)?;
    reading.parameters = parameters(reading)?;
    let body = AbstractScene::validate(reading, time.horizon, dimension)?;
    has_a_rule(reading, &time, [body.singular_key(), body.nested_key()])?;
    let predicts = predictions(reading, [!body.traces.is_empty(), false])?;
    for (index, prediction) in predicts.iter().enumerate() {
        prediction.only_in_time(reading, index)?;
    }
    let sweep = reading.if_given("sweep", |reading, _| Sweep::in_time(reading))?;
    sweep.iter().try_for_each(|sweep: &Sweep| time.serves(reading, sweep))?;
    Ok((time, Body::Abstract(Box::new(body)), predicts, sweep))
}

fn predictions(reading: &Reading, known: [bool; 2]) -> Result<Vec<Prediction>> {
    let one = |index| Prediction::validate(reading, index, known);
    reading.entries("predicts")?.map(one).collect()
}

// `[scene]`: the name, the question, and how the scene is judged.

/// A hypothesis that a scene may violate on purpose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hypothesis {
    /// (2.9): α_φ + α_j c_j² < m_A.
    Smallness,
    /// g concave on each contact face, so that U^h ⊂ U.
    ConcaveGap,
    /// κ Lipschitz, as (5.1) requires.
    LipschitzKappa,
    /// (3.4): k below the step-size bound.
    StepSize,
    /// q ∈ C² and u ∈ W^{2,∞}(0,T;X), the premises of (3.17) in Theorem 7; (5.15) for the body.
    RegularInTime,
    /// (5.25): u(t) ∈ H²(Ω), u_ν(t) ∈ H² on each side of Γ3.
    RegularInSpace,
}

impl Hypothesis {
    const NAMES: [(&str, Hypothesis); 6] = [
        ("2.9", Hypothesis::Smallness),
        ("concave_gap", Hypothesis::ConcaveGap),
        ("5.1", Hypothesis::LipschitzKappa),
        ("3.4", Hypothesis::StepSize),
        ("3.17", Hypothesis::RegularInTime),
        ("5.25", Hypothesis::RegularInSpace),
    ];

    /// Its name in `violates`.
    pub fn name(self) -> &'static str {
        name_in(&Self::NAMES, self)
    }
}

/// The name of a value in a table of all of its type.
pub(super) fn name_in<T: PartialEq>(names: &[(&'static str, T)], value: T) -> &'static str {
    names.iter().find(|(_, known)| *known == value).map_or("", |(name, _)| name)
}

impl SceneKind {
    /// The kind named in a file; by default contact.
    pub(crate) fn validate(reading: &Reading) -> Result<SceneKind> {
        let known = [("contact", SceneKind::Contact), ("abstract", SceneKind::Abstract)];
        reading.choice_or("scene.kind", &known, SceneKind::Contact)
    }
}

/// Longest name of a scene, in bytes: file systems allow 255, and pictures and unfinished files add some 30, as in
/// `NAME-trade-memory.svg.4194304.partial`.
const LONGEST_NAME: usize = 200;

// What a scene may have beyond the setting of the paper, and commands that leave it out of account.

/// Beyond the paper's kernels without a pole and contact without friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extension {
    /// `[contact.friction]`.
    Friction,
    /// Kernels that are infinite at s = t.
    SingularKernel,
}

impl Extension {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Friction, Self::SingularKernel];

    /// The key that asks for it in a scene, its name, and the way out; none where the scene does without.
    fn asked_by(self, scene: &Scene) -> Option<(String, String, &'static str)> {
        let body = scene.as_contact();
        match self {
            Self::Friction => {
                let way_out = "run, gate, verify, check, bound and solve do; for this command take a scene without [contact.friction]";
                let with = body?.contact.iter().find(|contact| contact.friction.is_some())?;
                Some((format!("{}.friction", with.key), "friction".into(), way_out))
            }
            Self::SingularKernel => {
                let key = match &scene.body {
                    Body::Contact(body) => body.material.singular_key(),
                    Body::Abstract(problem) => problem.singular_key(),
                };
                let name = "kernels that are infinite at s = t".into();
                let way_out = "list, check, run, gate, verify, solve, diagnose and gronwall do; for this command remove `singular`";
                key.map(|key| (key, name, way_out))
            }
        }
    }
}

impl Scene {
    /// Refuses a scene with one of these for a command that leaves them out of account, and says why it does.
    ///
    /// # Errors
    /// At the key that asks for the first of them.
    pub fn without(&self, extensions: &[Extension], command: &str, why: &str) -> Result<()> {
        match extensions.iter().find_map(|extension| extension.asked_by(self)) {
            None => Ok(()),
            Some((key, what, way_out)) => {
                Err(self.error(&key, format!("`{command}` does not treat {what}: {why}"), way_out))
            }
        }
    }
}

// `[discretization]`: the element of displacements.

const KEY: &str = "discretization.element";

impl Scene {
    /// The scene with another element.
    ///
    /// # Errors
    /// At `discretization.element`, where it is incompatible with a part of the scene.
    pub fn with_element(&self, element: Element) -> Result<Self> {
        let mut scene = self.clone();
        let Body::Contact(body) = &mut scene.body else { return Ok(scene) };
        let linear = element == Element::P1;
        let at_vertices = body.contact.iter().all(|c| c.quadrature == ContactQuadrature::Vertex);
        let message = "P2 integrates the contact law by Simpson's rule on edges, by the midpoints on triangles";
        let hint = "say quadrature = \"vertex\" in [contact], or take P1";
        self.refuse_if(!linear && !at_vertices, KEY, message, hint)?;
        let in_space = body.domain.dimension() == 3 && body.friction().is_some();
        let message = "P2 has no friction in space, where its contact is at midpoints alone";
        let hint = "remove [contact.friction], or take P1";
        self.refuse_if(!linear && in_space, KEY, message, hint)?;
        body.element = element;
        Ok(scene)
    }
}

// A scene with one thing different: a setting, a term removed, a unit, a parameter.

type Apply = dyn Fn(Scene) -> Result<Scene> + Send + Sync;

/// What is different in a scene, in words, and how to make it so. Changes with equal words are equal.
#[derive(Clone)]
pub struct Change {
    words: String,
    apply: Arc<Apply>,
}

impl Change {
    /// A change that `apply` makes, in a few words: they name it in tables, files and messages.
    pub fn new(
        words: impl Into<String>,
        apply: impl Fn(Scene) -> Result<Scene> + Send + Sync + 'static,
    ) -> Self {
        Self { words: words.into(), apply: Arc::new(apply) }
    }

    /// No change.
    pub fn none() -> Self {
        Self::new("as written", Ok)
    }

    pub fn words(&self) -> &str {
        &self.words
    }

    /// The scene that way.
    ///
    /// # Errors
    /// What the scene cannot have, at the key that would say it.
    pub fn of(&self, scene: &Scene) -> Result<Scene> {
        (self.apply)(scene.clone())
    }
}

impl PartialEq for Change {
    fn eq(&self, other: &Self) -> bool {
        self.words == other.words
    }
}

impl fmt::Debug for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words)
    }
}

impl serde::Serialize for Change {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.words)
    }
}

/// Refuses a key that no table of its name has. Unknown keys are refused before values are read: a misspelt one is why another
/// is missing.
fn refuse_unknown(reading: &Reading, kind: SceneKind) -> Result<()> {
    let whole = Part::of(kind).map(|part| part.tables[0].trim_end_matches(".*"));
    reading.keys("", &whole.filter(|name| !name.contains('.')).collect::<Vec<_>>())?;
    for part in Part::of(kind) {
        let keys = part.keys(kind);
        for table in &part.tables {
            let tables = tables(reading, table)?.into_iter();
            let is_table = |table: &String| !part.has_kinds() || reading.has_parts(table);
            tables.filter(is_table).try_for_each(|table| reading.keys(&table, &keys))?;
        }
    }
    Ok(())
}

/// The tables of a file that a name stands for.
fn tables(reading: &Reading, name: &str) -> Result<Vec<String>> {
    if let Some(rest) = name.strip_prefix("contact") {
        let of = |table: String| format!("{table}{rest}");
        return Ok(contact::tables(reading)?.into_iter().map(of).collect());
    }
    let Some((list, rest)) = name.split_once(".*") else { return Ok(vec![name.to_string()]) };
    let of_entry = |i| tables(reading, &format!("{list}.{i}{rest}"));
    Ok(reading.entries(list)?.map(of_entry).collect::<Result<Vec<_>, _>>()?.concat())
}
