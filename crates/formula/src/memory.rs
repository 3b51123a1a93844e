//! Stored integrands over all past panels, for kernels without a recursion.

use super::breaks::{Lane, Piece};
use super::history::{HistoryPlan, Kernel};
use super::past::{dot, lacking};
use super::quadrature::ORDER;
use super::weights::{STRIDE, Weights};

/// One panel: pieces sorted by tuple, and the integrands at their points.
#[derive(Clone, Debug, Default)]
struct Panel {
    starts: Vec<usize>,
    pieces: Vec<(f64, f64)>,
    /// [`ORDER`] values for each integrand of each piece.
    values: Vec<f64>,
    left: Vec<bool>,
}

/// The panels so far, and the weights of unbroken panels for one time.
#[derive(Clone, Debug, Default)]
pub(super) struct PastPanels {
    panels: Vec<Panel>,
    time: Option<u64>,
    whole: Vec<Vec<f64>>,
    /// Pieces of the current panel, whether they are unresolved, and their values.
    kept: Vec<(Piece, bool)>,
    kept_values: Vec<f64>,
}

impl HistoryPlan {
    pub(super) fn is_general(&self) -> bool {
        let general = |k: &Kernel| matches!(k, Kernel::General(..));
        self.kernels.iter().any(general)
    }

    fn remembered(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let general = |(_, m): &(usize, &super::history::Member)| {
            matches!(self.kernels[m.kernel], Kernel::General(..))
        };
        let members = self.members.iter().enumerate().filter(general);
        members.map(|(k, m)| (k, m.kernel, m.integrand))
    }
}

impl PastPanels {
    /// Keeps the integrands on piece k of those sampled until [`Self::put_away`].
    pub(super) fn keep(
        &mut self,
        plan: &HistoryPlan,
        (k, piece): (usize, &Piece),
        left: bool,
        values: &[Vec<f64>],
    ) {
        self.kept.push((*piece, left));
        for (_, _, integrand) in plan.remembered() {
            self.kept_values.extend_from_slice(&values[integrand][k * ORDER..][..ORDER]);
        }
    }

    /// Moves kept pieces into panels; each lane is the next tuple of its panel.
    pub(super) fn put_away(
        &mut self,
        plan: &HistoryPlan,
        panel: impl Fn(usize) -> usize,
        lanes: usize,
    ) {
        let length = plan.remembered().count() * ORDER;
        let mut order: Vec<usize> = (0..self.kept.len()).collect();
        order.sort_by_key(|&k| self.kept[k].0.lane);
        let mut next = order.into_iter().peekable();
        for lane in 0..lanes {
            let index = panel(lane);
            self.panels.resize_with(self.panels.len().max(index + 1), Panel::default);
            let panel = &mut self.panels[index];
            panel.starts.push(panel.pieces.len());
            while let Some(k) = next.next_if(|&k| self.kept[k].0.lane as usize == lane) {
                let (piece, left) = self.kept[k];
                panel.pieces.push((piece.from, piece.to));
                panel.left.push(left);
                panel.values.extend_from_slice(&self.kept_values[k * length..][..length]);
            }
        }
        self.kept.clear();
        self.kept_values.clear();
    }

    /// Adds the integrals over all panels before `panel`, and their error estimates.
    pub(super) fn add(
        &mut self,
        plan: &HistoryPlan,
        weights: &mut Weights,
        panel: usize,
        lane: &Lane,
        [out, remainders]: [&mut [f64]; 2],
    ) {
        let count = plan.remembered().count();
        if count == 0 {
            return;
        }
        self.prepare(plan, weights, panel, lane.to);
        let tuple = lane.tuple as usize;
        for (index, panel) in self.panels.iter().enumerate().take(panel) {
            let edges = (plan.edge(index), plan.edge(index + 1));
            let end = panel.starts.get(tuple + 1).copied();
            for k in panel.starts[tuple]..end.unwrap_or(panel.pieces.len()) {
                let piece = panel.pieces[k];
                let weights = if piece == edges {
                    self.whole[index].as_slice()
                } else {
                    weights.of(plan, piece.0, piece.1, lane.to)
                };
                for (place, (member, kernel, _)) in plan.remembered().enumerate() {
                    let values = &panel.values[(k * count + place) * ORDER..][..ORDER];
                    let weights = &weights[kernel * STRIDE..][..STRIDE];
                    out[member] += dot(weights, values);
                    let left = panel.left[k];
                    if left || weights[ORDER] > 0.0 {
                        remainders[member] += lacking(weights, values, left);
                    }
                }
            }
        }
    }

    fn prepare(&mut self, plan: &HistoryPlan, weights: &mut Weights, panels: usize, t: f64) {
        if self.time != Some(t.to_bits()) {
            self.time = Some(t.to_bits());
            self.whole.clear();
        }
        for p in self.whole.len()..panels {
            let (from, to) = (plan.edge(p), plan.edge(p + 1));
            self.whole.push(weights.of(plan, from, to, t).to_vec());
        }
    }
}
