//! Output of commands: text and progress on stdout and stderr, files in a given directory.

use std::io::{self, IsTerminal, Write};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;

use super::CliError;
use files::{counted, harmless, harmless_json, without_digits};
use indicatif::{ProgressBar, ProgressStyle};
use judge::record::{CaseRecord, Status};
use judge::verdict::Verdict;
use run::sweep::Progress;
use scene::setup::StepRemark;
use serde::Serialize;

/// The first failed write to stdout; nothing is written after it.
static STOPPED: OnceLock<io::Error> = OnceLock::new();

/// Prints a value, its keys in the order of the alphabet.
pub(crate) fn print_json(value: &impl Serialize) -> Result<(), CliError> {
    print_as_it_is(&harmless_json(&format!("{:#}", serde_json::to_value(value)?)));
    Ok(())
}

/// Prints to stdout; control characters of foreign text are disarmed.
pub(crate) fn print_text(text: &str) {
    print_as_it_is(&harmless(text));
}

/// More verdicts than a screen holds are not printed one by one.
const MOST: usize = 24;

/// Whether all of so many verdicts are printed.
pub(crate) fn prints_all(verdicts: &[Verdict]) -> bool {
    verdicts.len() <= MOST || loudness() == Loudness::Verbose
}

/// The verdicts that are printed one by one.
fn listed(verdicts: &[Verdict], all: bool) -> Vec<Verdict> {
    verdicts.iter().filter(|verdict| all || !verdict.is_plain_pass()).cloned().collect()
}

/// Prints verdicts, coloured if stdout allows it. Of more than a screen holds, those that are no plain pass, and then what
/// holds and what is least certain.
pub(crate) fn print_verdicts(verdicts: &[Verdict]) {
    let all = prints_all(verdicts);
    let some = listed(verdicts, all);
    if all || !some.is_empty() {
        let table = harmless(&verdict_table(&some)).into_owned();
        // Not with NO_COLOR (any value) or a dumb terminal.
        let colours = console::Term::stdout().features().colors_supported();
        print_as_it_is(&if colours { coloured(&table) } else { table });
    }
    if !all {
        let others = verdicts.len() - some.len();
        print_text(&format!(
            "{others} further verdicts pass: they are in the report, or here with -v"
        ));
        report::answers(verdicts).iter().for_each(|line| print_beside("", 0, line));
    }
}

/// Prints text with this program's control sequences. If stdout fails the command goes on, since its files and verdict
/// are still wanted; [`delivered`] sets the exit code.
pub(crate) fn print_as_it_is(text: &str) {
    if STOPPED.get().is_some() {
        return;
    }
    let mut out = io::stdout().lock();
    if let Err(error) = writeln!(out, "{text}").and_then(|()| out.flush()) {
        stopped(error);
    }
}

/// Keeps the first failure of stdout.
pub(crate) fn stopped(error: io::Error) {
    STOPPED.get_or_init(|| error);
}

/// The exit code of a command after printing. A closed pipe is no failure (the reader has what it wanted), a full disk
/// is.
pub(crate) fn delivered(code: u8) -> Result<u8, CliError> {
    match STOPPED.get() {
        Some(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::about("standard output", format!("{error}: the results are not there")))
        }
        _ => Ok(code),
    }
}

/// Prints a line on stderr, ignoring failures.
pub(crate) fn print_error(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", harmless(line));
}

/// Prints words beside their label, wrapped on a terminal only.
pub(crate) fn print_beside(label: &str, room: usize, words: &str) {
    print_text(&report::beside(label, room, words, width(u16::MAX)));
}

/// Columns for a table: of the terminal, else COLUMNS, else `usual`.
pub fn width(usual: u16) -> u16 {
    let terminal = || Some(console::Term::stdout().size_checked()?.1);
    let given = || std::env::var("COLUMNS").ok()?.parse().ok();
    terminal().or_else(given).map_or(usual, |columns: u16| columns.clamp(NARROWEST, WIDEST))
}

pub(crate) fn verdict_table(verdicts: &[Verdict]) -> String {
    report::verdict_table(verdicts, width(TABLE_WIDTH))
}

/// Width of a table where nothing else is known.
pub(crate) const TABLE_WIDTH: u16 = 100;

/// Narrowest table.
const NARROWEST: u16 = 60;
const WIDEST: u16 = 180;

// Colours the words of verdicts on a terminal.

/// The words and their colours; blue and orange differ for colour-blind readers.
const WORDS: [(&str, &str); 3] =
    [("pass", "\u{1b}[34m"), ("fail", "\u{1b}[1;33m"), ("unresolved", "\u{1b}[33m")];
