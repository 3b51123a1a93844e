//! `[material.memory]`: the relaxation tensor ℬ(t).

use crate::formula::{Node, Point, Scope, Variable};

use super::diagnostic::SceneError;
use super::reading::{Reading, evenly};
use super::written;

/// Intervals of [0, T] at whose ends the kernel is evaluated.
const SAMPLES: u32 = 512;

/// ℬ(t)ε = kernel(t) · (2 mu ε + lambda tr(ε) I).
#[derive(Debug, Clone, PartialEq)]
pub struct Memory {
    /// A formula in t, finite on [0, T].
    pub kernel: Node,
    /// Pairs (a, c) with kernel = Σ a exp(-c t), where it has that form.
    pub exponentials: Option<Vec<(f64, f64)>>,
    pub lambda: f64,
    pub mu: f64,
}

impl Memory {
    pub(super) fn validate(
        reading: &mut Reading,
        written: &written::Memory,
        horizon: f64,
    ) -> Result<Memory, SceneError> {
        let key = "material.memory.kernel";
        let lambda = reading.finite("material.memory.lambda", written.lambda)?;
        let mu = reading.finite("material.memory.mu", written.mu)?;
        let kernel = reading.formula(key, &written.kernel, &Scope::new(&[Variable::T]))?;
        let times = evenly(0.0, horizon, SAMPLES).map(|t| Point { t, ..Point::default() });
        if let Some((point, value)) = reading.first_not_finite(kernel, times) {
            let message = format!("the memory kernel is {value} at t = {}", point.t);
            let hint = "ℬ must be continuous on [0, T]: the trapezoidal rule uses its value at t = 0; -exp(-t) and sqrt(t) are examples";
            return Err(reading.error(key, message, hint));
        }
        Ok(Memory { kernel, exponentials: reading.formulas.exponential_sum(kernel), lambda, mu })
    }
}
