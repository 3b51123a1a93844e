//! Times that are compared: every run once a round, and ratios of runs of the same round.
//!
//! A machine that does other work slows down and recovers over seconds. Runs that follow each other are slow together, so
//! that their ratio is steady; the ratio of the least time of each is not. Rounds go forwards and backwards in
//! turn, which cancels what grows evenly.

use judge::fit::student_quantile;

/// A round whose first run takes this much longer than the fastest first run is not believed: the machine did something
/// else, for a part of the round at least.
const SLOW: f64 = 1.25;

/// Times by round; the run that all others are compared with comes first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rounds {
    times: Vec<Vec<f64>>,
}

/// How many times faster a run is than the first one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ratio {
    /// The geometric mean over the rounds.
    pub(super) value: f64,
    /// Its 95 % interval, Student's on the logarithm; without end where there are fewer than two rounds.
    pub(super) interval: [f64; 2],
}

impl Rounds {
    /// Runs `count` runs in `wanted` rounds that are believed, or in twice as many if the machine stays busy. A run
    /// without a time is not tried again.
    pub(super) fn run(
        count: usize,
        wanted: usize,
        mut timed: impl FnMut(usize) -> Option<f64>,
    ) -> Self {
        let mut rounds = Self { times: Vec::new() };
        let mut failed = vec![false; count];
        while rounds.believed().count() < wanted && rounds.times.len() < 2 * wanted {
            let mut times = vec![f64::NAN; count];
            let backwards = rounds.times.len() % 2 == 1;
            for place in 0..count {
                let run = if backwards { count - 1 - place } else { place };
                if !failed[run] {
                    times[run] = timed(run).unwrap_or(f64::NAN);
                    failed[run] = times[run].is_nan();
                }
            }
            rounds.times.push(times);
            if failed.first().is_none_or(|&first| first) {
                break;
            }
        }
        rounds
    }

    /// The rounds whose first run was not slow.
    fn believed(&self) -> impl Iterator<Item = &Vec<f64>> {
        let least = self.times.iter().map(|times| times[0]).fold(f64::INFINITY, f64::min);
        self.times.iter().filter(move |times| times[0] <= SLOW * least)
    }

    /// The ratio of the first run to what `cost` makes of the times of a round.
    pub(super) fn ratio(&self, cost: impl Fn(&[f64]) -> f64) -> Ratio {
        let logs: Vec<f64> = self.believed().map(|times| (times[0] / cost(times)).ln()).collect();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let squares: f64 = logs.iter().map(|log| (log - mean).powi(2)).sum();
        let half = logs
            .len()
            .checked_sub(1)
            .and_then(student_quantile)
            .map_or(f64::INFINITY, |t| t * (squares / (count - 1.0) / count).sqrt());
        Ratio { value: mean.exp(), interval: [(mean - half).exp(), (mean + half).exp()] }
    }
}

impl Ratio {
    /// Whether the rounds tell the two times apart.
    pub(super) fn shows(self) -> bool {
        self.interval[0] > 1.0 || self.interval[1] < 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounds of runs whose true times are 1 and 1/1.2; `machine` says how slow the machine is at each run.
    fn rounds(wanted: usize, machine: impl Fn(usize) -> f64) -> Rounds {
        let mut runs = 0;
        Rounds::run(2, wanted, |run| {
            runs += 1;
            Some([1.0, 1.0 / 1.2][run] * machine(runs - 1))
        })
    }

    fn second(rounds: &Rounds) -> Ratio {
        rounds.ratio(|times| times[1])
    }

    /// How many rounds count, of how many.
    fn counts(rounds: &Rounds) -> [usize; 2] {
        [rounds.believed().count(), rounds.times.len()]
    }

    #[test]
    fn a_machine_that_slows_down_does_not_hide_a_difference() {
        // Each run takes 1.45 % longer than the one before, as on a processor that grows warm: the slowest of the faster
        // runs takes longer than the fastest of the slower ones, and no pair does.
        let warm = rounds(8, |run| 1.0145f64.powi(run as i32));
        let least = warm.times.iter().map(|times| times[0]).fold(f64::INFINITY, f64::min);
        let slowest = warm.times.iter().map(|times| times[1]).fold(0.0, f64::max);
        assert!(slowest > least, "{slowest} {least}");
        let found = second(&warm);
        assert!(found.shows() && (found.value - 1.2).abs() < 1e-3, "{found:?}");
        // Without turning back every second run would look slower than it is.
        let forwards = Rounds { times: vec![vec![1.0, 1.0145 / 1.2]; 8] };
        assert!((second(&forwards).value - 1.2).abs() > 1e-2);
    }

    #[test]
    fn a_base_that_was_slow_once_is_not_believed() {
        // The third round meets another program at its first run: 1.0 becomes 1.7.
        let disturbed = Rounds { times: [1.0, 1.01, 1.7, 0.99].map(|base| vec![base, 1.0]).into() };
        assert_eq!(counts(&disturbed), [3, 4]);
        let found = second(&disturbed);
        assert!(!found.shows() && (found.value - 1.0).abs() < 0.01, "{found:?}");
        // Rounds go on until enough are believed, and no further than twice as many.
        let busy = rounds(4, |run| 1.0 + run as f64);
        assert_eq!(counts(&busy), [1, 8]);
        let rested = rounds(4, |run| if run == 0 { 2.0 } else { 1.0 });
        assert_eq!(counts(&rested), [4, 5]);
    }

    #[test]
    fn one_round_tells_nothing() {
        let one = second(&rounds(1, |_| 1.0));
        assert!(!one.shows() && (one.value - 1.2).abs() < 1e-12);
        assert_eq!(one.interval, [0.0, f64::INFINITY]);
        // What fails is run once, and has no ratio.
        let mut tried = 0;
        let broken = Rounds::run(2, 3, |run| {
            tried += run;
            (run == 0).then_some(1.0)
        });
        assert!(tried == 1 && second(&broken).value.is_nan() && !second(&broken).shows());
        assert_eq!(Rounds::run(2, 3, |_| None).times.len(), 1);
    }
}
