//! Knobs turned at a place of the grid: each against the run as written, in the same rounds.

use super::measure::{Bench, Case, Timed};
use super::rounds::Rounds;
use super::trial::TableError;
use super::{Knob, Price, Trial, Variant};

/// Adds a row to the others and to the table.
type Keep<'a> = dyn FnMut(Trial, &mut Vec<Trial>) -> Result<(), TableError> + 'a;

/// A run beside the one as written.
enum Beside {
    /// Coarser by half, with its words in the price list.
    Half(&'static str),
    /// The variant of this number.
    Knob(usize),
}

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
) -> Result<Vec<Price>, TableError> {
    let Some(plain) = variants.first() else { return Ok(Vec::new()) };
    let mut beside: Vec<Beside> = halves.iter().map(|(words, _)| Beside::Half(words)).collect();
    let mut cases: Vec<Case<'_>> = vec![(plain, n, steps)];
    cases.extend(halves.iter().map(|&(_, (n, steps))| (plain, n, steps)));
    for (at, variant) in variants.iter().enumerate().skip(1) {
        if variant.knob.matters(&bench.plain.setup, steps) {
            cases.push((variant, n, steps));
            beside.push(Beside::Knob(at));
        }
    }
    let (rounds, times) = bench.rounds(&cases);
    let mut prices = Vec::new();
    for (run, ((case, times), kind)) in
        cases.iter().zip(times).zip([None].into_iter().chain(beside.iter().map(Some))).enumerate()
    {
        let ratio = rounds.ratio(|times| times[run]);
        let (what, other) = match kind {
            None | Some(Beside::Half(_)) => {
                let at = position(trials, case.1, case.2);
                if let (Some(at), Ok(times)) = (at, times) {
                    timed_again(&mut trials[at], &times);
                }
                let Some((Beside::Half(words), at)) = kind.zip(at) else { continue };
                ((*words).to_owned(), trials[at].clone())
            }
            Some(Beside::Knob(at)) => {
                let what = variants[*at].knob.name();
                // Another element may have been run there on one of its meshes.
                if let Some((at, times)) =
                    position_of(trials, &what, case.1, case.2).zip(times.as_ref().ok())
                {
                    timed_again(&mut trials[at], times);
                    (what, trials[at].clone())
                } else {
                    let row = bench.after_rounds(*case, times);
                    keep(row.clone(), trials)?;
                    (what, row)
                }
            }
        };
        let as_written = position(trials, n, steps).map(|at| &trials[at]);
        prices.extend(as_written.and_then(|plain| Price::of(what, plain, &other, ratio)));
    }
    prices.extend(extrapolated((n, steps), &cases, &rounds, trials));
    Ok(prices)
}

/// The run as written at n and N.
fn position(trials: &[Trial], n: u32, steps: u32) -> Option<usize> {
    position_of(trials, &Knob::AsWritten.name(), n, steps)
}

fn position_of(trials: &[Trial], knob: &str, n: u32, steps: u32) -> Option<usize> {
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
    let name = Knob::Extrapolated.name();
    let row = &trials[position_of(trials, &name, n, steps)?];
    let half = cases.iter().position(|case| (case.1, case.2) == (n, steps / 2))?;
    let as_written = &trials[position(trials, n, steps)?];
    Price::of(name, as_written, row, rounds.ratio(|times| times[0] + times[half]))
}
