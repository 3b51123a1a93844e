//! Programs bound to points.

use std::convert::Infallible;
use std::ops::Range;
use std::sync::Arc;

use super::block::{BLOCK, Registers};
use super::history::HistoryPlan;
use super::past::Past;
use super::program::{EvaluationPlan, StageTape};
use super::sampler::Surroundings;
use super::stage::Stages;
use super::tape::{Register, Source};

/// A program bound to points, with its fixed values, the past of hereditary integrals and scratch memory.
///
/// Values at (t, zeta) are independent of earlier evaluations and of the other points, to the last bit.
#[derive(Clone, Debug)]
pub struct BoundProgram {
    plan: Arc<EvaluationPlan>,
    points: usize,
    stages: Stages,
    slots: Vec<Vec<f64>>,
    /// Number of moving stages that write slots: all, or all but the last if that has a lane per point.
    stored: usize,
    /// The slot of each output, its register if the last stage computes it, and its values on a block.
    outputs: Vec<(usize, Option<Register>, Vec<f64>)>,
    pasts: Vec<Past>,
    registers: Registers,
    taken: Vec<Vec<f64>>,
    /// Time and zeta of the integrals in slots.
    recalled_at: Option<[u64; 2]>,
    /// The zeta for which tables are valid.
    zeta: u64,
    tuples: Vec<u32>,
    times: Vec<f64>,
    values: Vec<f64>,
}

