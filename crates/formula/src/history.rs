//! Hereditary integrals in groups.
//!
//! Integrals at the same stage and the same depth of nesting are one group:
//! their integrands are one tape, sampled at the same times, and panels are
//! broken where any of their guards changes sign.

use super::graph::{Graph, Node, Op, Variable};
use super::program::is_hereditary;
use super::tape::{Source, Tape};

/// Panels of the horizon, unless fast relaxation asks for more.  Where an
/// integrand is not resolved its part of a panel is halved.
const PANELS: f64 = 16.0;
/// Panels where a kernel is no exponential: it is not asked whether that
/// is resolved.
const PANELS_OF_GENERAL: f64 = 64.0;
/// Intervals of the horizon over which guards are watched, at least.
const WATCHES: f64 = 320.0;
/// The largest rate times panel width that the quadrature resolves fully.
const STIFFEST: f64 = 4.0;
/// Intervals of a panel over which guards are watched, at least.
const LEAST_WATCHES: f64 = 5.0;
/// Panels are not refined beyond this factor.
const FINEST: f64 = 256.0;
/// Panels of equal width; so many at twice the width follow, and so on, so
/// that times far beyond the horizon are reached.
const UNIFORM: u64 = 4096;

/// What the integrand is weighted by.
#[derive(Clone, Debug)]
pub(super) enum Kernel {
    /// exp(-c (t-s))
    Exponential(f64),
    /// b(t-s): its node and its tape.
    General(Node, Tape),
}

/// One integral of a group.
#[derive(Clone, Debug)]
pub(super) struct Member {
    pub(super) node: Node,
    pub(super) kernel: usize,
    pub(super) integrand: usize,
}

/// A group of integrals.
#[derive(Clone, Debug)]
pub(super) struct HistoryPlan {
    pub(super) mask: u8,
    pub(super) on_zeta: bool,
    /// Width of the first panels.
    width: f64,
    /// Largest distance of two watches.
    watch_width: f64,
    pub(super) members: Vec<Member>,
    pub(super) kernels: Vec<Kernel>,
    integrands: Vec<Node>,
    guards: Vec<Node>,
    /// Computes the integrands.
    pub(super) tape: Tape,
    /// Computes the guards.
    pub(super) watch: Tape,
}

impl HistoryPlan {
    /// The groups of all integrals in `outputs`, nested ones first.
    pub(super) fn groups(graph: &Graph, outputs: &[Node], horizon: f64) -> Vec<Self> {
        let all = graph.reachable(outputs, |_| true);
        let mut keyed: Vec<((usize, u8, bool), Node)> = Vec::new();
        for node in all.into_iter().filter(|&n| is_hereditary(graph, n)) {
            let inside: Vec<Node> = graph.op(node).operands().collect();
            let inside = graph.reachable(&inside, |_| true);
            let depths = keyed.iter().filter(|(_, n)| inside.contains(n));
            let depth = depths.map(|((d, ..), _)| d + 1).max().unwrap_or(0);
            let on_zeta = graph.depends_on(node, Variable::Zeta);
            keyed.push(((depth, graph.dependence(node).space(), on_zeta), node));
        }
        keyed.sort_by_key(|(key, n)| (*key, n.0));
        keyed
            .chunk_by(|(a, _), (b, _)| a == b)
            .map(|group| {
                let nodes: Vec<Node> = group.iter().map(|(_, n)| *n).collect();
                Self::new(graph, &nodes, group[0].0.2, horizon)
            })
            .collect()
    }

    fn new(graph: &Graph, nodes: &[Node], on_zeta: bool, horizon: f64) -> Self {
        let mut plan = Self {
            mask: graph.dependence(nodes[0]).space(),
            on_zeta,
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

    /// The expressions the tapes compute.
    pub(super) fn roots(&self) -> Vec<Node> {
        [self.integrands.as_slice(), &self.guards].concat()
    }

    pub(super) fn compile(&mut self, graph: &Graph, source: impl Fn(Node) -> Option<Source>) {
        self.tape = Tape::compile(graph, &self.integrands, &source);
        self.watch = Tape::compile(graph, &self.guards, &source);
    }

    /// The groups nested in this one.
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

    /// Over how many intervals the guards of an interval of this length are
    /// watched: wider panels, far beyond the horizon, have no more than the
    /// first.
    pub(super) fn watches(&self, length: f64) -> usize {
        let most = (self.width / self.watch_width).ceil();
        (length.abs() / self.watch_width).ceil().min(most) as usize
    }

    /// The time at which panel `p` begins; the same whatever is evaluated.
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
        // Rounding in the guess must not matter.
        while p > 0 && self.edge(p) > t {
            p -= 1;
        }
        while self.edge(p + 1) <= t {
            p += 1;
        }
        p
    }
}
