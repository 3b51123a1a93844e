//! What may not change a verdict, and how claims follow from each other, on a thousand tables of all classes.

use super::classes::{KINDS, draw};
use super::{CLASSES, Claim, Known, Random, infer, level, table};
use crate::{Decision, Level, Posterior};

const TABLES: u64 = 1000;

fn tables() -> impl Iterator<Item = (Vec<Level>, f64)> {
    (0..TABLES).map(|seed| {
        let mut random = Random::new(900_000 + seed);
        let levels = 3 + (seed % 6) as usize;
        if seed % 2 == 0 {
            let class = CLASSES[(seed / 2) as usize % CLASSES.len()];
            let order = random.one_of(&[1.0, 1.5, 2.0, 3.0]);
            (table(class, order, levels, &mut random), order)
        } else {
            let drawn = draw(KINDS[(seed / 2) as usize % KINDS.len()], levels, &mut random);
            (drawn.table, drawn.order)
        }
    })
}

fn read(table: &[Level]) -> Posterior {
    infer(table, &Known::default()).expect("a posterior")
}

fn decide(posterior: &Posterior, order: f64, change: impl Fn(Claim) -> Claim) -> Decision {
    posterior.decide(&change(Claim::new(order).expect("a claim"))).decision
}

#[test]
fn scales_and_the_order_of_rows_change_no_verdict() {
    for (table, order) in tables() {
        let said = read(&table);
        let (mut turned, mut shifted) = (table.clone(), table.clone());
        turned.reverse();
        shifted.rotate_left(1);
        for other in [turned, shifted] {
            let found = read(&other);
            assert_eq!(decide(&said, order, |c| c), decide(&found, order, |c| c));
            assert_eq!(said.interval, found.interval);
        }
        // Sizes of one are rounding where they are small: errors keep away from it on both sides.
        let sizes = |factor: f64| {
            table.iter().map(|l| level(factor * l.size(), l.error())).collect::<Vec<_>>()
        };
        for factor in [1e-200, 1e200] {
            let found = read(&sizes(factor));
            assert_eq!(
                decide(&said, order, |c| c),
                decide(&found, order, |c| c),
                "{factor}: {table:?}"
            );
        }
        if table.iter().all(|level| level.error() > 1e-12) {
            for factor in [1e-200, 1e200] {
                let scaled: Vec<Level> =
                    table.iter().map(|l| level(l.size(), factor * l.error())).collect();
                let found = decide(&read(&scaled), order, |c| c);
                assert_eq!(decide(&said, order, |c| c), found, "{factor}: {table:?}");
            }
        }
    }
}

#[test]
fn claims_follow_from_each_other() {
    use Decision::{Fail, Pass, Unresolved};
    for (table, order) in tables() {
        let posterior = read(&table);
        let of = |claimed: f64| decide(&posterior, claimed, |c| c);
        let bound = |claimed| decide(&posterior, claimed, |c| Claim { at_least: true, ..c });
        let exact = |claimed| decide(&posterior, claimed, |c| Claim { exact: true, ..c });
        let claims = || (0..40).map(|i| 0.125 * f64::from(i + 2));
        for claimed in claims().chain([order]) {
            // A pass passes as a lower bound, a failed bound fails, and exactness only refutes more.
            assert!(of(claimed) != Pass || bound(claimed) == Pass, "{claimed} {table:?}");
            assert_eq!(bound(claimed) == Fail, of(claimed) == Fail, "{claimed} {table:?}");
            assert!(
                exact(claimed) == of(claimed)
                    || of(claimed) == Unresolved && exact(claimed) == Fail
            );
            let wider = decide(&posterior, claimed, |c| Claim { tolerance: 0.3, ..c });
            assert!(of(claimed) != Pass || wider == Pass, "{claimed} {table:?}");
            assert!(wider != Fail || of(claimed) == Fail, "{claimed} {table:?}");
        }
        // Along rising claims: unresolved, pass, unresolved, fail, each once at most.
        let place = |decision| match decision {
            Pass => 1,
            Fail => 2,
            Unresolved => 0,
        };
        let mut said: Vec<i32> = claims().map(|claimed| place(of(claimed))).collect();
        said.dedup();
        let passes = said.iter().filter(|s| **s == 1).count();
        let fails = said.iter().filter(|s| **s == 2).count();
        assert!(
            passes <= 1 && fails <= 1 && (fails == 0 || said.last() == Some(&2)),
            "{said:?} {table:?}"
        );
    }
}
