//! Missing cases of a merge or report, in words.

use super::plan::id;
use files::counted;
use judge::record::Key;

/// Missing cases that are named before the rest is counted.
pub(super) const NAMED: usize = 10;

/// How missing cases come to be.
#[derive(Debug, Clone, Copy)]
pub(super) enum WayOn {
    /// Run their jobs of a plan.
    Plan,
    /// Run them on the grids of scenes; there is no plan.
    Grids,
    /// Resume an unfinished sweep.
    Resume,
}

/// Cases that an unfinished sweep still owes.
pub fn unfinished_in_words(missing: &[Key]) -> String {
    missing_in_words(missing, id, WayOn::Resume)
}

/// Requested cases that are in no part, or have lost rows.
pub(super) fn missing_in_words(
    missing: &[Key],
    name: impl Fn(&Key) -> String,
    way: WayOn,
) -> String {
    let named: Vec<String> = missing.iter().take(NAMED).map(name).collect();
    let more = match missing.len() - named.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let way = match way {
        WayOn::Plan => {
            "run them with `sweep case --job JOB`, or merge with --incomplete: their verdicts fail then"
        }
        WayOn::Grids => {
            "they are on the grids of the scenes' files: give the plan with --plan if another grid was run, or merge with --incomplete: their verdicts fail then"
        }
        WayOn::Resume => "run the command that made these records again, `sweep run` with --resume",
    };
    format!("{} missing: {}{more}; {way}", counted(missing.len(), "case"), named.join(", "))
}
