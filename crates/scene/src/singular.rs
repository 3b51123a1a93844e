//! `singular`: the exponent of kernels that are infinite at s = t.

use super::diagnostic::Result;
use super::reading::Reading;
use super::spans::join;
use super::time::{Time, TimeRule};

/// The way out for a kernel that is infinite at lag zero, by the key of its formula.
pub(super) fn way_out(formula: &str) -> String {
    format!(
        "a kernel (t - s)^(-a) b, 0 < a < 1, is integrable: give b as {formula} and singular = a beside it, with rule = \"product-integration\" under [time]"
    )
}

/// The a of a kernel (t - s)^{-a} b at a table, or 0.
///
/// # Errors
/// An exponent that is not between 0 and 1.
pub(super) fn exponent(reading: &Reading, table: &str) -> Result<f64> {
    let key = join(table, "singular");
    let hint = "the kernel is t^(-singular) times its formula; from 1 on it has no integral, and without the key it is the formula";
    let given = reading.has(&key).then(|| reading.share(&key, hint)).transpose()?;
    Ok(given.unwrap_or(0.0))
}

/// The distinct exponents p of kernels t^{-p} b, with the factor T^{a-p} that bounds each by one with the largest, a,
/// which comes last; also for their last weights k^{1-p}/((1-p)(2-p)). Plain kernels, p = 0, are left out.
pub(crate) fn in_the_largest(
    exponents: impl Iterator<Item = f64>,
    horizon: f64,
) -> Vec<(f64, f64)> {
    let mut powers: Vec<f64> = exponents.filter(|&power| power > 0.0).collect();
    powers.sort_by(f64::total_cmp);
    powers.dedup();
    let most = powers.last().copied().unwrap_or(0.0);
    powers.into_iter().map(|power| (power, horizon.powf(most - power))).collect()
}

/// Refuses rules that evaluate a kernel at s = t where it is infinite; `key` is that of the exponent.
///
/// # Errors
/// Any rule but product integration.
pub(super) fn needs_product_integration(
    reading: &Reading,
    time: &Time,
    singular: Option<String>,
) -> Result<()> {
    let Some(key) = singular else { return Ok(()) };
    let message =
        "a kernel with `singular` is infinite at s = t, where this time rule takes its value";
    let hint = "add to [time]: rule = \"product-integration\", which integrates the power";
    reading.refuse_if(time.rule != TimeRule::ProductIntegration, &key, message, hint)
}
