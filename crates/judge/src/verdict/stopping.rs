//! Sequential stopping of the verdicts of a growing sweep.

use super::{Decision, FittedConstant, Verdict};
use crate::fit::{FEWEST, distinct, settles};

impl Verdict {
    /// Whether no further case is expected to change the verdict: by [`settles`], or by three passing levels with the
    /// predicted constant. `before` is the verdict before the last cases. An unexpected verdict settles nothing.
    pub fn settled(&self, before: Option<&Self>) -> bool {
        if !self.complete {
            return true;
        }
        let as_built = self.expect == Decision::Pass || self.decision == self.expect;
        let levels = self.levels();
        let before =
            before.filter(|before| before.levels() < levels).map(|verdict| verdict.decision);
        let agrees = self.decision == Decision::Pass && self.constants_agree();
        as_built
            && (settles(levels, self.decision, self.probability, before)
                || agrees && levels >= FEWEST)
    }

    /// Distinct steps of the points used; none for a grid, which needs every case.
    fn levels(&self) -> usize {
        let Some(direction) = self.variable.direction() else { return 0 };
        let steps = self.points_used.iter().map(|used| direction.step(&used.point));
        distinct(steps.collect()).len()
    }

    /// Whether constants are predicted, and all measured ones agree.
    fn constants_agree(&self) -> bool {
        let known = |constant: &FittedConstant| Some((constant.ratio?, constant.tolerance?));
        let known: Vec<_> = self.constants.values().filter_map(known).collect();
        !known.is_empty()
            && known.iter().all(|(ratio, tolerance)| (ratio - 1.0).abs() <= *tolerance)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::record::{CaseRecord, Key, NormError, V_MAX};
    use crate::verdict::{Prediction, Variable, judge};

    fn on(levels: u32, order: f64, expect: Decision) -> Verdict {
        let records: Vec<CaseRecord> = (0..levels)
            .map(|i| {
                let n = 4 << i;
                let h = 1.0 / f64::from(n);
                let norm = NormError { norm: V_MAX.into(), error: Some(h), floor: Some(0.0) };
                CaseRecord {
                    h: Some(h),
                    errors: vec![norm],
                    status: crate::record::Status::Converged,
                    ..CaseRecord::without_work("line", Some(n), 8, 0.125)
                }
            })
            .collect();
        let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
        judge("line", &records, &keys, &Prediction::new(V_MAX, Variable::H, order), expect)
    }

    #[test]
    fn a_pass_needs_four_levels_and_a_failure_a_second_one() {
        let pass = |levels| on(levels, 1.0, Decision::Pass);
        assert_eq!(pass(3).decision, Decision::Pass);
        assert!(!pass(3).settled(None) && pass(4).settled(None));
        let fail = |levels| on(levels, 1.5, Decision::Pass);
        assert_eq!(fail(3).decision, Decision::Fail);
        assert!(!fail(4).settled(Some(&fail(3))));
        assert!(fail(5).settled(Some(&fail(4))));
        assert!(!fail(5).settled(Some(&fail(5))) && !fail(5).settled(None));
        assert!(!fail(5).settled(Some(&pass(4))));
        assert!(!on(6, 0.5, Decision::Pass).settled(Some(&on(5, 0.5, Decision::Pass))));
    }

    #[test]
    fn what_a_scene_is_not_built_for_settles_nothing() {
        assert!(!on(6, 1.0, Decision::Fail).settled(Some(&on(5, 1.0, Decision::Fail))));
        assert!(!on(6, 1.0, Decision::Unresolved).settled(None));
        assert!(on(5, 1.5, Decision::Fail).settled(Some(&on(4, 1.5, Decision::Fail))));
        let grid = Verdict { variable: Variable::Joint, ..on(6, 1.0, Decision::Pass) };
        assert!(!grid.settled(None));
        assert!(Verdict { complete: false, ..on(3, 1.0, Decision::Pass) }.settled(None));
    }

    #[test]
    fn three_levels_are_enough_with_the_constant_that_was_predicted() {
        let with = |ratio| {
            let constant = FittedConstant {
                ratio: Some(ratio),
                tolerance: Some(1e-4),
                ..FittedConstant::fitted(1.0, [1.0, 1.0], 1.0)
            };
            let constants = BTreeMap::from([("C_h", constant)]);
            Verdict { constants, ..on(3, 1.0, Decision::Pass) }
        };
        assert!(with(1.00005).settled(None));
        assert!(!with(1.0002).settled(None) && !with(f64::NAN).settled(None));
    }
}
