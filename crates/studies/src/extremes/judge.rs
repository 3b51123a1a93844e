//! A rung run and judged.

use std::time::Instant;

use super::UnderTest;
use super::answer::{Unanswered, caught};
use super::rung::{Expected, Ladder, Measured, Rung};
use fem::contact::KKT_ALLOWED;

/// How a rung ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Standing {
    AsExpected,
    RefusedAsExpected,
    /// It measured something else, or was refused against expectation, or was not.
    NotAsExpected,
    Failed,
}

impl Standing {
    /// Whether the rung counts as green.
    pub fn as_expected(self) -> bool {
        matches!(self, Self::AsExpected | Self::RefusedAsExpected)
    }

    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::AsExpected => "as expected",
            Self::RefusedAsExpected => "refused as expected",
            Self::NotAsExpected => "not as expected",
            Self::Failed => "failed",
        }
    }
}

/// One row of the table.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct RungRow {
    /// The ladder.
    pub ladder: &'static str,
    /// The value of its parameter.
    pub at: String,
    /// What is measured.
    pub quantity: &'static str,
    /// What was expected.
    pub expected: String,
    /// What was measured; absent without an answer.
    pub measured: Option<f64>,
    /// Decimal digits of which rounding left nothing: log10(measured/ε), at least 0, where the measured
    /// number is a relative error.
    pub digits_lost: Option<f64>,
    /// Newton iterations per level.
    pub iterations: Option<f64>,
    /// Largest relative KKT residual.
    pub kkt: Option<f64>,
    /// How it ended.
    pub standing: Standing,
    /// A remark, or why it is not as expected.
    pub note: String,
    /// Seconds it took.
    pub seconds: f64,
}

/// Runs one rung; a panic is a failed row and not the end of the others.
pub fn judge(ladder: &Ladder, rung: &Rung, under_test: &UnderTest<'_>) -> RungRow {
    let start = Instant::now();
    let outcome = caught(|| (rung.run)(under_test));
    let (standing, note) = standing(&rung.expected, &outcome);
    let measured = outcome.ok();
    let value = measured.as_ref().map(|measured| measured.value);
    let error = matches!(rung.expected, Expected::AtMost(most) if most < LARGEST_ERROR);
    RungRow {
        ladder: ladder.name,
        at: rung.at.clone(),
        quantity: ladder.quantity,
        expected: in_words(&rung.expected),
        measured: value,
        digits_lost: value.filter(|_| error).map(|v| (v / f64::EPSILON).log10().max(0.0)),
        iterations: measured.as_ref().and_then(|measured| measured.iterations),
        kkt: measured.as_ref().and_then(|measured| measured.kkt),
        standing,
        note,
        seconds: start.elapsed().as_secs_f64(),
    }
}

/// A bound below this is one of a relative error; orders and ratios of errors are of order one.
const LARGEST_ERROR: f64 = 0.1;

fn in_words(expected: &Expected) -> String {
    match expected {
        Expected::AtMost(most) => format!("≤ {most:.1e}"),
        Expected::Within([low, high]) => format!("in [{low:.2}, {high:.2}]"),
        Expected::Refused(saying) => format!("refused: {saying}"),
    }
}

/// The verdict on an outcome, with the remark or the reason. NaN is as expected nowhere.
pub fn standing(expected: &Expected, outcome: &Result<Measured, Unanswered>) -> (Standing, String) {
    let not = |reason: String| (Standing::NotAsExpected, reason);
    match (outcome, expected) {
        (Err(error @ Unanswered::Panicked(_)), _) => (Standing::Failed, error.to_string()),
        (Err(Unanswered::Refused(said)), Expected::Refused(saying)) => {
            match said.contains(saying) {
                true => (Standing::RefusedAsExpected, said.clone()),
                false => not(format!("refused for another reason: {said}")),
            }
        }
        (Err(Unanswered::Refused(said)), _) => not(format!("refused: {said}")),
        (Ok(measured), Expected::Refused(_)) => {
            not(format!("not refused: it answered {:.3e}", measured.value))
        }
        (Ok(measured), _) => {
            let met = match expected {
                Expected::AtMost(most) => measured.value <= *most,
                Expected::Within([low, high]) => (*low..=*high).contains(&measured.value),
                Expected::Refused(_) => false,
            };
            // A solver may stop without a look at its residual.
            let balanced = measured.kkt.is_none_or(|kkt| kkt <= KKT_ALLOWED);
            match (met, balanced) {
                (true, true) => (Standing::AsExpected, measured.note.clone()),
                (false, _) => not(format!("measured {:.3e}", measured.value)),
                (true, false) => not(format!("KKT residual {:?}", measured.kkt)),
            }
        }
    }
}
