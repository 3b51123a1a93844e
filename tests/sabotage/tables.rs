//! Tables whose verdict is known beforehand, for defects of the judge: exact powers at several ratios, bends, plateaus,
//! gaps. Errors are formulas; nothing is recorded.

use judge::record::{CaseRecord, Key, NormError, Status, V_MAX};
use judge::verdict::{
    Decision, Foreseen, LeadingLine, LeadingPoint, Prediction, Variable, Verdict, judge_foreseen,
};

use crate::catalogue::{Defect, through};

/// A table: steps, errors by the step, and what a judge may say of it.
struct Table {
    name: &'static str,
    /// n and h.
    steps: Vec<(u32, f64)>,
    error: fn(usize, f64) -> f64,
    order: f64,
    exact: bool,
    allowed: &'static [Decision],
    /// The constant that is known beforehand, to 1 %.
    constant: Option<f64>,
    /// What becomes of the records.
    spoil: fn(&mut Vec<CaseRecord>),
}

const FLOOR: f64 = 1e-9;
const NOT_PASSED: &[Decision] = &[Decision::Fail, Decision::Unresolved];
const PASSED: &[Decision] = &[Decision::Pass];
const FAILED: &[Decision] = &[Decision::Fail];
const OPEN: &[Decision] = &[Decision::Unresolved];

fn ratio(count: u32, ratio: f64) -> Vec<(u32, f64)> {
    (0..count).map(|i| (8 << i, 0.125 * ratio.powi(-(i as i32)))).collect()
}

/// Deterministic scatter in [-1, 1].
fn scatter(i: usize) -> f64 {
    [0.9, -0.7, 0.6, -1.0, 0.8, -0.5][i % 6]
}

fn tables() -> Vec<Table> {
    let table = |name, steps, error, order, allowed| Table {
        name,
        steps,
        error,
        order,
        exact: false,
        allowed,
        constant: None,
        spoil: |_| (),
    };
    vec![
        table("3 h, ratio 2", ratio(5, 2.0), |_, h| 3.0 * h, 1.0, PASSED),
        table("h, ratio 1.5", ratio(5, 1.5), |_, h| h, 1.0, PASSED),
        table("h^2, ratio 1.3", ratio(6, 1.3), |_, h| h * h, 2.0, PASSED),
        table("h^2 where 1 is predicted", ratio(5, 2.0), |_, h| h * h, 1.0, OPEN),
        Table {
            exact: true,
            ..table("h^2 where 1 is exact", ratio(5, 2.0), |_, h| h * h, 1.0, FAILED)
        },
        table("h^0.6 where 1 is predicted", ratio(5, 2.0), |_, h| h.powf(0.6), 1.0, FAILED),
        table("1/h: divergence", ratio(5, 2.0), |_, h| 1.0 / h, 1.0, FAILED),
        table("h + 0.05: plateau", ratio(5, 2.0), |_, h| h + 0.05, 1.0, NOT_PASSED),
        table(
            "h, and no progress on the finest mesh",
            ratio(5, 2.0),
            |i, h| if i == 4 { 2.0 * h } else { h },
            1.0,
            NOT_PASSED,
        ),
        table("h with 20 % scatter", ratio(5, 2.0), |i, h| h * (1.0 + 0.2 * scatter(i)), 1.0, OPEN),
        Table {
            constant: Some(3.0),
            ..table("3.01 h where 3 h is known", ratio(5, 2.0), |_, h| 3.01 * h, 1.0, PASSED)
        },
        Table {
            constant: Some(3.0),
            ..table("3.1 h where 3 h is known", ratio(5, 2.0), |_, h| 3.1 * h, 1.0, FAILED)
        },
        Table {
            constant: Some(3.0),
            ..table("2.9 h where 3 h is known", ratio(5, 2.0), |_, h| 2.9 * h, 1.0, FAILED)
        },
        table("h, two points", ratio(2, 2.0), |_, h| h, 1.0, OPEN),
        table("h^2 above a floor", ratio(6, 8.0), |_, h| (h * h).max(FLOOR), 2.0, PASSED),
        Table {
            spoil: |records| records[2].errors[0].error = Some(f64::NAN),
            ..table("h with a NaN", ratio(5, 2.0), |_, h| h, 1.0, FAILED)
        },
        Table {
            spoil: |records| drop(records.remove(1)),
            ..table("h with a case missing", ratio(5, 2.0), |_, h| h, 1.0, FAILED)
        },
        Table {
            spoil: |records| {
                records[3].status = Status::Failed { reason: "gave up".into() };
                records[3].errors[0].error = None;
            },
            ..table("h with a failed case", ratio(5, 2.0), |_, h| h, 1.0, FAILED)
        },
        Table {
            spoil: |records| records[1].errors[0].error = Some(0.0),
            ..table("h with a zero error", ratio(5, 2.0), |_, h| h, 1.0, NOT_OF_ORDER)
        },
    ]
}

/// A zero that nothing explains, as a crashed writer leaves it, confirms no order.
const NOT_OF_ORDER: &[Decision] = &[Decision::Unresolved];

impl Table {
    fn records(&self) -> Vec<CaseRecord> {
        let record = |(i, &(n, h)): (usize, &(u32, f64))| CaseRecord {
            h: Some(h),
            status: Status::Converged,
            errors: vec![NormError {
                norm: V_MAX.into(),
                error: Some((self.error)(i, h)),
                floor: Some(FLOOR),
            }],
            ..CaseRecord::without_work(self.name, Some(n), 1, 1.0)
        };
        self.steps.iter().enumerate().map(record).collect()
    }

    fn judged(&self, defect: &Defect) -> Verdict {
        let mut records = self.records();
        let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
        (self.spoil)(&mut records);
        let (records, keys) = through(&defect.before, (records, keys));
        let prediction = Prediction {
            exact: self.exact,
            why: "the formula of the table".into(),
            ..Prediction::new(V_MAX, Variable::H, self.order)
        };
        let foreseen = self.constant.map(|constant| Foreseen::Leading(self.leading(constant)));
        let known = foreseen.as_ref();
        let verdict =
            judge_foreseen(self.name, &records, &keys, &prediction, known, Decision::Pass);
        through(&defect.after, verdict)
    }

    /// Leading errors `constant` h^order.
    fn leading(&self, constant: f64) -> LeadingLine {
        let point = |&(n, h): &(u32, f64)| LeadingPoint {
            n: Some(n),
            steps: 1,
            h: Some(h),
            k: 1.0,
            error: constant * h.powf(self.order),
        };
        LeadingLine { points: self.steps.iter().map(point).collect(), limit: None, tolerance: 0.01 }
    }
}

/// The first table that the judge of a defect gets wrong, or loses, when it judges all of them as one run.
pub fn misjudged(defect: &Defect) -> Option<String> {
    let tables = tables();
    let verdicts: Vec<Verdict> = tables.iter().map(|table| table.judged(defect)).collect();
    let verdicts = through(&defect.all, verdicts);
    tables.iter().find_map(|table| {
        let Some(verdict) = verdicts.iter().find(|verdict| verdict.scene == table.name) else {
            return Some(format!("{}: no verdict", table.name));
        };
        let wrong = !table.allowed.contains(&verdict.decision);
        wrong
            .then(|| format!("{}: {}, {:?}", table.name, verdict.decision.name(), verdict.interval))
    })
}
