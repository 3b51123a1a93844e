//! What more data and less trust in them do to an answer, on 216 tables of one next term without noise.

use super::{Claim, Known, infer, level};
use crate::fit::{Decision, Level, Posterior};

/// e = h^p (1 + D h^r) on four, five, six halvings.
fn tables() -> impl Iterator<Item = (Vec<Level>, f64)> {
    let of = |p: f64, bend: f64, r: f64, levels: i32| {
        let steps = (0..levels).map(|i| 0.5f64.powi(i));
        steps.map(|h| level(h, h.powf(p) * (1.0 + bend * h.powf(r)))).collect::<Vec<_>>()
    };
    let bends = [-0.4, -0.2, -0.05, 0.05, 0.2, 0.4];
    let forms = bends.into_iter().flat_map(|bend| [0.5, 1.0, 2.0].map(|r| (bend, r)));
    let forms = forms.flat_map(|(bend, r)| [4, 5, 6].map(|levels| (bend, r, levels)));
    forms.flat_map(move |(bend, r, levels)| {
        [0.5, 1.0, 2.0, 3.0].map(|p| (of(p, bend, r, levels), p))
    })
}

fn read(table: &[Level], noise: Option<f64>) -> Posterior {
    infer(table, &Known { noise, ..Known::default() }).expect("a posterior")
}

/// After slopes that still bend, a slope of exactly the order is a break: with a floor or a slower term it would look like
/// this. Such a table may be open again, but not fail.
#[test]
fn one_more_level_of_the_order_takes_few_passes_away() {
    let (mut passes, mut open) = (0, 0);
    for (mut table, order) in tables() {
        let claim = Claim::new(order).expect("a claim");
        if read(&table, None).decide(&claim).decision != Decision::Pass {
            continue;
        }
        passes += 1;
        let last = table[table.len() - 1];
        table.push(level(0.5 * last.size(), last.error() * 0.5f64.powf(order)));
        let found = read(&table, None);
        match found.decide(&claim).decision {
            Decision::Fail => panic!("{order}: {table:?}"),
            Decision::Unresolved => {
                println!("{order}: {:.3?} {}", found.slopes, found.interval);
                open += 1;
            }
            Decision::Pass => {}
        }
    }
    println!("{open} of {passes} passes are open with one more level");
    assert!(passes > 150 && open <= OPEN, "{open} of {passes}");
}

/// A larger noise makes a next term less likely, and that may narrow the interval; mostly it widens it.
#[test]
fn a_larger_noise_narrows_few_intervals() {
    let (mut narrower, mut all) = (0, 0);
    for (table, _) in tables() {
        let widths = [0.001, 0.003, 0.01, 0.03, 0.1].map(|noise| {
            let interval = read(&table, Some(noise)).interval;
            interval.hi - interval.lo
        });
        all += widths.len() - 1;
        // By more than is printed.
        narrower += widths.windows(2).filter(|pair| pair[1] < pair[0] - 1e-3).count();
    }
    println!("{narrower} of {all} intervals are narrower");
    assert!(narrower <= NARROWER, "{narrower} of {all}");
}

/// As measured: 7 % of the passes, and a quarter of the steps from one noise to the next.
const OPEN: usize = 16;
const NARROWER: usize = 216;
