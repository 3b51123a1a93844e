//! Compilation: which values are stored, and where they are computed.
//!
//! An expression is computed at the stage of its space variables, once per distinct tuple of their values. What depends
//! on neither t nor zeta is computed when points are bound, and kept. A value needed at another stage is stored in a
//! slot; all others live in registers. Cheap expressions of coordinates are recomputed where needed, which is faster
//! than a lookup.

use std::collections::HashMap;
use std::sync::Arc;

use rustc_hash::FxHashSet;

use super::bound::BoundProgram;
use super::graph::{Graph, Node, Op, Variable};
use super::history::HistoryPlan;
use super::stage::MASKS;
use super::tape::{Source, Tape};

/// Largest cost, in sums or products, of what is recomputed.
const CHEAP: u32 = 16;

/// Expressions prepared for evaluation; bind to points to evaluate.
#[derive(Clone, Debug)]
pub struct Program {
    plan: Arc<EvaluationPlan>,
}

#[derive(Clone, Debug)]
pub(super) struct StageTape {
    pub(super) mask: u8,
    pub(super) tape: Tape,
    pub(super) slots: Vec<usize>,
}

#[derive(Clone, Debug, Default)]
pub(super) struct EvaluationPlan {
    /// The space variables of each slot.
    pub(super) masks: Vec<u8>,
    /// Slots of coordinates, with their axis.
    pub(super) coordinates: Vec<(usize, usize)>,
    pub(super) fixed: Vec<StageTape>,
    /// Stages computed at each evaluation, in order.
    pub(super) moving: Vec<StageTape>,
    /// Groups of hereditary integrals, nested ones first.
    pub(super) histories: Vec<HistoryPlan>,
    /// Slots of hereditary integrals: group, member, slot.
    pub(super) recalled: Vec<(usize, usize, usize)>,
    pub(super) outputs: Vec<usize>,
    pub(super) adds_remainders: bool,
}

impl Program {
    /// Prepares the outputs for times from 0 to about `horizon`. Later times are allowed; the panels of hereditary
    /// integrals are horizon/16 wide, narrower for fast relaxation.
    pub fn compile(graph: &Graph, outputs: &[Node], horizon: f64) -> Self {
        let histories = HistoryPlan::groups(graph, outputs, horizon);
        let mut compiler = Compiler::new(graph, &histories, outputs);
        let outputs = compiler.places_of_outputs(outputs);
        compiler.choose_slots(&outputs);
        let (mut plan, slots) = compiler.plan(&outputs);
        plan.histories = compile_histories(graph, histories, &slots);
        plan.adds_remainders = graph.adds_remainders;
        Self { plan: Arc::new(plan) }
    }

    /// Approximate bytes for `points` of a structured set in dimension `d`, evaluated up to time `t`; the number of
    /// distinct tuples is taken as a power of that of the points.
    pub fn bytes(&self, points: f64, d: usize, t: f64) -> f64 {
        let count = |mask: u8| points.powf((f64::from(mask.count_ones()) / d as f64).min(1.0));
        // The last stage is evaluated block by block.
        let shown = self.plan.moving.last().filter(|last| last.mask.count_ones() as usize == d);
        let kept = |(slot, mask): (usize, &u8)| {
            shown.is_none_or(|last| !last.slots.contains(&slot)).then_some(*mask)
        };
        let mut masks: Vec<u8> = self.plan.masks.iter().enumerate().filter_map(kept).collect();
        let slots: f64 = masks.iter().map(|&mask| 8.0 * count(mask)).sum();
        masks.sort_unstable();
        masks.dedup();
        // A number per point for its tuple, and one per tuple for its first point.
        let numbering: f64 = masks.iter().map(|&mask| 4.0 * (points + count(mask))).sum();
        let past = |history: &HistoryPlan| {
            let panels = if history.is_general() { 0 } else { history.panel(t) };
            8.0 * (history.members.len() * (panels + 1)) as f64 * count(history.mask)
        };
        let pasts: f64 = self.plan.histories.iter().map(past).sum();
        let coordinates = 24.0 * points;
        slots + numbering + pasts + coordinates
    }

    /// Binds the program to points; fixed values are computed here.
    pub fn bind(&self, points: &[[f64; 3]]) -> BoundProgram {
        BoundProgram::new(Arc::clone(&self.plan), points)
    }

