//! Sequential stopping of a table that grows level by level.
//!
//! A claim judged at every level has as many chances of a wrong decision. With three levels a large next term or noise
//! of a few percent can look like another order, and unresolved coarse meshes like a lower one. The tests of the
//! inference simulate these rules.

use super::Decision;

/// Levels below which the errors alone settle nothing.
const SETTLED: usize = 4;
/// Probability at which a pass ends a table; stricter than for a table of fixed length. With 3 % of noise 0.3 % of the
/// tables whose order is ¼ above the claim pass at some level, against 1.7 % with the threshold of a fixed length.
const SURE: f64 = 0.90;

/// Whether no further level is needed: a pass from four levels on, or a failure from five on that was one a level
/// before.
pub fn settles(
    levels: usize,
    decision: Decision,
    probability: Option<f64>,
    before: Option<Decision>,
) -> bool {
    match decision {
        Decision::Pass => levels >= SETTLED && probability.is_some_and(|hit| hit > SURE),
        Decision::Fail => levels > SETTLED && before == Some(Decision::Fail),
        Decision::Unresolved => false,
    }
}
