//! The expression graph; equal expressions are stored once.

use rustc_hash::{FxHashMap, FxHashSet};

use super::vocabulary::{Function, is_word};

/// An independent variable.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub enum Variable {
    X,
    Y,
    Z,
    T,
    /// A second scalar argument, constant over the points of one evaluation.
    Zeta,
}

impl Variable {
    pub(crate) const ALL: [Self; 5] = [Self::X, Self::Y, Self::Z, Self::T, Self::Zeta];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::T => "t",
            Self::Zeta => "zeta",
        }
    }

    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|v| v.name() == name)
    }
}

/// The set of variables an expression depends on, as bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, PartialOrd, Ord)]
pub(super) struct Dependence(u8);

impl Dependence {
    const HISTORY: u8 = 1 << 5;

    pub(super) fn of(variable: Variable) -> Self {
        Self(1 << variable as u8)
    }

    pub(super) fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub(super) fn contains(self, variable: Variable) -> bool {
        self.0 & Self::of(variable).0 != 0
    }

    /// The space variables: bit 0 for x, 1 for y, 2 for z.
    pub(super) fn space(self) -> u8 {
        self.0 & 7
    }

    pub(super) fn on_time(self) -> bool {
        self.contains(Variable::T)
    }

    pub(super) fn on_history(self) -> bool {
        self.0 & Self::HISTORY != 0
    }

    pub(super) fn at_most_time(self) -> bool {
        self.0 & !Self::HISTORY & !Self::of(Variable::T).0 == 0
    }
}

/// An expression of one [`Graph`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Node(pub(super) u32);

impl Node {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Operands always have smaller numbers than the node, so ascending numbers are an order of evaluation.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum Op {
    Constant(u64),
    Variable(Variable),
    Neg(Node),
    Add(Node, Node),
    Sub(Node, Node),
    Mul(Node, Node),
    Div(Node, Node),
    Power(Node, i32),
    Pow(Node, Node),
    Apply(Function, Node),
    Max(Node, Node),
    Min(Node, Node),
    /// `[a, b, then, otherwise]`: `then` where a < b.
    Less([Node; 4]),
    /// Integral over 0 < s < t of exp(-c (t-s)) f(s); bits of c, then f.
    Relax(u64, Node),
    /// Integral over 0 < s < t of b(t-s) f(s); b, then f.
    Convolve(Node, Node),
}

impl Op {
    pub(super) fn is_integral(self) -> bool {
        matches!(self, Self::Relax(..) | Self::Convolve(..))
    }

    pub(super) fn operands(&self) -> impl Iterator<Item = Node> + use<> {
        let list = match *self {
            Self::Constant(_) | Self::Variable(_) => [None; 4],
            Self::Neg(a) | Self::Power(a, _) | Self::Apply(_, a) | Self::Relax(_, a) => {
                [Some(a), None, None, None]
            }
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Div(a, b)
            | Self::Pow(a, b)
            | Self::Max(a, b)
            | Self::Min(a, b)
            | Self::Convolve(a, b) => [Some(a), Some(b), None, None],
            Self::Less(four) => four.map(Some),
        };
        list.into_iter().flatten()
    }
}

/// A directed acyclic graph of expressions, equal ones shared.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    ops: Vec<Op>,
    dependence: Vec<Dependence>,
    known: FxHashMap<Op, Node>,
    pub(super) derivatives: FxHashMap<(Node, Variable), Node>,
    /// For each branching node the expression whose sign decides.
    pub(super) deciders: FxHashMap<Node, Node>,
    /// Whether programs add estimated quadrature errors to hereditary integrals.
    pub(super) adds_remainders: bool,
    /// Whether a - c a becomes (1 - c) a.
    pub(super) collects: bool,
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether the name belongs to the language (function, constant, variable or connective) and cannot be defined by
    /// the user.
    pub fn is_reserved(name: &str) -> bool {
        is_word(name) || Variable::named(name).is_some()
    }

    /// Programs compiled from now on add to each hereditary integral an estimate of its quadrature error, so that its
    /// effect shows in the difference. The estimate is zero unless the integrand is hardly integrable or resolved by no
    /// halving.
    pub fn add_remainders(&mut self) {
        self.adds_remainders = true;
    }

    /// From now on a - c a becomes (1 - c) a, the same number with other roundings: a range of t - s for s = c t is exact then.
    pub fn collect(&mut self) {
        self.collects = true;
    }

    pub(super) fn op(&self, node: Node) -> Op {
        self.ops[node.index()]
    }

    pub(super) fn dependence(&self, node: Node) -> Dependence {
        self.dependence[node.index()]
    }

    /// The node of an operation, without simplification.
    pub(super) fn intern(&mut self, op: Op) -> Node {
        if let Some(&node) = self.known.get(&op) {
            return node;
        }
        let mut dependence = op
            .operands()
            .fold(Dependence::default(), |set, operand| set.union(self.dependence(operand)));
        match op {
            Op::Variable(v) => dependence = Dependence::of(v),
            Op::Relax(..) | Op::Convolve(..) => {
                let time = Dependence::of(Variable::T);
                dependence = dependence.union(time).union(Dependence(Dependence::HISTORY));
            }
            _ => {}
        }
        let node = Node(self.ops.len() as u32);
        self.ops.push(op);
        self.dependence.push(dependence);
        self.known.insert(op, node);
        node
    }

    /// Whether `f` depends on `v`; hereditary integrals depend on t.
    pub fn depends_on(&self, f: Node, v: Variable) -> bool {
        self.dependence(f).contains(v)
    }

    /// Whether a hereditary integral occurs in `f`.
    pub fn remembers(&self, f: Node) -> bool {
        self.dependence(f).on_history()
    }

    /// The number `f` is, if it is one.
    pub fn value_of_constant(&self, f: Node) -> Option<f64> {
        match self.op(f) {
            Op::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// All nodes below and including `roots`, in order of evaluation. A node that `enter` refuses is listed without its
    /// operands.
    ///
    /// Not recursive, because a long sum is a deep graph.
    pub(super) fn reachable(&self, roots: &[Node], enter: impl Fn(Node) -> bool) -> Vec<Node> {
        let mut seen = FxHashSet::default();
        let mut stack = roots.to_vec();
        let mut found = Vec::new();
        while let Some(node) = stack.pop() {
            if seen.insert(node) {
                found.push(node);
                if enter(node) {
                    stack.extend(self.op(node).operands());
                }
            }
        }
        found.sort_unstable_by_key(|n| n.0);
        found
    }
}
