//! The price list: what each knob changes in time and error, against the scene as written on the same grid.

use super::Trial;

/// What a knob does to time and error.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Price {
    /// The knob, or the coarser step.
    pub what: String,
    /// Where: n and N of the run that it is compared with.
    pub n: u32,
    /// Number of steps there.
    pub steps: u32,
    /// Seconds of that run over seconds with the knob.
    pub speed: f64,
    /// This ratio over all repeats, from the least to the most favourable pair.
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
    /// The price of `turned` against `plain`.
    pub(crate) fn of(what: String, plain: &Trial, turned: &Trial) -> Option<Self> {
        let own = plain.done()?;
        let (n, steps) = (plain.n, plain.steps);
        let none = Self {
            what,
            n,
            steps,
            speed: f64::NAN,
            range: [f64::NAN; 2],
            error: f64::NAN,
            bytes: f64::NAN,
            failure: None,
            words: String::new(),
        };
        let found = match &turned.outcome {
            Err(reason) => Self { failure: Some(reason.clone()), ..none },
            Ok(other) => Self {
                speed: own.seconds / other.seconds,
                range: [own.seconds / other.slowest, own.slowest / other.seconds],
                error: other.error / own.error - 1.0,
                bytes: other.bytes / own.bytes,
                ..none
            },
        };
        Some(Self { words: found.sentence(), ..found })
    }

    /// Whether the repeats tell the two times apart.
    pub(crate) fn shows(&self) -> bool {
        self.range[0] > 1.0 || self.range[1] < 1.0
    }

    /// The price in words.
    fn sentence(&self) -> String {
        let place = format!("n = {}, N = {}", self.n, self.steps);
        if let Some(reason) = &self.failure {
            return format!("{}: fails ({place}): {reason}", self.what);
        }
        let time = match () {
            () if !self.shows() => "no difference in time beyond the repeats".to_owned(),
            () if self.speed >= 1.0 => format!("{:.2} times faster", self.speed),
            () => format!("{:.2} times slower", 1.0 / self.speed),
        };
        let memory = match self.bytes {
            ratio if !(0.95..1.05).contains(&ratio) => format!(", {ratio:.2} times the memory"),
            _ => String::new(),
        };
        format!("{}: {time}, {}{memory} ({place})", self.what, errors(self.error))
    }
}

/// What becomes of the error.
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
    use super::super::trial::trial;
    use super::*;

    #[test]
    fn a_price_says_what_is_bought_and_paid() {
        let plain = trial("as written", [64, 16], 0.5, 3.1);
        let price = |error, seconds| {
            let turned = trial("loads of degree 1", [64, 16], error, seconds);
            Price::of(turned.knob.clone(), &plain, &turned).expect("a price")
        };
        assert!(
            price(0.5001, 1.0)
                .words
                .starts_with("loads of degree 1: 3.10 times faster, +0.020 % error")
        );
        assert!(price(0.25, 6.2).words.contains("2.00 times slower, -50 % error"));
        assert!(price(0.5 + 1e-8, 1.0).words.contains(", same error"));
        // A run beats another only where all of its repeats do.
        let mut noisy = trial("loads of degree 1", [64, 16], 0.5, 3.0);
        noisy.outcome.as_mut().expect("a run").slowest = 3.2;
        let same = Price::of("x".into(), &plain, &noisy).expect("a price");
        assert!(!same.shows() && same.words.contains("no difference in time"));
        let failed = Trial { outcome: Err("KKT".into()), ..noisy };
        let none = Price::of("tolerance 1e-8".into(), &plain, &failed).expect("a price");
        assert!(none.words.contains("fails") && !none.shows());
        assert!(Price::of("x".into(), &failed, &plain).is_none());
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
