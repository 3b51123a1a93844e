//! A table of classes that are not the families of the model at its own nodes, beside the rules in common use.

use super::{Random, level, straight_line};
use crate::{Claim, Decision, Known, Level, infer};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A next term of a power that is in no list, up to 1 % of noise.
    Bend,
    /// Errors against a run at a half, a quarter, an eighth of the finest step: differences, and roots of squares.
    Reference,
    ReferenceSquares,
    /// One to L − 4 levels in a constant floor, and in one that scatters.
    Floor,
    RandomFloor,
    /// A power lower by ½ or 1, 1 to 30 % of the finest error.
    Slow,
    /// h^s + b h².
    Corner,
    /// The next term outweighs the first on coarse levels and has the other sign.
    SignChange,
    /// 0.3 to 10 %.
    Noise,
    /// Constants of even and odd levels differ by 10 to 30 %.
    OddEven,
    Plateau,
    /// Grows by nine orders of magnitude and falls again.
    BlowUp,
    /// Orders 4 to 12.
    High,
    /// Nothing but rounding of numbers of size one.
    Rounding,
}

pub(super) const KINDS: [Kind; 14] = [
    Kind::Bend,
    Kind::Reference,
    Kind::ReferenceSquares,
    Kind::Floor,
    Kind::RandomFloor,
    Kind::Slow,
    Kind::Corner,
    Kind::SignChange,
    Kind::Noise,
    Kind::OddEven,
    Kind::Plateau,
    Kind::BlowUp,
    Kind::High,
    Kind::Rounding,
];

/// A table, its order, another order that may be read in its place, and the step of its reference.
pub(super) struct Drawn {
    pub(super) table: Vec<Level>,
    pub(super) order: f64,
    pub(super) other: f64,
    pub(super) reference: f64,
}

fn log_between(random: &mut Random, lo: f64, hi: f64) -> f64 {
    random.between(lo.ln(), hi.ln()).exp()
}

pub(super) fn draw(kind: Kind, levels: usize, random: &mut Random) -> Drawn {
    let sizes: Vec<f64> = (0..levels as i32).map(|i| 0.5f64.powi(i)).collect();
    let finest = sizes[levels - 1];
    let orders: &[f64] = match kind {
        Kind::Reference | Kind::ReferenceSquares => &[0.5, 0.75, 1.0, 1.5, 2.0, 3.0],
        Kind::High => &[4.0, 5.0, 6.0, 8.0, 12.0],
        Kind::Floor | Kind::RandomFloor => &[1.0, 1.5, 2.0, 3.0, 4.0, 6.0],
        _ => &[1.0, 1.5, 2.0, 3.0],
    };
    let mut p = random.one_of(orders);
    let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
    let bend = sign * random.between(0.0, 0.4);
    let power = random.between(0.5, 2.2);
    let reference = finest / random.one_of(&[2.0, 4.0, 8.0]);
    let flat = 1 + (random.uniform() * levels.saturating_sub(4).max(1) as f64) as usize;
    let floor = sizes[levels - flat].powf(p);
    let slower = if p > 1.25 { random.one_of(&[0.5, 1.0]) } else { 0.5 };
    let slow = log_between(random, 0.01, 0.3);
    let corner = random.between(0.4, 1.7);
    let quadratic = random.between(-0.7, 2.0);
    let crossing = -random.between(1.1, 8.0);
    let crossing_power = random.one_of(&[0.5, 1.0, 2.0]);
    let noise = match kind {
        Kind::Bend => random.one_of(&[0.0, 0.001, 0.003, 0.01]),
        Kind::Noise => log_between(random, 0.003, 0.1),
        Kind::High => 0.003,
        _ => 0.0,
    };
    let odd = sign * random.between(0.05, 0.15);
    let knee = random.between(0.1, 0.4);
    let mut other = p;
    let error = |(i, &h): (usize, &f64)| {
        let clean = h.powf(p);
        let exact = match kind {
            Kind::Bend => clean * (1.0 + bend * h.powf(power)),
            Kind::High => clean * (1.0 + 0.5 * bend * h.powf(power)),
            Kind::Reference => clean - reference.powf(p),
            Kind::ReferenceSquares => (clean.powi(2) - reference.powf(2.0 * p)).sqrt(),
            Kind::Floor => clean + floor,
            Kind::RandomFloor => clean + floor * (0.5 * random.normal()).exp(),
            Kind::Slow => clean * (1.0 + slow * (h / finest).powf(-slower)),
            Kind::Corner => h.powf(corner) + quadratic * h * h,
            Kind::SignChange => (clean * (1.0 + crossing * h.powf(crossing_power))).abs(),
            Kind::Noise => clean,
            Kind::OddEven => clean * (1.0 + if i % 2 == 0 { odd } else { -odd }),
            Kind::Plateau => clean / (1.0 + (h / knee).powf(p)),
            Kind::BlowUp if i == 0 => 1e-30,
            Kind::BlowUp => clean,
            Kind::Rounding => 1e-16 * (0.5 * random.normal()).exp(),
        };
        let scatter = (noise * random.normal()).exp();
        level(h, exact.max(1e-300) * scatter)
    };
    let table: Vec<Level> = sizes.iter().enumerate().map(error).collect();
    match kind {
        Kind::Slow => other = p - slower,
        Kind::Corner => (p, other) = (corner, corner),
        _ => {}
    }
    Drawn { table, order: p, other, reference }
}

