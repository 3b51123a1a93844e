//! Whether the intervals of orders and constants contain the truth.
//! Source: simulation of 1,000 tables a cell, seeded. Data: e = C s^p (1 + D s^r)(1 + noise) with
//!   p one of 1/2, 1, 3/2, 2, C log-uniform on [e⁻², e²], D uniform on [-4, 4], lognormal noise of
//!   0, 1 and 2 %, on 4, 5 or 6 neighbouring levels of s = 1/8 … 1/256; for grids
//!   E = (A^m + B^m)^(1/m) with A, B such tables in h and k. `--nocapture` prints
//!   the tables.

use judge::fit::{
    Correction, ErrorCombination, Interval, Point, Posterior, Sample, Triple, ValueSample,
    constant_under, fit_constants, infer_values, joint_fits, order, power_law,
};

const TABLES: usize = 1000;
const WANTED: f64 = 0.95;
const LEVELS: [usize; 3] = [4, 5, 6];
const NOISES: [f64; 3] = [0.0, 0.01, 0.02];

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        lo + (hi - lo) * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, end: usize) -> usize {
        (self.between(0.0, end as f64) as usize).min(end - 1)
    }

    /// exp(σ N) by Box and Muller.
    fn noise(&mut self, sigma: f64) -> f64 {
        let radius = (-2.0 * (1.0 - self.between(0.0, 1.0)).ln()).sqrt();
        (sigma * radius * self.between(0.0, std::f64::consts::TAU).cos()).exp()
    }
}

/// C s^p (1 + D s^r).
#[derive(Clone, Copy)]
struct Law {
    order: f64,
    constant: f64,
    bend: f64,
    power: i32,
}

impl Law {
    fn draw(random: &mut Random, correction: Correction) -> Self {
        Self {
            order: [0.5, 1.0, 1.5, 2.0][random.below(4)],
            constant: random.between(-2.0, 2.0).exp(),
            bend: random.between(-4.0, 4.0),
            power: if correction == Correction::Linear { 1 } else { 2 },
        }
    }

    fn at(self, step: f64) -> f64 {
        self.constant * step.powf(self.order) * (1.0 + self.bend * step.powi(self.power))
    }
}

/// Neighbouring levels of 1/8 … 1/256.
fn halvings(random: &mut Random, levels: usize) -> Vec<f64> {
    let first = random.below(7 - levels);
    (first..first + levels).map(|level| 0.125 * 0.5f64.powi(level as i32)).collect()
}

/// Steps of 1/8 … 1/256 whose ratios are drawn one by one from 1.3, 1.5 and 2.
fn unequal(random: &mut Random, levels: usize) -> Vec<f64> {
    let mut steps = vec![0.125 / random.between(1.0, 2.0)];
    for level in 1..levels {
        steps.push(steps[level - 1] / [1.3, 1.5, 2.0][random.below(3)]);
    }
    steps
}

/// Coverage and median half-width of some interval.
struct Cell {
    coverage: f64,
    median: f64,
}

impl Cell {
    fn of(draws: impl Iterator<Item = (Interval, f64)>) -> Self {
        let (mut covered, mut widths) = (0usize, Vec::new());
        for (interval, truth) in draws {
            covered += usize::from(interval.contains(truth));
            widths.push(interval.half_width());
        }
        widths.sort_by(f64::total_cmp);
        let coverage = covered as f64 / widths.len() as f64;
        Self { coverage, median: widths[widths.len() / 2] }
    }
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.1} %, ±{:.3}", 100.0 * self.coverage, self.median)
    }
}

/// The nine cells of one simulation, printed as rows of a table.
fn nine_cells(title: &str, cell: impl Fn(usize, f64) -> Cell) -> Vec<Cell> {
    println!("\n{title}\n| levels | no noise | 1 % | 2 % |\n|---|---|---|---|");
    let mut all = Vec::new();
    for levels in LEVELS {
        let row = NOISES.map(|noise| cell(levels, noise));
        println!("| {levels} | {} | {} | {} |", row[0], row[1], row[2]);
        all.extend(row);
    }
    all
}

fn worst(cells: &[Cell]) -> f64 {
    cells.iter().map(|cell| cell.coverage).fold(1.0, f64::min)
}

fn seed(levels: usize, noise: f64) -> Random {
    Random(1000 * levels as u64 + (1000.0 * noise) as u64)
}

type Steps = fn(&mut Random, usize) -> Vec<f64>;

/// 1,000 laws with their tables.
fn tables(
    steps: Steps,
    truth: Correction,
    levels: usize,
    noise: f64,
) -> impl Iterator<Item = (Law, Vec<Sample>)> {
    let mut random = seed(levels, noise);
    (0..TABLES).map(move |_| {
        let law = Law::draw(&mut random, truth);
        let steps = steps(&mut random, levels);
        let sample = |step: f64| Sample { step, error: law.at(step) * random.noise(noise) };
        (law, steps.into_iter().map(sample).collect())
    })
}

