//! Judged predictions.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{FittedConstant, Foreseen, JudgedPoint, MeshAndSteps, Prediction, Variable};
use crate::record::{CaseRecord, Status};
use fit::Decision;

/// What is said of a constant, apart from the order.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConstantClaim {
    /// C_h or C_k.
    pub name: &'static str,
    #[serde(rename = "standing")]
    pub decision: Decision,
    pub reason: String,
    /// Whether one that is still drifting is red: the scene states how far it may be off.
    pub owed: bool,
    /// Whether its agreement, not the slopes, shows the order.
    pub decides: bool,
}

/// A judged prediction: the claims about an order and about its constant.
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
    pub points_used: Vec<JudgedPoint>,
    pub points_left_out: Vec<JudgedPoint>,
    /// `C_h` and `C_k`, as far as fitted.
    pub constants: BTreeMap<&'static str, FittedConstant>,
    /// The predicted constant: leading errors, or why there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub foreseen: Option<Foreseen>,
    /// The predicted error, on the finest case, of the direction that is not refined.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_error: Option<f64>,
    /// What comes of the claim about the order.
    pub order: Decision,
    /// The claim about the constant; none without a prediction of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constant: Option<ConstantClaim>,
    /// What comes of both: the order's, unless the constant fails, or is owed and open.
    #[serde(rename = "verdict")]
    pub decision: Decision,
    pub reason: String,
    /// The cases that would help an unresolved verdict.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub next: Vec<MeshAndSteps>,
    /// Every expected case is there, converged and finite, and what was left out agrees with what was used; otherwise the
    /// verdict is no `pass` and never as expected.
    pub complete: bool,
    /// The verdict that the scene is built to get.
    pub expect: Decision,
}

impl Verdict {
    /// Before any point is judged.
    pub fn open(scene: &str, prediction: &Prediction, expect: Decision) -> Self {
        let joint = prediction.variable == Variable::Joint;
        Self {
            scene: scene.to_owned(),
            norm: prediction.norm.clone(),
            variable: prediction.variable,
            predicted: prediction.order,
            predicted_k: prediction.order_k.filter(|_| joint),
            at_least: prediction.at_least,
            why: prediction.why.clone(),
            observed: None,
            observed_k: None,
            interval: None,
            interval_k: None,
            probability: None,
            contradicted_by: None,
            points_used: Vec::new(),
            points_left_out: Vec::new(),
            constants: BTreeMap::new(),
            foreseen: None,
            other_error: prediction.other_error,
            order: Decision::Unresolved,
            constant: None,
            decision: Decision::Unresolved,
            reason: String::new(),
            next: Vec::new(),
            complete: true,
            expect,
        }
    }

    /// The order's verdict with that of the constant.
    pub(super) fn settle(&mut self) {
        self.decision = match &self.constant {
            Some(claim) if claim.decision == Decision::Fail || claim.owed => {
                self.order.and(claim.decision)
            }
            _ => self.order,
        };
    }

    /// A pass that was expected: there is nothing to say of it.
    pub fn is_plain_pass(&self) -> bool {
        self.as_expected() && self.decision == Decision::Pass
    }

    /// Whether the verdict is the expected one. An expected failure must come from the order, not from a missing case.
    pub fn as_expected(&self) -> bool {
        self.complete && self.decision == self.expect
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
