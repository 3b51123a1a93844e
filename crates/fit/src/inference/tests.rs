//! Pass, fail and unresolved rates on tables of known order, compared with two common rules.
//!
//! Some classes match the model (one next term, noise), others do not (two terms, other knees, a wild coarsest level).
//! The priors were chosen with other seeds.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use super::line::infer;
use super::{Claim, ClaimError, Known, Posterior, TOLERANCE};
use crate::{Decision, FitError, Level, LevelError, student_quantile};

mod classes;
mod invariances;
mod one_more;
mod stopping;

fn level(size: f64, error: f64) -> Level {
    Level::new(size, error).expect("a level")
}

struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        (0..8).for_each(|_| _ = random.uniform());
        random
    }

    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.uniform()
    }

    fn one_of(&mut self, values: &[f64]) -> f64 {
        values[(self.uniform() * values.len() as f64) as usize % values.len()]
    }

    fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Class {
    Exact,
    /// One next term and up to 1 % of noise.
    Smooth,
    Plateau,
    /// The first levels converge faster.
    Superconvergent,
    /// Ratios of 1.3 to 2.5, constants that oscillate by 1 %.
    Irregular,
    TwoTerms,
    /// The coarsest level is unrelated to the rest.
    Wild,
    Noisy,
    Floor,
    /// A next term of up to twice the first.
    Bent,
}

fn table(class: Class, p: f64, levels: usize, random: &mut Random) -> Vec<Level> {
    let ratio = |random: &mut Random| match class {
        Class::Irregular => random.between(1.3, 2.5),
        _ => 2.0,
    };
    let mut sizes = vec![1.0];
    for _ in 1..levels {
        let last = sizes[sizes.len() - 1];
        sizes.push(last / ratio(random));
    }
    let finest = sizes[levels - 1];
    let sign = |random: &mut Random| if random.uniform() < 0.5 { -1.0 } else { 1.0 };
    let (power, size) = (random.one_of(&[1.0, 1.0, 2.0]), random.between(0.0, 0.4));
    let (term, other) = (sign(random) * size, sign(random) * random.between(0.0, 0.2));
    let noise = match class {
        Class::Smooth => random.one_of(&[0.0, 0.001, 0.003, 0.01]),
        Class::Noisy => 0.03,
        _ => 0.0,
    };
    let (bend, root) = (random.between(-0.7, 2.0), random.one_of(&[0.5, 1.0, 2.0]));
    let knee = random.between(0.1, 0.4);
    let phase = random.between(0.0, 6.0);
    let factor = |i: usize, h: f64, random: &mut Random| match class {
        Class::Exact => 1.0,
        Class::Smooth | Class::Noisy => {
            (1.0 + term * h.powf(power)) * (noise * random.normal()).exp()
        }
        Class::Plateau => 1.0 / (1.0 + (h / knee).powf(p)),
        Class::Superconvergent => 1.0 + (h / knee).powi(2),
        Class::Irregular => 1.0 + 0.01 * (7.0 * i as f64 + phase).sin(),
        Class::TwoTerms => 1.0 + term * h + other * h * h,
        Class::Wild if i == 0 => 10f64.powf(phase / 3.0 - 1.0),
        Class::Wild => 1.0,
        Class::Bent => 1.0 + bend * h.powf(root),
        Class::Floor => 1.0 + 0.8 * (finest / h).powf(p),
    };
    let error = |(i, &h): (usize, &f64)| level(h, 3.0 * h.powf(p) * factor(i, h, random));
    sizes.iter().enumerate().map(error).collect()
}

/// Common rule: the last slope within 0.1.
fn last_pair(table: &[Level], order: f64) -> Decision {
    let [.., a, b] = table else { return Decision::Unresolved };
    let slope = (a.error() / b.error()).ln() / (a.size() / b.size()).ln();
    if (slope - order).abs() <= 0.1 { Decision::Pass } else { Decision::Fail }
}

