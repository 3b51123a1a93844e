//! Wrong entries in the table of cases.

use judge::record::{CaseRecord, Status, V_MAX};

use super::{Defect, Term};

fn each(mut records: Vec<CaseRecord>, change: fn(&mut CaseRecord)) -> Vec<CaseRecord> {
    records.iter_mut().for_each(change);
    records
}

/// The finest case of each scene changed, with the case before it.
fn finest(
    mut records: Vec<CaseRecord>,
    change: fn(&mut CaseRecord, &CaseRecord),
) -> Vec<CaseRecord> {
    records.sort_by_key(CaseRecord::key);
    if let [.., before, last] = records.as_mut_slice() {
        change(last, before);
    }
    records
}

fn errors(record: &mut CaseRecord, change: impl Fn(f64) -> f64) {
    for entry in &mut record.errors {
        entry.error = entry.error.map(&change);
    }
}

pub fn defects() -> Vec<Defect> {
    let of = |name, records: fn(Vec<CaseRecord>) -> Vec<CaseRecord>| Defect {
        records,
        ..Defect::none(Term::Record, name)
    };
    vec![
        of("h recorded as the diameter, √2 h", |records| {
            each(records, |record| record.h = record.h.map(|h| 2f64.sqrt() * h))
        }),
        of("k recorded twice as large", |records| each(records, |record| record.k *= 2.0)),
        of("h and k of the finest case recorded twice as large", |records| {
            finest(records, |last, _| {
                last.h = last.h.map(|h| 2.0 * h);
                last.k *= 2.0;
            })
        }),
        of("finest case carries the errors of the one before", |records| {
            finest(records, |last, before| last.errors.clone_from(&before.errors))
        }),
        of("finest case stopped unconverged and recorded", |records| {
            // What is left of a run that was broken off: ten times the error.
            finest(records, |last, _| errors(last, |error| 10.0 * error))
        }),
        of("finest case failed", |records| {
            finest(records, |last, _| {
                last.status = Status::Failed { reason: "seeded".into() };
                last.errors.iter_mut().for_each(|entry| entry.error = None);
            })
        }),
        of("finest case lost", |records| {
            let mut records = records;
            records.sort_by_key(CaseRecord::key);
            records.pop();
            records
        }),
        of("NaN recorded as 0", |records| finest(records, |last, _| errors(last, |_| 0.0))),
        of("NaN recorded", |records| finest(records, |last, _| errors(last, |_| f64::NAN))),
        of("squared errors", |records| {
            each(records, |record| errors(record, |error| error * error))
        }),
        of("errors 5 % too small", |records| {
            each(records, |record| errors(record, |error| 0.95 * error))
        }),
        of("norms exchanged: V_max holds another one", |records| {
            each(records, |record| {
                let other = record.errors.iter().find(|entry| entry.norm != V_MAX);
                let other = other.map(|entry| (entry.error, entry.floor));
                let v_max = record.errors.iter_mut().find(|entry| entry.norm == V_MAX);
                if let (Some(v_max), Some((error, floor))) = (v_max, other) {
                    (v_max.error, v_max.floor) = (error, floor);
                }
            })
        }),
        of("errors 1 % too small", |records| {
            each(records, |record| errors(record, |error| 0.99 * error))
        }),
        of("errors of the two finest cases exchanged", |records| {
            let mut records = records;
            records.sort_by_key(CaseRecord::key);
            if let [.., before, last] = records.as_mut_slice() {
                std::mem::swap(&mut before.errors, &mut last.errors);
            }
            records
        }),
        of("coarsest case lost", |records| {
            let mut records = records;
            records.sort_by_key(CaseRecord::key);
            if !records.is_empty() {
                records.remove(0);
            }
            records
        }),
        of("k of the finest case recorded 1 % too large", |records| {
            finest(records, |last, _| {
                last.h = last.h.map(|h| 1.01 * h);
                last.k *= 1.01;
            })
        }),
        of("h recorded half as large", |records| {
            each(records, |record| record.h = record.h.map(|h| 0.5 * h))
        }),
        of("k recorded as 1/N, whatever the horizon", |records| {
            each(records, |record| record.k = 1.0 / f64::from(record.steps))
        }),
        of("floors lost", |records| {
            each(records, |record| record.errors.iter_mut().for_each(|entry| entry.floor = None))
        }),
        of("finest errors 0 with floors of 0", |records| {
            finest(records, |last, _| {
                errors(last, |_| 0.0);
                last.errors.iter_mut().for_each(|entry| entry.floor = Some(0.0));
            })
        }),
        of("floors a million times too high", |records| {
            each(records, |record| {
                for entry in &mut record.errors {
                    entry.floor = entry.floor.map(|floor| 1e6 * floor);
                }
            })
        }),
    ]
}