const PLAIN: &str = "\u{1b}[0m";

/// Head of the coloured column.
const HEAD: &str = "verdict";

/// Colours the words in the column of verdicts; widths are unchanged.
fn coloured(table: &str) -> String {
    let column = |line: &str| line.find(HEAD).map(|at| line[..at].chars().count());
    let Some(start) = table.lines().find_map(column) else { return table.to_owned() };
    let line = |line: &str| {
        let at = line.char_indices().nth(start).map_or(line.len(), |(at, _)| at);
        let (before, rest) = line.split_at(at);
        let word = rest.split(|c: char| !c.is_alphabetic()).next().unwrap_or("");
        match WORDS.iter().find(|(known, _)| *known == word) {
            Some((_, colour)) => format!("{before}{colour}{word}{PLAIN}{}", &rest[word.len()..]),
            None => line.to_owned(),
        }
    };
    table.lines().map(line).collect::<Vec<_>>().join("\n")
}

// Progress of a sweep on stderr: a bar on a terminal, plain lines elsewhere.

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

    /// A failure in words; a reason that is repeated, but for its numbers, is omitted.
    fn failed(&mut self, reason: &str) -> String {
        let said = Some(without_digits(reason));
        if self.reason == said {
            return "failed for the same reason".into();
        }
        self.reason = said;
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
    mod verdicts {
        use super::super::*;
        use judge::record::V_MAX;
        use judge::verdict::{Decision, Prediction, Variable};

        /// Of more than a screen holds every one that is no plain pass, an expected failure too, is printed.
        #[test]
        fn none_but_plain_passes_is_left_out() {
            let verdict = |scene: &str, expect, decision| {
                let open = Verdict::open(scene, &Prediction::new(V_MAX, Variable::H, 1.0), expect);
                Verdict { decision, ..open }
            };
            let mut verdicts = vec![verdict("sound", Decision::Pass, Decision::Pass); 30];
            verdicts.push(verdict("defect", Decision::Pass, Decision::Fail));
            verdicts.push(verdict("open", Decision::Pass, Decision::Unresolved));
            verdicts.push(verdict("built-to-fail", Decision::Fail, Decision::Fail));
            verdicts.push(verdict("not-failing", Decision::Fail, Decision::Pass));
            let names = |all| -> Vec<String> {
                listed(&verdicts, all).into_iter().map(|verdict| verdict.scene).collect()
            };
            assert_eq!(names(false), ["defect", "open", "built-to-fail", "not-failing"]);
            assert_eq!(names(true).len(), 34);
            assert!(!prints_all(&verdicts) && prints_all(&verdicts[..24]));
        }
    }

    mod colour {
        use super::super::*;

        #[test]
        fn words_of_the_column_alone_are_coloured() {
            let table = " scene     norm   observed    verdict   why\n pass-it   V_max  ≥ 1 [a, b]  pass      pass\n b         V_max  -           fail, as  why";
            let found = coloured(table);
            assert_eq!(found.matches('\u{1b}').count(), 4, "{found}");
            assert!(found.contains("\u{1b}[34mpass\u{1b}[0m      pass"), "{found}");
            assert!(found.contains("\u{1b}[1;33mfail\u{1b}[0m, as"), "{found}");
            let bare =
                WORDS.iter().fold(found.replace(PLAIN, ""), |text, (_, c)| text.replace(c, ""));
            assert_eq!(bare, table);
            assert_eq!(coloured("nothing was judged"), "nothing was judged");
        }
    }

    mod progress {
        use super::super::*;

        #[test]
        fn the_rest_is_predicted_by_work_and_not_by_cases() {
            // Ten of eleven cases are done, and a tenth of the work.
            assert_eq!(left(2.0, 0.1), Some(18.0));
            assert_eq!(left(2.0, 0.0), None);
            assert_eq!(left(2.0, 1.0), Some(0.0));
            assert_eq!(left(2.0, f64::NAN), None);
            let (total, done, begun) = (12, 0, Some(Instant::now()));
            let state = State { total, done, begun, ..State::default() };
            assert_eq!(
                state.in_words(),
                "0/12 cases",
                "nothing is claimed before anything is known"
            );
        }

        #[test]
        fn a_reason_is_given_once() {
            let mut state = State::default();
            let said = ["no solver", "no solver", "too slow"].map(|reason| state.failed(reason));
            assert_eq!(
                said,
                ["failed: no solver", "failed for the same reason", "failed: too slow"]
            );
        }
    }
}