/// Least squares of log e by log h: both means, the squares of log h about its mean, the slope.
fn straight_line(table: &[Level]) -> [f64; 4] {
    let n = table.len() as f64;
    let mean = |f: fn(&Level) -> f64| table.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(|l| l.size().ln()), mean(|l| l.error().ln()));
    let spread: f64 = table.iter().map(|l| (l.size().ln() - x).powi(2)).sum();
    let products: f64 = table.iter().map(|l| (l.size().ln() - x) * (l.error().ln() - y)).sum();
    [x, y, spread, products / spread]
}

/// Common rule: Student's interval of a straight line contains the order and is narrower than ±0.15.
fn student(table: &[Level], order: f64) -> Decision {
    let n = table.len() as f64;
    let [x, y, spread, slope] = straight_line(table);
    let left: f64 =
        table.iter().map(|l| (l.error().ln() - y - slope * (l.size().ln() - x)).powi(2)).sum();
    let reach = student_quantile(table.len() - 2).expect("degrees of freedom")
        * (left / (n - 2.0) / spread).sqrt();
    match () {
        () if order > slope + reach + 0.05 => Decision::Fail,
        () if (order - slope).abs() <= reach + 0.01 && reach <= 0.15 => Decision::Pass,
        () => Decision::Unresolved,
    }
}

fn judge(table: &[Level], order: f64) -> Decision {
    posterior_of(table).decide(&Claim::new(order).expect("a claim")).decision
}

/// The posterior of a table, on which several claims are judged: inferred once.
fn posterior_of(table: &[Level]) -> Rc<Posterior> {
    type Cache = HashMap<Vec<[u64; 2]>, Rc<Posterior>>;
    thread_local!(static KNOWN: RefCell<Cache> = RefCell::default());
    let numbers = |level: &Level| [level.size(), level.error()].map(f64::to_bits);
    let new = || Rc::new(infer(table, &Known::default()).expect("a posterior"));
    let key = table.iter().map(numbers).collect();
    KNOWN.with_borrow_mut(|known| known.entry(key).or_insert_with(new).clone())
}

/// Shares of pass and fail for a claim that is off by `offset`.
fn shares(
    rule: fn(&[Level], f64) -> Decision,
    (class, levels, offset): (Class, usize, f64),
    seeds: std::ops::Range<u64>,
) -> [f64; 2] {
    let count = seeds.clone().count() as f64;
    let mut found = [0.0; 2];
    for seed in seeds {
        let mut random = Random::new(seed);
        let p = random.one_of(&[1.0, 1.5, 2.0, 3.0]);
        match rule(&table(class, p, levels, &mut random), p + offset) {
            Decision::Pass => found[0] += 1.0,
            Decision::Fail => found[1] += 1.0,
            Decision::Unresolved => {}
        }
    }
    found.map(|number| number / count)
}

const CLASSES: [Class; 10] = [
    Class::Exact,
    Class::Smooth,
    Class::Plateau,
    Class::Superconvergent,
    Class::Irregular,
    Class::TwoTerms,
    Class::Wild,
    Class::Noisy,
    Class::Floor,
    Class::Bent,
];

type Rule = fn(&[Level], f64) -> Decision;

/// A requirement: classes and numbers of levels, the offset of the claim, bounds in percent of pass and fail.
struct Demand {
    classes: &'static [Class],
    levels: std::ops::RangeInclusive<usize>,
    offset: f64,
    pass: [f64; 2],
    fail: [f64; 2],
}

const ANY: [f64; 2] = [0.0, 100.0];
/// Classes whose order shows in a few levels.
const CLEAN: &[Class] = &[Class::Exact, Class::Smooth, Class::Irregular, Class::TwoTerms];
const COARSE_START: &[Class] = &[Class::Plateau, Class::Superconvergent];

