//! `--target E` and `--norm`: a wanted error and its norm.

use super::CliError;
use scene::Norm;
use scene::setup::Setup;
use studies::trade::{NORMS, NoAnswer};

/// What is wanted of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wanted {
    pub norm: Norm,
    error: Option<f64>,
    /// Whether the error is one relative to the largest ‖ε(u)‖.
    relative: bool,
}

impl Wanted {
    /// Reads both options; only norms with a value at every time level, and norms on Γ3 only with Γ3.
    pub(super) fn read(setup: &Setup, norm: &str, error: Option<&str>) -> Result<Self, CliError> {
        let known = NORMS.into_iter().find(|known| known.name() == norm);
        let norm = known.ok_or_else(|| {
            let known: Vec<&str> = NORMS.iter().map(|norm| norm.name()).collect();
            CliError::other(format!("no norm `{norm}` here: choose one of {}", known.join(", ")))
        })?;
        let name = norm.name();
        if norm.needs_contact() && setup.model.boundary.is_none() {
            let message = format!("`{name}` is a norm on Γ3, and the scene has none");
            return Err(CliError::other(message));
        }
        let Some(text) = error else { return Ok(Self { norm, error: None, relative: false }) };
        let percent = text.trim().strip_suffix('%');
        let number: Result<f64, _> = percent.unwrap_or(text).trim().parse();
        let target = number.map_err(|_| {
            CliError::other(format!("--target {text}: not a number; `0.01` is an error in the norm, `1%` a hundredth of the solution"))
        })?;
        if !(target.is_finite() && target > 0.0) {
            return Err(CliError::other(NoAnswer::NotPositive { target }));
        }
        let relative = percent.is_some();
        if relative && norm != Norm::VMax {
            return Err(CliError::other(format!(
                "--target {text}: a part of the solution is known in V_max alone; give an error in {name}"
            )));
        }
        let error = if relative { target / 100.0 } else { target };
        Ok(Self { norm, error: Some(error), relative })
    }

    /// The absolute error, for a solution of this size.
    pub(super) fn error(&self, size: f64) -> Option<f64> {
        self.error.map(|error| if self.relative { error * size } else { error })
    }
}
