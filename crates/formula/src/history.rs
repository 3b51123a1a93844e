//! Groups of hereditary integrals.
//!
//! Integrals at one stage and depth of nesting form a group, if their kernels are all exponential or none is: one tape computes
//! their integrands at common times, and panels are broken where any of their guards changes sign.

use super::graph::{Graph, Node, Op, Variable};
use super::program::is_hereditary;
use super::tape::{Source, Tape};

/// Panels per horizon, unless fast relaxation needs more; unresolved parts are halved.
const PANELS: f64 = 16.0;
/// Panels per horizon for non-exponential kernels, whose resolution is not checked.
const PANELS_OF_GENERAL: f64 = 64.0;
/// Minimum of watch intervals per horizon.
const WATCHES: f64 = 320.0;
/// Largest rate times panel width that the quadrature resolves fully.
const STIFFEST: f64 = 4.0;
/// Minimum of watch intervals per panel.
const LEAST_WATCHES: f64 = 5.0;
/// Limit of the refinement of panels.
const FINEST: f64 = 256.0;
/// Number of panels of equal width; as many of twice the width follow, and so on, to reach times far beyond the
/// horizon.
const UNIFORM: u64 = 4096;

#[derive(Clone, Debug)]
pub(super) enum Kernel {
    /// exp(-c (t-s))
    Exponential(f64),
    /// b(t-s): node and tape.
    General(Node, Tape),
}

#[derive(Clone, Debug)]
pub(super) struct Member {
    pub(super) node: Node,
    pub(super) kernel: usize,
    pub(super) integrand: usize,
}

#[derive(Clone, Debug)]
pub(super) struct HistoryPlan {
    pub(super) mask: u8,
    pub(super) on_zeta: bool,
    general: bool,
    width: f64,
    watch_width: f64,
    pub(super) members: Vec<Member>,
    pub(super) kernels: Vec<Kernel>,
    integrands: Vec<Node>,
    guards: Vec<Node>,
    pub(super) tape: Tape,
    pub(super) watch: Tape,
}

impl HistoryPlan {
    /// The groups of all integrals in `outputs`, nested ones first.
    pub(super) fn groups(graph: &Graph, outputs: &[Node], horizon: f64) -> Vec<Self> {
        let all = graph.reachable(outputs, |_| true);
        let mut keyed: Vec<((usize, u8, bool, bool), Node)> = Vec::new();
        for node in all.into_iter().filter(|&n| is_hereditary(graph, n)) {
            let inside: Vec<Node> = graph.op(node).operands().collect();
            let inside = graph.reachable(&inside, |_| true);
            let depths = keyed.iter().filter(|(_, n)| inside.contains(n));
            let depth = depths.map(|((d, ..), _)| d + 1).max().unwrap_or(0);
            let on_zeta = graph.depends_on(node, Variable::Zeta);
            let general = matches!(graph.op(node), Op::Convolve(..));
            keyed.push(((depth, graph.dependence(node).space(), on_zeta, general), node));
        }
        keyed.sort_by_key(|(key, n)| (*key, n.0));
        keyed
            .chunk_by(|(a, _), (b, _)| a == b)
            .map(|group| {
                let nodes: Vec<Node> = group.iter().map(|(_, n)| *n).collect();
                let (_, _, on_zeta, general) = group[0].0;
                Self::new(graph, &nodes, (on_zeta, general), horizon)
            })
            .collect()
    }

