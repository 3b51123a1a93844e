//! Suggestions for misspelt names.

pub(super) fn suggestion(name: &str, allowed: &[&str]) -> String {
    let list = format!("allowed: {}", allowed.join(", "));
    let near = allowed.iter().map(|other| (distance(name, other), other)).min_by_key(|(d, _)| *d);
    match near {
        Some((d, other)) if d <= 2 && d < name.chars().count() => {
            format!("did you mean `{other}`? {list}")
        }
        _ => list,
    }
}

/// Levenshtein distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, c) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for j in 0..b.len() {
            let replaced = diagonal + usize::from(c != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(row[j + 1] + 1);
        }
    }
    row[b.len()]
}
