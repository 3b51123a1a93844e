//! Memory kernels by name: a table in place of a formula in t.

use super::diagnostic::SceneError;
use super::reading::Reading;
use super::written::{self, Formula};

/// The formula of a kernel, given directly or by the table `{ kind = "exponential", amplitude = a, time = τ }`: a
/// exp(-t/τ); `{ kind = "prony", terms = [[a_1, τ_1], …] }`: Σ a_i exp(-t/τ_i); `{ kind = "power", amplitude = a, time
/// = τ, exponent = p }`: a (1 + t/τ)^{-p}, which is smooth on [0, T].
pub(super) fn formula_of(
    reading: &Reading,
    key: &str,
    written: &written::Kernel,
) -> Result<Formula, SceneError> {
    let table = match written {
        written::Kernel::Plain(formula) => return Ok(formula.clone()),
        written::Kernel::Table(table) => table,
    };
    let kinds = [("exponential", 0), ("prony", 1), ("power", 2)];
    let text = match reading.choice(&format!("{key}.kind"), &table.kind, &kinds)? {
        0 => {
            only(reading, key, table, &["amplitude", "time"])?;
            decay(
                number(reading, key, "amplitude", table.amplitude)?,
                time(reading, key, table.time)?,
            )
        }
        1 => {
            only(reading, key, table, &["terms"])?;
            prony(reading, key, table)?
        }
        _ => {
            only(reading, key, table, &["amplitude", "time", "exponent"])?;
            let amplitude = number(reading, key, "amplitude", table.amplitude)?;
            let time = time(reading, key, table.time)?;
            let exponent = number(reading, key, "exponent", table.exponent)?;
            format!("({amplitude:?})*(1 + t/({time:?}))^(-({exponent:?}))")
        }
    };
    Ok(Formula(text))
}

fn decay(amplitude: f64, time: f64) -> String {
    // The literal rate, so that the formula is recognised as this exponential.
    format!("({amplitude:?})*exp(-({:?})*t)", 1.0 / time)
}

fn prony(reading: &Reading, key: &str, table: &written::KernelTable) -> Result<String, SceneError> {
    let place = format!("{key}.terms");
    let terms = table.terms.as_deref().unwrap_or_default();
    if terms.is_empty() {
        let message = "a Prony series without terms";
        return Err(reading.error(
            key,
            message,
            "for instance: terms = [[-0.5, 0.2], [-0.3, 2.0]]",
        ));
    }
    let mut text = Vec::new();
    for (index, term) in terms.iter().enumerate() {
        let at = format!("{place}.{index}");
        let &[amplitude, time] = &term[..] else {
            let message =
                format!("a term of a Prony series is a pair, this one has {} numbers", term.len());
            return Err(reading.error(&at, message, "give [amplitude, time], as in [-0.5, 0.2]"));
        };
        reading.finite(&at, amplitude)?;
        text.push(decay(amplitude, reading.positive(&at, time)?));
    }
    Ok(text.join(" + "))
}

fn number(reading: &Reading, key: &str, name: &str, value: Option<f64>) -> Result<f64, SceneError> {
    match value {
        Some(value) => reading.finite(&format!("{key}.{name}"), value),
        None => {
            let message = format!("the kernel lacks the key `{name}`");
            Err(reading.error(key, message, format!("for instance: {name} = 0.5")))
        }
    }
}

fn time(reading: &Reading, key: &str, value: Option<f64>) -> Result<f64, SceneError> {
    let value = number(reading, key, "time", value)?;
    reading.positive(&format!("{key}.time"), value)
}

/// Refuses keys of other kinds of kernel.
fn only(
    reading: &Reading,
    key: &str,
    table: &written::KernelTable,
    allowed: &[&str],
) -> Result<(), SceneError> {
    let given = [
        ("amplitude", table.amplitude.is_some()),
        ("time", table.time.is_some()),
        ("exponent", table.exponent.is_some()),
        ("terms", table.terms.is_some()),
    ];
    let other = given.iter().find(|(name, is)| *is && !allowed.contains(name));
    if let Some((name, _)) = other {
        let message = format!("a kernel of kind \"{}\" has no key `{name}`", table.kind);
        let hint = format!("its keys are kind, {}", allowed.join(", "));
        return Err(reading.error(&format!("{key}.{name}"), message, hint));
    }
    Ok(())
}
