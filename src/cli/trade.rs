//! `sweep trade`: speed against accuracy over the settings of a scene, and the cheapest run with an error.

use std::path::PathBuf;

use clap::Args;

use super::machine::Common;
use super::study::show;
use super::{CliError, Scenes};
use studies::trade::{Trade, TradeError, Wanted, measurable, trade};

/// `sweep trade`.
#[derive(Args)]
#[command(
    after_help = "Each case is run once from the mesh to the last step. Its error is recorded, and its CPU seconds on one thread of this machine, without the time to measure the error. Settings beside h and k are changed one at a time on three cases. A factor below 1.25 between two times is no difference. docs/TRADE.md explains every number.\n\nFiles in --out: SCENE-trade.csv (a row a case; failures have status `failed`), SCENE-trade-claims.csv, SCENE-trade.json, SCENE-trade.svg (error against time).\n\nJSON keys with --json: scene, fingerprint (of its text), holds, claims (line, says, n, steps, level, at: the setting, left, relation, right, low, difference, accuracy, tightness, standing, holds, note), norm, size (largest strain norm of the truth), trials (scene, change: what is different from the scene as written, n, steps, h, k, dofs, norm, error, floor, cpu_seconds, load_share, predicted_bytes, history_bytes, newton_iterations, factorizations, status, reason, tie: a setting that moves neither time by 1.25 times nor error by 1 %, front: no run is as good in time and error and better in one, errors within 1 % being one), error_model (model, space and time with constant, order, interval; source, residual), cost_model (parts: seconds per run, per cell, per cell and level, per operation of a factorization, per operation and level; residual), coupling (exponent, factor, space_share, cost_exponent), prices (what, n, steps, speed, error, bytes), elements (the other elements: change, their error_model and cost_model), candidates and of these the cheapest, answer (target, n, steps, h, k, change, error, cpu_seconds, bytes, extrapolates), confirmed (error, cpu_seconds, ratios: predicted over real). Exit code 1: a run fails or has no error but rounding, the model of the error is off by more than a fourth at a run, or the run of --confirm misses the target by more than that. Exit code 2: no error can be measured, or none of the wanted size is in reach."
)]
pub(crate) struct TradeCommand {
    /// Name of a scene, or path of a TOML file
    scene: String,
    /// Cells per unit length [default: the scene's, completed to three and cut to --budget]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=4096))]
    n: Option<Vec<u32>>,
    /// Numbers N of time steps [default: likewise]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: Option<Vec<u32>>,
    /// Norm of the errors: V_max, L2_max, trace_L2_max, pressure_L2_max or stress_L2_max
    #[arg(long, default_value = "V_max")]
    norm: String,
    /// Budget for the grid in predicted CPU seconds; the settings may take as much again
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    budget: f64,
    /// Find the n, N and setting that reach this error at the lowest cost. `1%` is a hundredth of the largest
    /// strain norm of the truth (V_max alone), a plain number is an error in the norm
    #[arg(long, value_name = "E")]
    target: Option<String>,
    /// Run the recommended case and compare the prediction with the result
    #[arg(long, requires = "target")]
    confirm: bool,
    /// Directory for tables, JSON and picture
    #[arg(long, value_name = "DIR", default_value = "reports/latest/trade")]
    out: PathBuf,
    #[command(flatten)]
    common: Common,
}

impl From<TradeError> for CliError {
    fn from(error: TradeError) -> Self {
        match error {
            TradeError::Setup(error) => error.into(),
            TradeError::Memory(error) => error.into(),
            other => Self::other(other),
        }
    }
}

impl TradeCommand {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        if self.budget.is_nan() || self.budget <= 0.0 {
            return Err(CliError::other(format!("`{}` is no number of seconds", self.budget)));
        }
        let setup = measurable(&scenes.scene(&self.scene)?)?;
        let wanted = Wanted::read(&setup, &self.norm, self.target.as_deref());
        let asked = Trade {
            setup: &setup,
            wanted: wanted.map_err(CliError::other)?,
            n: self.n.clone(),
            steps: self.steps.clone(),
            budget: self.budget,
            confirm: self.confirm,
            limit: self.common.allowance.limit(),
        };
        let (findings, refused) = trade(&asked, &super::progress::note)?;
        let code = show(&findings, Some(&self.out), self.common.json)?;
        refused.map_or(Ok(code), |none| Err(CliError::other(format!("no answer: {none}"))))
    }
}
