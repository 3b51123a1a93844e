//! Quadrature weights times kernels.

use super::block::Registers;
use super::history::{HistoryPlan, Kernel};
use super::quadrature::{GAUSS, ORDER};
use super::tape::Source;

/// Parts of a piece near the end, in y.
const PARTS: u32 = 4;

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
    /// (a, b), [`ORDER`] each; those of [`Self::near_end`] where a general
    /// kernel may have a root at a lag of zero nearby.
    pub(super) fn of(&mut self, plan: &HistoryPlan, from: f64, to: f64, end: f64) -> &[f64] {
        let key = [from, to, end].map(f64::to_bits);
        if self.of != Some(key) {
            self.of = Some(key);
            self.weights.clear();
            for kernel in &plan.kernels {
                if matches!(kernel, Kernel::General(..)) && end - to < to - from {
                    let near = self.near_end(kernel, from, to, end);
                    self.weights.extend(near);
                    continue;
                }
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

    /// Weights that integrate the polynomial through the values at the Gauss
    /// points against the kernel: only the function has to be smooth.
    ///
    /// Lags are graded as y^4, which makes a power lag^a a polynomial for
    /// a = 1/4, 1/2, 3/4; 1e-13 of the integral for other a > 0.
    fn near_end(&mut self, kernel: &Kernel, from: f64, to: f64, end: f64) -> [f64; ORDER] {
        let mut weights = [0.0; ORDER];
        let (low, high) = ((end - to).max(0.0).powf(0.25), (end - from).max(0.0).powf(0.25));
        let width = (high - low) / f64::from(PARTS);
        for part in 0..PARTS {
            let place = |u: f64| low + width * (f64::from(part) + u);
            let lags = GAUSS.abscissae.map(|u| place(u).powi(4));
            let mut kernels = lags;
            self.apply(kernel, &mut kernels);
            for (i, (u, w)) in GAUSS.abscissae.iter().zip(&GAUSS.weights).enumerate() {
                let density = 4.0 * place(*u).powi(3) * width * w * kernels[i];
                let share = (end - lags[i] - from) / (to - from);
                for (weight, lagrange) in weights.iter_mut().zip(GAUSS.lagrange(share)) {
                    *weight += density * lagrange;
                }
            }
        }
        weights
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
