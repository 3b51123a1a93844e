//! The cheapest n, N and knob for an error, by the models of a trade.

use serde::Serialize;

use super::candidates::finest;
use super::rival::Known;
use super::{
    Answer, Bench, Candidates, Knob, MOST, Models, NoAnswer, Optimum, Price, Study, TradeRuns,
    Variant, knobs, optimum,
};
use files::{digits, megabytes};
use run::sweep::{MemoryLimit, admit_run, run_cost};
use scene::Norm;
use scene::setup::Setup;

/// A knob is taken where it saves this part of the time at least, and moves the error by less.
const WORTH: f64 = 0.05;

/// The answer with what it rests on.
#[derive(Debug, Clone, Serialize)]
pub struct Answered {
    /// The error that is wanted.
    pub target: f64,
    /// The run that has it.
    #[serde(flatten)]
    pub choice: Answer,
    /// The knob to turn.
    pub knob: Knob,
    /// Memory, as predicted.
    pub bytes: f64,
    h: f64,
    k: f64,
    optimum: Option<Optimum>,
    /// How many times n and N exceed the largest that were run, where they do.
    extrapolates: Option<String>,
}

impl Answered {
    /// The cheapest run whose predicted error is at most `target`, for a study whose runs are in `bench`.
    ///
    /// # Errors
    /// [`NoAnswer`].
    pub fn new(
        bench: &Bench,
        study: &Study,
        plan: &TradeRuns,
        target: f64,
        limit: &MemoryLimit,
    ) -> Result<Self, NoAnswer> {
        let setup = &bench.plain.setup;
        let plain = known(study, &study.models, Knob::AsWritten)?;
        let floor = study.plain().filter_map(|trial| Some(trial.done()?.floor)).fold(0.0, f64::max);
        NoAnswer::admit(target, floor)?;
        let most = finest(setup).unwrap_or(MOST);
        let candidates = Candidates::new(setup, true)?;
        if plan.n.is_empty() || plan.steps.is_empty() {
            return Err(nothing_run());
        }
        let by = |known: &Known<'_>, target: f64| known.cheapest(&candidates, most, target);
        let as_written = by(&plain, target).and_then(|mut choice| {
            let (knob, factors) = best_knob(setup, study, choice);
            let inner = target / factors[1].max(1.0);
            if inner < target {
                choice = by(&plain, inner)?;
            }
            choice.seconds *= factors[0];
            choice.error *= factors[1];
            Ok((&plain, knob, choice, inner))
        });
        let rivals = study.elements.iter().map(|rival| known(study, &rival.models, rival.knob));
        let rivals: Vec<Known<'_>> = rivals.filter_map(Result::ok).collect();
        let others = rivals
            .iter()
            .filter_map(|rival| Some((rival, rival.knob, by(rival, target).ok()?, target)));
        let all = as_written.iter().copied().chain(others);
        let best = all.min_by(|a, b| a.2.seconds.total_cmp(&b.2.seconds));
        let Some((known, knob, choice, inner)) = best else {
            return Err(as_written.err().unwrap_or_else(nothing_run));
        };
        let variant = Variant::new(&setup.scene, knob)?;
        let setup = bench.judging(&variant);
        // The mesh of an answer is made to predict its memory, and may be one that no machine holds.
        let Answer { n, steps, .. } = choice;
        admit_run(setup, None, (n, steps), limit).map_err(|source| NoAnswer::Memory {
            target,
            n,
            steps,
            source,
        })?;
        let space = setup.space(choice.n)?;
        let bytes = run_cost(setup, &space, choice.steps).memory_bytes;
        Ok(Self {
            target,
            knob,
            bytes,
            h: (candidates.h)(choice.n),
            k: (candidates.k)(choice.steps),
            optimum: optimum(known.error, known.cost, inner),
            extrapolates: known.beyond(&choice),
            choice,
        })
    }

    /// The answer in words.
    pub fn words(&self, study: &Study) -> String {
        let Answer { n, steps, error, seconds } = self.choice;
        let relative = 100.0 * self.target / study.size;
        let part = match study.norm {
            Norm::VMax => format!(" ({relative:.3} % of the solution)"),
            _ => String::new(),
        };
        let real = |value: Option<f64>| value.map_or("any".into(), |value| digits(value, 5));
        let best = self.optimum.map_or(String::new(), |optimum| {
            format!("; real numbers would be h = {}, k = {}", real(optimum.h), real(optimum.k))
        });
        let warning = self
            .extrapolates
            .as_ref()
            .map_or(String::new(), |text| format!("\n  beyond what was measured: {text}"));
        format!(
            "target {:.4e} in {}{part}: n = {n}, N = {steps}, {} (h = {}, k = {}{best})\n  predicted: error {error:.4e}, {seconds:.3} CPU s, {}{warning}",
            self.target,
            study.norm.name(),
            self.knob.name(),
            digits(self.h, 5),
            digits(self.k, 5),
            megabytes(self.bytes),
        )
    }
}

fn nothing_run() -> NoAnswer {
    NoAnswer::Refused("nothing was run".into())
}

/// The models of a knob, or which of them is missing.
fn known<'a>(study: &Study, models: &'a Models, knob: Knob) -> Result<Known<'a>, NoAnswer> {
    Known::new(models, knob, &study.trials).ok_or_else(|| {
        let missing = models.error.as_ref().err().map(|reason| ("errors", reason));
        let missing = missing.or_else(|| Some(("times", models.cost.as_ref().err()?)));
        missing.map_or_else(nothing_run, |(what, reason)| {
            NoAnswer::Refused(format!("the {what} have no model: {reason}"))
        })
    })
}

/// The knob that saves most time at next to no error, with its factors of time and error in the run nearest to the
/// answer; it must save time wherever it was turned. Extrapolation in k is another scheme, and is left to the reader of the price list.
fn best_knob(setup: &Setup, study: &Study, choice: Answer) -> (Knob, [f64; 2]) {
    let factors = |knob: Knob| -> Option<[f64; 2]> {
        let prices: Vec<_> =
            study.prices.iter().filter(|price| price.what == knob.name()).collect();
        let serves = |price: &&Price| {
            price.shows() && 1.0 / price.speed <= 1.0 - WORTH && price.error.abs() <= WORTH
        };
        let all = !prices.is_empty() && prices.iter().all(serves);
        all.then(|| {
            let away = |price: &Price| {
                let ratio = |a: u32, b: u32| (f64::from(a) / f64::from(b)).ln().abs();
                ratio(price.n, choice.n) + ratio(price.steps, choice.steps)
            };
            let nearest = prices.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            nearest.map_or([1.0; 2], |price| [1.0 / price.speed, 1.0 + price.error])
        })
    };
    // Sums over a short past do not know the knobs of a long one.
    let offered = knobs(setup).into_iter().filter(|knob| knob.matters(setup, choice.steps));
    let turned = offered.filter_map(|knob| Some((knob, factors(knob)?)));
    let best = turned.min_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    best.unwrap_or((Knob::AsWritten, [1.0; 2]))
}
