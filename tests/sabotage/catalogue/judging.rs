//! A judge that is wrong itself: what it reads of a table, or what its inference is given of it.

use std::collections::BTreeMap;
use std::sync::Arc;

use judge::fit::{Claim, Direction, Known, Level, Point, Posterior, infer, infer_grid};
use judge::record::{CaseRecord, Key, NormError};
use judge::verdict::{Decision, FittedConstant, JudgedPoint, Variable, Verdict};

use super::{Defect, Table, Term};

/// Distinct steps in falling order, each with its place.
fn ranks(values: impl Iterator<Item = f64>) -> BTreeMap<u64, usize> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(|a, b| b.total_cmp(a));
    sorted.dedup();
    sorted.iter().enumerate().map(|(i, value)| (value.to_bits(), i)).collect()
}

/// The posterior against the order that was predicted.
fn ruled(posterior: &Posterior, order: f64, at_least: bool) -> Decision {
    let claim = Claim { at_least, ..Claim::new(order).expect("a finite order") };
    posterior.decide(&claim).decision
}

/// The judge again, by the order alone, on the errors that a defect makes of a step and an error.
fn again(verdict: &mut Verdict, error: impl Fn(f64, f64) -> f64) {
    let direction = match verdict.variable {
        Variable::H | Variable::Path => Direction::Space,
        Variable::K => Direction::Time,
        Variable::Joint => return grid_again(verdict),
    };
    if !verdict.complete || verdict.observed.is_none() {
        return;
    }
    let level = |used: &JudgedPoint| {
        let step = direction.step(&point(used));
        Level::new(step, error(step, used.point.error)).expect("an error")
    };
    let levels: Vec<Level> = verdict.points_used.iter().map(level).collect();
    let posterior = infer(&levels, &Known::default()).expect("levels that served");
    verdict.observed = Some(posterior.order);
    verdict.interval = Some([posterior.interval.lo, posterior.interval.hi]);
    verdict.decision = ruled(&posterior, verdict.predicted, verdict.at_least);
}

fn grid_again(verdict: &mut Verdict) {
    let points: Vec<Point> = verdict.points_used.iter().map(point).collect();
    let (Some(order_k), Ok(found)) = (verdict.predicted_k, infer_grid(&points, None)) else {
        return;
    };
    if verdict.complete {
        let both = [(&found.order_h, verdict.predicted), (&found.order_k, order_k)];
        let [h, k] = both.map(|(posterior, order)| ruled(posterior, order, verdict.at_least));
        verdict.decision = h.and(k);
    }
}

fn point(used: &JudgedPoint) -> Point {
    Point { floor: 0.0, ..used.point }
}

/// The verdict, where a compared constant of ratio r was refuted that this judge lets pass.
fn forgiving(name: &'static str, passes: fn(f64) -> bool) -> Defect {
    says(name, move |verdict| {
        let refuted = |constant: &FittedConstant| {
            let (ratio, tolerance) = (constant.ratio?, constant.tolerance?);
            ((ratio - 1.0).abs() > tolerance).then_some(ratio)
        };
        if verdict.constants.values().find_map(refuted).is_some_and(passes) {
            again(verdict, |_, error| error);
        }
    })
}

fn says(name: &'static str, after: impl Fn(&mut Verdict) + Send + Sync + 'static) -> Defect {
    Defect { after: Some(Arc::new(after)), ..Defect::none(Term::Judging, name) }
}

fn reads(name: &'static str, before: fn(&mut Vec<CaseRecord>, &mut Vec<Key>)) -> Defect {
    let before = move |(records, keys): &mut Table| before(records, keys);
    Defect { before: Some(Arc::new(before)), ..Defect::none(Term::Judging, name) }
}

fn lists(name: &'static str, all: fn(&mut Vec<Verdict>)) -> Defect {
    Defect { all: Some(Arc::new(all)), ..Defect::none(Term::Judging, name) }
}

fn pass(verdict: &mut Verdict) {
    (verdict.decision, verdict.complete) = (Decision::Pass, true);
}

