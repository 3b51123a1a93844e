//! Orders that theory predicts.

use serde::{Deserialize, Serialize};

use super::MeshAndSteps;
use fit::Direction;

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

    /// The direction of a line; none for a grid.
    pub fn direction(self) -> Option<Direction> {
        match self {
            Self::H | Self::Path => Some(Direction::Space),
            Self::K => Some(Direction::Time),
            Self::Joint => None,
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
            Self::Solver => {
                "lower the floor: it comes from the solver, which needs a tighter tolerance"
            }
            Self::Quadrature => {
                "lower the floor: it is the quadrature of loads and errors, where a kink cuts cells; `sweep check --floors` measures its parts"
            }
            Self::LoadQuadrature => {
                "lower the floor: it is the load quadrature of form = \"strong\", where f0 or a traction is rough inside cells; leave form out for loads in weak form; `sweep check --floors` measures its parts"
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
    /// Order in the variable; in h for [`Variable::Joint`]. 0 as a lower bound says that the error tends to zero.
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
    /// Mesh and steps of the run that errors are measured against.
    pub reference: Option<MeshAndSteps>,
    /// Predicted error, on the finest case, of the direction that is not refined: what no refinement of the other lowers.
    pub other_error: Option<f64>,
    /// A constant that is still drifting leaves the prediction open.
    pub constant_owed: bool,
    /// The solution is unique; otherwise a run may have followed another one.
    pub unique: bool,
}

impl Prediction {
    /// Whether the error is to tend to zero, at no rate that anybody predicts.
    pub(crate) fn tends_to_zero(&self) -> bool {
        self.at_least && self.order == 0.0
    }

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
            reference: None,
            other_error: None,
            constant_owed: false,
            unique: true,
        }
    }
}
