//! What `bound`, `gronwall` and `audit` wrote with `--out`, as far as a report shows it; `--help` of each lists all keys.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::Number;

/// `SCENE-bound.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Bound {
    pub scene: String,
    pub fingerprint: String,
    pub n: Option<u32>,
    pub steps: u32,
    pub constants: Vec<Constant>,
    pub samples: Vec<Sampled>,
    pub thresholds: Thresholds,
    pub ratio: Number,
    pub worst: Level,
    pub rungs: Vec<Rung>,
    pub violations: Vec<BoundViolation>,
}

/// A constant with how it was obtained.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Constant {
    pub name: String,
    pub value: Number,
    pub uncertainty: Number,
    pub how: String,
    pub safe: bool,
    pub note: String,
}

/// A declared constant beside what samples need.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Sampled {
    pub what: String,
    pub declared: Number,
    pub needed: Number,
    pub holds: bool,
}

/// Step sizes up to which something holds; absent: for every k.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Thresholds {
    pub paper_norm: Number,
    pub theorem: Number,
    pub sharpened: Number,
    pub solvable: Number,
    pub norm_one: Option<[Number; 2]>,
    pub radius_one: Option<[Number; 2]>,
    pub loss: Option<[Number; 2]>,
    pub loss_reason: Option<String>,
    /// Why no solution was followed in k, where none was.
    #[serde(default)]
    pub not_followed: Option<String>,
}

/// A level of the run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Level {
    pub level: usize,
    pub t: f64,
}

/// A last step of size k.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Rung {
    pub k: f64,
    pub norm: Number,
    pub radius: Number,
    pub sharpened: Number,
    pub theorem: Number,
    pub paper_norm: Number,
    /// Iterations, or why there is no solution.
    pub newton: serde_json::Value,
    pub fixed_point: serde_json::Value,
}

/// An inequality that does not hold.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct BoundViolation {
    pub k: Number,
    pub what: String,
    pub left: Number,
    pub right: Number,
}

/// `SCENE-gronwall.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Gronwall {
    pub scene: String,
    pub fingerprint: String,
    pub n: Option<u32>,
    pub truth: String,
    pub constants: BTreeMap<String, Number>,
    pub grids: Vec<Grid>,
    pub horizons: Option<Horizons>,
    pub perturbations: Vec<Perturbation>,
    pub violations: Vec<LinkViolation>,
}

/// One number of steps.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Grid {
    pub steps: u32,
    #[serde(rename = "C2_k")]
    pub c2_k: Number,
    pub error_end: Number,
    pub truncation_end: Number,
    pub effectivity: Effectivities,
}

/// Bound over error of every envelope.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Effectivities {
    pub weighted: Effectivity,
    pub primed: Effectivity,
    pub closed: Effectivity,
    pub limit: Effectivity,
    pub printed: Option<Effectivity>,
    pub printed_closed: Option<Effectivity>,
}

/// Bound over error.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Effectivity {
    pub at_end: Number,
}

/// Long times at one step size.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Horizons {
    pub k: f64,
    pub rows: Vec<Horizon>,
}

/// One T.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Horizon {
    pub horizon: f64,
    pub error: Number,
    pub weighted: Number,
    pub primed: Number,
    pub closed: Number,
    pub c2: Number,
    pub growth: Number,
}

/// Two loads.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Perturbation {
    pub shape: String,
    pub size: Number,
    pub load: Number,
    pub difference: Number,
    pub growth: Number,
    pub least_effectivity: Number,
}

/// A link of the chain that does not hold.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct LinkViolation {
    pub part: String,
    pub link: String,
    pub n: usize,
    pub left: Number,
    pub right: Number,
}

/// `SCENE-audit.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Audit {
    pub scene: String,
    pub fingerprint: String,
    pub theorem: String,
    pub rule: String,
    pub holds: bool,
    pub lines: Vec<Line>,
    pub cases: Vec<Case>,
    pub violations: Vec<String>,
    /// Lines without a defined constant.
    #[serde(default)]
    pub undefined: Vec<String>,
}

/// A line of the proof over all runs.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Line {
    pub line: String,
    pub says: String,
    pub relation: String,
    pub left: Number,
    pub right: Number,
    pub ratio: Number,
    pub power_h: [Number; 2],
    pub power_k: [Number; 2],
    pub holds: bool,
}

/// A run of an audit.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Case {
    pub n: u32,
    pub steps: u32,
}

/// A row of `ledger.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Claim {
    pub claim: String,
    pub hypotheses: String,
    pub quantity: String,
    pub proved: Number,
    pub observed: Number,
    pub claimed: String,
    pub confirmed: bool,
    pub command: String,
}