    /// All outputs at these points at t alone.
    pub fn values(&self, points: &[[f64; 3]], t: f64, zeta: f64) -> Vec<Vec<f64>> {
        self.bind(points).values_at(t, zeta)
    }
}

/// An expression, and the space variables of the stage that stores it.
type Place = (Node, u8);
type Slots = HashMap<Place, usize>;

/// The space variables of a stage, and whether it is computed at binding.
type Stage = (u8, bool);

struct Compiler<'a> {
    graph: &'a Graph,
    histories: &'a [HistoryPlan],
    costs: Vec<u32>,
    slots: Slots,
    stored: Vec<Place>,
}

impl<'a> Compiler<'a> {
    fn new(graph: &'a Graph, histories: &'a [HistoryPlan], outputs: &[Node]) -> Self {
        // Guards are separate from what they guard.
        let inner = histories.iter().flat_map(HistoryPlan::roots);
        let costs = graph.costs(&outputs.iter().copied().chain(inner).collect::<Vec<Node>>());
        Self { graph, histories, costs, slots: Slots::new(), stored: Vec::new() }
    }

    fn space(&self, n: Node) -> u8 {
        self.graph.dependence(n).space()
    }

    fn is_fixed(&self, n: Node) -> bool {
        self.graph.dependence(n).is_static()
    }

    /// Whether a node is recomputed wherever it is needed.
    fn is_cheap(&self, n: Node) -> bool {
        self.space(n) != 0 && self.costs[n.index()] <= CHEAP
    }

    fn is_given(&self, n: Node) -> bool {
        is_hereditary(self.graph, n) || axis(self.graph, n).is_some()
    }

    fn is_local(&self, n: Node, stage: Stage) -> bool {
        let of_this_stage = || (self.space(n), self.is_fixed(n)) == stage;
        !self.is_given(n) && (self.is_cheap(n) || of_this_stage())
    }

    fn place(&self, n: Node, (mask, _): Stage) -> Place {
        (n, if axis(self.graph, n).is_some() { mask } else { self.space(n) })
    }

    fn store(&mut self, place: Place) {
        let next = self.stored.len();
        if let std::collections::hash_map::Entry::Vacant(entry) = self.slots.entry(place) {
            entry.insert(next);
            self.stored.push(place);
        }
    }

    /// Where outputs are stored: cheap ones at the common stage, others at theirs.
    fn places_of_outputs(&self, outputs: &[Node]) -> Vec<Place> {
        let all = outputs.iter().fold(0, |all, &n| all | self.space(n));
        let everywhere = |n: Node| self.is_cheap(n) || axis(self.graph, n).is_some();
        let mask = |n: Node| if everywhere(n) { all } else { self.space(n) };
        outputs.iter().map(|&n| (n, mask(n))).collect()
    }

    fn choose_slots(&mut self, outputs: &[Place]) {
        let graph = self.graph;
        outputs.iter().for_each(|&place| self.store(place));
        for history in self.histories {
            let inner = |n| !graph.dependence(n).is_static() && !is_hereditary(graph, n);
            for node in graph.reachable(&history.roots(), inner) {
                if graph.dependence(node).is_static() && !is_immediate(graph, node) {
                    self.store((node, self.space(node)));
                }
            }
        }
        let mut seen: FxHashSet<(Node, Stage)> = FxHashSet::default();
        let mut next = 0;
        while let Some(&(root, mask)) = self.stored.get(next) {
            next += 1;
            let stage = (mask, self.is_fixed(root));
            let mut stack = if self.is_given(root) { Vec::new() } else { vec![root] };
            while let Some(node) = stack.pop() {
                if !seen.insert((node, stage)) {
                    continue;
                }
                for operand in graph.op(node).operands() {
                    if self.is_local(operand, stage) {
                        stack.push(operand);
                    } else if !is_immediate(graph, operand) {
                        self.store(self.place(operand, stage));
                    }
                }
            }
        }
    }

