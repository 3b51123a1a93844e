//! `--target E` and `--norm`: a wanted error and its norm.

use super::CliError;
use scene::Norm;
use studies::trade::{NORMS, NoAnswer};

/// The norm of a name; only norms with a value at every time level.
pub(super) fn norm(name: &str) -> Result<Norm, CliError> {
    NORMS.into_iter().find(|norm| norm.name() == name).ok_or_else(|| {
        let known: Vec<&str> = NORMS.iter().map(|norm| norm.name()).collect();
        CliError::other(format!("no norm `{name}` here: choose one of {}", known.join(", ")))
    })
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Target {
    Absolute(f64),
    /// Relative to the largest ‖ε(u)‖.
    Relative(f64),
}

impl Target {
    pub(super) fn read(text: &str, norm: Norm) -> Result<Self, CliError> {
        let (number, relative) = match text.trim().strip_suffix('%') {
            Some(number) => (number.trim(), true),
            None => (text.trim(), false),
        };
        let value: f64 = number.parse().map_err(|_| {
            CliError::other(format!("--target {text}: not a number; `0.01` is an error in the norm, `1%` a hundredth of the solution"))
        })?;
        if !(value.is_finite() && value > 0.0) {
            return Err(CliError::other(NoAnswer::NotPositive { target: value }));
        }
        match (relative, norm) {
            (false, _) => Ok(Self::Absolute(value)),
            (true, Norm::VMax) => Ok(Self::Relative(value / 100.0)),
            (true, _) => Err(CliError::other(format!(
                "--target {text}: a part of the solution is known in V_max alone; give an error in {}",
                norm.name()
            ))),
        }
    }

    /// The absolute error, for a solution of this size.
    pub(super) fn of(self, size: f64) -> f64 {
        match self {
            Self::Absolute(value) => value,
            Self::Relative(part) => part * size,
        }
    }
}
