//! Costs of expressions, in sums or products.

use super::graph::{Graph, Node, Op};
use super::vocabulary::Function;

const DIVISION: u32 = 4;
const FUNCTION: u32 = 50;

impl Graph {
    /// Approximate cost per point of each node below `roots`, by node number. What occurs twice counts twice; what is
    /// equal at all points costs nothing.
    pub(super) fn costs(&self, roots: &[Node]) -> Vec<u32> {
        let below = self.reachable(roots, |_| true);
        let mut costs = vec![0; below.last().map_or(0, |last| last.index() + 1)];
        for node in below {
            let op = self.op(node);
            let operands = op.operands().map(|operand| costs[operand.index()]);
            costs[node.index()] = match self.dependence(node).space() {
                0 => 0,
                _ => operands.fold(own_cost(op), u32::saturating_add),
            };
        }
        costs
    }
}

fn own_cost(op: Op) -> u32 {
    match op {
        Op::Constant(_) | Op::Variable(_) => 0,
        Op::Neg(_) | Op::Add(..) | Op::Sub(..) | Op::Mul(..) => 1,
        Op::Max(..) | Op::Min(..) | Op::Less(_) => 1,
        Op::Apply(Function::Abs | Function::Sign, _) => 1,
        // By squaring; a negative power adds a division.
        Op::Power(_, n) => 2 * n.unsigned_abs().max(1).ilog2() + if n < 0 { DIVISION } else { 0 },
        Op::Div(..) | Op::Apply(Function::Sqrt, _) => DIVISION,
        Op::Pow(..) | Op::Apply(..) | Op::Relax(..) | Op::Convolve(..) => FUNCTION,
    }
}

#[cfg(test)]
mod tests {
    use super::super::graph::Variable;
    use super::super::scope::Scope;
    use super::*;

    #[test]
    fn costs_are_those_of_a_tree() {
        let mut graph = Graph::new();
        let scope = Scope::new(&[Variable::X, Variable::Y, Variable::T]);
        let texts = [
            ("1 + 0.2*x + 0.1*y", 4),
            ("(1 - y^2)*(1 + y^2)", 7),
            ("x/(x + y)", 1 + DIVISION),
            ("sin(2*x)", 1 + FUNCTION),
            ("relax(0.5, max(t - x, 0))", 2 + FUNCTION),
            ("exp(t)*y", 1),
            ("y", 0),
        ];
        let roots = texts.map(|(text, _)| graph.parse(text, &scope).expect("a formula"));
        let costs = graph.costs(&roots);
        for ((text, expected), root) in texts.into_iter().zip(roots) {
            assert_eq!(costs[root.index()], expected, "{text}");
        }
    }
}
