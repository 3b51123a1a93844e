//! Start values of a level from the last ones.

use super::StepState;

/// Levels used for extrapolation. A third takes more iterations where fronts move through the body: 215 for 200 in
/// `punch`, n = N = 64, and 27 for 24 in `punch-box`, n = 12, N = 4; no scene was found to gain from it.
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

    /// Extrapolates u and c, exact for linear functions of time on any grid; leaves `state` unchanged before the first
    /// level.
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
