//! The cheapest n, N and setting for an error, by the models of a trade.

use serde::Serialize;

use super::optimum::{Choice, Choices, Law, NoAnswer};
use super::settings::{elements, settings};
use super::study::plain;
use super::{Bench, Study};
use files::{digits, megabytes};
use run::sweep::MemoryLimit;
use scene::setup::Setup;
use scene::{Change, Norm};

/// A setting is taken where it saves this part of the time at least, which single runs tell, and moves the error by less
/// than `MOVES`.
const SAVES: f64 = 0.2;
const MOVES: f64 = 0.05;

/// The answer with what it rests on.
#[derive(Debug, Clone, Serialize)]
pub struct Answered {
    /// The error that is wanted.
    pub target: f64,
    /// The run that has it.
    #[serde(flatten)]
    pub choice: Choice,
    /// The setting to change.
    pub change: Change,
    /// Memory, as predicted.
    pub bytes: f64,
    /// How many times n and N exceed the largest that were run, where they do.
    extrapolates: Option<String>,
}

impl Answered {
    /// The cheapest run whose predicted error is at most `target`, for a study of the scene in `bench`.
    ///
    /// # Errors
    /// [`NoAnswer`].
    pub fn new(
        bench: &Bench,
        study: &Study,
        target: f64,
        limit: &MemoryLimit,
    ) -> Result<Self, NoAnswer> {
        let setup = &bench.setup;
        let floors = plain(&study.trials).filter_map(|trial| Some(trial.done()?.floor));
        NoAnswer::admit(target, floors.fold(0.0, f64::max))?;
        let choices = Choices::new(setup, true)?;
        let most = choices.most();
        let law = study.models.law(most)?;
        let plain = choices.cheapest(&law, target, limit);
        let mut all = Vec::new();
        if let Ok((choice, bytes)) = plain {
            all.push((Change::none(), &study.models, choice, bytes));
            if let Some((change, [time, error])) = best_setting(setup, study, choice) {
                let law = Law {
                    error: Box::new(|h, k| error * (law.error)(h, k)),
                    seconds: Box::new(|h, k| time * (law.seconds)(h, k)),
                    ..law
                };
                let found = choices.cheapest(&law, target, limit);
                all.extend(
                    found.ok().map(|(choice, bytes)| (change, &study.models, choice, bytes)),
                );
            }
        }
        for rival in &study.elements {
            let change =
                elements(setup).into_iter().find(|(_, other)| other.words() == rival.change);
            let Some(((_, change), law)) = change.zip(rival.models.law(most).ok()) else {
                continue;
            };
            let changed =
                Setup::new(change.of(&setup.scene).map_err(scene::setup::SetupError::from)?)?;
            let found = Choices::new(&changed, true)?.cheapest(&law, target, limit);
            all.extend(found.ok().map(|(choice, bytes)| (change, &rival.models, choice, bytes)));
        }
        let best = all.into_iter().min_by(|a, b| a.2.seconds.total_cmp(&b.2.seconds));
        let Some((change, models, choice, bytes)) = best else {
            return Err(plain.err().unwrap_or_else(|| NoAnswer::Refused("nothing was run".into())));
        };
        Ok(Self { target, change, bytes, extrapolates: models.beyond(&choice), choice })
    }

    /// The answer in words.
    pub fn words(&self, study: &Study) -> String {
        let Choice { n, steps, h, k, error, seconds } = self.choice;
        let part = match study.norm {
            Norm::VMax => format!(" ({:.3} % of the solution)", 100.0 * self.target / study.size),
            _ => String::new(),
        };
        let warning = self
            .extrapolates
            .as_ref()
            .map_or(String::new(), |text| format!("\n  beyond what was measured: {text}"));
        format!(
            "target {:.4e} in {}{part}: n = {n}, N = {steps}, {} (h = {}, k = {})\n  predicted: error {error:.4e}, {seconds:.3} CPU s, {}{warning}",
            self.target,
            study.norm.name(),
            self.change.words(),
            digits(h, 5),
            digits(k, 5),
            megabytes(self.bytes),
        )
    }
}

/// The setting that saves most time at next to no error, with its factors of time and error in the run nearest to the
/// answer; it must save time wherever it was changed. Extrapolation in k is another scheme, and is left to the reader of
/// the price list.
fn best_setting(setup: &Setup, study: &Study, choice: Choice) -> Option<(Change, [f64; 2])> {
    let factors = |change: Change| {
        let prices = || study.prices.iter().filter(|price| price.what == change.words());
        let ratio = |a: u32, b: u32| (f64::from(a) / f64::from(b)).ln().abs();
        let away = |n, steps| ratio(n, choice.n) + ratio(steps, choice.steps);
        let nearest = prices()
            .min_by(|a, b| away(a.n, a.steps).total_cmp(&away(b.n, b.steps)))
            .map(|price| [1.0 / price.speed, 1.0 + price.error])?;
        let saves =
            prices().all(|price| 1.0 / price.speed <= 1.0 - SAVES && price.error.abs() <= MOVES);
        saves.then_some((change, nearest))
    };
    settings(setup).into_iter().filter_map(factors).min_by(|a, b| a.1[0].total_cmp(&b.1[0]))
}
