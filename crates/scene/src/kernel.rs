//! Memory kernels by name: a table in place of a formula in t.

use super::diagnostic::Result;
use super::reading::Reading;
use super::spans::join;
use super::values::Formula;

/// `{ kind = "exponential", amplitude = a, time = τ }`: a exp(-t/τ); `{ kind = "prony", terms = [[a_1, τ_1], …] }`: Σ
/// a_i exp(-t/τ_i); `{ kind = "power", amplitude = a, time = τ, exponent = p }`: a (1 + t/τ)^{-p}, which is smooth on
/// [0, T].
pub(super) const KERNELS: [(&str, &str); 3] =
    [("exponential", "amplitude time"), ("prony", "terms"), ("power", "amplitude time exponent")];

/// The formula of a kernel, given directly or by a table.
pub(super) fn formula_of(reading: &Reading, key: &str) -> Result<Formula> {
    if !reading.has_parts(key) {
        return reading.required(key);
    }
    let kind = reading.kind(key, &KERNELS)?;
    if kind == "prony" {
        return prony(reading, &join(key, "terms"));
    }
    let amplitude = reading.finite(&join(key, "amplitude"))?;
    let time = reading.positive(&join(key, "time"))?;
    if kind == "exponential" {
        return Ok(Formula(decay(amplitude, time)));
    }
    let exponent = reading.finite(&join(key, "exponent"))?;
    Ok(Formula(format!("({amplitude:?})*(1 + t/({time:?}))^(-({exponent:?}))")))
}

fn decay(amplitude: f64, time: f64) -> String {
    // The literal rate, so that the formula is recognised as this exponential.
    format!("({amplitude:?})*exp(-({:?})*t)", 1.0 / time)
}

fn prony(reading: &Reading, key: &str) -> Result<Formula> {
    let terms = reading.entries(key)?;
    let hint = "for instance: terms = [[-0.5, 0.2], [-0.3, 2.0]]";
    reading.refuse_if(terms.is_empty(), key, "a Prony series without terms", hint)?;
    let term = |index| {
        let at = format!("{key}.{index}");
        reading.entries_of(&at, 2, "a term is a pair [amplitude, time], as in [-0.5, 0.2]")?;
        let amplitude = reading.finite(&format!("{at}.0"))?;
        Ok(decay(amplitude, reading.positive(&format!("{at}.1"))?))
    };
    Ok(Formula(terms.map(term).collect::<Result<Vec<_>, _>>()?.join(" + ")))
}
