//! Programs at points.

use std::sync::Arc;

use super::block::{BLOCK, Registers};
use super::past::Past;
use super::program::{Plan, StageTape};
use super::sampler::Surroundings;
use super::stage::Stages;
use super::tape::Source;

/// A program bound to points: holds fixed values, the past of hereditary
/// integrals, and scratch memory.
///
/// Values at (t, zeta) do not depend on what was evaluated before, nor on the
/// other points, to the last bit.
#[derive(Clone, Debug)]
pub struct Bound {
    plan: Arc<Plan>,
    points: usize,
    stages: Stages,
    slots: Vec<Vec<f64>>,
    pasts: Vec<Past>,
    registers: Registers,
    /// Slots taken out while a stage writes them.
    taken: Vec<Vec<f64>>,
    /// Time and zeta of the hereditary integrals now in slots.
    recalled_at: Option<[u64; 2]>,
    /// The zeta of tables that depend on it.
    zeta: u64,
    tuples: Vec<u32>,
    times: Vec<f64>,
    values: Vec<f64>,
}

impl Bound {
    pub(super) fn new(plan: Arc<Plan>, points: &[[f64; 3]]) -> Self {
        let (masks, pairs) = plan.stages();
        let stages = Stages::new(points, &masks, &pairs);
        let mut slots: Vec<Vec<f64>> =
            plan.masks.iter().map(|&mask| vec![0.0; stages.count(mask)]).collect();
        for &(slot, axis) in &plan.coordinates {
            let first = stages.first_points(plan.masks[slot]);
            slots[slot] = first.iter().map(|&p| points[p as usize][axis]).collect();
        }
        let pasts = plan
            .histories
            .iter()
            .enumerate()
            .map(|(group, history)| Past::new(history, group, stages.count(history.mask)))
            .collect();
        let mut bound = Self {
            plan: Arc::clone(&plan),
            points: points.len(),
            stages,
            slots,
            pasts,
            registers: Registers::default(),
            taken: Vec::new(),
            recalled_at: None,
            zeta: 0,
            tuples: Vec::new(),
            times: Vec::new(),
            values: Vec::new(),
        };
        for stage in &plan.fixed {
            bound.run(stage, 0.0, 0.0);
        }
        bound
    }

    /// The number of points.
    pub fn points(&self) -> usize {
        self.points
    }

    /// Evaluates all outputs: `out[i][p]` becomes output i at point p.  Each
    /// vector is given the length of the points; `out` beyond the number of
    /// outputs is left alone.
    pub fn evaluate(&mut self, t: f64, zeta: f64, out: &mut [Vec<f64>]) {
        let plan = Arc::clone(&self.plan);
        self.recall(&plan, t, zeta);
        for stage in &plan.moving {
            self.run(stage, t, zeta);
        }
        for (&slot, out) in plan.outputs.iter().zip(out) {
            let values = &self.slots[slot];
            let of_points = self.stages.of_points(plan.masks[slot]);
            out.clear();
            if values.len() == self.points {
                // Tuples are numbered as they appear: these are the points.
                out.extend_from_slice(values);
            } else {
                out.extend(of_points.iter().map(|&tuple| values[tuple as usize]));
            }
        }
    }

    /// Puts the hereditary integrals at time t into their slots.
    fn recall(&mut self, plan: &Plan, t: f64, zeta: f64) {
        let now = [t.to_bits(), zeta.to_bits()];
        if self.recalled_at == Some(now) || plan.recalled.is_empty() || self.points == 0 {
            return;
        }
        self.recalled_at = Some(now);
        if self.zeta != zeta.to_bits() {
            self.zeta = zeta.to_bits();
            for (past, history) in self.pasts.iter_mut().zip(&plan.histories) {
                if history.on_zeta {
                    past.reset();
                }
            }
        }
        let mut last = None;
        for &(group, member, slot) in &plan.recalled {
            let history = &plan.histories[group];
            if last != Some(group) {
                last = Some(group);
                let count = self.stages.count(history.mask);
                self.tuples.clear();
                self.tuples.extend(0..count as u32);
                self.times.clear();
                self.times.resize(count, t);
                let all = Surroundings { plan, stages: &self.stages, slots: &self.slots, zeta };
                let (below, rest) = self.pasts.split_at_mut(group);
                rest[0].values(below, all, &self.tuples, &self.times, &mut self.values);
            }
            let values = self.values.iter().skip(member);
            let values = values.step_by(history.members.len());
            let pairs = self.slots[slot].iter_mut().zip(values);
            pairs.for_each(|(slot, value)| *slot = *value);
        }
    }

    /// Runs the tape of one stage over all its tuples.
    fn run(&mut self, stage: &StageTape, t: f64, zeta: f64) {
        let slots = &mut self.slots;
        self.taken.clear();
        self.taken.extend(stage.slots.iter().map(|&slot| std::mem::take(&mut slots[slot])));
        let count = self.stages.count(stage.mask);
        for start in (0..count).step_by(BLOCK) {
            let lanes = start..count.min(start + BLOCK);
            let (slots, stages, masks) = (&self.slots, &self.stages, &self.plan.masks);
            self.registers.run(&stage.tape, lanes.len(), |source, out| match source {
                Source::Time => out.fill(t),
                Source::Zeta => out.fill(zeta),
                Source::Slot(slot) if masks[slot] == stage.mask => {
                    out.copy_from_slice(&slots[slot][lanes.clone()]);
                }
                Source::Slot(slot) if masks[slot] == 0 => out.fill(slots[slot][0]),
                Source::Slot(slot) => {
                    let map = &stages.map(stage.mask, masks[slot])[lanes.clone()];
                    let values = &slots[slot];
                    for (out, &tuple) in out.iter_mut().zip(map) {
                        *out = values[tuple as usize];
                    }
                }
                // Integrals are read from slots here.
                Source::Recall(..) => out.fill(f64::NAN),
            });
            for (values, &result) in self.taken.iter_mut().zip(&stage.tape.results) {
                values[lanes.clone()].copy_from_slice(self.registers.lanes(result, lanes.len()));
            }
        }
        for (&slot, values) in stage.slots.iter().zip(&mut self.taken) {
            self.slots[slot] = std::mem::take(values);
        }
    }
}

impl Plan {
    /// The sets of space variables in use, and the pairs to be mapped.
    fn stages(&self) -> (Vec<u8>, Vec<(u8, u8)>) {
        let mut masks = self.masks.clone();
        let mut pairs = Vec::new();
        let tapes = self.fixed.iter().chain(&self.moving).map(|s| (s.mask, &s.tape));
        let inner = self.histories.iter().flat_map(|h| [(h.mask, &h.tape), (h.mask, &h.watch)]);
        for (mask, tape) in tapes.chain(inner) {
            masks.push(mask);
            for source in tape.sources() {
                let part = match source {
                    Source::Slot(slot) => self.masks[slot],
                    Source::Recall(group, _) => self.histories[group].mask,
                    Source::Time | Source::Zeta => continue,
                };
                if part != mask {
                    pairs.push((mask, part));
                }
            }
        }
        masks.extend(self.histories.iter().map(|h| h.mask));
        pairs.sort_unstable();
        pairs.dedup();
        (masks, pairs)
    }
}