fn slope_rule(table: &[Level], order: f64) -> Decision {
    let [.., slope] = straight_line(table);
    if (slope - order).abs() <= 0.1 { Decision::Pass } else { Decision::Fail }
}

fn three_grids(table: &[Level], order: f64) -> Decision {
    let [.., a, b, c] = table else { return Decision::Unresolved };
    let slope = ((a.error() - b.error()) / (b.error() - c.error())).abs().log2();
    if (slope - order).abs() <= 0.1 { Decision::Pass } else { Decision::Fail }
}

/// Percent: pass and fail at the truth, false passes at +¼, −¼, +½, −½, coverage of the interval.
#[derive(Default)]
pub(super) struct Cell {
    pub(super) pass: f64,
    pub(super) fail: f64,
    pub(super) wrong: [f64; 4],
    pub(super) covered: f64,
}

const OFFSETS: [f64; 4] = [0.25, -0.25, 0.5, -0.5];

pub(super) fn cell(kind: Kind, levels: usize, seeds: std::ops::Range<u64>, told: bool) -> Cell {
    let share = 100.0 / seeds.clone().count() as f64;
    let mut found = Cell::default();
    for seed in seeds {
        let drawn = draw(kind, levels, &mut Random::new(seed));
        let posterior = read(&drawn, told);
        let of = |order: f64| match &posterior {
            Some(posterior) => posterior.decide(&Claim::new(order).expect("a claim")).decision,
            None => Decision::Unresolved,
        };
        let either = [drawn.order, drawn.other].map(of);
        found.pass += share * f64::from(u8::from(either.contains(&Decision::Pass)));
        found.fail += share * f64::from(u8::from(either == [Decision::Fail; 2]));
        for (wrong, offset) in found.wrong.iter_mut().zip(OFFSETS) {
            // High orders have a wider tolerance.
            let offset = offset * (drawn.order / 3.0).max(1.0);
            let claimed = if offset > 0.0 { drawn.order } else { drawn.other } + offset;
            *wrong += share * f64::from(u8::from(of(claimed) == Decision::Pass));
        }
        let holds = posterior.is_none_or(|posterior| {
            let interval = posterior.interval;
            interval.contains(drawn.order) || interval.contains(drawn.other)
        });
        found.covered += share * f64::from(u8::from(holds));
    }
    found
}

fn read(drawn: &Drawn, told: bool) -> Option<crate::Posterior> {
    let known = Known { reference: told.then_some(drawn.reference), ..Known::default() };
    infer(&drawn.table, &known).ok()
}

const LENGTHS: [usize; 6] = [3, 4, 5, 6, 8, 12];

/// `COUNT` tables a cell, 100 unless said otherwise, on seeds from `FIRST` on.
#[test]
#[ignore = "prints a table: minutes"]
fn table_of_the_classes() {
    let count = std::env::var("COUNT").ok().and_then(|count| count.parse().ok()).unwrap_or(100);
    let only = std::env::var("ONLY").unwrap_or_default();
    let first = std::env::var("FIRST").ok().and_then(|first| first.parse().ok()).unwrap_or(300_000);
    let seeds = first..first + count;
    println!(
        "class levels pass/fail/open +1/4 -1/4 +1/2 -1/2 coverage | last pair, slope, three grids: pass, wrong at ±1/4"
    );
    for kind in KINDS {
        if !format!("{kind:?}").contains(&only) {
            continue;
        }
        let told = [false, true];
        let told =
            &told[..1 + usize::from(matches!(kind, Kind::Reference | Kind::ReferenceSquares))];
        for (&told, levels) in told.iter().flat_map(|told| LENGTHS.map(|levels| (told, levels))) {
            let Cell { pass, fail, wrong, covered } = cell(kind, levels, seeds.clone(), told);
            let rules = [super::last_pair as super::Rule, slope_rule, three_grids].map(|rule| {
                let share = |offset: f64| {
                    let hits = seeds.clone().filter(|&seed| {
                        let drawn = draw(kind, levels, &mut Random::new(seed));
                        rule(&drawn.table, drawn.order + offset) == Decision::Pass
                    });
                    100.0 * hits.count() as f64 / count as f64
                };
                format!("{:3.0} {:3.0}", share(0.0), 0.5 * (share(0.25) + share(-0.25)))
            });
            let name = format!("{kind:?}{}", if told { " told" } else { "" });
            println!(
                "{name:22} {levels:2} {pass:5.1} {fail:5.1} {:5.1}  {}  {covered:5.1} | {}",
                100.0 - pass - fail,
                wrong.map(|share| format!("{share:4.1}")).join(" "),
                rules.join(" | ")
            );
        }
    }
}

