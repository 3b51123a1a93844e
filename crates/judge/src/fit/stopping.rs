//! When a table that grows level by level has told what it can.
//!
//! A claim that is judged at every level has as many chances to be wrong as levels. With three levels a next term of the
//! size of the first, or noise of a few percent, looks like another order now and then, and coarse meshes that do not
//! resolve look like a lower one, until a further level shows what they are. The simulation of these rules is among the
//! tests of the inference.

use super::Decision;

/// With fewer levels nothing is settled by the errors alone.
const SETTLED: usize = 4;
/// A pass ends a table above this probability, not above that which is enough for a table of a fixed length: with 3 % of
/// noise 1.7 % of the tables whose order is ¼ higher than claimed would pass at one level or another, and 0.3 % do.
const SURE: f64 = 0.90;

/// Whether no further level is needed: a pass from four levels on, a failure from five on that was one a level before.
pub fn settles(
    levels: usize,
    decision: Decision,
    probability: Option<f64>,
    before: Option<Decision>,
) -> bool {
    match decision {
        Decision::Pass => levels >= SETTLED && probability.is_some_and(|own| own > SURE),
        Decision::Fail => levels > SETTLED && before == Some(Decision::Fail),
        Decision::Unresolved => false,
    }
}
