//! What `trade` and `extremes` wrote with `--out`, as far as a report shows it.

use serde::Deserialize;

use super::Number;

/// `SCENE-trade.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Trade {
    pub scene: String,
    pub fingerprint: String,
    pub norm: String,
    pub trials: Vec<Trial>,
    pub error_model: ErrorModel,
    pub cost_model: CostModel,
    pub coupling: Option<Coupling>,
    pub prices: Vec<Price>,
    pub answer: Option<Answer>,
    pub confirmed: Option<Confirmed>,
}

/// A run for the clock.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Trial {
    pub knob: String,
    pub n: u32,
    pub steps: u32,
    pub front: bool,
    pub status: String,
    pub reason: Option<String>,
    pub error: Number,
    pub cpu_seconds: Number,
    pub predicted_bytes: Number,
}

/// C h^p and C k^q, or why there is no model.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ErrorModel {
    pub model: Option<String>,
    pub space: Option<Power>,
    pub time: Option<Power>,
    pub reason: Option<String>,
}

/// C x^order.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Power {
    pub constant: f64,
    pub order: f64,
}

/// base + constant h^-a k^-b, or why there is no model.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct CostModel {
    pub base: Number,
    pub constant: Number,
    pub space: Option<Exponent>,
    pub time: Option<Exponent>,
    pub reason: Option<String>,
}

/// An exponent of the cost.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Exponent {
    pub exponent: f64,
}

/// k = factor h^exponent.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Coupling {
    pub exponent: f64,
    pub factor: f64,
    pub space_share: f64,
    pub cost_exponent: f64,
}

/// A row of the price list.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Price {
    pub words: String,
}

/// The cheapest run under a target.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Answer {
    pub target: f64,
    pub n: u32,
    pub steps: u32,
    pub knob: String,
    pub error: Number,
    pub cpu_seconds: Number,
}

/// The answer, run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Confirmed {
    pub error: Number,
    pub cpu_seconds: Number,
}

/// `extremes.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Extremes {
    pub ladders: Vec<Ladder>,
    pub rungs: Vec<ExtremeRung>,
}

/// A ladder of one parameter.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Ladder {
    pub name: String,
    pub parameter: String,
    pub quantity: String,
    pub why: String,
}

/// A rung of a ladder.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ExtremeRung {
    pub ladder: String,
    pub at: String,
    pub expected: String,
    pub measured: Number,
    pub digits_lost: Number,
    pub standing: String,
    pub note: String,
}