fn demands() -> Vec<Demand> {
    let of = |classes, levels, offset, pass, fail| Demand { classes, levels, offset, pass, fail };
    let mut demands = vec![
        // Two slopes that rise may be those of errors against a finer run, unless the table says that they are not.
        of(&[Class::Smooth], 3..=3, 0.0, [70.0, 100.0], [0.0, 0.5]),
        of(&[Class::Smooth], 4..=4, 0.0, [90.0, 100.0], [0.0, 0.5]),
        of(&[Class::Smooth], 5..=8, 0.0, [97.0, 100.0], [0.0, 0.5]),
        of(&[Class::Plateau], 8..=8, 0.0, [95.0, 100.0], [0.0, 4.0]),
        of(&[Class::Superconvergent], 8..=8, 0.0, [90.0, 100.0], [0.0, 4.0]),
        of(&[Class::Irregular], 5..=8, 0.0, [92.0, 100.0], [0.0, 0.5]),
        of(&[Class::TwoTerms, Class::Wild], 5..=8, 0.0, [97.0, 100.0], [0.0, 0.5]),
        of(&[Class::Noisy], 8..=8, 0.0, [90.0, 100.0], ANY),
        of(COARSE_START, 4..=8, 0.0, ANY, [0.0, 4.0]),
        of(&[Class::Exact, Class::Smooth], 3..=3, 0.5, ANY, [82.0, 100.0]),
        of(&[Class::Exact], 8..=8, 0.1, ANY, [97.0, 100.0]),
    ];
    for (offset, most) in [(0.25, 0.5), (-0.25, 0.5), (0.5, 0.1), (-0.5, 0.1)] {
        demands.push(of(CLEAN, 4..=5, offset, [0.0, most], ANY));
        demands.push(of(CLEAN, 3..=3, offset, [0.0, most], ANY));
        demands.push(of(&[Class::Superconvergent], 3..=4, offset, [0.0, most], ANY));
    }
    demands
}

/// Seeds reserved for the requirements, one per table of a class and number of levels.
const SEEDS: std::ops::Range<u64> = 90_000..90_100;

/// Requirements that a rule misses.
fn unmet(rule: Rule, seeds: std::ops::Range<u64>) -> impl Iterator<Item = String> {
    let met = |[lo, hi]: [f64; 2], share: f64| lo <= share && share <= hi;
    demands().into_iter().filter_map(move |demand| {
        let Demand { classes, levels, offset, pass, fail } = demand;
        let cells = classes.iter().flat_map(|class| levels.clone().map(move |l| (*class, l)));
        let found: Vec<[f64; 2]> =
            cells.map(|(class, l)| shares(rule, (class, l, offset), seeds.clone())).collect();
        let mean =
            |at: usize| 100.0 * found.iter().map(|cell| cell[at]).sum::<f64>() / found.len() as f64;
        let [passed, failed] = [mean(0), mean(1)];
        println!("{classes:?} {levels:?} {offset:+}: {passed:.2} % pass, {failed:.2} % fail");
        let what = format!("{classes:?} {levels:?} {offset:+}: {passed:.2}, {failed:.2}");
        (!met(pass, passed) || !met(fail, failed)).then_some(what)
    })
}

/// Three of six levels of order 2 lie near a floor of 1e-3.
#[test]
fn levels_near_their_floors_leave() {
    let near = |i: i32| {
        let error = 0.25f64.powi(i);
        level(0.5f64.powi(i), error + 1e-3).with_floor(1e-3).expect("a floor")
    };
    // 4^-3 is 16 floors; 20 are needed.
    let told: Vec<Level> = (0..6).map(near).collect();
    let found = infer(&told, &Known::default()).expect("an order");
    assert_eq!(found.slopes.len(), 2, "{:?}", found.slopes);
    let too_few = infer(&told[1..], &Known::default()).expect_err("two levels");
    assert_eq!(too_few, FitError::TooFew { found: 2, needed: 3 });
}

