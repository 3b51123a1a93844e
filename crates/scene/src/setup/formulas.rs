//! Scene formulas as components of the solver's model.

use std::sync::Arc;

use fem::contact::{OnContact, OnContactInTime};
use formula::{EvaluationPoint, Graph, Node, Variable};
use vhi::law::{MemoryKernel, YieldLimit};

/// b(t) by a formula in t.
pub(crate) struct KernelFormula {
    pub(super) graph: Arc<Graph>,
    pub(super) node: Node,
}

impl MemoryKernel for KernelFormula {
    fn value(&self, lag: f64) -> f64 {
        self.graph.evaluate(self.node, &EvaluationPoint { t: lag, ..EvaluationPoint::default() })
    }
}

/// κ(ζ) by a formula in ζ, with its exact derivative.
pub struct YieldFormula {
    graph: Graph,
    value: Node,
    slope: Node,
}

impl YieldFormula {
    /// The limit that `node` of `graph` states.
    pub fn new(graph: &Graph, node: Node) -> Self {
        let mut graph = graph.clone();
        let slope = graph.derivative(node, Variable::Zeta);
        Self { graph, value: node, slope }
    }
}

impl YieldLimit for YieldFormula {
    fn value(&self, zeta: f64) -> f64 {
        self.graph.evaluate(self.value, &EvaluationPoint { zeta, ..EvaluationPoint::default() })
    }

    fn slope(&self, zeta: f64) -> f64 {
        self.graph.evaluate(self.slope, &EvaluationPoint { zeta, ..EvaluationPoint::default() })
    }
}

/// A function on Γ3 by a formula in x, or the constant `absent`.
pub(super) fn on_contact(graph: &Arc<Graph>, node: Option<Node>, absent: f64) -> OnContact {
    let graph = graph.clone();
    Box::new(move |place| node.map_or(absent, |node| graph.evaluate(node, &place.into())))
}

/// A function on Γ3 × [0, T] by a formula in x and t, or the constant `absent`.
pub(super) fn on_contact_in_time(
    graph: &Arc<Graph>,
    node: Option<Node>,
    absent: f64,
) -> OnContactInTime {
    let graph = graph.clone();
    Box::new(move |place, t| {
        let at = EvaluationPoint { t, ..place.into() };
        node.map_or(absent, |node| graph.evaluate(node, &at))
    })
}
