//! The price list: what each knob changes in time and error, against the scene as written on the same grid.

use super::Trial;
use super::pareto::TIE;
use super::rounds::Ratio;

/// What a knob does to time and error.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct Price {
    /// The knob, or the coarser step.
    pub what: String,
    /// Where: n and N of the run that it is compared with.
    pub n: u32,
    /// Number of steps there.
    pub steps: u32,
    /// Seconds of that run over seconds with the knob, within a round: the geometric mean over the rounds.
    pub speed: f64,
    /// Its 95 % interval.
    pub range: [f64; 2],
    /// Error with the knob over error without, less one.
    pub error: f64,
    /// Memory with the knob over memory without.
    pub bytes: f64,
    /// Why there is no price: the run failed.
    #[serde(skip)]
    pub failure: Option<String>,
    /// All of it in one sentence.
    pub words: String,
}

impl Price {
    /// The price of `turned` against `plain`, whose times have this ratio.
    pub(super) fn of(what: String, plain: &Trial, turned: &Trial, ratio: Ratio) -> Option<Self> {
        let (without, with) = (plain.done()?, turned.done());
        let found = Self {
            what,
            n: plain.n,
            steps: plain.steps,
            speed: with.map_or(f64::NAN, |_| ratio.value),
            range: with.map_or([f64::NAN; 2], |_| ratio.interval),
            error: with.map_or(f64::NAN, |with| with.error / without.error - 1.0),
            bytes: with.map_or(f64::NAN, |with| with.bytes / without.bytes),
            failure: turned.outcome.as_ref().err().cloned(),
            words: String::new(),
        };
        Some(Self { words: found.sentence(), ..found })
    }

    /// Whether the rounds tell the two times apart.
    pub(super) fn shows(&self) -> bool {
        Ratio { value: self.speed, interval: self.range }.shows()
    }

    /// Whether neither time nor error changes.
    pub(super) fn is_tie(&self) -> bool {
        self.failure.is_none() && !self.shows() && self.error.abs() <= TIE
    }

    fn sentence(&self) -> String {
        let place = format!("n = {}, N = {}", self.n, self.steps);
        if let Some(reason) = &self.failure {
            return format!("{}: fails ({place}): {reason}", self.what);
        }
        let [lo, hi] = self.range;
        let time = match () {
            () if !(lo.is_finite() && hi.is_finite()) => {
                "no difference in time that a single round could tell".to_owned()
            }
            () if !self.shows() => format!("no difference in time, {lo:.2} to {hi:.2} times"),
            () if self.speed >= 1.0 => {
                format!("{:.2} times faster [{lo:.2}, {hi:.2}]", self.speed)
            }
            () => {
                format!("{:.2} times slower [{:.2}, {:.2}]", 1.0 / self.speed, 1.0 / hi, 1.0 / lo)
            }
        };
        let memory = match self.bytes {
            ratio if !(0.95..1.05).contains(&ratio) => format!(", {ratio:.2} times the memory"),
            _ => String::new(),
        };
        format!("{}: {time}, {}{memory} ({place})", self.what, errors(self.error))
    }
}

fn errors(change: f64) -> String {
    match percent(change) {
        none if none == "0 %" => "same error".to_owned(),
        change => format!("{change} error"),
    }
}

/// A relative change with two digits, at least a ten-thousandth of a percent.
fn percent(change: f64) -> String {
    let value = 100.0 * change;
    match value.abs() {
        size if size < 1e-4 => "0 %".to_owned(),
        size if size >= 10.0 => format!("{value:+.0} %"),
        size => {
            let digits = (1 - size.log10().floor() as i32).max(0) as usize;
            format!("{value:+.digits$} %")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Knob;
    use super::super::trial::trial;
    use super::*;

    #[test]
    fn a_price_says_what_is_bought_and_paid() {
        let plain = trial(Knob::AsWritten, [64, 16], 0.5, 3.1);
        let sure = |value: f64| Ratio { value, interval: [0.99 * value, 1.01 * value] };
        let price = |error, ratio| {
            let turned = trial(Knob::LoadDegree(1), [64, 16], error, 1.0);
            Price::of(turned.knob.name(), &plain, &turned, ratio).expect("a price")
        };
        let words = price(0.5001, sure(3.1)).words;
        let start = "loads of degree 1: 3.10 times faster [3.07, 3.13], +0.020 % error";
        assert!(words.starts_with(start), "{words}");
        let slower = price(0.25, sure(0.5)).words;
        assert!(slower.contains("2.00 times slower [1.98, 2.02], -50 % error"), "{slower}");
        assert!(price(0.5 + 1e-8, sure(3.1)).words.contains(", same error"));
        // A difference within the interval is none, and one round has no interval.
        let noisy = price(0.5, Ratio { value: 1.4, interval: [0.97, 2.0] });
        assert!(noisy.is_tie() && noisy.words.contains("no difference in time, 0.97 to 2.00"));
        let single = price(0.5, Ratio { value: 1.4, interval: [0.0, f64::INFINITY] });
        assert!(single.is_tie() && single.words.contains("single round"));
        assert!(!price(0.25, Ratio { value: 1.4, interval: [0.97, 2.0] }).is_tie());
        let failed = Trial { outcome: Err("KKT".into()), ..plain.clone() };
        let none = Price::of("tolerance 1e-8".into(), &plain, &failed, sure(f64::NAN));
        let none = none.expect("a price");
        assert!(none.words.contains("fails") && !none.shows() && !none.is_tie());
        assert!(Price::of("x".into(), &failed, &plain, sure(1.0)).is_none());
    }

    #[test]
    fn changes_have_two_digits() {
        for (change, words) in [
            (0.000123, "+0.012 %"),
            (-0.0456, "-4.6 %"),
            (1.0, "+100 %"),
            (0.0, "0 %"),
            (0.0099, "+0.99 %"),
        ] {
            assert_eq!(percent(change), words);
        }
    }
}
