//! Knobs turned at a place of the grid: each against the run as written, in the same rounds.

use super::measure::{Bench, Case, Timed};
use super::rounds::Rounds;
use super::{Knob, Price, Trial, Variant};
use files::FileError;

/// Adds a row to the others and to the table.
type Keep<'a> = dyn FnMut(Trial, &mut Vec<Trial>) -> Result<(), FileError> + 'a;

/// Turns the knobs that matter at n and N, and compares the run as written there with half the cells and half the steps
/// as far as `halves` names them. Rows of knobs go to `keep`; those of runs as written get the times of these rounds too.
///
/// # Errors
/// The error of `keep`.
pub(super) fn turn(
    bench: &mut Bench,
    variants: &[Variant],
    (n, steps): (u32, u32),
    halves: &[(&'static str, (u32, u32))],
    trials: &mut Vec<Trial>,
    keep: &mut Keep<'_>,
) -> Result<Vec<Price>, FileError> {
    let Some(plain) = variants.first() else { return Ok(Vec::new()) };
    let at_place = |variant| (variant, n, steps);
    let half = |&(words, (n, steps)): &(&str, _)| (words.to_owned(), (plain, n, steps));
    let matters = |variant: &&Variant| variant.knob.matters(&bench.plain.setup, steps);
    let turned = variants.iter().skip(1).filter(matters);
    let turned = turned.map(|variant| (variant.knob.name(), at_place(variant)));
    let (names, cases): (Vec<String>, Vec<Case<'_>>) =
        std::iter::once((String::new(), at_place(plain)))
            .chain(halves.iter().map(half))
            .chain(turned)
            .unzip();
    let (rounds, times) = bench.rounds(&cases);
    let mut prices = Vec::new();
    for (run, ((what, case), times)) in names.into_iter().zip(&cases).zip(times).enumerate() {
        // Another element may have been run there on one of its meshes.
        let at = match position(trials, case.0.knob, case.1, case.2) {
            Some(at) => {
                if let Ok(times) = times {
                    timed_again(&mut trials[at], &times);
                }
                at
            }
            None => {
                keep(bench.after_rounds(*case, times), trials)?;
                trials.len() - 1
            }
        };
        if run > 0 {
            let as_written = position(trials, Knob::AsWritten, n, steps).map(|at| &trials[at]);
            let ratio = rounds.ratio(|times| times[run]);
            prices.extend(as_written.and_then(|plain| Price::of(what, plain, &trials[at], ratio)));
        }
    }
    prices.extend(extrapolated((n, steps), &cases, &rounds, trials));
    Ok(prices)
}

fn position(trials: &[Trial], knob: Knob, n: u32, steps: u32) -> Option<usize> {
    trials.iter().position(|t| t.knob == knob && t.n == n && t.steps == steps)
}

/// Takes the times of the rounds into those of a run: its least is the least of all.
fn timed_again(trial: &mut Trial, times: &[Timed]) {
    if let Ok(run) = &mut trial.outcome {
        let seconds = || times.iter().map(|timed| timed.seconds);
        run.seconds = seconds().fold(run.seconds, f64::min);
        run.slowest = seconds().fold(run.slowest, f64::max);
        run.repeats += times.len() as u32;
    }
}

/// What Richardson's extrapolation costs, which needs the run with half the steps as well.
fn extrapolated(
    (n, steps): (u32, u32),
    cases: &[Case<'_>],
    rounds: &Rounds,
    trials: &[Trial],
) -> Option<Price> {
    let row = &trials[position(trials, Knob::Extrapolated, n, steps)?];
    let half = cases.iter().position(|case| (case.1, case.2) == (n, steps / 2))?;
    let as_written = &trials[position(trials, Knob::AsWritten, n, steps)?];
    Price::of(row.knob.name(), as_written, row, rounds.ratio(|times| times[0] + times[half]))
}
