//! Compilation: which values are stored, at which stage, and how they are
//! computed.
//!
//! An expression is computed at the stage of the space variables it depends
//! on, once per distinct tuple of their values.  What depends on neither t nor
//! zeta is fixed: computed when points are bound, and kept.  A value is stored
//! in a slot where an expression of another stage needs it; all others live in
//! registers.

use std::collections::HashMap;
use std::sync::Arc;

use super::bound::Bound;
use super::graph::{Graph, Node, Op, Variable};
use super::history::HistoryPlan;
use super::stage::MASKS;
use super::tape::{Source, Tape};

/// Expressions prepared for evaluation; bind to points to evaluate.
#[derive(Clone, Debug)]
pub struct Program {
    plan: Arc<Plan>,
}

/// The tape of one stage and the slots its results go to.
#[derive(Clone, Debug)]
pub(super) struct StageTape {
    pub(super) mask: u8,
    pub(super) tape: Tape,
    pub(super) slots: Vec<usize>,
}

/// All that does not depend on the points.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    /// The space variables of each slot.
    pub(super) masks: Vec<u8>,
    /// Slots of coordinates, with their axis.
    pub(super) coordinates: Vec<(usize, usize)>,
    /// Stages computed at binding, in order.
    pub(super) fixed: Vec<StageTape>,
    /// Stages computed at each evaluation, in order.
    pub(super) moving: Vec<StageTape>,
    /// Hereditary integrals in groups, those inside others first.
    pub(super) histories: Vec<HistoryPlan>,
    /// Slots of hereditary integrals: group, member, slot.
    pub(super) recalled: Vec<(usize, usize, usize)>,
    /// The slot of each output.
    pub(super) outputs: Vec<usize>,
}

impl Program {
    /// Prepares the outputs for evaluation over times from 0 to about
    /// `horizon`.  Later times are allowed; the horizon sets the panels of
    /// hereditary integrals, horizon/16 wide and narrower for fast relaxation.
    pub fn compile(graph: &mut Graph, outputs: &[Node], horizon: f64) -> Self {
        let histories = HistoryPlan::groups(graph, outputs, horizon);
        let mut compiler = Compiler::new(graph, &histories);
        compiler.choose_slots(outputs);
        let (mut plan, slots) = compiler.plan(outputs);
        plan.histories = compile_histories(graph, histories, &slots);
        Self { plan: Arc::new(plan) }
    }

    /// Bytes that the program takes for so many points of a structured set, in a space of dimension `d`, once it has been
    /// evaluated up to time `t`: about, for the distinct tuples of some variables alone are a power of the points.
    pub fn bytes(&self, points: f64, d: usize, t: f64) -> f64 {
        let count = |mask: u8| points.powf((f64::from(mask.count_ones()) / d as f64).min(1.0));
        // What is computed last is shown block by block.
        let shown = self.plan.moving.last().filter(|last| last.mask.count_ones() as usize == d);
        let kept = |(slot, mask): (usize, &u8)| {
            shown.is_none_or(|last| !last.slots.contains(&slot)).then_some(*mask)
        };
        let mut masks: Vec<u8> = self.plan.masks.iter().enumerate().filter_map(kept).collect();
        let slots: f64 = masks.iter().map(|&mask| 8.0 * count(mask)).sum();
        masks.sort_unstable();
        masks.dedup();
        // A number a point for its tuple, and one a tuple for its first point.
        let numbering: f64 = masks.iter().map(|&mask| 4.0 * (points + count(mask))).sum();
        let past = |history: &HistoryPlan| {
            8.0 * (history.members.len() * (history.panel(t) + 1)) as f64 * count(history.mask)
        };
        let pasts: f64 = self.plan.histories.iter().map(past).sum();
        let coordinates = 24.0 * points;
        slots + numbering + pasts + coordinates
    }

    /// Binds the program to points; fixed values are computed here.
    pub fn bind(&self, points: &[[f64; 3]]) -> Bound {
        Bound::new(Arc::clone(&self.plan), points)
    }
}

type Slots = HashMap<Node, usize>;

struct Compiler<'a> {
    graph: &'a Graph,
    histories: &'a [HistoryPlan],
    slots: Slots,
    /// The nodes of the slots, in order.
    stored: Vec<Node>,
}

impl<'a> Compiler<'a> {
    fn new(graph: &'a Graph, histories: &'a [HistoryPlan]) -> Self {
        Self { graph, histories, slots: Slots::new(), stored: Vec::new() }
    }

