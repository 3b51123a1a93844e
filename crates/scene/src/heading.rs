//! `[scene]`: the name, the question, and how the scene is judged.

use super::abstract_scene::MOST;
use super::diagnostic::Result;
use super::reading::Reading;

/// The verdict that a scene must reach.
pub use judge::verdict::Decision as Expectation;

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

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SceneKind {
    /// Problem 12: a body in contact.
    Contact,
    /// Problem 1 in ℝ^m.
    Abstract,
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

/// A name becomes part of file names: letters, digits, `-` and `_`.
pub(super) fn name(reading: &Reading) -> Result<String> {
    let name: String = reading.required("scene.name")?;
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let message = format!("a name of {} characters", name.len());
    let hint = format!("use at most {LONGEST_NAME}: the name becomes part of file names");
    reading.refuse_if(name.len() > LONGEST_NAME, "scene.name", message, hint)?;
    let odd = name.is_empty() || !name.chars().all(allowed);
    let message = format!("`{name}` cannot name a scene");
    let hint = "use letters, digits, - and _: the name becomes part of file names";
    reading.refuse_if(odd, "scene.name", message, hint).map(|()| name)
}

pub(super) fn dimension(reading: &Reading, kind: SceneKind) -> Result<usize> {
    let dimension: i64 = reading.required("scene.dimension")?;
    let (known, message, hint) = match kind {
        SceneKind::Abstract => (
            1..=MOST,
            format!("{dimension} is no dimension of an abstract problem"),
            format!("X = R^m with m from 1 to {MOST}: matrices are dense"),
        ),
        SceneKind::Contact => (
            2..=3,
            format!("dimension {dimension} has no contact problem"),
            "write dimension = 2 (plane strain) or 3".into(),
        ),
    };
    reading.refuse_if(!known.contains(&dimension), "scene.dimension", message, hint)?;
    Ok(dimension.unsigned_abs() as usize)
}

pub(super) fn expectation(reading: &Reading) -> Result<Expectation> {
    let known = [Expectation::Pass, Expectation::Fail, Expectation::Unresolved];
    let known = known.map(|verdict| (verdict.name(), verdict));
    reading.choice_or("scene.expect", &known, Expectation::Pass)
}

pub(super) fn violates(reading: &Reading) -> Result<Vec<Hypothesis>> {
    let one = |index| reading.choice(&format!("scene.violates.{index}"), &Hypothesis::NAMES);
    reading.entries("scene.violates")?.map(one).collect()
}
