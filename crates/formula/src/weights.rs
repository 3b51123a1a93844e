//! Quadrature weights times kernels.

use super::block::Registers;
use super::history::{HistoryPlan, Kernel};
use super::quadrature::{GAUSS, ORDER};
use super::resolution::{NEGLIGIBLE, RESOLVED, is_unresolved, last};
use super::tape::Source;

/// Numbers per kernel: its weights, and an error estimate.
pub(super) const STRIDE: usize = ORDER + 1;
/// Limit of parts of a piece for one kernel: 600 halvings towards a power, as for an integrand.
const MOST_PARTS: usize = 1200;

#[derive(Clone, Debug, Default)]
pub(super) struct Weights {
    of: Option<[u64; 3]>,
    weights: Vec<f64>,
    decay_of: Option<u64>,
    decay: Vec<f64>,
    registers: Registers,
}

impl Weights {
    /// For each kernel k the weights (b-a) w_i k(end - s_i) of a piece (a, b), and 0; those of [`Self::graded`] for a
    /// general kernel not resolved there, as near a root at lag zero.
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
                if matches!(kernel, Kernel::General(..)) && is_unresolved(&lags, RESOLVED) {
                    let graded = self.graded(kernel, from, to, end);
                    self.weights.extend(graded);
                    continue;
                }
                let pairs = lags.iter().zip(&GAUSS.weights);
                self.weights.extend(pairs.map(|(k, w)| (to - from) * w * k));
                self.weights.push(0.0);
            }
        }
        &self.weights
    }

    /// Weights that integrate the interpolating polynomial at the Gauss points against the kernel, whose lags are
    /// halved where unresolved: only the function has to be smooth. The last number is the error estimate of the
    /// integral of |k|.
    fn graded(&mut self, kernel: &Kernel, from: f64, to: f64, end: f64) -> [f64; STRIDE] {
        let mut weights = [0.0; STRIDE];
        let mut parts = vec![[end - to, end - from]];
        let (mut taken, mut size) = (0, 0.0);
        while let Some([low, high]) = parts.pop() {
            taken += 1;
            let width = high - low;
            let lags = GAUSS.abscissae.map(|u| low + width * u);
            let mut kernels = lags;
            self.apply(kernel, &mut kernels);
            let pairs = kernels.iter().zip(&GAUSS.weights);
            let integral_of_part = width.abs() * pairs.map(|(k, w)| w * k.abs()).sum::<f64>();
            if taken == 1 {
                size = integral_of_part;
            }
            let left = width.abs() * last(&kernels);
            if is_unresolved(&kernels, RESOLVED) && left > NEGLIGIBLE * size {
                let middle = 0.5 * (low + high);
                if taken < MOST_PARTS && middle != low && middle != high {
                    parts.extend([[middle, high], [low, middle]]);
                    continue;
                }
                weights[ORDER] += left;
            }
            for (i, w) in GAUSS.weights.iter().enumerate() {
                let share = (end - lags[i] - from) / (to - from);
                for (weight, lagrange) in weights.iter_mut().zip(GAUSS.lagrange(share)) {
                    *weight += width * w * kernels[i] * lagrange;
                }
            }
        }
        weights
    }

    /// The factors exp(-c lag) of all kernels; 0 for other kernels.
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
