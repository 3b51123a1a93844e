//! Integrands over all past panels, for kernels without a recursion.

use super::breaks::{Lane, Piece};
use super::history::{HistoryPlan, Kernel};
use super::past::dot;
use super::quadrature::ORDER;
use super::weights::Weights;

/// One panel: its pieces by tuples, and the integrands at their points.
#[derive(Clone, Debug, Default)]
struct Panel {
    /// The first piece of each tuple.
    starts: Vec<usize>,
    pieces: Vec<(f64, f64)>,
    /// [`ORDER`] values for each integrand of each piece.
    values: Vec<f64>,
}

/// The panels so far, and the weights of unbroken panels for one time.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    panels: Vec<Panel>,
    time: Option<u64>,
    whole: Vec<Vec<f64>>,
}

impl HistoryPlan {
    /// Whether some kernel needs the whole past.
    pub(super) fn is_general(&self) -> bool {
        let general = |k: &Kernel| matches!(k, Kernel::General(..));
        self.kernels.iter().any(general)
    }

    /// The integrands under general kernels.
    fn remembered(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let general = |(_, m): &(usize, &super::history::Member)| {
            matches!(self.kernels[m.kernel], Kernel::General(..))
        };
        let members = self.members.iter().enumerate().filter(general);
        members.map(|(k, m)| (k, m.kernel, m.integrand))
    }
}

impl Memory {
    /// Keeps the integrands of whole panels at more tuples, in order.
    pub(super) fn keep(
        &mut self,
        plan: &HistoryPlan,
        panel: Option<usize>,
        lanes: &[Lane],
        pieces: &[Piece],
        values: &[Vec<f64>],
    ) {
        let Some(index) = panel else { return };
        self.panels.resize_with(index + 1, Panel::default);
        let panel = &mut self.panels[index];
        let mut next = 0;
        for lane in 0..lanes.len() {
            panel.starts.push(panel.pieces.len());
            while let Some(piece) = pieces.get(next).filter(|p| p.lane as usize == lane) {
                panel.pieces.push((piece.from, piece.to));
                for (_, _, integrand) in plan.remembered() {
                    let points = next * ORDER..(next + 1) * ORDER;
                    panel.values.extend_from_slice(&values[integrand][points]);
                }
                next += 1;
            }
        }
    }

    /// Adds the sums over all panels before `panel` to the values of a lane.
    pub(super) fn add(
        &mut self,
        plan: &HistoryPlan,
        weights: &mut Weights,
        panel: usize,
        lane: &Lane,
        out: &mut [f64],
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
                    let values = &panel.values[(k * count + place) * ORDER..];
                    out[member] += dot(&weights[kernel * ORDER..], values);
                }
            }
        }
    }

    /// The weights of unbroken panels for the time `t`.
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
