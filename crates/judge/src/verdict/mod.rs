//! What the theory predicts, compared with what was measured: pass, fail or unresolved.

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
    Baseline, BaselineError, Comparison, Deviation, DeviationKind, Owed, Owing, Recorded,
    RecordedCase, Run, compare_owed, compare_with_baseline,
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
    /// Nothing is known: a table of numbers.
    #[default]
    Unknown,
    /// The tolerance of the solver, and rounding.
    Solver,
    /// The quadrature of loads and errors.
    Quadrature,
    /// The quadrature of f0 and f2, given or derived pointwise.
    LoadQuadrature,
    /// The error of the reference run.
    Reference,
}

impl FloorSource {
    /// How a floor from there is lowered.
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

/// An order that the theory predicts for a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Name of the norm.
    pub norm: String,
    /// What is refined.
    pub variable: Variable,
    /// Order in the variable; in h for [`Variable::Joint`].
    pub order: f64,
    /// Order in k, for [`Variable::Joint`] alone.
    pub order_k: Option<f64>,
    /// The theory gives a lower bound.
    pub at_least: bool,
    /// Higher orders refute the prediction as well.
    pub exact: bool,
    /// The theorem that predicts it.
    pub why: String,
    /// First and last n to be judged.
    pub window_n: Option<[u32; 2]>,
    /// First and last number of steps to be judged.
    pub window_steps: Option<[u32; 2]>,
    /// What the floor of an error comes from, for advice.
    pub floor: FloorSource,
    /// The data have one solution that a run must find; else another one of them may have been followed.
    pub unique: bool,
}

impl Prediction {
    /// Order `order` of the error `norm` in `variable`, judged on all cases: no lower bound, not refuted by higher orders,
    /// no order in k beside it, no theorem named. What differs is set beside it:
    /// `Prediction { exact: true, ..Prediction::new(norm, variable, order) }`.
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
    /// The theory holds here.
    #[default]
    Pass,
    /// The theory does not hold here, and a gate must show it.
    Fail,
    /// The cases cannot decide, and a gate must say so.
    Unresolved,
}

impl Expect {
    /// The decision that is expected.
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
    /// Mesh size.
    pub h: f64,
    /// Time step.
    pub k: f64,
    /// Error.
    pub error: f64,
}

/// A point that was left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointLeftOut {
    /// Mesh size.
    pub h: f64,
    /// Time step.
    pub k: f64,
    /// Error.
    pub error: f64,
    /// Why.
    pub reason: String,
}

/// Constant of an error term under its predicted order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Constant {
    /// The constant.
    pub value: f64,
    /// Its interval.
    pub interval: [f64; 2],
    /// The order it belongs to.
    pub order: f64,
    /// The constant of the leading errors, where they are known beforehand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted: Option<f64>,
    /// What error over step tends to, where that is known apart from the cases.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Measured over predicted on the finest case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ratio: Option<f64>,
    /// How far from one the ratio may be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
}

impl Constant {
    /// A constant as fitted, of which nothing is predicted.
    pub(crate) fn fitted(value: f64, interval: [f64; 2], order: f64) -> Self {
        Self { value, interval, order, predicted: None, limit: None, ratio: None, tolerance: None }
    }
}

/// One prediction judged; serialised it is an entry of `verdict.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Name of the scene.
    pub scene: String,
    /// Name of the norm.
    pub norm: String,
    /// What is refined.
    pub variable: Variable,
    /// Predicted order, in h if joint.
    pub predicted: f64,
    /// Predicted order in k, if joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_k: Option<f64>,
    /// The prediction is a lower bound.
    pub at_least: bool,
    /// The theorem that predicts it.
    pub why: String,
    /// Fitted order, in h if joint.
    pub observed: Option<f64>,
    /// Fitted order in k, if joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observed_k: Option<f64>,
    /// Interval of the order, in h if joint.
    pub interval: Option<[f64; 2]>,
    /// Interval of the order in k, if joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval_k: Option<[f64; 2]>,
    /// Probability that the prediction holds within its tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// The order of the errors that the exact solution predicts, where the measured errors are these and the prediction
    /// has another order: it is wrong, and the program is sound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contradicted_by: Option<f64>,
    /// The points that served.
    pub points_used: Vec<PointUsed>,
    /// The points that did not.
    pub points_left_out: Vec<PointLeftOut>,
    /// `C_h` and `C_k`, as far as they were fitted.
    pub constants: BTreeMap<&'static str, Constant>,
    /// What is known beforehand of the constant: leading errors, or why there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub foreseen: Option<Foreseen>,
    /// The decision.
    #[serde(rename = "verdict")]
    pub decision: Decision,
    /// Why, in one sentence.
    pub reason: String,
    /// The cases that would help an unresolved verdict.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub next: Vec<NextCase>,
    /// Every expected case is there, converged, with a finite error. Without, the verdict is
    /// `fail` and meets no expectation.
    pub complete: bool,
    /// The verdict that the scene is built to get.
    pub expect: Expect,
}

impl Verdict {
    /// Whether the scene got the verdict it is built to get. A scene that must fail has to fail
    /// by its order: a case that is missing does not count.
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
