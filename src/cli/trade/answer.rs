//! `--target E` and `--confirm`: the cheapest n, N and knob for an error, and the same run for real.

use serde_json::{Value, json};

use super::super::target::Target;
use super::super::{CliError, Scenes, megabytes};
use super::finite;
use judge::fit::FLOORS_ABOVE;
use run::sweep::{MemoryLimit, admit_run, run_cost};
use scene::Norm;
use scene::setup::Setup;
use studies::trade::{
    Answer, Bench, Candidates, Choices, Knob, MOST, NoAnswer, Optimum, Plan, Study, Variant,
    cheapest, knobs, optimum,
};

/// Runs of a confirmed answer for the clock.
const CONFIRMING: u32 = 5;
/// A knob is taken where it saves this part of the time at least, and moves the error by less.
const WORTH: f64 = 0.05;

/// The answer with what it rests on.
pub(super) struct Answered {
    pub(super) target: f64,
    pub(super) choice: Answer,
    pub(super) knob: Knob,
    pub(super) bytes: f64,
    h: f64,
    k: f64,
    optimum: Option<Optimum>,
    /// Over how many levels h and k are extrapolated, where they are beyond the grid.
    extrapolates: Option<String>,
}

impl Answered {
    pub(super) fn new(
        bench: &Bench,
        study: &Study,
        plan: &Plan,
        target: Target,
        limit: &MemoryLimit,
    ) -> Result<Self, CliError> {
        let setup = &bench.plain.setup;
        let target = target.of(study.size);
        let words =
            |what: &str, reason: &String| CliError::other(format!("no answer: {what}: {reason}"));
        let error =
            study.error.as_ref().map_err(|reason| words("the errors have no model", reason))?;
        let cost =
            study.cost.as_ref().map_err(|reason| words("the times have no model", reason))?;
        let floor = study.plain().filter_map(|trial| Some(trial.done()?.floor)).fold(0.0, f64::max);
        if target <= FLOORS_ABOVE * floor {
            return Err(CliError::other(NoAnswer::BelowFloor {
                target,
                floor,
                times: FLOORS_ABOVE,
            }));
        }
        let reference = setup.scene.sweep.as_ref().and_then(|sweep| sweep.reference);
        let reference = reference.filter(|_| setup.exact.is_none());
        // A run as fine as the reference has no error against it.
        let most = reference.map_or(MOST, |r| [r.n as u32 / 2, r.steps as u32 / 2]);
        let own = Candidates::new(setup, true)?;
        let (h, k) = (|n: u32| own.h(n), |steps: u32| own.k(steps));
        let (cells, steps) = (|n: u32| own.cells(n), |steps: u32| own.steps(steps));
        let [Some(&n0), Some(&steps0)] = [plan.n.first(), plan.steps.first()] else {
            return Err(CliError::other("no answer: nothing was run"));
        };
        let choices =
            Choices { least: [n0, steps0], most, h: &h, k: &k, cells: &cells, steps: &steps };
        let sum = study.composition.as_ref();
        let seconds = |h: f64, k: f64| {
            sum.map_or_else(|| cost.seconds(h, k), |composition| composition.seconds(h, k))
        };
        let law = |h: f64, k: f64| error.error(h, k);
        let mut choice = cheapest(&law, &seconds, target, &choices).map_err(CliError::other)?;
        let (knob, factors) = best_knob(setup, study, choice);
        let inner = target / factors[1].max(1.0);
        if inner < target {
            choice = cheapest(&law, &seconds, inner, &choices).map_err(CliError::other)?;
        }
        choice.seconds *= factors[0];
        choice.error *= factors[1];
        // The mesh of an answer is made to predict its memory, and may be one that no machine holds.
        admit_run(setup, None, (choice.n, choice.steps), limit).map_err(|error| {
            CliError::about(format!("the answer, n = {}, N = {}", choice.n, choice.steps), error)
        })?;
        let space = setup.space(choice.n)?;
        let bytes = run_cost(setup, &space, choice.steps).memory_bytes;
        let beyond = |name: &str, value: u32, list: &[u32]| {
            let most = list.iter().copied().max().filter(|&most| value > most)?;
            Some(format!(
                "{name} is {:.1} times the largest that was run",
                f64::from(value) / f64::from(most)
            ))
        };
        let parts = [beyond("n", choice.n, &plan.n), beyond("N", choice.steps, &plan.steps)];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        Ok(Self {
            target,
            knob,
            bytes,
            h: h(choice.n),
            k: k(choice.steps),
            optimum: optimum(error, cost, inner),
            extrapolates: (!parts.is_empty()).then(|| parts.join(", ")),
            choice,
        })
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "target": self.target,
            "n": self.choice.n,
            "steps": self.choice.steps,
            "h": self.h,
            "k": self.k,
            "knob": self.knob.name(),
            "error": self.choice.error,
            "cpu_seconds": self.choice.seconds,
            "bytes": self.bytes,
            "optimum": self.optimum.map(|o| json!({ "h": o.h, "k": o.k })),
            "extrapolates": self.extrapolates,
        })
    }

    pub(super) fn words(&self, study: &Study) -> String {
        let Answer { n, steps, error, seconds } = self.choice;
        let relative = 100.0 * self.target / study.size;
        let part = match study.norm {
            Norm::VMax => format!(" ({relative:.3} % of the solution)"),
            _ => String::new(),
        };
        let real = |value: Option<f64>| value.map_or("any".into(), |value| format!("{value:.4}"));
        let best = self.optimum.map_or(String::new(), |optimum| {
            format!("; real numbers would be h = {}, k = {}", real(optimum.h), real(optimum.k))
        });
        let warning = self
            .extrapolates
            .as_ref()
            .map_or(String::new(), |text| format!("\n  beyond what was measured: {text}"));
        format!(
            "\ntarget {:.4e} in {}{part}: n = {n}, N = {steps}, {} (h = {:.5}, k = {:.5}{best})\n  predicted: error {error:.4e}, {seconds:.3} CPU s, {}{warning}",
            self.target,
            study.norm.name(),
            self.knob.name(),
            self.h,
            self.k,
            megabytes(self.bytes),
        )
    }

    /// Runs the answer.
    pub(super) fn confirm(
        &self,
        bench: &mut Bench,
        scenes: &Scenes,
        scene: &str,
    ) -> Result<Confirmed, CliError> {
        let own = Variant::new(&bench.plain.setup.scene.clone(), self.knob)?;
        let variant =
            own.ok_or_else(|| CliError::other("the scene does not have the knob of the answer"))?;
        bench.repeats = CONFIRMING;
        let trial = bench.trial(&variant, self.choice.n, self.choice.steps);
        let run = trial
            .outcome
            .map_err(|reason| CliError::other(format!("the answer does not run: {reason}")))?;
        let bytes = peak_of_a_process(scenes, scene, self.choice);
        Ok(Confirmed { error: run.error, seconds: run.seconds, slowest: run.slowest, bytes })
    }
}

