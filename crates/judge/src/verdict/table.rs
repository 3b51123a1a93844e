//! Verdicts as a table of at most 100 columns, and the reasons below it.

use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{ContentArrangement, LineStyle, Table};

use super::{Decision, Verdict};

/// Width of the text in characters.
const WIDTH: usize = 100;

/// What stands in place of an empty table.
pub const NOTHING_JUDGED: &str =
    "nothing was judged: every scene here says judge = false and is measured only";

/// The table of verdicts: scene, norm, in, predicted, observed, verdict, why; and below it the
/// reason of every verdict that is not a plain pass. Without verdicts: [`NOTHING_JUDGED`].
pub fn render_table(verdicts: &[Verdict]) -> String {
    if verdicts.is_empty() {
        return NOTHING_JUDGED.into();
    }
    let mut table = Table::new();
    table.set_content_arrangement(ContentArrangement::Dynamic).force_no_tty();
    table.set_width(WIDTH as u16).load_style(UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));

    table.set_header(["scene", "norm", "in", "predicted", "observed", "verdict", "why"]);
    table.add_rows(verdicts.iter().map(cell_texts));
    let reasons = verdicts.iter().filter(|verdict| !is_plain_pass(verdict)).map(|verdict| {
        let Verdict { scene, norm, variable, reason, .. } = verdict;
        let name = verdict.decision.name();
        wrapped(&format!("{scene} {norm} in {}: {name}: {reason}", variable.name()))
    });
    let blocks: Vec<String> = [table.trim_fmt()].into_iter().chain(reasons).collect();
    blocks.join("\n")
}

/// The cells of a verdict: scene, norm, in, predicted, observed, verdict, why.
pub fn cell_texts(verdict: &Verdict) -> [String; 7] {
    let name = verdict.decision.name();
    let decision = match (verdict.as_expected(), verdict.decision) {
        (true, Decision::Pass) | (false, Decision::Fail | Decision::Unresolved) => name.to_owned(),
        (true, _) => format!("{name}, as expected"),
        (false, Decision::Pass) => format!("{name}, expected {}", verdict.expect.decision().name()),
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

/// Breaks a text at blanks, later lines indented.
fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        if lines[last].chars().count() + 1 + word.chars().count() > WIDTH {
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
        assert_eq!(wrapped(&format!("{a} {b}")), format!("{a} {b}"));
        assert_eq!(wrapped(&format!("{a} {c} d")), format!("{a}\n    {c} d"));
        assert_eq!(wrapped(""), "");
    }
}
