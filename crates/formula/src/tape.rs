//! Straight-line programs over registers.

use std::collections::{HashMap, HashSet};

use super::graph::{Graph, Node, Op, Variable};
use super::vocabulary::Function;

/// The group and the member of each hereditary integral.
pub(super) type Integrals = HashMap<Node, (usize, usize)>;

#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum Source {
    Time,
    Zeta,
    /// A coordinate: 0 for x, 1 for y, 2 for z.
    Axis(usize),
    /// A hereditary integral: group and member.
    Integral(usize, usize),
}

pub(super) type Register = usize;

/// One operation on registers; numbers are folded in.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    Constant(f64),
    Fetch(Source),
    Neg(Register),
    Scale(f64, Register),
    Shift(f64, Register),
    /// number - register
    From(f64, Register),
    /// register / number
    Over(Register, f64),
    Add(Register, Register),
    Sub(Register, Register),
    Mul(Register, Register),
    Div(Register, Register),
    Power(Register, i32),
    Pow(Register, Register),
    Apply(Function, Register),
    Max(Register, Register),
    Min(Register, Register),
    Less([Register; 4]),
}

#[derive(Clone, Debug, Default)]
pub(super) struct Tape {
    /// Each with the register that it writes, and whether the result is equal in all lanes.
    pub(super) steps: Vec<(Register, Step, bool)>,
    pub(super) registers: usize,
    pub(super) results: Vec<Register>,
}

impl Tape {
    /// Compiles `roots`; `at_once` if all lanes have the same time.
    pub(super) fn compile(
        graph: &Graph,
        roots: &[Node],
        integrals: &Integrals,
        at_once: bool,
    ) -> Self {
        let source = |n: Node| match graph.op(n) {
            Op::Variable(Variable::T) => Some(Source::Time),
            Op::Variable(Variable::Zeta) => Some(Source::Zeta),
            Op::Variable(axis) => Some(Source::Axis(axis as usize)),
            _ => integrals.get(&n).map(|&(group, member)| Source::Integral(group, member)),
        };
        let order = graph.reachable(roots, |n| source(n).is_none());
        let mut last_use: HashMap<Node, usize> = HashMap::new();
        for (k, &node) in order.iter().enumerate() {
            if source(node).is_none() {
                last_use.extend(operands(graph, node).map(|operand| (operand, k)));
            }
        }
        last_use.extend(roots.iter().map(|&root| (root, usize::MAX)));

        let mut tape = Self::default();
        let mut held: HashMap<Node, Register> = HashMap::new();
        let mut free: Vec<Register> = Vec::new();
        for (k, &node) in order.iter().enumerate() {
            if !last_use.contains_key(&node) {
                // A number folded into every operation that uses it.
                continue;
            }
            let out = free.pop().unwrap_or_else(|| {
                tape.registers += 1;
                tape.registers - 1
            });
            let step = match source(node) {
                Some(source) => Step::Fetch(source),
                None => step(graph, node, |n| held.get(&n).copied().unwrap_or(out)),
            };
            let equal = at_once && graph.dependence(node).space() == 0;
            tape.steps.push((out, step, equal));
            held.insert(node, out);
            // Freed only now: a step never writes where it reads.
            if source(node).is_none() {
                let done: HashSet<Node> = operands(graph, node)
                    .filter(|operand| last_use.get(operand) == Some(&k))
                    .collect();
                for operand in operands(graph, node) {
                    if done.contains(&operand) {
                        free.extend(held.remove(&operand));
                    }
                }
            }
        }
        let result = |root| held.get(root).copied().unwrap_or(0);
        tape.results = roots.iter().map(result).collect();
        tape
    }

    pub(super) fn sources(&self) -> impl Iterator<Item = Source> {
        self.steps.iter().filter_map(|(_, step, _)| match step {
            Step::Fetch(source) => Some(*source),
            _ => None,
        })
    }

    /// Whether it reads an integral of a group.
    pub(super) fn reads(&self, group: usize) -> bool {
        self.sources().any(|source| matches!(source, Source::Integral(of, _) if of == group))
    }
}

fn operands(graph: &Graph, node: Node) -> impl Iterator<Item = Node> + use<> {
    let number = |n: Node| graph.value_of_constant(n).is_some();
    let (first, second) = match graph.op(node) {
        Op::Add(a, _) | Op::Mul(a, _) | Op::Sub(a, _) => (!number(a), true),
        Op::Div(_, b) => (true, !number(b)),
        _ => (true, true),
    };
    let keep = [first, second, true, true];
    graph.op(node).operands().zip(keep).filter_map(|(operand, keep)| keep.then_some(operand))
}

fn step(graph: &Graph, node: Node, register: impl Fn(Node) -> Register) -> Step {
    let number = |n: Node| graph.value_of_constant(n);
    let r = register;
    match graph.op(node) {
        Op::Constant(bits) => Step::Constant(f64::from_bits(bits)),
        Op::Neg(a) => Step::Neg(r(a)),
        Op::Add(a, b) => match number(a) {
            Some(v) => Step::Shift(v, r(b)),
            None => Step::Add(r(a), r(b)),
        },
        Op::Sub(a, b) => match number(a) {
            Some(v) => Step::From(v, r(b)),
            None => Step::Sub(r(a), r(b)),
        },
        Op::Mul(a, b) => match number(a) {
            Some(v) => Step::Scale(v, r(b)),
            None => Step::Mul(r(a), r(b)),
        },
        Op::Div(a, b) => match number(b) {
            Some(v) => Step::Over(r(a), v),
            None => Step::Div(r(a), r(b)),
        },
        Op::Power(a, n) => Step::Power(r(a), n),
        Op::Pow(a, b) => Step::Pow(r(a), r(b)),
        Op::Apply(function, a) => Step::Apply(function, r(a)),
        Op::Max(a, b) => Step::Max(r(a), r(b)),
        Op::Min(a, b) => Step::Min(r(a), r(b)),
        Op::Less(four) => Step::Less(four.map(r)),
        // These have sources.
        Op::Variable(_) | Op::Relax(..) | Op::Convolve(..) => Step::Constant(f64::NAN),
    }
}
