//! Missing cases of a merge or report, in words.

use super::plan::id;
use crate::sweep::first_named;
use files::counted;
use judge::record::Key;

/// Missing cases that are named before the rest is counted.
pub(super) const NAMED: usize = 10;

/// Cases that an unfinished sweep still owes.
pub fn unfinished_in_words(missing: &[Key]) -> String {
    let way = "run the command that made these records again, `sweep run` with --resume";
    missing_in_words(missing, id, way)
}

/// Requested cases that are in no part, or have lost rows, with the way to get them.
pub(super) fn missing_in_words(
    missing: &[Key],
    name: impl Fn(&Key) -> String,
    way: &str,
) -> String {
    let named = first_named(missing.iter().map(name), NAMED);
    format!("{} missing: {named}; {way}", counted(missing.len(), "case"))
}