/// The knob that saves most time at next to no error, with its factors of time and error in the run nearest to the
/// answer; it must save time wherever it was turned. Extrapolation in k is another scheme, and is left to the reader of the price list.
fn best_knob(setup: &Setup, study: &Study, choice: Answer) -> (Knob, [f64; 2]) {
    let factors = |knob: Knob| -> Option<[f64; 2]> {
        let own: Vec<_> = study.prices.iter().filter(|price| price.what == knob.name()).collect();
        let serves = |price: &&studies::trade::Price| {
            price.shows() && 1.0 / price.speed <= 1.0 - WORTH && price.error.abs() <= WORTH
        };
        let all = !own.is_empty() && own.iter().all(serves);
        all.then(|| {
            let away = |price: &studies::trade::Price| {
                let ratio = |a: u32, b: u32| (f64::from(a) / f64::from(b)).ln().abs();
                ratio(price.n, choice.n) + ratio(price.steps, choice.steps)
            };
            let nearest = own.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            nearest.map_or([1.0; 2], |price| [1.0 / price.speed, 1.0 + price.error])
        })
    };
    // Sums over a short past do not know the knobs of a long one.
    let offered = knobs(setup).into_iter().filter(|knob| knob.matters(setup, choice.steps));
    let turned = offered.filter_map(|knob| Some((knob, factors(knob)?)));
    let best = turned.min_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    best.unwrap_or((Knob::AsWritten, [1.0; 2]))
}

/// The peak resident size of a process that does the run alone, by the scene as written; none where the system does not
/// say it.
fn peak_of_a_process(scenes: &Scenes, scene: &str, choice: Answer) -> Option<f64> {
    let program = std::env::current_exe().ok()?;
    let numbers = [choice.n, choice.steps].map(|value| value.to_string());
    let output = std::process::Command::new(program)
        .args(scenes.folder.iter().flat_map(|folder| ["--scenes".as_ref(), folder.as_os_str()]))
        .args(["solve", scene, "--n", &numbers[0], "--steps", &numbers[1], "--json"])
        .output()
        .ok()?;
    let document: Value = serde_json::from_slice(&output.stdout).ok()?;
    document["peak_resident_bytes"].as_f64()
}

/// The answer run.
pub(super) struct Confirmed {
    error: f64,
    seconds: f64,
    slowest: f64,
    bytes: Option<f64>,
}

impl Confirmed {
    pub(super) fn json(&self, answered: &Answered) -> Value {
        json!({
            "error": finite(self.error),
            "cpu_seconds": self.seconds,
            "cpu_slowest": self.slowest,
            "bytes": self.bytes,
            "ratios": {
                "error": finite(answered.choice.error / self.error),
                "cpu_seconds": answered.choice.seconds / self.seconds,
                "bytes": self.bytes.map(|bytes| answered.bytes / bytes),
            },
        })
    }

    pub(super) fn words(&self, answered: &Answered) -> String {
        let off = |predicted: f64, real: f64| format!("{:+.0} %", 100.0 * (predicted / real - 1.0));
        let memory = self.bytes.map_or("memory unknown on this system".into(), |bytes| {
            format!("{} ({})", megabytes(bytes), off(answered.bytes, bytes))
        });
        format!(
            "  real:      error {:.4e} ({}), {:.3} CPU s ({}; least of {CONFIRMING}, slowest {:.3}), {memory}\n  in brackets: predicted over real, less one",
            self.error,
            off(answered.choice.error, self.error),
            self.seconds,
            off(answered.choice.seconds, self.seconds),
            self.slowest,
        )
    }
}
