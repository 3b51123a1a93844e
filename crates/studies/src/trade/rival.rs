//! Which element reaches an error first: the cheapest runs of both at equal error.

use super::candidates::{Candidates, MOST};
use super::{Answer, CostModel, ErrorModel, Knob, Models, NoAnswer, Trial};
use serde::Serialize;

/// Errors at which elements are compared.
const LEVELS: u32 = 5;

/// Another element, on meshes of about as many nodes, beside the scene as written.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Rival {
    /// The knob.
    pub knob: Knob,
    /// What its runs say.
    #[serde(flatten)]
    pub models: Models,
    /// Errors from the largest that was measured to the least, with the cheapest run of each. Empty where a model is missing.
    pub equal_error: Vec<Equal>,
    /// Who wins where, in words.
    pub words: String,
}

/// The cheapest runs of the scene as written and of the rival whose errors are predicted to be at most this.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Equal {
    /// The error.
    pub error: f64,
    /// The scene as written.
    pub as_written: Answer,
    /// The rival.
    pub rival: Answer,
    /// Seconds of the one over seconds of the other.
    pub speed: f64,
    /// Whether they are finer than what was run.
    pub extrapolates: [bool; 2],
}

/// Both models of an element, with the range of n and N that they rest on.
pub(super) struct Known<'a> {
    pub knob: Knob,
    pub error: &'a ErrorModel,
    pub cost: &'a CostModel,
    models: &'a Models,
    least: [u32; 2],
    most: [u32; 2],
}

impl<'a> Known<'a> {
    /// The models of the rows with a knob; none unless both were fitted.
    pub(super) fn new(models: &'a Models, knob: Knob, trials: &[Trial]) -> Option<Self> {
        let (error, cost) = models.both()?;
        let rows = || trials.iter().filter(|t| t.knob == knob).map(|t| [t.n, t.steps]);
        let least = rows().fold([u32::MAX; 2], |a, b| [a[0].min(b[0]), a[1].min(b[1])]);
        let most = rows().fold([0; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        Some(Self { knob, error, cost, models, least, most })
    }

    /// The cheapest run for an error, no finer than `most`.
    ///
    /// # Errors
    /// [`NoAnswer`].
    pub(super) fn cheapest(
        &self,
        candidates: &Candidates<'_>,
        most: [u32; 2],
        target: f64,
    ) -> Result<Answer, NoAnswer> {
        let seconds = |h: f64, k: f64| self.models.seconds(self.cost, h, k);
        candidates.cheapest(&|h, k| self.error.error(h, k), &seconds, target, [self.least, most])
    }

    /// How many times beyond the runs an answer lies, in words; none within them.
    pub(super) fn beyond(&self, answer: &Answer) -> Option<String> {
        let part = |name: &str, value: u32, most: u32| {
            let times = f64::from(value) / f64::from(most);
            (value > most).then(|| format!("{name} is {times:.1} times the largest that was run"))
        };
        let parts = [part("n", answer.n, self.most[0]), part("N", answer.steps, self.most[1])];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    }
}

impl Rival {
    /// Compares the models of a knob with those of the scene as written.
    pub(super) fn new(
        candidates: &Candidates<'_>,
        plain: &Models,
        knob: Knob,
        models: Models,
        trials: &[Trial],
    ) -> Self {
        let errors = || {
            let rows = trials.iter().filter(|t| [Knob::AsWritten, knob].contains(&t.knob));
            rows.filter_map(|t| Some(t.done()?.error)).filter(|error| *error > 0.0)
        };
        let (lo, hi) = (errors().fold(f64::INFINITY, f64::min), errors().fold(0.0, f64::max));
        let known =
            Known::new(plain, Knob::AsWritten, trials).zip(Known::new(&models, knob, trials));
        let level = |i: u32| hi * (lo / hi).powf(f64::from(i) / f64::from(LEVELS - 1));
        let (mut words, mut equal_error) = (
            format!("{}: not compared at equal error, for want of a model", knob.name()),
            Vec::new(),
        );
        if let Some((first, second)) = &known {
            let equal = |error: f64| {
                let answer = |known: &Known<'_>| known.cheapest(candidates, MOST, error).ok();
                let (as_written, rival) = (answer(first)?, answer(second)?);
                let extrapolates =
                    [first.beyond(&as_written), second.beyond(&rival)].map(|far| far.is_some());
                let speed = as_written.seconds / rival.seconds;
                Some(Equal { error, as_written, rival, speed, extrapolates })
            };
            equal_error = (0..LEVELS).map(level).filter_map(equal).collect();
            // Times are told apart where they differ by more than what both models miss of the runs.
            let unsure = first.cost.residual + second.cost.residual;
            words = verdict(&knob.name(), &equal_error, unsure);
        }
        Self { knob, models, equal_error, words }
    }
}

/// Who wins where: neighbours with the same winner are one range of errors.
fn verdict(name: &str, levels: &[Equal], unsure: f64) -> String {
    let winner = |at: &Equal| match at.speed.ln() {
        log if log > unsure => Some(true),
        log if log < -unsure => Some(false),
        _ => None,
    };
    let ranges = levels.chunk_by(|a, b| winner(a) == winner(b)).map(|range| {
        let [first, last] = [range[0], range[range.len() - 1]];
        let span = |a: String, b: String| if a == b { a } else { format!("{a} to {b}") };
        let errors = span(format!("{:.1e}", first.error), format!("{:.1e}", last.error));
        let times = |invert: bool| {
            let of = |at: Equal| format!("{:.1}", if invert { 1.0 / at.speed } else { at.speed });
            span(of(first), of(last))
        };
        match winner(&first) {
            Some(true) => format!("{name} wins at {errors} ({} times faster)", times(false)),
            Some(false) => format!("as written wins at {errors} ({} times faster)", times(true)),
            None => format!("no difference at {errors}"),
        }
    });
    let ranges: Vec<String> = ranges.collect();
    match ranges.is_empty() {
        true => format!("{name}: no error is in reach of both"),
        false => format!("at equal error {}", ranges.join("; ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_name_their_winner() {
        let answer = |seconds| Answer { n: 8, steps: 4, error: 0.1, seconds };
        let level = |error: f64, speed: f64| Equal {
            error,
            as_written: answer(speed),
            rival: answer(1.0),
            speed,
            extrapolates: [false; 2],
        };
        let levels = [level(0.1, 0.5), level(0.05, 1.02), level(0.02, 3.0), level(0.01, 8.0)];
        assert_eq!(
            verdict("element P2", &levels, 0.1),
            "at equal error as written wins at 1.0e-1 (2.0 times faster); no difference at 5.0e-2; element P2 wins at 2.0e-2 to 1.0e-2 (3.0 to 8.0 times faster)"
        );
        // What the models miss decides nothing.
        assert!(verdict("element P2", &levels[..1], 0.7).ends_with("no difference at 1.0e-1"));
        assert!(verdict("element P2", &[], 0.1).contains("no error is in reach"));
    }
}