/// What few levels leave open: a sign change at three is in the interval, and of lines that a floor explains some are
/// refuted by the likeliest readings alone.
#[test]
fn sign_changes_and_floors_that_scatter_are_thought_of_at_few_levels() {
    let seeds = 500_000..500_120;
    // 85 are wanted, and three deviations of 120 tables are 10; 60 without a thought.
    let found = cell(Kind::SignChange, 3, seeds.clone(), false);
    assert!(found.covered > 75.0, "{}", found.covered);
    let claim = |order: f64| Claim::new(order).expect("a claim");
    let words = |(levels, seed): (usize, u64)| {
        let drawn = draw(Kind::RandomFloor, levels, &mut Random::new(seed));
        let answer = read(&drawn, false).map(|found| found.decide(&claim(drawn.order)));
        answer.map(|answer| (answer.decision, answer.reason))
    };
    let tables =
        [4, 5, 6].into_iter().flat_map(|levels| seeds.clone().map(move |seed| (levels, seed)));
    let answers: Vec<_> = tables.filter_map(words).collect();
    let floor = |(decision, reason): &&(Decision, String)| {
        *decision == Decision::Unresolved
            && reason.contains("unless a floor scatters below the errors")
    };
    let open = answers.iter().filter(floor).count();
    let failed = answers.iter().filter(|(decision, _)| *decision == Decision::Fail).count();
    println!("{open} open, {failed} failed of {}", answers.len());
    assert!(open > 0 && failed <= answers.len() / 100, "{open} open, {failed} failed");
}

/// Limits in percent, 60 tables a cell, on seeds of their own.
#[test]
fn classes_beyond_the_families_of_the_model_keep_their_limits() {
    let seeds = 500_000..500_060;
    let of = |kind, levels, told| cell(kind, levels, seeds.clone(), told);
    for levels in [5, 8] {
        for kind in [Kind::Reference, Kind::ReferenceSquares] {
            let found = of(kind, levels, false);
            assert!(found.wrong[0] <= 0.5 && found.covered >= 90.0, "{kind:?} {levels}");
            let told = of(kind, levels, true);
            assert!(told.pass >= 90.0 && told.wrong[0] <= 0.5, "{kind:?} {levels}, told");
        }
        for (kind, least) in [(Kind::Corner, 85.0), (Kind::Noise, 90.0), (Kind::High, 90.0)] {
            let found = of(kind, levels, false);
            assert!(found.covered >= least, "{kind:?} {levels}: {}", found.covered);
        }
        assert!(of(Kind::Slow, levels + 1, false).covered >= 85.0, "{levels}");
        assert!(of(Kind::Noise, levels, false).pass >= 90.0, "{levels}");
    }
    for levels in [3, 4, 5, 6, 8, 12] {
        assert_eq!(of(Kind::Floor, levels, false).fail, 0.0, "{levels}");
        for kind in [Kind::Rounding, Kind::BlowUp] {
            let found = of(kind, levels, false);
            assert!(found.pass == 0.0 && found.fail == 0.0, "{kind:?} {levels}");
        }
        assert_eq!(of(Kind::Plateau, levels, false).fail, 0.0, "{levels}");
    }
}

/// No next term makes slopes fall by more and more about their order; one makes them fall by less and less.
#[test]
fn slopes_that_fall_ever_faster_about_the_order_are_those_of_noise() {
    let decided = |slopes: [f64; 3], order: f64| {
        let mut table = vec![level(1.0, 1.0)];
        for slope in slopes {
            let last = table[table.len() - 1];
            table.push(level(0.5 * last.size(), last.error() * 0.5f64.powf(slope)));
        }
        let posterior = crate::infer(&table, &Known::default()).expect("a line");
        posterior.decide(&Claim::new(order).expect("a claim")).decision
    };
    assert_eq!(decided([3.07, 3.02, 2.90], 3.0), Decision::Pass);
    assert_eq!(decided([3.10, 2.97, 2.91], 3.0), Decision::Unresolved);
    assert_eq!(decided([3.07, 3.02, 2.83], 3.0), Decision::Unresolved);
}

/// Slopes of h^s + b h² fall by a little more where h² outweighs h^s. Of 1,000 tables an order ¼ too high passes for 3.3 % if
/// that is taken for noise; a deviation is 0.3 % of 1.
#[test]
fn slopes_of_corners_at_four_levels_are_not_taken_for_noise() {
    let found = cell(Kind::Corner, 4, 500_000..501_000, false);
    assert!(found.wrong[0] <= 2.0, "{}", found.wrong[0]);
}