pub fn defects() -> Vec<Defect> {
    vec![
        reads("all ratios of steps taken for 2", |records, _| {
            let hs = ranks(records.iter().filter_map(|record| record.h));
            let ks = ranks(records.iter().map(|record| record.k));
            for record in records {
                record.h = record.h.map(|h| 0.5f64.powi(hs[&h.to_bits()] as i32));
                record.k = 0.5f64.powi(ks[&record.k.to_bits()] as i32);
            }
        }),
        // Errors are paired with steps in the order of their names as texts.
        reads("cases sorted as texts", |records, _| {
            records.sort_by_key(CaseRecord::key);
            let mut named: Vec<usize> = (0..records.len()).collect();
            named.sort_by_key(|&i| format!("{:?} {}", records[i].n, records[i].steps));
            let errors: Vec<_> = named.iter().map(|&i| records[i].errors.clone()).collect();
            for (record, errors) in records.iter_mut().zip(errors) {
                record.errors = errors;
            }
        }),
        // What does not fit is not there: neither the records nor the plan.
        reads("missing, failed and NaN cases skipped", |records, keys| {
            let is_finite = |entry: &NormError| entry.error.is_some_and(f64::is_finite);
            records.retain(|record| record.converged() && record.errors.iter().all(is_finite));
            keys.retain(|key| records.iter().any(|record| record.key() == *key));
        }),
        reads("finest case left out", |records, keys| {
            records.sort_by_key(CaseRecord::key);
            if let Some(last) = records.pop() {
                keys.retain(|key| *key != last.key());
            }
        }),
        reads("floors ignored", |records, _| {
            for entry in records.iter_mut().flat_map(|record| &mut record.errors) {
                entry.floor = Some(0.0);
            }
        }),
        // Divergence reads as convergence.
        says("absolute value of the order", |verdict| {
            if verdict.observed.is_some_and(|order| order < 0.0) {
                again(verdict, |_, error| error.recip());
            }
        }),
        // The fitted slope alone, as if it were certain: an exact law of that order.
        says("slope ± 0.1 in place of the interval", |verdict| {
            if let Some(order) = verdict.observed {
                again(verdict, |step, _| step.powf(order));
            }
        }),
        says("orders above the prediction cut to it", |verdict| {
            let most = verdict.predicted;
            if verdict.observed.is_some_and(|order| order > most) {
                again(verdict, |step, _| step.powf(most));
            }
        }),
        says("tolerance 0.5", |verdict| {
            let most = verdict.predicted;
            let near = |[lo, hi]: [f64; 2]| lo <= most + 0.5 && hi >= most - 0.5;
            if verdict.complete && verdict.interval.is_some_and(near) {
                verdict.decision = Decision::Pass;
            }
        }),
        says("unresolved counts as pass", |verdict| {
            if verdict.decision == Decision::Unresolved {
                verdict.decision = Decision::Pass;
            }
        }),
        says("always pass", pass),
        // They are fitted and shown.
        says("constants compared with nothing", |verdict| {
            again(verdict, |_, error| error);
            verdict.constants.values_mut().for_each(|constant| constant.ratio = None);
            verdict.constant = None;
        }),
        forgiving("a constant within 50 % passes", |ratio| (ratio - 1.0).abs() <= 0.5),
        forgiving("a constant too small passes", |ratio| ratio < 1.0),
        // Nothing fails as long as something is as expected.
        lists("any verdict as expected is enough", |verdicts| {
            if verdicts.iter().any(Verdict::as_expected) {
                verdicts.iter_mut().for_each(pass);
            }
        }),
        lists("the last verdict counts for all", |verdicts| {
            if let Some(last) = verdicts.last().map(|verdict| verdict.decision) {
                verdicts.iter_mut().for_each(|verdict| verdict.decision = last);
            }
        }),
        lists("first prediction judged alone", |verdicts| verdicts.truncate(1)),
        lists("failed verdicts dropped", |verdicts| {
            verdicts.retain(|verdict| verdict.decision != Decision::Fail);
        }),
        lists("unresolved verdicts dropped", |verdicts| {
            verdicts.retain(|verdict| verdict.decision != Decision::Unresolved);
        }),
    ]
}
