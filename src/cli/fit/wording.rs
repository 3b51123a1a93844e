//! A result in words, and the words that results share.

use judge::verdict::Decision;

/// The result for one table in one direction.
pub(super) struct Part {
    pub(super) text: String,
    pub(super) json: serde_json::Value,
    /// Set if an order is predicted.
    pub(super) decision: Option<Decision>,
}

/// Four digits, but never 0.0000.
pub(super) fn plain(number: f64) -> String {
    let rounded: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    match rounded.abs() {
        size if size == 0.0 || (1e-3..1e5).contains(&size) => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

/// The steps of the missing levels: one more in the ratio of the last two, or two after a single one.
pub(super) fn next_steps(steps: &[f64]) -> Vec<f64> {
    match steps {
        [.., previous, last] => vec![last * last / previous],
        [only] => vec![only / 2.0, only / 4.0],
        [] => Vec::new(),
    }
}

pub(super) fn run(name: &str, steps: &[f64]) -> String {
    let each: Vec<String> = steps.iter().map(|step| format!("{name} = {}", plain(*step))).collect();
    match each.is_empty() {
        true => format!("run three values of {name}"),
        false => format!("run {}", each.join(" and ")),
    }
}
