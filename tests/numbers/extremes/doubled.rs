//! Small problems against arithmetic with twice the digits (double-double), at random points.

use crate::shipped::abstract_of;
use algebra::linalg::signed_unit;
use scene::setup::AbstractSetup;
use twofloat::TwoFloat;
use vhi::Newton;
use vhi::history::{Memory, TimeGrid, Trapezoid};
use vhi::law::ExponentialSum;

/// The law of the contact scenes: 0, 2r, 0.08 - 0.5(r - 0.04), 0.05.
const LAW: [[f64; 2]; 3] = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]];

/// A point of the parameters.
#[derive(Debug)]
struct Point {
    /// A = m.
    m: f64,
    /// q = c exp(-r(t - s)).
    c: f64,
    r: f64,
    /// u = a sin(w t).
    a: f64,
    w: f64,
    steps: u32,
}

impl Point {
    fn random(seed: u64) -> Self {
        let mut state = seed;
        let mut within =
            |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + signed_unit(&mut state));
        Self {
            m: within(1.5, 4.0),
            c: within(-0.5, 0.5),
            r: within(0.1, 20.0),
            a: within(0.05, 0.2),
            w: within(1.0, 6.0),
            steps: within(8.0, 128.0) as u32,
        }
    }

    fn setup(&self) -> AbstractSetup {
        let Self { m, c, r, a, w, .. } = self;
        let text = format!(
            "[scene]\nname = \"random\"\nkind = \"abstract\"\nquestion = \"Is every digit right?\"\ndimension = 1\njudge = false\n[time]\nhorizon = 1.0\n[operator]\nmatrix = [[{m:?}]]\n[history]\nkernels = [{{ q = \"{c:?}*exp(-{r:?}*(t - s))\", matrix = [[1.0]] }}]\n[[trace]]\nfunctional = [1.0]\nlaw = {{ kind = \"piecewise-linear\", points = {LAW:?}, slope_before = 0.0, slope_after = 0.0 }}\n[exact]\nu = [\"{a:?}*sin({w:?}*t)\"]\n"
        );
        abstract_of(text)
    }

    /// The discrete solution in double-double, from the loads of the setup.
    fn doubled(&self, setup: &AbstractSetup) -> Vec<TwoFloat> {
        let (two, times) = (TwoFloat::from, setup.grid(self.steps).times().to_vec());
        let mut u: Vec<TwoFloat> = Vec::new();
        for n in 0..times.len() {
            let mut rest = two(setup.state(times[n]).load[0]);
            let mut diagonal = two(self.m);
            for j in 0..=n {
                let before = if j > 0 { two(times[j]) - times[j - 1] } else { two(0.0) };
                let after = if j < n { two(times[j + 1]) - times[j] } else { two(0.0) };
                let lag = two(times[n]) - times[j];
                let weight = (before + after) * 0.5 * self.c * (-(lag * self.r)).exp();
                match u.get(j) {
                    Some(&u) => rest -= weight * u,
                    None => diagonal += weight,
                }
            }
            u.push(on_its_piece(diagonal, rest));
        }
        u
    }
}

/// The root of diagonal·u + p(u) = rest, which increases in u: on the one piece of p where it lies.
fn on_its_piece(diagonal: TwoFloat, rest: TwoFloat) -> TwoFloat {
    let two = TwoFloat::from;
    let [zero, peak, end] = LAW;
    let rising = two(peak[1]) / (two(peak[0]) - zero[0]);
    let falling = (two(end[1]) - peak[1]) / (two(end[0]) - peak[0]);
    // p(r) = at + slope (r - from) between two abscissae.
    let pieces = [
        (f64::NEG_INFINITY, zero[0], zero, two(0.0)),
        (zero[0], peak[0], zero, rising),
        (peak[0], end[0], peak, falling),
        (end[0], f64::INFINITY, end, two(0.0)),
    ];
    let roots = pieces.map(|(low, high, [from, at], slope)| {
        (low, high, (rest - at + slope * from) / (diagonal + slope))
    });
    let fits = |(low, high, root): &&(f64, f64, TwoFloat)| *root >= *low && *root <= *high;
    roots.iter().find(fits).expect("a piece").2
}

