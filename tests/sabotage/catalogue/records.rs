//! Wrong entries in the table of cases.

use judge::record::{CaseRecord, Status, V_MAX};

use super::Defect;
use super::Term::Record;

/// The finest case of each scene changed, with the case before it.
pub(super) fn finest(name: &'static str, change: fn(&mut CaseRecord, &mut CaseRecord)) -> Defect {
    Record.records(name, move |records| {
        records.sort_by_key(CaseRecord::key);
        if let [.., before, last] = records.as_mut_slice() {
            change(last, before);
        }
    })
}

fn errors(record: &mut CaseRecord, change: impl Fn(f64) -> f64) {
    for entry in &mut record.errors {
        entry.error = entry.error.map(&change);
    }
}

/// All errors changed.
fn all_errors(name: &'static str, change: fn(f64) -> f64) -> Defect {
    Record.each(name, move |record| errors(record, change))
}

pub fn defects() -> Vec<Defect> {
    vec![
        Record.each("h recorded as the diameter, √2 h", |record| {
            record.h = record.h.map(|h| 2f64.sqrt() * h);
        }),
        Record.each("k recorded twice as large", |record| record.k *= 2.0),
        finest("h and k of the finest case recorded twice as large", |last, _| {
            last.h = last.h.map(|h| 2.0 * h);
            last.k *= 2.0;
        }),
        finest("finest case carries the errors of the one before", |last, before| {
            last.errors.clone_from(&before.errors);
        }),
        // What is left of a run that was broken off: ten times the error.
        finest("finest case stopped unconverged and recorded", |last, _| {
            errors(last, |error| 10.0 * error);
        }),
        finest("finest case failed", |last, _| {
            last.status = Status::Failed { reason: "seeded".into() };
            last.errors.iter_mut().for_each(|entry| entry.error = None);
        }),
        Record.records("finest case lost", |records| {
            records.sort_by_key(CaseRecord::key);
            records.pop();
        }),
        finest("NaN recorded as 0", |last, _| errors(last, |_| 0.0)),
        finest("NaN recorded", |last, _| errors(last, |_| f64::NAN)),
        all_errors("squared errors", |error| error * error),
        all_errors("errors 5 % too small", |error| 0.95 * error),
        Record.each("norms exchanged: V_max holds another one", |record| {
            let other = record.errors.iter().find(|entry| entry.norm != V_MAX);
            let other = other.map(|entry| (entry.error, entry.floor));
            let v_max = record.errors.iter_mut().find(|entry| entry.norm == V_MAX);
            if let (Some(v_max), Some((error, floor))) = (v_max, other) {
                (v_max.error, v_max.floor) = (error, floor);
            }
        }),
        all_errors("errors 1 % too small", |error| 0.99 * error),
        finest("errors of the two finest cases exchanged", |last, before| {
            std::mem::swap(&mut before.errors, &mut last.errors);
        }),
        Record.records("coarsest case lost", |records| {
            records.sort_by_key(CaseRecord::key);
            records.drain(..records.len().min(1));
        }),
        finest("k of the finest case recorded 1 % too large", |last, _| {
            last.h = last.h.map(|h| 1.01 * h);
            last.k *= 1.01;
        }),
        Record.each("h recorded half as large", |record| record.h = record.h.map(|h| 0.5 * h)),
        Record.each("k recorded as 1/N, whatever the horizon", |record| {
            record.k = 1.0 / f64::from(record.steps);
        }),
        Record.each("floors lost", |record| {
            record.errors.iter_mut().for_each(|entry| entry.floor = None);
        }),
        finest("finest errors 0 with floors of 0", |last, _| {
            errors(last, |_| 0.0);
            last.errors.iter_mut().for_each(|entry| entry.floor = Some(0.0));
        }),
        Record.each("floors a million times too high", |record| {
            for entry in &mut record.errors {
                entry.floor = entry.floor.map(|floor| 1e6 * floor);
            }
        }),
    ]
}
