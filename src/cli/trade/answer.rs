//! `--confirm`: runs the answer of a trade.

use serde::Serialize;
use serde_json::Value;

use super::super::{CliError, Scenes};
use files::megabytes;
use studies::trade::{Answer, Answered, Bench, Knob, Variant};

/// Timed runs of a confirmed answer.
const CONFIRMING: u32 = 5;

#[derive(Serialize)]
pub(super) struct Confirmed {
    error: f64,
    cpu_seconds: f64,
    cpu_slowest: f64,
    bytes: Option<f64>,
    ratios: Ratios,
}

#[derive(Serialize)]
struct Ratios {
    error: f64,
    cpu_seconds: f64,
    bytes: Option<f64>,
}

impl Confirmed {
    pub(super) fn run(
        found: &Answered,
        bench: &mut Bench,
        scenes: &Scenes,
        scene: &str,
    ) -> Result<Self, CliError> {
        let variant = Variant::new(&bench.plain.setup.scene, found.knob)?;
        bench.repeats = CONFIRMING;
        let trial = bench.trial(&variant, found.choice.n, found.choice.steps);
        let run = trial
            .outcome
            .map_err(|reason| CliError::other(format!("the answer does not run: {reason}")))?;
        // `sweep solve` uses the element named in the scene.
        let as_named = !matches!(found.knob, Knob::Element(_));
        let bytes = as_named.then(|| peak_of_a_process(scenes, scene, found.choice)).flatten();
        Ok(Self {
            error: run.error,
            cpu_seconds: run.seconds,
            cpu_slowest: run.slowest,
            bytes,
            ratios: Ratios {
                error: found.choice.error / run.error,
                cpu_seconds: found.choice.seconds / run.seconds,
                bytes: bytes.map(|bytes| found.bytes / bytes),
            },
        })
    }

    pub(super) fn words(&self) -> String {
        let off = |ratio: f64| format!("{:+.0} %", 100.0 * (ratio - 1.0));
        let memory = self
            .bytes
            .zip(self.ratios.bytes)
            .map_or("memory not measured".into(), |(bytes, ratio)| {
                format!("{} ({})", megabytes(bytes), off(ratio))
            });
        format!(
            "real: error {:.4e} ({}), {:.3} CPU s ({}; least of {CONFIRMING}, slowest {:.3}), {memory}; in brackets: predicted over real, less one",
            self.error,
            off(self.ratios.error),
            self.cpu_seconds,
            off(self.ratios.cpu_seconds),
            self.cpu_slowest,
        )
    }
}

/// The peak resident size of a separate process for the run, by the scene as written; None if the system does not tell.
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
