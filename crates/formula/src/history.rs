//! Groups of hereditary integrals.
//!
//! Integrals over the same coordinates and at one depth of nesting form a group, if their kernels are all exponential or
//! none is: one tape computes their integrands at common times.

use super::graph::{Graph, Node, Op, Variable};
use super::tape::{Integrals, Source, Tape};

/// Panels per horizon, unless fast relaxation needs more; unresolved parts are halved.
const PANELS: f64 = 4.0;
/// Times per horizon, and at least per piece, between which signs of guards are compared.
const WATCHES: f64 = 160.0;
const LEAST_WATCHES: f64 = 5.0;
/// Largest rate times panel width.
const STIFFEST: f64 = 4.0;
/// Limit of the refinement of panels.
const FINEST: f64 = 256.0;
/// Number of panels of equal width; as many of twice the width follow, and so on, to reach times far beyond the
/// horizon.
const UNIFORM: u64 = 4096;

#[derive(Debug)]
pub(super) enum Kernel {
    /// exp(-c (t-s))
    Exponential(f64),
    /// b(t-s)
    General(Tape),
}

/// One integral, by the numbers of its kernel and its integrand.
#[derive(Debug)]
pub(super) struct Member {
    pub(super) kernel: usize,
    pub(super) integrand: usize,
}

#[derive(Debug)]
pub(super) struct Group {
    /// The coordinates of which the integrals depend: bit 0 for x, 1 for y, 2 for z.
    pub(super) mask: u8,
    pub(super) on_zeta: bool,
    /// Whether the kernels are no exponentials.
    pub(super) general: bool,
    width: f64,
    watched: f64,
    pub(super) members: Vec<Member>,
    pub(super) kernels: Vec<Kernel>,
    /// The integrands.
    pub(super) tape: Tape,
    pub(super) guards: Tape,
}

/// All that a program evaluates.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) outputs: Tape,
    /// Groups of hereditary integrals, nested ones first.
    pub(super) groups: Vec<Group>,
    pub(super) adds_remainders: bool,
}

impl Group {
    /// The groups of all integrals in `outputs`, nested ones first.
    pub(super) fn all(
        graph: &Graph,
        outputs: &[Node],
        horizon: f64,
        integrals: &mut Integrals,
    ) -> Vec<Self> {
        let key = |&node: &Node| {
            let on_zeta = graph.depends_on(node, Variable::Zeta);
            let general = matches!(graph.op(node), Op::Convolve(..));
            (graph.past_depth(node), graph.dependence(node).space(), on_zeta, general)
        };
        let mut nodes = graph.reachable(outputs, |_| true);
        nodes.retain(|&node| graph.op(node).is_integral());
        nodes.sort_by_cached_key(|node| (key(node), node.0));
        let mut groups = Vec::new();
        for nodes in nodes.chunk_by(|a, b| key(a) == key(b)) {
            groups.push(Self::new(graph, nodes, horizon, integrals));
            let numbered = nodes.iter().enumerate();
            integrals.extend(numbered.map(|(member, &node)| (node, (groups.len() - 1, member))));
        }
        groups
    }

    fn new(graph: &Graph, nodes: &[Node], horizon: f64, integrals: &Integrals) -> Self {
        let (mut kernels, mut integrands, mut members) = (Vec::new(), Vec::new(), Vec::new());
        for &node in nodes {
            // Kernels by the bits of their rate, or by their formula.
            let (kernel, f) = match graph.op(node) {
                Op::Relax(c, f) => (Ok(c), f),
                Op::Convolve(b, f) => (Err(b), f),
                _ => continue,
            };
            members.push(Member {
                kernel: number(&mut kernels, kernel),
                integrand: number(&mut integrands, f),
            });
        }
        let mut guards = graph.guards(&integrands);
        guards.retain(|guard| graph.depends_on(*guard, Variable::T));
        let horizon = if horizon.is_finite() && horizon > 0.0 { horizon } else { 1.0 };
        let width = horizon / PANELS;
        let rates = kernels.iter().flatten().map(|&c| f64::from_bits(c).abs());
        let stiffness = rates.fold(0.0, f64::max) * width;
        let tape = |roots: &[Node]| Tape::compile(graph, roots, integrals, false);
        let kernel = |kernel: Result<u64, Node>| match kernel {
            Ok(c) => Kernel::Exponential(f64::from_bits(c)),
            Err(b) => Kernel::General(tape(&[b])),
        };
        Self {
            mask: graph.dependence(nodes[0]).space(),
            on_zeta: graph.depends_on(nodes[0], Variable::Zeta),
            general: matches!(graph.op(nodes[0]), Op::Convolve(..)),
            watched: horizon / WATCHES,
            width: width / (stiffness / STIFFEST).ceil().clamp(1.0, FINEST),
            members,
            tape: tape(&integrands),
            guards: tape(&guards),
            kernels: kernels.into_iter().map(kernel).collect(),
        }
    }

    /// The groups that the tapes read.
    pub(super) fn nested(&self) -> Vec<usize> {
        let of = |source| match source {
            Source::Integral(group, _) => Some(group),
            _ => None,
        };
        let mut groups: Vec<usize> = self.tape.sources().filter_map(of).collect();
        groups.sort_unstable();
        groups.dedup();
        groups
    }

    /// exp(-c lag) of each member; 0 for other kernels.
    pub(super) fn decays(&self, lag: f64) -> Vec<f64> {
        let of_kernel = |kernel: &Kernel| match kernel {
            Kernel::Exponential(c) => (-c * lag).exp(),
            Kernel::General(..) => 0.0,
        };
        let kernels: Vec<f64> = self.kernels.iter().map(of_kernel).collect();
        self.members.iter().map(|member| kernels[member.kernel]).collect()
    }

    /// The number of intervals of a piece at whose ends guards are compared.
    pub(super) fn watches(&self, width: f64) -> usize {
        (width / self.watched).ceil().clamp(LEAST_WATCHES, WATCHES) as usize
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

/// The number of an entry in a list, appended if it is new.
fn number<T: PartialEq>(list: &mut Vec<T>, entry: T) -> usize {
    list.iter().position(|known| *known == entry).unwrap_or_else(|| {
        list.push(entry);
        list.len() - 1
    })
}
