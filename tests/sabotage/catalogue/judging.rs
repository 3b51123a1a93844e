//! A judge that is wrong itself: what it reads of a table, or what its inference is given of it.

use std::collections::BTreeMap;

use judge::fit::{Claim, Direction, Known, Level, Point, Posterior, infer, infer_grid};
use judge::record::CaseRecord;
use judge::verdict::{Decision, JudgedPoint, Variable, Verdict};

use super::{Defect, Table, Term};

/// Distinct steps in falling order, each with its place.
fn ranks(values: impl Iterator<Item = f64>) -> BTreeMap<u64, usize> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(|a, b| b.total_cmp(a));
    sorted.dedup();
    sorted.iter().enumerate().map(|(i, value)| (value.to_bits(), i)).collect()
}

/// Every ratio of steps taken for two.
fn halving((mut records, keys): Table) -> Table {
    let hs = ranks(records.iter().filter_map(|record| record.h));
    let ks = ranks(records.iter().map(|record| record.k));
    for record in &mut records {
        record.h = record.h.map(|h| 0.5f64.powi(hs[&h.to_bits()] as i32));
        record.k = 0.5f64.powi(ks[&record.k.to_bits()] as i32);
    }
    (records, keys)
}

/// Errors paired with steps in the order of their names as texts.
fn as_texts((mut records, keys): Table) -> Table {
    records.sort_by_key(CaseRecord::key);
    let mut named: Vec<usize> = (0..records.len()).collect();
    let text = |record: &CaseRecord| format!("{:?} {}", record.n, record.steps);
    named.sort_by_key(|&i| text(&records[i]));
    let errors: Vec<_> = named.iter().map(|&i| records[i].errors.clone()).collect();
    for (record, errors) in records.iter_mut().zip(errors) {
        record.errors = errors;
    }
    (records, keys)
}

/// What does not fit is not there: neither the records nor the plan.
fn without_broken((records, keys): Table) -> Table {
    let whole = |record: &CaseRecord| {
        record.converged()
            && record.errors.iter().all(|entry| entry.error.is_some_and(f64::is_finite))
    };
    let records: Vec<CaseRecord> = records.into_iter().filter(whole).collect();
    let there = |key: &judge::record::Key| records.iter().any(|record| record.key() == *key);
    let keys = keys.into_iter().filter(there).collect();
    (records, keys)
}

/// The finest case is left out wherever it stands.
fn without_finest((mut records, mut keys): Table) -> Table {
    records.sort_by_key(CaseRecord::key);
    if let Some(last) = records.pop() {
        keys.retain(|key| *key != last.key());
    }
    (records, keys)
}

/// Floors are not read.
fn without_floors((mut records, keys): Table) -> Table {
    for entry in records.iter_mut().flat_map(|record| &mut record.errors) {
        entry.floor = Some(0.0);
    }
    (records, keys)
}

/// The posterior against the order that was predicted.
fn ruled(posterior: &Posterior, order: f64, at_least: bool) -> Decision {
    let claim = Claim { at_least, ..Claim::new(order).expect("a finite order") };
    posterior.decide(&claim).decision
}

