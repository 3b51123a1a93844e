//! Sequential stopping: pass, fail and unresolved rates of tables that end once settled, and their lengths.

use super::{CLASSES, Claim, Class, Known, Random, infer, table};
use crate::{Decision, FEWEST, Posterior, settles};

const MOST: usize = 8;

type Rule = fn(usize, Decision, Option<f64>, Option<Decision>) -> bool;

/// Decision and order from the coarsest three, four, … levels.
struct Growing {
    order: f64,
    said: Vec<Posterior>,
}

impl Growing {
    fn new(class: Class, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let order = random.one_of(&[1.0, 1.5, 2.0, 3.0]);
        let table = table(class, order, MOST, &mut random);
        let of = |levels| infer(&table[..levels], &Known::default()).expect("an order");
        Self { order, said: (FEWEST..=MOST).map(of).collect() }
    }

    fn stopped(&self, offset: f64, rule: Rule) -> (Decision, usize) {
        let claim = Claim::new(self.order + offset).expect("a claim");
        let mut before = None;
        for (levels, posterior) in (FEWEST..).zip(&self.said) {
            let ruling = posterior.decide(&claim);
            if levels == MOST || rule(levels, ruling.decision, Some(ruling.probability), before) {
                return (ruling.decision, levels);
            }
            before = Some(ruling.decision);
        }
        unreachable!("the last level ends it")
    }
}

/// Percent of pass, of fail, and the mean number of levels.
fn shares(tables: &[Growing], offset: f64, rule: Rule) -> [f64; 3] {
    let found: Vec<_> = tables.iter().map(|table| table.stopped(offset, rule)).collect();
    let of = |wanted| found.iter().filter(|(decision, _)| *decision == wanted).count() as f64;
    let levels = found.iter().map(|(_, levels)| *levels as f64).sum::<f64>();
    let count = found.len() as f64;
    [100.0 * of(Decision::Pass) / count, 100.0 * of(Decision::Fail) / count, levels / count]
}

/// Violations: at most 1 % of a class may pass an order off by ¼ or ½, and at most 1 % fail the true one. Reserved
/// seeds.
fn unmet(rule: Rule, classes: &[Class]) -> Vec<String> {
    let mut unmet = Vec::new();
    for class in classes {
        let tables: Vec<_> = (400_000..400_100).map(|seed| Growing::new(*class, seed)).collect();
        for offset in [0.0, 0.25, -0.25, 0.5, -0.5] {
            let [passed, failed, levels] = shares(&tables, offset, rule);
            let line = format!(
                "{class:?} {offset:+}: {passed:.1} % pass, {failed:.1} % fail, {levels:.2} levels"
            );
            println!("{line}");
            let wrong = if offset == 0.0 { failed } else { passed };
            if wrong > 1.0 {
                unmet.push(line);
            }
        }
    }
    unmet
}

#[test]
#[ignore = "seconds: make test-long"]
fn long_stopping_keeps_its_errors_below_one_percent() {
    assert_eq!(unmet(settles, &CLASSES), Vec::<String>::new());
    // It does stop early: an exact power needs four levels.
    assert!(shares(&[Growing::new(Class::Exact, 1)], 0.0, settles)[2] < 4.01);
}

#[test]
#[ignore = "seconds: make test-long"]
fn long_a_rule_that_ends_at_once_is_caught() {
    let at_once: Rule = |_, decision, _, _| decision != Decision::Unresolved;
    let found = unmet(at_once, &[Class::Plateau, Class::Noisy, Class::Bent]).join("\n");
    for wrong in ["Noisy -0.25", "Bent +0.25"] {
        assert!(found.contains(wrong), "{wrong}: {found}");
    }
}
