//! Verdicts as a table, with reasons below.

use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{ColumnConstraint, ContentArrangement, LineStyle, Table};

use super::{Decision, Verdict};

/// Width of the text in characters where nothing else is known.
pub const TABLE_WIDTH: u16 = 100;

/// Minimal width for the theorems beside the intervals.
const WITH_REASONS: u16 = 96;

/// Columns not to be broken: in, predicted, observed, verdict.
const WHOLE: std::ops::RangeInclusive<usize> = 2..=5;

/// What stands in place of an empty table.
pub const NOTHING_JUDGED: &str =
    "nothing was judged: every scene here says judge = false and is measured only";

/// Table in `width` characters: scene, norm, in, predicted, observed, verdict and, with enough room, why; below it the
/// reason of every verdict that is not a plain pass. Without verdicts [`NOTHING_JUDGED`].
pub fn render_table(verdicts: &[Verdict], width: u16) -> String {
    if verdicts.is_empty() {
        return NOTHING_JUDGED.into();
    }
    let mut table = Table::new();
    table.set_content_arrangement(ContentArrangement::Dynamic).force_no_tty();
    table.set_width(width).load_style(UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    let columns = if width < WITH_REASONS { HEAD.len() - 1 } else { HEAD.len() };
    table.set_header(&HEAD[..columns]);
    table.add_rows(verdicts.iter().map(|verdict| cell_texts(verdict).into_iter().take(columns)));
    for (at, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        match at {
            0 => column.set_delimiter('-'),
            1 => column.set_delimiter('_'),
            _ if WHOLE.contains(&at) => column.set_constraint(ColumnConstraint::ContentWidth),
            _ => column,
        };
    }
    let blocks: Vec<String> =
        [table.trim_fmt()].into_iter().chain(reasons(verdicts, width.into())).collect();
    blocks.join("\n")
}

/// Reasons of all but plain passes; one that several orders of a scene share is stated once.
fn reasons(verdicts: &[Verdict], width: usize) -> Vec<String> {
    let explained: Vec<&Verdict> =
        verdicts.iter().filter(|verdict| !is_plain_pass(verdict)).collect();
    let shared = explained
        .chunk_by(|a, b| (&a.scene, a.decision, &a.reason) == (&b.scene, b.decision, &b.reason));
    let words = |group: &[&Verdict]| {
        let Verdict { scene, decision, reason, .. } = group[0];
        let orders =
            group.iter().map(|verdict| format!("{} in {}", verdict.norm, verdict.variable.name()));
        let orders = orders.collect::<Vec<_>>().join(", ");
        wrapped(&format!("{scene} {orders}: {}: {reason}", decision.name()), width)
    };
    shared.map(words).collect()
}

const HEAD: [&str; 7] = ["scene", "norm", "in", "predicted", "observed", "verdict", "why"];

/// The cells of a verdict: scene, norm, in, predicted, observed, verdict, why.
pub fn cell_texts(verdict: &Verdict) -> [String; 7] {
    let name = verdict.decision.name();
    let decision = match (verdict.as_expected(), verdict.decision) {
        (true, Decision::Pass) | (false, Decision::Fail | Decision::Unresolved) => name.to_owned(),
        (true, _) => format!("{name}, as expected"),
        (false, Decision::Pass) => format!("{name}, expected {}", verdict.expect.name()),
    };
    [
        verdict.scene.clone(),
        verdict.norm.clone(),
        verdict.variable.name().to_owned(),
        predicted(verdict),
        observed(verdict),
        decision,
        verdict.why.clone(),
    ]
}

fn is_plain_pass(verdict: &Verdict) -> bool {
    verdict.as_expected() && verdict.decision == Decision::Pass
}

fn predicted(verdict: &Verdict) -> String {
    let bound = if verdict.at_least { "≥ " } else { "" };
    let order_k = verdict.predicted_k.map_or_else(String::new, |order| format!(", {order}"));
    format!("{bound}{}{order_k}", verdict.predicted)
}

fn observed(verdict: &Verdict) -> String {
    let text = |order: Option<f64>, interval: Option<[f64; 2]>| {
        order.zip(interval).map(|(order, [lo, hi])| format!("{order:.2} [{lo:.2}, {hi:.2}]"))
    };
    let both =
        [text(verdict.observed, verdict.interval), text(verdict.observed_k, verdict.interval_k)];
    let texts: Vec<String> = both.into_iter().flatten().collect();
    if texts.is_empty() { "-".to_owned() } else { texts.join("\n") }
}

fn wrapped(text: &str, width: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        if lines[last].chars().count() + 1 + word.chars().count() > width {
            lines.push(format!("    {word}"));
        } else {
            let blank = if lines[last].is_empty() { "" } else { " " };
            lines[last] = format!("{}{blank}{word}", lines[last]);
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_full_and_no_longer() {
        let [a, b, c] = ["a".repeat(50), "b".repeat(49), "c".repeat(50)];
        assert_eq!(wrapped(&format!("{a} {b}"), 100), format!("{a} {b}"));
        assert_eq!(wrapped(&format!("{a} {c} d"), 100), format!("{a}\n    {c} d"));
        assert_eq!(wrapped("", 100), "");
    }
}
