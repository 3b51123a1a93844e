//! A scene of `kind = "abstract"` as written: keys and types only.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::written::{Formula, Heading, Law, Prediction, Time};

/// The whole file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AbstractFile {
    pub scene: Heading,
    pub time: Time,
    pub space: Option<Space>,
    pub operator: Operator,
    pub history: Option<History>,
    pub phi: Option<Phi>,
    #[serde(default)]
    pub trace: Vec<Trace>,
    pub exact: Exact,
    pub sweep: Option<Sweep>,
    #[serde(default)]
    pub predicts: Vec<Prediction>,
}

/// `[space]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Space {
    pub inner_product: Vec<Vec<f64>>,
}

/// `[operator]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Operator {
    pub matrix: Vec<Vec<f64>>,
    pub nonlinear: Option<Vec<Formula>>,
}

/// `[history]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct History {
    pub kernels: Vec<Kernel>,
    #[serde(rename = "R")]
    pub r: Option<Vec<Vec<f64>>>,
    #[serde(rename = "a_S")]
    pub a_s: Option<Vec<f64>>,
}

/// `{ q = "-exp(-(t - s))", matrix = [[1.0, 0.0], [0.0, 1.0]] }`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Kernel {
    pub q: Formula,
    pub singular: Option<f64>,
    pub matrix: Option<Vec<Vec<f64>>>,
}

/// `[phi]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Phi {
    pub force: Vec<Formula>,
}

/// `[[trace]]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Trace {
    pub functional: Vec<f64>,
    pub weight: Option<f64>,
    pub law: Option<Law>,
    pub upper: Option<f64>,
    pub lower: Option<f64>,
}

/// `[exact]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Exact {
    pub u: Vec<Formula>,
    pub multiplier: Option<Vec<Formula>>,
    pub selection: Option<Vec<Formula>>,
    #[serde(default)]
    pub parameters: BTreeMap<String, Formula>,
    #[serde(default)]
    pub define: BTreeMap<String, Formula>,
}

/// `[sweep]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Sweep {
    pub steps: Vec<i64>,
}
