//! Ladders: one parameter from the ordinary to the extreme, and what each rung must show.

use super::UnderTest;
use super::answer::{SceneAnswer, Unanswered, solve};
pub(super) use judge::claim::Relation;

/// What a run measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The number that the ladder is about.
    pub value: f64,
    /// Newton iterations per level, where levels were solved.
    pub iterations: Option<f64>,
    /// Largest relative KKT residual by separate evaluation, where there is one.
    pub kkt: Option<f64>,
    /// What else was seen; empty mostly.
    pub note: String,
}

impl Measured {
    /// A number without a solve behind it.
    pub fn number(value: f64) -> Self {
        Self { value, iterations: None, kkt: None, note: String::new() }
    }

    /// A number about an answer.
    pub(crate) fn of(value: f64, answer: &SceneAnswer) -> Self {
        let iterations = f64::from(answer.iterations) / answer.zeta.len().max(1) as f64;
        Self { iterations: Some(iterations), kkt: Some(answer.kkt), ..Self::number(value) }
    }

    /// What was measured, with a remark.
    pub(crate) fn noted(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }
}

/// Runs a rung with the parts under test.
pub type Run = dyn Fn(&UnderTest<'_>) -> Result<Measured, Unanswered> + Send + Sync;

/// One value of the parameter.
pub struct Rung {
    /// The value in words.
    pub at: String,
    /// What it must show of its number, or the words in the first line of a typed error.
    pub expected: Relation,
    /// The run.
    pub run: Box<Run>,
    /// The largest run of a body in it, if that has more than a few thousand unknowns and levels together.
    pub largest: Option<Largest>,
}

/// A run of a body: its scene, n and N.
pub struct Largest {
    /// The scene file.
    pub text: String,
    /// Cells per unit length.
    pub n: u32,
    /// Steps.
    pub steps: u32,
}

impl Rung {
    pub(crate) fn new(
        at: impl Into<String>,
        expected: Relation,
        run: impl Fn(&UnderTest<'_>) -> Result<Measured, Unanswered> + Send + Sync + 'static,
    ) -> Self {
        Self { at: at.into(), expected, run: Box::new(run), largest: None }
    }

    /// A rung that is one run of a body, its text with n and N, and a number about the answer.
    pub(super) fn body(
        at: impl Into<String>,
        expected: Relation,
        (text, n, steps): (String, u32, u32),
        value: impl Fn(&SceneAnswer) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self::new(at, expected, move |under_test| {
            let answer = solve(text.clone(), n, steps, under_test.prepare)?;
            Ok(Measured::of(value(&answer), &answer))
        })
    }

    /// Names the largest run of a body in the rung, for the limit of memory.
    pub(super) fn with_largest(self, text: String, n: u32, steps: u32) -> Self {
        Self { largest: Some(Largest { text, n, steps }), ..self }
    }
}

/// All values of one parameter.
#[derive(serde::Serialize)]
pub struct Ladder {
    /// Its name on the command line.
    pub name: &'static str,
    /// The parameter.
    pub parameter: &'static str,
    /// What is measured.
    pub quantity: &'static str,
    /// Why the expectation is what it is.
    pub why: &'static str,
    /// From the first value to the last.
    #[serde(skip)]
    pub rungs: Vec<Rung>,
}

/// 10^e, the nearest double; the powers of ten that `powi` forms by multiplication are not.
pub(super) fn power_of_ten(e: i32) -> f64 {
    format!("1e{e}").parse().unwrap_or(f64::NAN)
}