impl BoundProgram {
    /// A plan at points.
    pub(super) fn new(plan: Arc<EvaluationPlan>, points: &[[f64; 3]]) -> Self {
        let (masks, pairs) = plan.stages();
        let stages = Stages::new(points, &masks, &pairs);
        // Only outputs read slots of the last stage.
        let last = plan.moving.last().filter(|last| stages.count(last.mask) == points.len());
        let computed = |slot: usize| {
            let place = last?.slots.iter().position(|&result| result == slot)?;
            Some(last?.tape.results[place])
        };
        let output = |&slot: &usize| (slot, computed(slot), Vec::new());
        let outputs = plan.outputs.iter().map(output).collect();
        let room = |(slot, &mask): (usize, &u8)| match computed(slot) {
            Some(_) => Vec::new(),
            None => vec![0.0; stages.count(mask)],
        };
        let mut slots: Vec<Vec<f64>> = plan.masks.iter().enumerate().map(room).collect();
        for &(slot, axis) in &plan.coordinates {
            let first = stages.first_points(plan.masks[slot]);
            slots[slot] = first.iter().map(|&p| points[p as usize][axis]).collect();
        }
        let past = |(group, history): (usize, &HistoryPlan)| {
            Past::new(history, group, stages.count(history.mask))
        };
        let pasts = plan.histories.iter().enumerate().map(past).collect();
        let mut bound = Self {
            plan: Arc::clone(&plan),
            points: points.len(),
            stored: plan.moving.len() - usize::from(last.is_some()),
            stages,
            slots,
            outputs,
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

    pub fn points(&self) -> usize {
        self.points
    }

    /// Evaluates all outputs: `out[i][p]` becomes output i at point p. Vectors are resized to the number of points;
    /// entries of `out` beyond the outputs are left alone.
    pub fn evaluate(&mut self, t: f64, zeta: f64, out: &mut [Vec<f64>]) {
        out.iter_mut().take(self.outputs.len()).for_each(Vec::clear);
        let Ok(()) = self.evaluate_in_blocks(t, zeta, BLOCK, |_, values| {
            out.iter_mut().zip(values).for_each(|(out, values)| out.extend_from_slice(values));
            Ok::<(), Infallible>(())
        });
    }

    /// All outputs at t, as [`Self::evaluate`] has them.
    pub fn values_at(&mut self, t: f64, zeta: f64) -> Vec<Vec<f64>> {
        let mut out = vec![Vec::new(); self.outputs.len()];
        self.evaluate(t, zeta, &mut out);
        out
    }

    /// Evaluates all outputs block by block, a few hundred points that stay in cache. `visit` gets the range of points
    /// and the values of each output there.
    ///
    /// # Errors
    /// The error of `visit`, which is not called again.
    pub fn evaluate_in_blocks<E>(
        &mut self,
        t: f64,
        zeta: f64,
        length: usize,
        mut visit: impl FnMut(Range<usize>, &[&[f64]]) -> Result<(), E>,
    ) -> Result<(), E> {
        let plan = Arc::clone(&self.plan);
        self.recall(&plan, t, zeta);
        for stage in &plan.moving[..self.stored] {
            self.run(stage, t, zeta);
        }
        let Self { stages, slots, registers, outputs, .. } = self;
        for start in (0..self.points).step_by(length.max(1)) {
            let lanes = start..self.points.min(start + length.max(1));
            if let Some(last) = plan.moving.get(self.stored) {
                let inputs =
                    Inputs { stages, slots, masks: &plan.masks, stage: last.mask, t, zeta };
                let fetch = |source, out: &mut [f64]| inputs.fetch(source, &lanes, out);
                registers.run(&last.tape, lanes.len(), fetch);
            }
            for (slot, register, values) in outputs.iter_mut() {
                values.clear();
                match register {
                    Some(register) => {
                        values.extend_from_slice(registers.lanes(*register, lanes.len()))
                    }
                    None => {
                        let tuples = &stages.of_points(plan.masks[*slot])[lanes.clone()];
                        values.extend(tuples.iter().map(|&tuple| slots[*slot][tuple as usize]));
                    }
                }
            }
            let values: Vec<&[f64]> = outputs.iter().map(|(_, _, values)| &values[..]).collect();
            visit(lanes, &values)?;
        }
        Ok(())
    }

    fn recall(&mut self, plan: &Arc<EvaluationPlan>, t: f64, zeta: f64) {
        let now = [t.to_bits(), zeta.to_bits()];
        if self.recalled_at == Some(now) || plan.recalled.is_empty() || self.points == 0 {
            return;
        }
        self.recalled_at = Some(now);
        self.take_zeta(zeta);
        let mut last = None;
        for &(group, member, slot) in &plan.recalled {
            let history = &plan.histories[group];
            if last != Some(group) {
                last = Some(group);
                self.values_of(group, t, zeta);
            }
            let values = self.values.iter().skip(member);
            let values = values.step_by(history.members.len());
            let pairs = self.slots[slot].iter_mut().zip(values);
            pairs.for_each(|(slot, value)| *slot = *value);
        }
    }

    fn take_zeta(&mut self, zeta: f64) {
        if self.zeta == zeta.to_bits() {
            return;
        }
        self.zeta = zeta.to_bits();
        for (past, history) in self.pasts.iter_mut().zip(&self.plan.histories) {
            if history.on_zeta {
                past.reset();
            }
        }
    }

    fn values_of(&mut self, group: usize, t: f64, zeta: f64) {
        let Self { plan, stages, slots, pasts, tuples, times, values, .. } = self;
        let count = stages.count(plan.histories[group].mask);
        tuples.clear();
        tuples.extend(0..count as u32);
        times.clear();
        times.resize(count, t);
        let (below, rest) = pasts.split_at_mut(group);
        rest[0].values(below, Surroundings { plan, stages, slots, zeta }, tuples, times, values);
    }

    fn run(&mut self, stage: &StageTape, t: f64, zeta: f64) {
        let slots = &mut self.slots;
        self.taken.clear();
        self.taken.extend(stage.slots.iter().map(|&slot| std::mem::take(&mut slots[slot])));
        let (slots, stages, masks) = (&self.slots, &self.stages, &self.plan.masks);
        let inputs = Inputs { stages, slots, masks, stage: stage.mask, t, zeta };
        let count = stages.count(stage.mask);
        for start in (0..count).step_by(BLOCK) {
            let lanes = start..count.min(start + BLOCK);
            let fetch = |source, out: &mut [f64]| inputs.fetch(source, &lanes, out);
            self.registers.run(&stage.tape, lanes.len(), fetch);
            for (values, &result) in self.taken.iter_mut().zip(&stage.tape.results) {
                values[lanes.clone()].copy_from_slice(self.registers.lanes(result, lanes.len()));
            }
        }
        for (&slot, values) in stage.slots.iter().zip(&mut self.taken) {
            self.slots[slot] = std::mem::take(values);
        }
    }
}

struct Inputs<'a> {
    stages: &'a Stages,
    slots: &'a [Vec<f64>],
    masks: &'a [u8],
    stage: u8,
    t: f64,
    zeta: f64,
}

impl Inputs<'_> {
    #[inline(always)]
    fn fetch(&self, source: Source, lanes: &Range<usize>, out: &mut [f64]) {
        let Self { stages, slots, masks, stage, t, zeta } = *self;
        match source {
            Source::Time => out.fill(t),
            Source::Zeta => out.fill(zeta),
            Source::Slot(slot) if masks[slot] == stage => {
                out.copy_from_slice(&slots[slot][lanes.clone()]);
            }
            Source::Slot(slot) if masks[slot] == 0 => out.fill(slots[slot][0]),
            Source::Slot(slot) => {
                let map = &stages.map(stage, masks[slot])[lanes.clone()];
                let values = &slots[slot];
                for (out, &tuple) in out.iter_mut().zip(map) {
                    *out = values[tuple as usize];
                }
            }
            // Integrals are read from slots here.
            Source::Recall(..) => out.fill(f64::NAN),
        }
    }
}

impl EvaluationPlan {
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
