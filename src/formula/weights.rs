//! Quadrature weights times kernels.

use super::block::Registers;
use super::history::{HistoryPlan, Kernel};
use super::quadrature::{GAUSS, ORDER};
use super::tape::Source;

/// The weights last asked for: most lanes ask for the same.
#[derive(Clone, Debug, Default)]
pub(super) struct Weights {
    of: Option<[u64; 3]>,
    weights: Vec<f64>,
    decay_of: Option<u64>,
    decay: Vec<f64>,
    registers: Registers,
}

impl Weights {
    /// For each kernel k in turn the weights (b-a) w_i k(end - s_i) of a piece
    /// (a, b), [`ORDER`] each.
    pub(super) fn of(&mut self, plan: &HistoryPlan, from: f64, to: f64, end: f64) -> &[f64] {
        let key = [from, to, end].map(f64::to_bits);
        if self.of != Some(key) {
            self.of = Some(key);
            self.weights.clear();
            for kernel in &plan.kernels {
                let mut lags = [0.0; ORDER];
                for (lag, u) in lags.iter_mut().zip(&GAUSS.abscissae) {
                    *lag = end - (from + (to - from) * u);
                }
                self.apply(kernel, &mut lags);
                let pairs = lags.iter().zip(&GAUSS.weights);
                self.weights.extend(pairs.map(|(k, w)| (to - from) * w * k));
            }
        }
        &self.weights
    }

    /// The factors exp(-c lag) of all kernels; 0 where a kernel is another.
    pub(super) fn decay(&mut self, plan: &HistoryPlan, lag: f64) -> &[f64] {
        if self.decay_of != Some(lag.to_bits()) {
            self.decay_of = Some(lag.to_bits());
            self.decay.clear();
            self.decay.extend(plan.kernels.iter().map(|kernel| match kernel {
                Kernel::Exponential(c) => (-c * lag).exp(),
                Kernel::General(..) => 0.0,
            }));
        }
        &self.decay
    }

    /// Replaces lags by the kernel's values there.
    fn apply(&mut self, kernel: &Kernel, lags: &mut [f64; ORDER]) {
        match kernel {
            Kernel::Exponential(c) => lags.iter_mut().for_each(|lag| *lag = (-c * *lag).exp()),
            Kernel::General(_, tape) => {
                self.registers.run(tape, ORDER, |source, out| match source {
                    Source::Time => out.copy_from_slice(&lags[..]),
                    // A kernel depends on time only.
                    _ => out.fill(f64::NAN),
                });
                if let Some(&result) = tape.results.first() {
                    lags.copy_from_slice(self.registers.lanes(result, ORDER));
                }
            }
        }
    }
}