/// A level leaves 16ε of forces of size 2(m + 1)|u|, which m0 ≥ 1 divides and Gronwall's factor e^{|c|T/m0} ≤ 1.7
/// spreads: 270ε at m = 4; weights and sums add to it.
const UNITS: f64 = 400.0;

/// The last level of a run of `setup` against the scheme of `point`, relative to the largest u.
fn difference(setup: &AbstractSetup, point: &Point) -> f64 {
    let known = point.doubled(setup);
    let run = setup.run(point.steps, &Newton::default());
    let run = run.unwrap_or_else(|error| panic!("{point:?}: {error}"));
    let last = *known.last().expect("levels");
    f64::from((last - run.u[0]).abs()) / point.a
}

#[test]
fn random_histories_and_laws_have_the_digits_they_promise() {
    for seed in 0..24 {
        let point = Point::random(seed);
        let error = difference(&point.setup(), &point);
        assert!(error <= UNITS * f64::EPSILON, "{point:?}: {error:e}");
    }
}

/// A history that is wrong in the eleventh digit is found out at most points.
#[test]
fn lost_digits_are_seen() {
    let seen = (0..24).filter(|&seed| {
        let point = Point::random(seed);
        let setup = point.setup();
        let wrong = Point { c: point.c * (1.0 + 1e-10), ..point };
        difference(&setup, &wrong) > UNITS * f64::EPSILON
    });
    let seen = seen.count();
    assert!(seen >= 16, "{seen}");
}

/// Σ'_j e^{-c(t_N - t_j)} u_j k of the past and the last slot, as the recursion gives it.
fn by_recursion(rate: f64, k: f64, steps: usize) -> f64 {
    let value = |j: usize| 1.0 + (0.7 * j as f64).sin().powi(2);
    let kernel = ExponentialSum { terms: vec![(1.0, rate)] };
    let grid = TimeGrid::uniform(k * steps as f64, steps as u32);
    let mut memory = Memory::new(&kernel, &Trapezoid, &grid, 1);
    for j in 0..steps {
        memory.commit(&grid, &[value(j)]);
    }
    let mut past = [0.0];
    memory.past(&kernel, &Trapezoid, &grid, &mut past);
    past[0] + 0.5 * k * value(steps)
}

/// Σ' k e^{-c(N-j)k} u_j in double-double against the recursion: 3ε for each step that is remembered.
#[test]
fn recursions_have_the_digits_they_promise() {
    let exact = |rate: f64, k: f64, steps: usize| {
        let two = TwoFloat::from;
        let decay = (-(two(rate) * k)).exp();
        let (mut sum, mut factor) = (two(0.0), two(1.0));
        for j in (0..=steps).rev() {
            let weight = if j == 0 || j == steps { 0.5 } else { 1.0 };
            let value = two(1.0 + (0.7 * j as f64).sin().powi(2));
            sum += factor * value * k * weight;
            factor *= decay;
        }
        sum
    };
    for seed in 0..12 {
        let part = 0.5 * (1.0 + signed_unit(&mut (1000 + seed)));
        let (rate, steps) = (10f64.powf(4.0 * part - 2.0), 100 + 150 * seed as usize);
        let k = 1.0 / steps as f64;
        let known = exact(rate, k, steps);
        let error = f64::from(((known - by_recursion(rate, k, steps)) / known).abs());
        let remembered = (1.0 / -(-rate * k).exp_m1()).min(steps as f64);
        // The grid's steps are k to ε/2 each, and its times to ε: one more unit a step.
        let allowed = f64::EPSILON * (4.0 * remembered + 5.0);
        assert!(error <= allowed, "{rate} {steps}: {error:e} > {allowed:e}");
        let wrong = by_recursion(rate * (1.0 + 1e-9), k, steps);
        let change = f64::from(((known - wrong) / known).abs());
        assert!(change > 1e-12, "{change:e}");
    }
}