#[test]
fn the_judge_meets_its_demands() {
    assert_eq!(unmet(judge, SEEDS).next(), None);
}

#[test]
fn errors_against_an_exact_solution_need_no_reference() {
    let told: Rule = |table, order| {
        let posterior = infer(table, &Known::EXACT).expect("a posterior");
        posterior.decide(&Claim::new(order).expect("a claim")).decision
    };
    let [pass, fail] = shares(told, (Class::Smooth, 3, 0.0), SEEDS);
    assert!(pass >= 0.75 && fail <= 0.005, "{pass} {fail}");
}

/// A thousand fresh tables per class and number of levels.
#[test]
#[ignore = "minutes"]
fn the_judge_meets_them_on_fresh_tables() {
    assert_eq!(unmet(judge, 700_000..701_000).next(), None);
}

/// Neither the median alone nor the two common rules meet the requirements.
#[test]
fn other_rules_do_not_meet_them() {
    fn median(table: &[Level], order: f64) -> Decision {
        let posterior = posterior_of(table);
        let near = (posterior.order - order).abs() <= TOLERANCE;
        if near { Decision::Pass } else { Decision::Fail }
    }
    for rule in [median as Rule, last_pair, student] {
        assert!(unmet(rule, SEEDS).next().is_some());
    }
}

/// The trapezoidal rule for x log x on [0, 1], h² (|log h|/12 + 0.24875), and h² beside h³.
#[test]
fn slopes_that_rise_slowly_name_the_logarithm() {
    let reason = |error: fn(f64) -> f64, order: f64| {
        let table: Vec<Level> =
            (3..9).map(|i| 0.5f64.powi(i)).map(|h| level(h, error(h))).collect();
        let found = infer(&table, &Known::default()).expect("an order");
        let ruling = found.decide(&Claim::new(order).expect("a claim"));
        assert_eq!(ruling.decision, Decision::Fail, "{ruling:?}");
        ruling.reason
    };
    let log = reason(|h| h * h * (h.ln().abs() / 12.0 + 0.24875), 2.0);
    assert!(log.contains("a factor |log h|"), "{log}");
    let plain = reason(|h| h * h * (1.0 - h), 2.25);
    assert!(!plain.contains("log"), "{plain}");
}

#[test]
fn what_is_no_table_is_refused() {
    let [a, b, c] = [0.25, 0.125, 0.0625].map(|h| level(h, h));
    let refused = |levels: &[Level], noise, log| {
        infer(levels, &Known { noise, log, ..Known::default() }).unwrap_err()
    };
    assert_eq!(refused(&[a, b], None, 0.0), FitError::TooFew { found: 2, needed: 3 });
    for noise in [0.0, -0.1, f64::NAN, f64::INFINITY, 1e308] {
        let none = refused(&[a, b, c], Some(noise), 0.0);
        assert!(matches!(none, FitError::Level(LevelError::Sigma(_))), "{none}");
    }
    for log in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308] {
        assert!(matches!(refused(&[a, b, c], None, log), FitError::Log(_)), "{log}");
        let claim = Claim { log, ..Claim::new(1.0).expect("a claim") };
        assert!(matches!(claim.checked(), Err(ClaimError::Log(_))), "{log}");
    }
    let both = Claim { at_least: true, exact: true, ..Claim::new(1.0).expect("a claim") };
    assert_eq!(both.checked(), Err(ClaimError::Both));
    let one = level(1.0, 1.0);
    assert_eq!(refused(&[one, a, b], None, 1.0), FitError::NoLogarithm { step: 1.0 });
    let apart = [level(64.0, 1.0), level(32.0, 0.5), level(5e-324, 0.1)];
    let no_ratio = FitError::NoRatio { coarse: 64.0, fine: 5e-324 };
    assert_eq!(refused(&apart, None, 0.0), no_ratio);
    for order in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(Claim::new(order).is_err());
    }
}