/// The judge again, by the order alone, on the errors that a defect makes of a step and an error.
fn again(mut verdict: Verdict, error: impl Fn(f64, f64) -> f64) -> Verdict {
    let direction = match verdict.variable {
        Variable::H | Variable::Path => Direction::Space,
        Variable::K => Direction::Time,
        Variable::Joint => return grid_again(verdict),
    };
    if !verdict.complete || verdict.observed.is_none() {
        return verdict;
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
    verdict
}

fn grid_again(mut verdict: Verdict) -> Verdict {
    let points: Vec<Point> = verdict.points_used.iter().map(point).collect();
    let (Some(order_k), Ok(found)) = (verdict.predicted_k, infer_grid(&points, None)) else {
        return verdict;
    };
    if verdict.complete {
        let both = [(&found.order_h, verdict.predicted), (&found.order_k, order_k)];
        let [h, k] = both.map(|(posterior, order)| ruled(posterior, order, verdict.at_least));
        verdict.decision = h.and(k);
    }
    verdict
}

fn point(used: &JudgedPoint) -> Point {
    Point { floor: 0.0, ..used.point }
}

/// |order|: divergence reads as convergence.
fn absolute(verdict: Verdict) -> Verdict {
    match verdict.observed {
        Some(order) if order < 0.0 => again(verdict, |_, error| error.recip()),
        _ => verdict,
    }
}

/// The fitted slope alone, as if it were certain: an exact law of that order.
fn without_interval(verdict: Verdict) -> Verdict {
    match verdict.observed {
        Some(order) => again(verdict, |step, _| step.powf(order)),
        None => verdict,
    }
}

/// Orders above the prediction cut to it.
fn never_too_high(verdict: Verdict) -> Verdict {
    let most = verdict.predicted;
    match verdict.observed {
        Some(order) if order > most => again(verdict, |step, _| step.powf(most)),
        _ => verdict,
    }
}

fn wider(verdict: Verdict) -> Verdict {
    let most = verdict.predicted;
    let near = |[lo, hi]: [f64; 2]| lo <= most + 0.5 && hi >= most - 0.5;
    match verdict.interval.filter(|_| verdict.complete).is_some_and(near) {
        true => Verdict { decision: Decision::Pass, ..verdict },
        false => verdict,
    }
}

fn lenient(verdict: Verdict) -> Verdict {
    match verdict.decision {
        Decision::Unresolved => Verdict { decision: Decision::Pass, ..verdict },
        _ => verdict,
    }
}

fn always(verdict: Verdict) -> Verdict {
    Verdict { decision: Decision::Pass, complete: true, ..verdict }
}

fn by_order_alone(verdict: Verdict) -> Verdict {
    again(verdict, |_, error| error)
}

/// Constants are fitted and shown, and compared with nothing.
fn without_comparison(verdict: Verdict) -> Verdict {
    let mut verdict = by_order_alone(verdict);
    verdict.constants.values_mut().for_each(|constant| constant.ratio = None);
    verdict.constant = None;
    verdict
}

/// The verdict, where a compared constant of ratio r was refuted that this judge lets pass.
fn forgiving(verdict: Verdict, passes: fn(f64) -> bool) -> Verdict {
    let refuted = |constant: &judge::verdict::FittedConstant| {
        let (ratio, tolerance) = (constant.ratio?, constant.tolerance?);
        ((ratio - 1.0).abs() > tolerance).then_some(ratio)
    };
    match verdict.constants.values().find_map(refuted) {
        Some(ratio) if passes(ratio) => by_order_alone(verdict),
        _ => verdict,
    }
}

/// Nothing fails as long as something is as expected.
fn any_is_enough(verdicts: Vec<Verdict>) -> Vec<Verdict> {
    match verdicts.iter().any(Verdict::as_expected) {
        true => verdicts.into_iter().map(always).collect(),
        false => verdicts,
    }
}

fn last_for_all(mut verdicts: Vec<Verdict>) -> Vec<Verdict> {
    if let Some(last) = verdicts.last().map(|verdict| verdict.decision) {
        verdicts.iter_mut().for_each(|verdict| verdict.decision = last);
    }
    verdicts
}

fn refuted_dropped(mut verdicts: Vec<Verdict>) -> Vec<Verdict> {
    verdicts.retain(|verdict| verdict.decision != Decision::Fail);
    verdicts
}

fn unresolved_dropped(mut verdicts: Vec<Verdict>) -> Vec<Verdict> {
    verdicts.retain(|verdict| verdict.decision != Decision::Unresolved);
    verdicts
}

/// One prediction a run: the first.
fn first_alone(mut verdicts: Vec<Verdict>) -> Vec<Verdict> {
    verdicts.truncate(1);
    verdicts
}

pub fn defects() -> Vec<Defect> {
    let lists = |name, all| Defect { all, ..Defect::none(Term::Judging, name) };
    let reads = |name, before| Defect { before, ..Defect::none(Term::Judging, name) };
    let says = |name, after| Defect { after, ..Defect::none(Term::Judging, name) };
    vec![
        reads("all ratios of steps taken for 2", halving),
        reads("cases sorted as texts", as_texts),
        reads("missing, failed and NaN cases skipped", without_broken),
        reads("finest case left out", without_finest),
        reads("floors ignored", without_floors),
        says("absolute value of the order", absolute),
        says("slope ± 0.1 in place of the interval", without_interval),
        says("orders above the prediction cut to it", never_too_high),
        says("tolerance 0.5", wider),
        says("unresolved counts as pass", lenient),
        says("always pass", always),
        says("constants compared with nothing", without_comparison),
        says("a constant within 50 % passes", |verdict| {
            forgiving(verdict, |ratio| (ratio - 1.0).abs() <= 0.5)
        }),
        says("a constant too small passes", |verdict| forgiving(verdict, |ratio| ratio < 1.0)),
        lists("any verdict as expected is enough", any_is_enough),
        lists("the last verdict counts for all", last_for_all),
        lists("first prediction judged alone", first_alone),
        lists("failed verdicts dropped", refuted_dropped),
        lists("unresolved verdicts dropped", unresolved_dropped),
    ]
}
