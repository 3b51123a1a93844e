//! Progress of a sweep on stderr: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use super::output::print_error;
use files::{counted, harmless};
use judge::record::{CaseRecord, Status};
use run::sweep::Progress;
use scene::setup::StepRemark;

/// Amount of output on stderr beside errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Loudness {
    Quiet,
    /// A bar on a terminal, a line per case elsewhere; notes and warnings.
    Usual,
    /// A line per case on a terminal as well.
    Verbose,
}

static LOUDNESS: OnceLock<Loudness> = OnceLock::new();

/// Set once, at the start of the program.
pub(crate) fn say(loudness: Loudness) {
    LOUDNESS.get_or_init(|| loudness);
}

fn loudness() -> Loudness {
    LOUDNESS.get().copied().unwrap_or(Loudness::Usual)
}

pub(crate) fn note(line: &str) {
    if loudness() != Loudness::Quiet {
        print_error(line);
    }
}

/// Prints the remark of (3.4) on the step sizes of a scene.
pub(crate) fn remark(scene: &str, remark: &StepRemark) {
    let kind = if remark.warning { "warning" } else { "note" };
    note(&format!("{kind}: {scene}: {}", remark.text));
}

/// Progress for a person or a log.
pub(crate) struct Display {
    bar: Option<ProgressBar>,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    total: usize,
    done: usize,
    running: Vec<String>,
    begun: Option<Instant>,
    /// The done share of the work.
    share: f64,
    /// Reason of the last failed case.
    reason: Option<String>,
}

/// Resolution of the bar, in shares of the work: a case may take a thousand times as long as another.
const PARTS: u64 = 1000;

impl State {
    /// Number of done cases and, once known, the estimated remaining time.
    fn in_words(&self) -> String {
        let cases = format!("{}/{} cases", self.done, self.total);
        let left = self.begun.and_then(|begun| left(begun.elapsed().as_secs_f64(), self.share));
        left.map_or(cases.clone(), |left| format!("{cases}, about {} s left", left.ceil()))
    }

    /// A failure in words; a repeated reason is omitted.
    fn failed(&mut self, reason: &str) -> String {
        if self.reason.as_deref() == Some(reason) {
            return "failed for the same reason".into();
        }
        self.reason = Some(reason.into());
        format!("failed: {reason}")
    }
}

/// Seconds left if `share` of the work took `seconds`; unknown at first.
fn left(seconds: f64, share: f64) -> Option<f64> {
    (share > 0.0).then(|| seconds * (1.0 - share.min(1.0)) / share)
}

impl Display {
    /// A bar if stderr is a terminal.
    pub(crate) fn new() -> Self {
        let terminal = std::io::stderr().is_terminal() && loudness() != Loudness::Quiet;
        let bar = terminal.then(|| {
            let style = ProgressStyle::with_template("{bar:24} {prefix}  {msg}");
            ProgressBar::new(PARTS)
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { bar, state: Mutex::default() }
    }

    fn show(&self, state: &State) {
        if let Some(bar) = self.bar.as_ref().filter(|bar| !bar.is_finished()) {
            bar.set_position((state.share * PARTS as f64) as u64);
            bar.set_prefix(state.in_words());
            bar.set_message(state.running.join(" | "));
        }
    }

    /// A line, above the bar if there is one.
    fn line(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.println(harmless(line).as_ref()),
            None => note(line),
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Display {
    fn begin(&self, total: usize, done: usize) {
        let mut state = self.state();
        (state.total, state.done, state.begun, state.share) =
            (total, done, Some(Instant::now()), 0.0);
        self.show(&state);
        let cases = counted(total, "case");
        match (&self.bar, done) {
            (Some(_), _) => {}
            (None, 0) => note(&cases),
            (None, done) => note(&format!("{cases}, {done} already recorded")),
        }
    }

    fn doubted(&self, why: &str) {
        note(&format!("warning: {why}"));
    }

    fn started(&self, what: &str) {
        let mut state = self.state();
        state.running.push(what.to_string());
        self.show(&state);
    }

    fn finished(&self, what: &str, record: Option<&CaseRecord>) {
        let mut state = self.state();
        state.running.retain(|running| running != what);
        let failure = record.and_then(|record| match &record.status {
            Status::Failed { reason } => Some(state.failed(reason)),
            _ => None,
        });
        state.done += usize::from(record.is_some());
        if failure.is_some() || self.bar.is_none() || loudness() == Loudness::Verbose {
            let outcome = failure.unwrap_or_else(|| "done".into());
            let seconds = record.map_or(String::new(), |r| format!(" {:.2} s", r.seconds_total));
            self.line(&format!("[{}/{}] {what} {outcome}{seconds}", state.done, state.total));
        }
        self.show(&state);
        if let Some(bar) = self.bar.as_ref().filter(|_| state.done == state.total) {
            bar.finish_and_clear();
        }
    }

    fn advanced(&self, share: f64) {
        let mut state = self.state();
        state.share = share;
        self.show(&state);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_is_predicted_by_work_and_not_by_cases() {
        // Ten of eleven cases are done, and a tenth of the work.
        assert_eq!(left(2.0, 0.1), Some(18.0));
        assert_eq!(left(2.0, 0.0), None);
        assert_eq!(left(2.0, 1.0), Some(0.0));
        assert_eq!(left(2.0, f64::NAN), None);
        let (total, done, begun) = (12, 0, Some(Instant::now()));
        let state = State { total, done, begun, ..State::default() };
        assert_eq!(state.in_words(), "0/12 cases", "nothing is claimed before anything is known");
    }

    #[test]
    fn a_reason_is_given_once() {
        let mut state = State::default();
        let said = ["no solver", "no solver", "too slow"].map(|reason| state.failed(reason));
        assert_eq!(said, ["failed: no solver", "failed for the same reason", "failed: too slow"]);
    }
}
