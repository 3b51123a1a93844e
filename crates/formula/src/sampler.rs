//! Runs tapes of integrands at lanes that each have a tuple and a time.

use std::sync::Arc;

use super::block::{BLOCK, Registers};
use super::past::Past;
use super::program::EvaluationPlan;
use super::stage::Stages;
use super::tape::{Source, Tape};

/// What integrals may read; fixed while they run.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub(super) plan: &'a Arc<EvaluationPlan>,
    pub(super) stages: &'a Stages,
    pub(super) slots: &'a [Vec<f64>],
    pub(super) zeta: f64,
}

impl Surroundings<'_> {
    /// Reads a slot at tuples of the stage `mask`.
    fn gather(&self, mask: u8, slot: usize, tuples: &[u32], out: &mut [f64]) {
        let values = &self.slots[slot];
        let part = self.plan.masks[slot];
        if part == mask {
            for (out, &tuple) in out.iter_mut().zip(tuples) {
                *out = values[tuple as usize];
            }
        } else if part == 0 {
            out.fill(values[0]);
        } else {
            let map = self.stages.map(mask, part);
            for (out, &tuple) in out.iter_mut().zip(tuples) {
                *out = values[map[tuple as usize] as usize];
            }
        }
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Sampler {
    pub(super) tuples: Vec<u32>,
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<Vec<f64>>,
    registers: Registers,
    inner_tuples: Vec<u32>,
    recalled: Vec<(usize, Vec<f64>)>,
}

impl Sampler {
    pub(super) fn new(nested: &[usize]) -> Self {
        Self {
            recalled: nested.iter().map(|&group| (group, Vec::new())).collect(),
            ..Self::default()
        }
    }

    pub(super) fn clear(&mut self) {
        self.tuples.clear();
        self.times.clear();
    }

    pub(super) fn extend(&mut self, tuple: u32, times: impl ExactSizeIterator<Item = f64>) {
        self.tuples.extend(std::iter::repeat_n(tuple, times.len()));
        self.times.extend(times);
    }

    /// Runs `tape` at all lanes; tuples belong to the stage `mask`, and `below` are the groups that may be nested in
    /// this one.
    pub(super) fn run(&mut self, tape: &Tape, mask: u8, below: &mut [Past], all: Surroundings) {
        let count = self.tuples.len();
        self.values.resize_with(tape.results.len(), Vec::new);
        self.values.iter_mut().for_each(|v| v.resize(count, 0.0));
        for start in (0..count).step_by(BLOCK) {
            let lanes = start..count.min(start + BLOCK);
            self.recall(lanes.clone(), mask, below, all);
            let (tuples, times) = (&self.tuples[lanes.clone()], &self.times[lanes.clone()]);
            let recalled = &self.recalled;
            self.registers.run(tape, lanes.len(), |source, out| match source {
                Source::Time => out.copy_from_slice(times),
                Source::Zeta => out.fill(all.zeta),
                Source::Slot(slot) => all.gather(mask, slot, tuples, out),
                Source::Recall(group, member) => {
                    let members = all.plan.histories[group].members.len();
                    let values = recalled.iter().find(|(g, _)| *g == group);
                    let values = values.map_or(&[][..], |(_, v)| v);
                    let mine = values.iter().skip(member).step_by(members);
                    out.iter_mut().zip(mine).for_each(|(out, v)| *out = *v);
                }
            });
            for (values, &result) in self.values.iter_mut().zip(&tape.results) {
                values[lanes.clone()].copy_from_slice(self.registers.lanes(result, lanes.len()));
            }
        }
    }

    fn recall(
        &mut self,
        lanes: std::ops::Range<usize>,
        mask: u8,
        below: &mut [Past],
        all: Surroundings,
    ) {
        for (group, values) in &mut self.recalled {
            let part = all.plan.histories[*group].mask;
            let map = all.stages.map(mask, part);
            self.inner_tuples.clear();
            let tuples = self.tuples[lanes.clone()].iter();
            self.inner_tuples.extend(tuples.map(|&tuple| match part {
                _ if part == mask => tuple,
                _ => map[tuple as usize],
            }));
            let (lower, rest) = below.split_at_mut(*group);
            let times = &self.times[lanes.clone()];
            rest[0].values(lower, all, &self.inner_tuples, times, values);
        }
    }
}