    fn store(&mut self, node: Node) {
        let next = self.stored.len();
        if let std::collections::hash_map::Entry::Vacant(entry) = self.slots.entry(node) {
            entry.insert(next);
            self.stored.push(node);
        }
    }

    /// Stores what crosses from one stage to another.
    fn choose_slots(&mut self, outputs: &[Node]) {
        let graph = self.graph;
        outputs.iter().for_each(|&output| self.store(output));
        let stage = |n: Node| (graph.dependence(n).space(), graph.dependence(n).is_static());
        for node in graph.reachable(outputs, |n| !is_hereditary(graph, n)) {
            if is_hereditary(graph, node) {
                self.store(node);
                continue;
            }
            for operand in graph.op(node).operands() {
                if stage(operand) != stage(node) && !is_immediate(graph, operand) {
                    self.store(operand);
                }
            }
        }
        for history in self.histories {
            let inner = |n| !graph.dependence(n).is_static() && !is_hereditary(graph, n);
            for node in graph.reachable(&history.roots(), inner) {
                if graph.dependence(node).is_static() && !is_immediate(graph, node) {
                    self.store(node);
                }
            }
        }
        let mut fixed = self.stored.clone();
        fixed.retain(|&n| graph.dependence(n).is_static());
        for node in graph.reachable(&fixed, |_| true) {
            if let Op::Variable(_) = graph.op(node) {
                self.store(node);
            }
            for operand in graph.op(node).operands() {
                if stage(operand) != stage(node) && !is_immediate(graph, operand) {
                    self.store(operand);
                }
            }
        }
    }

    fn plan(self, outputs: &[Node]) -> (Plan, Slots) {
        let graph = self.graph;
        let mut plan = Plan {
            masks: self.stored.iter().map(|&n| graph.dependence(n).space()).collect(),
            outputs: outputs.iter().filter_map(|n| self.slots.get(n).copied()).collect(),
            ..Plan::default()
        };
        for (slot, &node) in self.stored.iter().enumerate() {
            if let Op::Variable(v @ (Variable::X | Variable::Y | Variable::Z)) = graph.op(node) {
                plan.coordinates.push((slot, v as usize));
            }
            for (group, history) in self.histories.iter().enumerate() {
                let member = history.members.iter().position(|m| m.node == node);
                plan.recalled.extend(member.map(|member| (group, member, slot)));
            }
        }
        plan.recalled.sort_unstable();
        let mut masks: Vec<u8> = (0..MASKS as u8).collect();
        masks.sort_by_key(|m| m.count_ones());
        for mask in masks {
            plan.fixed.extend(self.stage(mask, true));
            plan.moving.extend(self.stage(mask, false));
        }
        (plan, self.slots)
    }

    /// The tape of the slots of one stage that are computed.
    fn stage(&self, mask: u8, fixed: bool) -> Option<StageTape> {
        let graph = self.graph;
        let here = |n: Node| {
            graph.dependence(n).space() == mask && graph.dependence(n).is_static() == fixed
        };
        let given = |n: Node| {
            is_hereditary(graph, n)
                || matches!(graph.op(n), Op::Variable(Variable::X | Variable::Y | Variable::Z))
        };
        let (slots, roots): (Vec<usize>, Vec<Node>) = (self.stored.iter().enumerate())
            .filter(|(_, n)| here(**n) && !given(**n))
            .map(|(slot, n)| (slot, *n))
            .unzip();
        if roots.is_empty() {
            return None;
        }
        let tape = Tape::compile(graph, &roots, |n| {
            let elsewhere = !here(n) || given(n);
            let slot = self.slots.get(&n).filter(|_| elsewhere);
            slot.map(|slot| Source::Slot(*slot))
        });
        Some(StageTape { mask, tape, slots })
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
            let slot = slots.get(&n).filter(|_| graph.dependence(n).is_static());
            slot.map(|slot| Source::Slot(*slot)).or(places.get(&n).copied())
        });
    }
    histories
}

pub(super) fn is_hereditary(graph: &Graph, n: Node) -> bool {
    matches!(graph.op(n), Op::Relax(..) | Op::Convolve(..))
}

/// Values every tape has at hand: numbers, t and zeta.
fn is_immediate(graph: &Graph, n: Node) -> bool {
    matches!(graph.op(n), Op::Constant(_) | Op::Variable(Variable::T | Variable::Zeta))
}