fn inferred(samples: &[Sample]) -> Posterior {
    let table: Vec<(f64, f64)> = samples.iter().map(|s| (s.step, s.error)).collect();
    order(&table).expect("a posterior")
}

/// An inference costs a thousand times what a least-squares fit does: a cell of 200 tells 95 % from 91 %.
const INFERRED: usize = 200;

/// The nine cells of an interval of the order.
fn orders(
    title: &str,
    (steps, truth): (Steps, Correction),
    interval: impl Fn(&[Sample]) -> Interval,
) -> Vec<Cell> {
    nine_cells(title, |levels, noise| {
        let some = tables(steps, truth, levels, noise).take(INFERRED);
        Cell::of(some.map(|(law, samples)| (interval(&samples), law.order)))
    })
}

const SPACE: (Steps, Correction, Correction) = (halvings, Correction::Linear, Correction::Linear);
const TIME: (Steps, Correction, Correction) =
    (halvings, Correction::Quadratic, Correction::Quadratic);

/// Next terms of four times the first at h = 1/8, which priors do not expect.
fn are_covered(title: &str, steps: Steps, truth: Correction) {
    let cells = orders(title, (steps, truth), |samples| inferred(samples).interval);
    // Four standard deviations of a cell below 95 %.
    assert!(worst(&cells) >= WANTED - 0.06, "{title}: {}", worst(&cells));
}

#[test]
fn orders_are_covered() {
    are_covered("order, e = C h^p (1 + D h)", halvings, Correction::Linear);
    // Bias counted as noise misses the truth where there is no noise.
    let student = orders("Student", (halvings, Correction::Linear), |samples| {
        power_law(samples).expect("a law").interval.expect("an interval")
    });
    assert!(worst(&student) < 0.10, "{}", worst(&student));
}

#[test]
#[ignore = "3,600 posteriors: make test-long"]
fn long_orders_in_time_and_of_other_ratios_are_covered() {
    are_covered("order, e = C k^p (1 + D k²)", halvings, Correction::Quadratic);
    are_covered("order, ratios 1.3, 1.5, 2 mixed", unequal, Correction::Linear);
}

/// Relative interval of C under the true order.
fn constants(title: &str, (steps, truth, fitted): (Steps, Correction, Correction)) -> Vec<Cell> {
    nine_cells(title, |levels, noise| {
        Cell::of(tables(steps, truth, levels, noise).map(|(law, samples)| {
            let (_, found) = constant_under(law.order, &samples, fitted).expect("a constant");
            let relative = |end: f64| end / law.constant;
            (Interval { lo: relative(found.lo), hi: relative(found.hi) }, 1.0)
        }))
    })
}

#[test]
fn constants_are_covered() {
    let space = constants("constant, e = C h^p (1 + D h), relative", SPACE);
    let time = constants("constant, e = C k^p (1 + D k²), relative", TIME);
    for cells in [&space, &time] {
        assert!(worst(cells) >= WANTED, "{}", worst(cells));
    }
    // Without noise a constant is known within a few percent.
    assert!(space[0].median < 0.03 && time[0].median < 0.03);
}

/// Under an order that is wrong by a half the constant is none, and the true one is missed.
#[test]
fn constants_under_a_wrong_order_are_caught() {
    let cells = nine_cells("order wrong by 1/2", |levels, noise| {
        Cell::of(tables(halvings, Correction::Linear, levels, noise).map(|(law, samples)| {
            let found = constant_under(law.order + 0.5, &samples, Correction::Linear);
            (found.expect("a constant").1, law.constant)
        }))
    });
    assert!(worst(&cells) < 0.5, "{}", worst(&cells));
}

/// What a grid says of p, q, C_h and C_k: the share of grids that cover each, and that are
/// identifiable at all.
struct Grids {
    orders: [Cell; 2],
    student: [Cell; 2],
    constants: [Cell; 2],
    identified: f64,
}

/// Fewer than for lines: a cell of 300 tells 95 % from 91 %.
const GRIDS: usize = 300;

fn grids(model: ErrorCombination, levels: usize, noise: f64) -> Grids {
    let m = if model == ErrorCombination::Sum { 1.0 } else { 2.0 };
    let mut random = seed(levels, noise);
    let (mut orders, mut student, mut constants) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..GRIDS {
        let mut draw = |order: f64, constant: f64, power: i32| Law {
            order,
            constant: constant * random.between(1.0, 4.0),
            bend: random.between(-4.0, 4.0),
            power,
        };
        let (space, time) = (draw(1.0, 0.3, 1), draw(2.0, 8.0, 2));
        let step = |level: usize| 0.125 * 0.5f64.powi(level as i32);
        let pairs = (0..levels).flat_map(|i| (0..levels).map(move |j| (step(i), step(j))));
        let points: Vec<Point> = pairs
            .map(|(h, k)| {
                let exact = (space.at(h).powf(m) + time.at(k).powf(m)).powf(1.0 / m);
                Point { h, k, error: exact * random.noise(noise), floor: 0.0 }
            })
            .collect();
        let Ok(fits) = joint_fits(&points, false) else { continue };
        orders.push((fits.best.order_h.interval, fits.best.order_k.interval));
        student.push((fits.best.student[0], fits.best.student[1]));
        let [h, k] = fit_constants(&points, fits.best.model, (1.0, 2.0)).expect("constants");
        let relative = |found: Interval, law: Law| Interval {
            lo: found.lo / law.constant,
            hi: found.hi / law.constant,
        };
        constants.push((relative(h.interval, space), relative(k.interval, time)));
    }
    let cells = |pairs: &[(Interval, Interval)], truth: (f64, f64)| {
        [
            Cell::of(pairs.iter().map(|pair| (pair.0, truth.0))),
            Cell::of(pairs.iter().map(|pair| (pair.1, truth.1))),
        ]
    };
    Grids {
        orders: cells(&orders, (1.0, 2.0)),
        student: cells(&student, (1.0, 2.0)),
        constants: cells(&constants, (1.0, 1.0)),
        identified: orders.len() as f64 / GRIDS as f64,
    }
}