    fn plan(self, outputs: &[Place]) -> (EvaluationPlan, Slots) {
        let mut plan = EvaluationPlan {
            masks: self.stored.iter().map(|(_, mask)| *mask).collect(),
            outputs: outputs.iter().filter_map(|place| self.slots.get(place).copied()).collect(),
            ..EvaluationPlan::default()
        };
        for (slot, &(node, _)) in self.stored.iter().enumerate() {
            plan.coordinates.extend(axis(self.graph, node).map(|axis| (slot, axis)));
            for (group, history) in self.histories.iter().enumerate() {
                let member = history.members.iter().position(|m| m.node == node);
                plan.recalled.extend(member.map(|member| (group, member, slot)));
            }
        }
        plan.recalled.sort_unstable();
        let mut masks: Vec<u8> = (0..MASKS as u8).collect();
        masks.sort_by_key(|m| m.count_ones());
        for mask in masks {
            plan.fixed.extend(self.stage((mask, true)));
            plan.moving.extend(self.stage((mask, false)));
        }
        (plan, self.slots)
    }

    fn stage(&self, stage: Stage) -> Option<StageTape> {
        let here = |(n, mask): Place| (mask, self.is_fixed(n)) == stage && !self.is_given(n);
        let (slots, roots): (Vec<usize>, Vec<Node>) = (self.stored.iter().enumerate())
            .filter(|(_, place)| here(**place))
            .map(|(slot, (n, _))| (slot, *n))
            .unzip();
        if roots.is_empty() {
            return None;
        }
        let tape = Tape::compile(self.graph, &roots, |n| {
            let slot = self.slots.get(&self.place(n, stage));
            slot.filter(|_| !self.is_local(n, stage)).map(|slot| Source::Slot(*slot))
        });
        Some(StageTape { mask: stage.0, tape, slots })
    }
}

fn compile_histories(
    graph: &Graph,
    mut histories: Vec<HistoryPlan>,
    slots: &Slots,
) -> Vec<HistoryPlan> {
    let mut places = HashMap::new();
    for (group, history) in histories.iter().enumerate() {
        for (member, integral) in history.members.iter().enumerate() {
            places.insert(integral.node, Source::Recall(group, member));
        }
    }
    for history in &mut histories {
        history.compile(graph, |n| {
            let dependence = graph.dependence(n);
            let slot = slots.get(&(n, dependence.space())).filter(|_| dependence.is_static());
            slot.map(|slot| Source::Slot(*slot)).or(places.get(&n).copied())
        });
    }
    histories
}

pub(super) fn is_hereditary(graph: &Graph, n: Node) -> bool {
    matches!(graph.op(n), Op::Relax(..) | Op::Convolve(..))
}

fn axis(graph: &Graph, n: Node) -> Option<usize> {
    match graph.op(n) {
        Op::Variable(v @ (Variable::X | Variable::Y | Variable::Z)) => Some(v as usize),
        _ => None,
    }
}

/// Values available to every tape: numbers, t and zeta.
fn is_immediate(graph: &Graph, n: Node) -> bool {
    matches!(graph.op(n), Op::Constant(_) | Op::Variable(Variable::T | Variable::Zeta))
}

#[cfg(test)]
mod tests {
    use super::super::scope::Scope;
    use super::*;

    /// Space variables of the computed slots, at binding and at each evaluation.
    fn computed(plan: &EvaluationPlan) -> [Vec<u8>; 2] {
        [&plan.fixed, &plan.moving].map(|stages| {
            let slots = stages.iter().flat_map(|stage| &stage.slots);
            slots.map(|&slot| plan.masks[slot]).collect()
        })
    }

    /// Of (1 - y²) sin(x) + x t the sine is kept for each x, and (1 - y²) computed at each point.
    #[test]
    fn what_is_cheap_is_not_stored() {
        let mut graph = Graph::new();
        let scope = Scope::new(&[Variable::X, Variable::Y, Variable::T]);
        let texts = ["(1 - y^2)*sin(x) + x*t", "y + 1", "exp(t)"];
        let outputs = texts.map(|text| graph.parse(text, &scope).expect("a formula"));
        let both = 0b11;
        let plan = Program::compile(&graph, &outputs, 1.0).plan;
        // (1 - y²) sin(x) and y + 1 are fixed.
        assert_eq!(computed(&plan), [vec![0b01, both, both], vec![0, both]]);
        assert_eq!(plan.coordinates.len(), 3);
    }
}
