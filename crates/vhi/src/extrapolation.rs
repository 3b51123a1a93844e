//! Start values of a level from the last ones.

use super::StepState;

/// Levels through which start values are extrapolated. A third one takes more iterations where fronts move through the
/// body, 215 in place of 200 in `punch`, n = N = 64, and 27 in place of 24 in `punch-box`, n = 12, N = 4; no scene was
/// found that has fewer with it.
const LEVELS: usize = 2;

/// The last solutions (u, c) with their times, newest first.
#[derive(Debug, Clone, Default)]
pub struct Extrapolation {
    last: Vec<(f64, StepState)>,
}

impl Extrapolation {
    /// Keeps the solution at t.
    pub fn keep(&mut self, t: f64, state: &StepState) {
        if self.last.len() == LEVELS {
            self.last.rotate_right(1);
            self.last[0].0 = t;
            self.last[0].1.clone_from(state);
        } else {
            self.last.insert(0, (t, state.clone()));
        }
    }

    /// u and c through the last levels, exact for linear functions of time on any grid; `state` is left as it is before
    /// the first level.
    pub fn start(&self, t: f64, state: &mut StepState) {
        let last = &self.last;
        if last.is_empty() {
            return;
        }
        let mut weights = [0.0; LEVELS];
        for (a, weight) in weights.iter_mut().enumerate().take(last.len()) {
            let others = (0..last.len()).filter(|&b| b != a);
            *weight = others.map(|b| (t - last[b].0) / (last[a].0 - last[b].0)).product();
        }
        let blend = |pick: fn(&StepState) -> &[f64], out: &mut [f64]| {
            out.fill(0.0);
            for ((_, state), weight) in last.iter().zip(&weights) {
                algebra::linalg::axpy(*weight, pick(state), out);
            }
        };
        blend(|state| &state.u, &mut state.u);
        blend(|state| &state.pressure, &mut state.pressure);
    }
}
