//! Predictions of theory compared with measurements: pass, fail or unresolved.

mod baseline;
mod constants;
mod document;
mod joint;
mod judge;
mod next;
mod selection;
mod stopping;
mod table;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::record::{CaseRecord, Status};

pub use crate::fit::Decision;
pub use baseline::{
    Baseline, BaselineError, ComparedRun, Comparison, Deviation, DeviationKind, Owed, Owing,
    Recorded, RecordedCase, compare_owed, compare_with_baseline,
};
pub use constants::{Foreseen, ForeseenConstant, LeadingLine, LeadingPoint};
pub use document::{
    DocumentError, Failure, document, failures, read_failures, read_foreseen, restore_reasons,
    write_json,
};
pub use judge::{judge, judge_foreseen};
pub use next::NextCase;
pub use selection::{line_keys, line_points};
pub use table::{NOTHING_JUDGED, TABLE_WIDTH, cell_texts, render_table};

/// What is refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Variable {
    /// The mesh, at the finest time step.
    H,
    /// The time step, on the finest mesh.
    K,
    /// Both: order p in h and q in k from the whole grid.
    Joint,
    /// h along a path of cases on which k follows it: the order in h of the whole error.
    Path,
}

impl Variable {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::H => "h",
            Self::K => "k",
            Self::Joint => "joint",
            Self::Path => "path",
        }
    }
}

/// What most of the floor of an error comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FloorSource {
    #[default]
    Unknown,
    Solver,
    /// Quadrature of loads and errors.
    Quadrature,
    /// Quadrature of f0 and f2, given or derived pointwise.
    LoadQuadrature,
    /// The error of the reference run.
    Reference,
}

impl FloorSource {
    /// How to lower a floor of this source.
    pub(crate) fn remedy(self) -> &'static str {
        match self {
            Self::Unknown => {
                "lower the floor: a tighter solver tolerance, a stronger quadrature of loads and errors or a finer reference"
            }
            Self::Solver => "lower the floor: it is the solver's, a tighter tolerance",
            Self::Quadrature => {
                "lower the floor: it is the quadrature of loads and errors, where a kink cuts cells; `sweep floors` measures its parts"
            }
            Self::LoadQuadrature => {
                "lower the floor: it is the load quadrature of form = \"strong\", where f0 or a traction jumps inside cells; leave form out for loads in weak form; `sweep floors` measures its parts"
            }
            Self::Reference => {
                "lower the floor: it is the error of the reference run, a finer one in [sweep] reference"
            }
        }
    }
}

/// An order predicted by theory for a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    pub norm: String,
    pub variable: Variable,
    /// Order in the variable; in h for [`Variable::Joint`].
    pub order: f64,
    /// Order in k, for [`Variable::Joint`].
    pub order_k: Option<f64>,
    pub at_least: bool,
    /// Higher orders refute the prediction as well.
    pub exact: bool,
    pub why: String,
    /// First and last n to judge.
    pub window_n: Option<[u32; 2]>,
    /// First and last number of steps to judge.
    pub window_steps: Option<[u32; 2]>,
    /// What the floor of an error comes from, for advice.
    pub floor: FloorSource,
    /// The solution is unique; otherwise a run may have followed another one.
    pub unique: bool,
}

impl Prediction {
    /// Predicts `order` of the error `norm` in `variable`: two-sided, on all cases, not refuted by higher orders,
    /// without an order in k or a theorem. Set what differs: `Prediction { exact: true, ..Prediction::new(norm,
    /// variable, order) }`.
    pub fn new(norm: impl Into<String>, variable: Variable, order: f64) -> Self {
        Self {
            norm: norm.into(),
            variable,
            order,
            order_k: None,
            at_least: false,
            exact: false,
            why: String::new(),
            window_n: None,
            window_steps: None,
            floor: FloorSource::Unknown,
            unique: true,
        }
    }
}

/// The verdict a scene is built to get.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Expect {
    #[default]
    Pass,
    Fail,
    Unresolved,
}

impl Expect {
    pub(crate) fn decision(self) -> Decision {
        match self {
            Self::Pass => Decision::Pass,
            Self::Fail => Decision::Fail,
            Self::Unresolved => Decision::Unresolved,
        }
    }
}

/// A point that served.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PointUsed {
    pub h: f64,
    pub k: f64,
    pub error: f64,
}

/// A point that was left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointLeftOut {
    pub h: f64,
    pub k: f64,
    pub error: f64,
    pub reason: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FittedConstant {
    pub value: f64,
    pub interval: [f64; 2],
    pub order: f64,
    /// Constant of the leading errors, if known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted: Option<f64>,
    /// Limit of error over step, if known independently of the cases.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Measured over predicted on the finest case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ratio: Option<f64>,
    /// Allowed distance of the ratio from one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
}

impl FittedConstant {
    pub(crate) fn fitted(value: f64, interval: [f64; 2], order: f64) -> Self {
        Self { value, interval, order, predicted: None, limit: None, ratio: None, tolerance: None }
    }
}

/// A judged prediction, an entry of `verdict.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    pub scene: String,
    pub norm: String,
    pub variable: Variable,
    /// In h if joint.
    pub predicted: f64,
    /// In k if joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_k: Option<f64>,
    pub at_least: bool,
    pub why: String,
    /// Fitted order, in h if joint.
    pub observed: Option<f64>,
    /// Fitted order in k if joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observed_k: Option<f64>,
    /// Interval of the order, in h if joint.
    pub interval: Option<[f64; 2]>,
    /// Interval of the order in k if joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval_k: Option<[f64; 2]>,
    /// Probability that the prediction holds within its tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// Order of the leading errors if the measured errors match them and not the prediction: then the prediction is
    /// wrong and the program sound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contradicted_by: Option<f64>,
    pub points_used: Vec<PointUsed>,
    pub points_left_out: Vec<PointLeftOut>,
    /// `C_h` and `C_k`, as far as fitted.
    pub constants: BTreeMap<&'static str, FittedConstant>,
    /// The predicted constant: leading errors, or why there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub foreseen: Option<Foreseen>,
    #[serde(rename = "verdict")]
    pub decision: Decision,
    pub reason: String,
    /// The cases that would help an unresolved verdict.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub next: Vec<NextCase>,
    /// Every expected case is there, converged and finite; otherwise the verdict is `fail` and never as expected.
    pub complete: bool,
    /// The verdict that the scene is built to get.
    pub expect: Expect,
}

impl Verdict {
    /// Whether the verdict is the expected one. An expected failure must come from the order, not from a missing case.
    pub fn as_expected(&self) -> bool {
        self.complete && self.decision == self.expect.decision()
    }
}

/// 0 if all verdicts are as expected, 1 if one is not, 2 if a solver gave up on a case.
pub fn exit_code(records: &[CaseRecord], verdicts: &[Verdict]) -> u8 {
    if records.iter().any(|record| matches!(record.status, Status::Failed { .. })) {
        2
    } else {
        u8::from(!verdicts.iter().all(Verdict::as_expected))
    }
}
