//! Suggestions for misspelt names.

use strsim::levenshtein;

pub(super) fn suggestion(name: &str, allowed: &[&str]) -> String {
    let list = format!("allowed: {}", allowed.join(", "));
    let near =
        allowed.iter().map(|other| (levenshtein(name, other), other)).min_by_key(|(d, _)| *d);
    match near {
        Some((d, other)) if d <= 2 && d < name.chars().count() => {
            format!("did you mean `{other}`? {list}")
        }
        _ => list,
    }
}