#[test]
fn grids_are_covered() {
    println!("| model | levels | noise | p | q | C_h | C_k |\n|---|---|---|---|---|---|---|");
    let mut lowest_student: f64 = 1.0;
    for model in [ErrorCombination::Sum, ErrorCombination::RootSumSquare] {
        for levels in [4, 5] {
            for noise in NOISES {
                let Grids { orders, student, constants, identified } = grids(model, levels, noise);
                let [p, q] = &orders;
                let [c_h, c_k] = &constants;
                let percent = 100.0 * noise;
                println!(
                    "| {} | {levels} | {percent} % | {p} | {q} | {c_h} | {c_k} | {identified}",
                    model.name()
                );
                let all = [p, q, c_h, c_k].map(|cell| cell.coverage);
                assert!(all.iter().all(|coverage| *coverage >= WANTED), "{all:?}");
                assert!(identified > 0.99, "{identified}");
                lowest_student = lowest_student.min(student[0].coverage);
            }
        }
    }
    // The Student interval alone takes the bias of the space error for noise.
    assert!(lowest_student < 0.7, "{lowest_student}");
}

/// Values φ = 1 − e of a functional, e as above, the noise relative to e; read without knowing
/// the limit 1.
fn value_tables(levels: usize, noise: f64) -> impl Iterator<Item = (Law, Vec<ValueSample>)> {
    tables(halvings, Correction::Linear, levels, noise).map(|(law, samples)| {
        let value = |sample: &Sample| ValueSample { step: sample.step, value: 1.0 - sample.error };
        (law, samples.iter().map(value).collect())
    })
}

/// Four values have three differences, as three errors have; a few tables oscillate and have no order.
#[test]
#[ignore = "1,800 posteriors: make test-long"]
fn long_orders_of_values_are_covered() {
    println!(
        "\norder of values without a limit\n| levels | noise | order | tables with an order |"
    );
    for levels in LEVELS {
        for noise in NOISES {
            let some = value_tables(levels, noise).take(INFERRED);
            let orders: Vec<(Interval, f64)> = some
                .filter_map(|(law, samples)| {
                    Some((infer_values(&samples, None).ok()?.interval, law.order))
                })
                .collect();
            let share = orders.len() as f64 / INFERRED as f64;
            let cell = Cell::of(orders.into_iter());
            println!("| {levels} | {} % | {cell} | {:.1} % |", 100.0 * noise, 100.0 * share);
            // Three standard deviations of a cell below 95 %; 2 % of an error are 6 % of a difference, which priors of
            // the noise hardly expect: four values of that kind cover 86 %.
            let least = if noise > 0.01 { 0.80 } else { WANTED - 0.05 };
            assert!(cell.coverage >= least && share > 0.8, "{cell} {share}");
        }
    }
}

/// The grid convergence index is what it is: it aims at 95 %, and holds it near order two.
/// Below it the tables with p = 1/2 and bends of |D| ≤ 4 are what it misses.
#[test]
#[ignore = "thousands of tables: make test-long"]
fn long_the_grid_convergence_index_is_measured() {
    /// The index, less its factor of safety or not, beside the true error of 1 on the finest grid.
    fn measured(levels: usize, noise: f64, safety: f64) -> Cell {
        Cell::of(value_tables(levels, noise).take(300).filter_map(|(_, samples)| {
            let Triple::Converging { gci, .. } = Triple::of(*samples.last_chunk()?) else {
                return None;
            };
            let error = 1.0 - samples.last()?.value;
            Some((Interval::around(0.0, gci / safety / error.abs()), 1.0))
        }))
    }
    let title = "GCI on the finest grid, in units of the true error";
    let cells = nine_cells(title, |levels, noise| measured(levels, noise, 1.0));
    assert!(worst(&cells) > 0.8 && cells.iter().all(|cell| cell.median < 2.0));
    // Without the factor of safety half of the tables are missed.
    let bare = measured(4, 0.01, 1.25);
    assert!(bare.coverage < 0.8, "{bare}");
}
