//! `singular`: the exponent of kernels that are infinite at s = t.

use super::diagnostic::SceneError;
use super::reading::Reading;
use super::time::{Time, TimeRule};
use super::validated::{Body, Scene};

/// The way out for a kernel that is infinite at lag zero, by the name of the key of its formula.
pub(super) fn way_out(formula: &str) -> String {
    format!(
        "a kernel (t - s)^(-a) b, 0 < a < 1, is integrable: give b as {formula} and singular = a beside it, with rule = \"product-integration\" under [time]"
    )
}

/// The a of a kernel (t - s)^{-a} b at `key`; 0 where it has none.
///
/// # Errors
/// An exponent that is not between 0 and 1.
pub(super) fn exponent(
    reading: &Reading,
    key: &str,
    written: Option<f64>,
) -> Result<f64, SceneError> {
    match written {
        None => Ok(0.0),
        Some(a) if a > 0.0 && a < 1.0 => Ok(a),
        Some(a) => {
            let message = format!("singular = {a} is not between 0 and 1");
            let hint = "the kernel is t^(-singular) times its formula; from 1 on it has no integral, and without the key it is the formula";
            Err(reading.error(&format!("{key}.singular"), message, hint))
        }
    }
}

/// Refuses rules that take the value of a kernel at s = t where that is infinite; `key` is that of the exponent.
///
/// # Errors
/// Any rule but product integration.
pub(super) fn needs_product_integration(
    reading: &Reading,
    time: &Time,
    singular: Option<String>,
) -> Result<(), SceneError> {
    match singular {
        Some(key) if time.rule != TimeRule::ProductIntegration => {
            let message = "a kernel with `singular` is infinite at s = t, where this time rule takes its value";
            let hint = "add to [time]: rule = \"product-integration\", which integrates the power";
            Err(reading.error(&key, message, hint))
        }
        _ => Ok(()),
    }
}

impl Scene {
    /// Refuses a scene with a kernel that is infinite at s = t for a command whose constants are values of kernels there.
    ///
    /// # Errors
    /// At the key `singular`.
    pub fn with_finite_kernels(&self, command: &str) -> Result<(), SceneError> {
        let key = match &self.body {
            Body::Contact(body) => {
                let mut terms = body.material.memory.iter();
                let key = || "material.memory.singular".to_string();
                terms.any(|term| term.singular.is_some()).then(key)
            }
            Body::Abstract(problem) => {
                let at = problem.kernels.iter().position(|kernel| kernel.power > 0.0);
                at.map(|l| format!("history.kernels.{l}.singular"))
            }
        };
        let Some(key) = key else { return Ok(()) };
        let message = format!("`{command}` does not treat kernels that are infinite at s = t");
        let hint =
            "list, check, explain, run, gate and solve do; for this command remove `singular`";
        Err(self.error(&key, message, hint))
    }
}
