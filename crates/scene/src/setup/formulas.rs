//! Scene formulas as components of the solver's model.

use std::sync::Arc;

use formula::{EvaluationPoint, Graph, Node, Variable};
use vhi::law::{MemoryKernel, YieldLimit};

/// b(t) by a formula in t.
pub struct KernelFormula {
    graph: Arc<Graph>,
    node: Node,
}

impl KernelFormula {
    pub(crate) fn new(graph: Arc<Graph>, node: Node) -> Self {
        Self { graph, node }
    }
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

/// g or s on Γ3 by a formula in x, with a default value.
pub struct GapFormula {
    graph: Arc<Graph>,
    node: Option<Node>,
    absent: f64,
}

impl GapFormula {
    /// The function of `node`, or the constant `absent`.
    pub(crate) fn new(graph: Arc<Graph>, node: Option<Node>, absent: f64) -> Self {
        Self { graph, node, absent }
    }

    pub(crate) fn boxed(self) -> Box<dyn Fn([f64; 3]) -> f64 + Send + Sync> {
        Box::new(move |[x, y, z]| match self.node {
            Some(node) => self
                .graph
                .evaluate(node, &EvaluationPoint { x, y, z, ..EvaluationPoint::default() }),
            None => self.absent,
        })
    }
}

/// A factor on Γ3 × [0, T] by a formula in x and t; 1 without one.
pub(super) fn boxed_in_time(
    graph: Arc<Graph>,
    node: Option<Node>,
) -> Box<dyn Fn([f64; 3], f64) -> f64 + Send + Sync> {
    Box::new(move |[x, y, z], t| match node {
        Some(node) => {
            graph.evaluate(node, &EvaluationPoint { x, y, z, t, ..EvaluationPoint::default() })
        }
        None => 1.0,
    })
}