    fn new(graph: &Graph, nodes: &[Node], (on_zeta, general): (bool, bool), horizon: f64) -> Self {
        let mut plan = Self {
            mask: graph.dependence(nodes[0]).space(),
            on_zeta,
            general,
            width: 0.0,
            watch_width: 0.0,
            members: Vec::new(),
            kernels: Vec::new(),
            integrands: Vec::new(),
            guards: Vec::new(),
            tape: Tape::default(),
            watch: Tape::default(),
        };
        for &node in nodes {
            let (kernel, f) = match graph.op(node) {
                Op::Relax(c, f) => (Kernel::Exponential(f64::from_bits(c)), f),
                Op::Convolve(b, f) => (Kernel::General(b, Tape::compile(graph, &[b], |_| None)), f),
                _ => continue,
            };
            let same = |k: &Kernel| match (k, &kernel) {
                (Kernel::Exponential(c), Kernel::Exponential(d)) => c == d,
                (Kernel::General(a, _), Kernel::General(b, _)) => a == b,
                _ => false,
            };
            let known = plan.kernels.iter().position(same);
            let place = known.unwrap_or(plan.kernels.len());
            if known.is_none() {
                plan.kernels.push(kernel);
            }
            let integrand = plan.integrands.iter().position(|&g| g == f);
            let integrand = integrand.unwrap_or_else(|| {
                plan.integrands.push(f);
                plan.integrands.len() - 1
            });
            plan.members.push(Member { node, kernel: place, integrand });
        }
        plan.guards = graph.guards(&plan.integrands);
        plan.guards.retain(|g| graph.depends_on(*g, Variable::T));
        let horizon = if horizon.is_finite() && horizon > 0.0 { horizon } else { 1.0 };
        plan.width = plan.panel_width(horizon);
        plan.watch_width = (horizon / WATCHES).min(plan.width / LEAST_WATCHES);
        plan
    }

    /// Whether the kernels are no exponentials.
    pub(super) fn is_general(&self) -> bool {
        self.general
    }

    fn panel_width(&self, horizon: f64) -> f64 {
        let panels = if self.is_general() { PANELS_OF_GENERAL } else { PANELS };
        let width = horizon / panels;
        let rates = self.kernels.iter().map(|k| match k {
            Kernel::Exponential(c) => c.abs(),
            Kernel::General(..) => 0.0,
        });
        let stiffness = rates.fold(0.0, f64::max) * width;
        width / (stiffness / STIFFEST).ceil().clamp(1.0, FINEST)
    }

    pub(super) fn roots(&self) -> Vec<Node> {
        [self.integrands.as_slice(), &self.guards].concat()
    }

    pub(super) fn compile(&mut self, graph: &Graph, source: impl Fn(Node) -> Option<Source>) {
        self.tape = Tape::compile(graph, &self.integrands, &source);
        self.watch = Tape::compile(graph, &self.guards, &source);
    }

    pub(super) fn nested(&self) -> Vec<usize> {
        let sources = self.tape.sources().chain(self.watch.sources());
        let mut groups: Vec<usize> = sources
            .filter_map(|source| match source {
                Source::Recall(group, _) => Some(group),
                _ => None,
            })
            .collect();
        groups.sort_unstable();
        groups.dedup();
        groups
    }

    /// Number of watch intervals for a length; the wide panels far beyond the horizon have no more than the first.
    pub(super) fn watches(&self, length: f64) -> usize {
        let most = (self.width / self.watch_width).ceil();
        (length.abs() / self.watch_width).ceil().min(most) as usize
    }

    pub(super) fn edge(&self, p: usize) -> f64 {
        let (doublings, rest) = (p as u64 / UNIFORM, p as u64 % UNIFORM);
        let scale = (doublings as f64).exp2();
        self.width * (UNIFORM as f64 * (scale - 1.0) + rest as f64 * scale)
    }

    /// The panel that contains `t`; the first for t < 0.
    pub(super) fn panel(&self, t: f64) -> usize {
        let units = (t / self.width).max(0.0);
        let doublings = (units / UNIFORM as f64 + 1.0).log2().floor();
        let scale = doublings.exp2();
        let rest = (units - UNIFORM as f64 * (scale - 1.0)) / scale;
        let mut p = (doublings * UNIFORM as f64 + rest.max(0.0)) as usize;
        while p > 0 && self.edge(p) > t {
            p -= 1;
        }
        while self.edge(p + 1) <= t {
            p += 1;
        }
        p
    }
}
