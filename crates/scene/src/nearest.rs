//! Suggestions for misspelt names.

/// The nearest candidate, if near enough.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    by_distance(name, candidates).into_iter().next()
}

/// All candidates near enough, nearest first.
pub(super) fn by_distance<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Vec<&'a str> {
    let name = name.to_lowercase();
    let mut near: Vec<(usize, &str)> = candidates
        .into_iter()
        .filter_map(|candidate| Some((closeness(&name, &candidate.to_lowercase())?, candidate)))
        .collect();
    near.sort();
    near.into_iter().map(|(_, candidate)| candidate).collect()
}

/// Number of edits between the names; None if more than a third of the letters differ. A prefix of three letters or
/// more counts as one edit.
fn closeness(name: &str, candidate: &str) -> Option<usize> {
    let shorter = name.len().min(candidate.len());
    if shorter >= 3 && (name.starts_with(candidate) || candidate.starts_with(name)) {
        return Some(1);
    }
    let edits = edit_distance(name, candidate);
    let longer = name.chars().count().max(candidate.chars().count());
    (edits <= longer.div_ceil(3)).then_some(edits).filter(|&edits| edits < longer)
}

/// Fewest insertions, deletions, substitutions and swaps of neighbours that turn one name into the other. Cost: product
/// of the lengths.
fn edit_distance(from: &str, to: &str) -> usize {
    let from: Vec<char> = from.chars().collect();
    let to: Vec<char> = to.chars().collect();
    let mut before: Vec<usize> = Vec::new();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for i in 0..from.len() {
        let mut next = vec![i + 1];
        for j in 0..to.len() {
            let substituted = row[j] + usize::from(from[i] != to[j]);
            let mut cost = substituted.min(row[j + 1] + 1).min(next[j] + 1);
            if i > 0 && j > 0 && from[i] == to[j - 1] && from[i - 1] == to[j] {
                cost = cost.min(before[j - 1] + 1);
            }
            next.push(cost);
        }
        before = std::mem::replace(&mut row, next);
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::{edit_distance, nearest};

    #[test]
    fn edits_are_counted() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("gpa", "gap"), 1);
        assert_eq!(edit_distance("", "gap"), 3);
    }

    #[test]
    fn only_what_may_be_meant_is_offered() {
        assert_eq!(nearest("quadrture", ["gap", "quadrature"]), Some("quadrature"));
        assert_eq!(nearest("colour", ["gap", "law"]), None);
        assert_eq!(nearest("a", ["b"]), None);
    }
}
