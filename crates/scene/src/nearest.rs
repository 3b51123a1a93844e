//! Suggestions for misspelt names.

use strsim::osa_distance;

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

/// Number of edits between the names (insertions, deletions, substitutions, swaps of neighbours); None if more than a third of the letters differ. A prefix of three letters or
/// more counts as one edit.
fn closeness(name: &str, candidate: &str) -> Option<usize> {
    let shorter = name.len().min(candidate.len());
    if shorter >= 3 && (name.starts_with(candidate) || candidate.starts_with(name)) {
        return Some(1);
    }
    let edits = osa_distance(name, candidate);
    let longer = name.chars().count().max(candidate.chars().count());
    (edits <= longer.div_ceil(3)).then_some(edits).filter(|&edits| edits < longer)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn only_what_may_be_meant_is_offered() {
        assert_eq!(nearest("quadrture", ["gap", "quadrature"]), Some("quadrature"));
        assert_eq!(nearest("colour", ["gap", "law"]), None);
        assert_eq!(nearest("a", ["b"]), None);
    }
}
