//! `[scene]`: the name, the question, and how the scene is judged.

use super::abstract_scene::MOST;
use super::diagnostic::SceneError;
use super::reading::Reading;
use super::written;

/// The verdict that a scene must reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expectation {
    Pass,
    Fail,
    Unresolved,
}

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
    const ALL: [Hypothesis; 6] = [
        Hypothesis::Smallness,
        Hypothesis::ConcaveGap,
        Hypothesis::LipschitzKappa,
        Hypothesis::StepSize,
        Hypothesis::RegularInTime,
        Hypothesis::RegularInSpace,
    ];

    /// Its name in `violates`.
    pub fn name(self) -> &'static str {
        match self {
            Hypothesis::Smallness => "2.9",
            Hypothesis::ConcaveGap => "concave_gap",
            Hypothesis::LipschitzKappa => "5.1",
            Hypothesis::StepSize => "3.4",
            Hypothesis::RegularInTime => "3.17",
            Hypothesis::RegularInSpace => "5.25",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SceneKind {
    /// Problem 12: a body in contact.
    Contact,
    /// Problem 1 in ℝ^m.
    Abstract,
}

impl SceneKind {
    /// The kind named in a file; by default contact.
    pub(crate) fn validate(reading: &Reading, word: Option<&str>) -> Result<SceneKind, SceneError> {
        let known = [("contact", SceneKind::Contact), ("abstract", SceneKind::Abstract)];
        reading.choice("scene.kind", word.unwrap_or("contact"), &known)
    }
}

pub(super) struct Heading {
    pub name: String,
    pub dimension: usize,
    pub expect: Expectation,
    pub window_n: Option<[usize; 2]>,
    pub window_steps: Option<[usize; 2]>,
    pub violates: Vec<Hypothesis>,
}

impl Heading {
    pub(crate) fn validate(
        reading: &Reading,
        written: &written::Heading,
        kind: SceneKind,
    ) -> Result<Heading, SceneError> {
        Ok(Heading {
            name: name(reading, &written.name)?,
            dimension: dimension(reading, written.dimension, kind)?,
            expect: match &written.expect {
                Some(word) => expectation(reading, word)?,
                None => Expectation::Pass,
            },
            window_n: reading.window("scene.window_n", written.window_n.as_ref())?,
            window_steps: reading.window("scene.window_steps", written.window_steps.as_ref())?,
            violates: violates(reading, &written.violates)?,
        })
    }
}

/// Longest name of a scene, in bytes: file systems allow 255, and pictures and unfinished files add some 30, as in
/// `NAME-trade-memory.svg.4194304.partial`.
const LONGEST_NAME: usize = 200;

/// A name becomes part of file names: letters, digits, `-` and `_`.
fn name(reading: &Reading, name: &str) -> Result<String, SceneError> {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if name.len() > LONGEST_NAME {
        return Err(reading.error(
            "scene.name",
            format!("a name of {} characters", name.len()),
            format!("use at most {LONGEST_NAME}: the name becomes part of file names"),
        ));
    }
    if !name.is_empty() && name.chars().all(allowed) {
        return Ok(name.to_string());
    }
    Err(reading.error(
        "scene.name",
        format!("`{name}` cannot name a scene"),
        "use letters, digits, - and _: the name becomes part of file names",
    ))
}

fn dimension(reading: &Reading, dimension: i64, kind: SceneKind) -> Result<usize, SceneError> {
    match dimension {
        1..=MOST if kind == SceneKind::Abstract => Ok(dimension.unsigned_abs() as usize),
        _ if kind == SceneKind::Abstract => Err(reading.error(
            "scene.dimension",
            format!("{dimension} is no dimension of an abstract problem"),
            format!("X = R^m with m from 1 to {MOST}: matrices are dense"),
        )),
        2 => Ok(2),
        3 => Ok(3),
        _ => Err(reading.error(
            "scene.dimension",
            format!("dimension {dimension} has no contact problem"),
            "write dimension = 2 (plane strain) or 3",
        )),
    }
}

fn expectation(reading: &Reading, word: &str) -> Result<Expectation, SceneError> {
    let known = [
        ("pass", Expectation::Pass),
        ("fail", Expectation::Fail),
        ("unresolved", Expectation::Unresolved),
    ];
    reading.choice("scene.expect", word, &known)
}

fn violates(reading: &Reading, words: &[String]) -> Result<Vec<Hypothesis>, SceneError> {
    let known = Hypothesis::ALL.map(|hypothesis| (hypothesis.name(), hypothesis));
    let one = |(index, word): (usize, &String)| {
        reading.choice(&format!("scene.violates.{index}"), word, &known)
    };
    words.iter().enumerate().map(one).collect()
}
