//! Source: product integration for kernels (t-s)^{-a} b(t,s), docs/THEORY.md.
//! Goal: orders at the regularity that such kernels give, for a solution that no scene writes down; wrong weights are seen
//!   by order or constant on the shipped scenes; the bound (3.4) with k^{1-a}; commands that know kernels by their value
//!   at s = t refuse them.
//! Data: u + ∫ (t-s)^{-1/2}/√π u ds = 1, u = E_{1/2}(-√t), by its series; singular-*.toml and edited copies.

use crate::judged::foreseen;
use crate::shipped::{abstract_of, edited, on_mesh, refusal, scene_of, setup_of, text, v_max};
use crate::wrong::KernelWeights;
use nalgebra::DVector;
use scene::setup::{AbstractLoad, AbstractSetup, Subject};
use scene::{Direction, Extension, Norm};
use studies::guarantee::guarantee;
use studies::theory::audit::audit;
use vhi::Newton;
use vhi::finite::march;
use vhi::history::{ProductIntegration, TimeGrid, TimeRule};
use vhi::law::{Convolution, ExponentialSum, HistoryKernel, Singular};

/// E_{1/2}(-x) = Σ (-x)^i/Γ(i/2 + 1), for x ≤ 1.
fn mittag_leffler(x: f64) -> f64 {
    // 1/Γ(i/2 + 1) of even and odd i.
    let mut factors = [1.0, 2.0 / std::f64::consts::PI.sqrt()];
    let (mut sum, mut power) = (0.0, 1.0);
    for i in 0..60 {
        sum += power * factors[i % 2];
        power *= -x;
        factors[i % 2] /= 0.5 * i as f64 + 1.0;
    }
    sum
}

/// max over n of |u(t_n) - u_n|, and |u(T) - u_N|, for u + ∫ (t-s)^{-1/2}/√π u ds = 1.
fn of_relaxation(grid: &TimeGrid) -> [f64; 2] {
    let root = std::f64::consts::PI.sqrt();
    let factor = Box::new(ExponentialSum { terms: vec![(1.0 / root, 0.0)] });
    let kernel = Singular { power: 0.5, factor };
    let mut u: Vec<f64> = Vec::new();
    let (mut worst, mut last) = (0.0f64, 0.0);
    for n in 0..=grid.steps() {
        let row = ProductIntegration.kernel_row(&Convolution(&kernel), grid, n);
        let past: f64 = row.iter().zip(&u).map(|(w, u)| w * u).sum();
        u.push((1.0 - past) / (1.0 + row[n]));
        last = (u[n] - mittag_leffler(grid.time(n).sqrt())).abs();
        worst = worst.max(last);
    }
    [worst, last]
}

/// 2r(1-a) in the maximum, r(2-a) at T, and 2 for r = 2: the load is smooth, the regularity that of the kernel.
#[test]
fn the_solution_of_a_smooth_load_has_the_orders_that_the_scenes_predict() {
    // e erfc(1) = 0.4275835761558070…, from tables.
    assert!((mittag_leffler(1.0) - 0.427_583_576_155_807).abs() < 1e-14);
    let orders = |grid: fn(u32) -> TimeGrid| {
        let [coarse, fine] = [512, 1024].map(|n| of_relaxation(&grid(n)));
        [0, 1].map(|i| (coarse[i] / fine[i]).log2())
    };
    let [worst, last] = orders(|n| TimeGrid::uniform(1.0, n));
    // Terms of half an order more are k^{1/2} = 3 % beside the leading ones.
    assert!((worst - 1.0).abs() < 0.03 && (last - 1.5).abs() < 0.03, "{worst} {last}");
    let [worst, last] = orders(|n| TimeGrid::graded(1.0, n, 2.0));
    assert!((worst - 2.0).abs() < 0.03 && (last - 2.0).abs() < 0.03, "{worst} {last}");
    let [worst, _] = orders(|n| TimeGrid::graded(1.0, n, 1.5));
    assert!((worst - 1.5).abs() < 0.03, "{worst}");
}

/// Weights of a kernel (t-s)^{-a} b on one step of lags near, near + k, at the far and at the near end; else the sound ones.
type OfStep = fn(a: f64, near: f64, k: f64) -> [f64; 2];

fn of_steps(of_step: OfStep) -> Box<dyn TimeRule> {
    Box::new(KernelWeights(move |q: &dyn HistoryKernel, grid: &TimeGrid, n, j| {
        let of_step = |i: usize| of_step(q.power(), grid.lag(n, i), grid.step(i));
        let before = if j > 0 { of_step(j)[1] } else { 0.0 };
        let after = if j < n { of_step(j + 1)[0] } else { 0.0 };
        (before + after) * q.factor(grid.time(n), grid.time(j))
    }))
}

/// ∫ λ^{-a} over the lags of a step.
fn whole(a: f64, near: f64, k: f64) -> f64 {
    ((near + k).powf(1.0 - a) - near.powf(1.0 - a)) / (1.0 - a)
}

/// The sound moments by differences of powers: digits enough for four of a constant.
fn sound(a: f64, near: f64, k: f64) -> [f64; 2] {
    let first = ((near + k).powf(2.0 - a) - near.powf(2.0 - a)) / (2.0 - a);
    let far = (first - near * whole(a, near, k)) / k;
    [far, whole(a, near, k) - far]
}

const RULES: [(&str, OfStep); 6] = [
    ("sound", sound),
    ("ends of the last step exchanged", |a, near, k| {
        let [far, near_end] = sound(a, near, k);
        if near > 0.0 { [far, near_end] } else { [near_end, far] }
    }),
    ("trapezoidal, the power at midpoints", |a, near, k| {
        let half = 0.5 * k * (near + 0.5 * k).powf(-a);
        [half, half]
    }),
    ("power integrated, values of the far end", |a, near, k| [whole(a, near, k), 0.0]),
    ("power integrated, means of both ends", |a, near, k| {
        let half = 0.5 * whole(a, near, k);
        [half, half]
    }),
    ("another exponent on the last step", |a, near, k| {
        sound(if near > 0.0 { a } else { 0.98 * a }, near, k)
    }),
];

/// Errors over their predictions, and the order between the last two.
fn seen(errors: [f64; 2], subject: &Subject, n: Option<u32>, steps: [u32; 2]) -> (f64, f64) {
    let told = foreseen(subject, (Norm::VMax, Direction::K, 2.0), n, &steps);
    (errors[1] / told.points[1].error, (errors[0] / errors[1]).log2())
}

fn judge(name: &str, scene: &str, order: f64, (ratio, slope): (f64, f64)) {
    println!("{scene}, {name}: error/predicted {ratio:.5}, order {slope:.3}");
    // The tolerances of the gate: 1e-4 of the constant, 0.15 of the order.
    let passes = (ratio - 1.0).abs() < 1e-4 && (slope - order).abs() < 0.15;
    assert_eq!(passes, name == "sound", "{scene}, {name}: {ratio} {slope}");
}

fn error(setup: &AbstractSetup, steps: u32) -> f64 {
    let mut worst = 0f64;
    let mut load = AbstractLoad(setup);
    march(&setup.model, &setup.grid(steps), &mut load, &Newton::default(), &mut |view| {
        let exact = DVector::from_column_slice(&setup.state(view.t).u);
        worst = worst.max(setup.model.norm(&(exact - view.u)));
    })
    .unwrap_or_else(|error| panic!("{error}"));
    worst
}

#[test]
fn wrong_weights_are_seen_by_order_or_constant() {
    for (scene, order) in
        [("singular-smooth", 2.0), ("singular-start", 1.0), ("singular-graded", 2.0)]
    {
        for (name, rule) in RULES {
            let mut setup = abstract_of(text(scene));
            setup.model.time_rule = of_steps(rule);
            let errors = [128, 256].map(|steps| error(&setup, steps));
            let subject = Subject::Abstract(Box::new(setup));
            judge(name, scene, order, seen(errors, &subject, None, [128, 256]));
        }
    }
}

#[test]
fn wrong_weights_are_seen_in_a_body_in_contact() {
    for (name, rule) in RULES {
        let mut setup = setup_of(text("singular-contact"));
        setup.model.time_rule = of_steps(rule);
        let data = on_mesh(&setup, 2);
        let errors = [64, 128].map(|steps| v_max(&setup, &setup.model, &data, steps));
        let subject = Subject::Contact(Box::new(setup));
        judge(name, "singular-contact", 2.0, seen(errors, &subject, Some(2), [64, 128]));
    }
}

/// m0 (1-a)(2-a)/(‖R‖‖b‖) = 1 · ¾/6: k < 1/64, and twice ‖b‖ beside a plain kernel of norm 2: 2 k + 8 √k = 1.
#[test]
fn the_step_bound_counts_the_last_weight() {
    let scene = |kernels: &str, steps: u32| {
        format!(
            "[scene]\nname = \"bound\"\nkind = \"abstract\"\nquestion = \"k?\"\ndimension = 1\n\
             [time]\nhorizon = 1.0\nrule = \"product-integration\"\n\
             [operator]\nmatrix = [[1.0]]\n[history]\nkernels = [{kernels}]\n[exact]\nu = [\"t\"]\n\
             [sweep]\nsteps = [{steps}]\n\
             [[predicts]]\nnorm = \"V_max\"\nvariable = \"k\"\norder = 2.0\nwhy = \"none\"\n"
        )
    };
    let limit = |kernels: &str| {
        let setup = abstract_of(scene(kernels, 100));
        setup.constants.step_bounds(setup.model.time_rule.as_ref()).limit()
    };
    let one = "{ q = \"-6\", singular = 0.5 }";
    assert!((limit(one) - 1.0 / 64.0).abs() < 1e-15, "{}", limit(one));
    let both = limit("{ q = \"-6\", singular = 0.5 }, { q = \"2\" }");
    assert!((2.0 * both + 8.0 * both.sqrt() - 1.0).abs() < 1e-12, "{both}");
    // t^{-1/4} ≤ t^{-1/2} on [0, 1]: 6 + 3 in place of 6.
    let two = limit("{ q = \"-6\", singular = 0.5 }, { q = \"-3\", singular = 0.25 }");
    assert!((two - 1.0 / 144.0).abs() < 1e-15, "{two}");
}

/// From the library too, not from the command line alone.
#[test]
fn commands_that_take_kernels_at_lag_zero_refuse_singular_ones() {
    let refused = audit(&setup_of(text("singular-contact")), &[2], &[4]).map(drop);
    let said = refused.expect_err("a refusal").to_string();
    let expected = "`sweep audit` does not treat kernels that are infinite at s = t";
    assert!(said.contains(expected), "{said}");
}

/// The guaranteed bound takes the weights of the rule, whatever the kernel: it holds, and without the memory of the bound
/// it is less than with it.
#[test]
fn the_guaranteed_bound_takes_singular_kernels() {
    let singular = "kernel = \"-exp(-t)\"\nsingular = 0.4";
    let scene = edited(&text("viscoelastic"), "kernel = \"-exp(-t)\"", singular);
    let rule = "grid = { kind = \"uniform\" }\nrule = \"product-integration\"";
    let setup = setup_of(edited(&scene, "grid = { kind = \"uniform\" }", rule));
    let found = guarantee(&setup, 8, 16).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found.levels.len(), 17);
    for level in &found.levels[1..] {
        let error = level.error.expect("an exact solution");
        // As in docs/THEORY.md: 1.06 to 1.3 from the stresses, e^{1/4 of the memory} from its weights.
        assert!(level.bound >= error && level.bound < 2.5 * error, "{} {error}", level.bound);
    }
}

/// A formula that is infinite itself, a rule that takes its value, an exponent that is none.
#[test]
fn what_cannot_be_integrated_is_refused_with_the_way_out() {
    let smooth = "singular = 0.5, ";
    let rule = "rule = \"product-integration\"";
    for (name, from, to, parts) in [
        (
            "singular-contact",
            "kernel = \"-exp(-t)\"\nsingular = 0.4",
            "kernel = \"-t^(-0.4)\"",
            ["the memory kernel is -inf at t = 0", "singular = a"],
        ),
        (
            "singular-contact",
            "singular = 0.4",
            "singular = 1.0",
            ["`singular` = 1 is not", "no integral"],
        ),
        (
            "singular-contact",
            rule,
            "rule = \"trapezoid\"",
            ["is infinite at s = t", "product-integration"],
        ),
        (
            "singular-smooth",
            rule,
            "rule = \"left\"",
            ["is infinite at s = t", "product-integration"],
        ),
        (
            "singular-smooth",
            smooth,
            "singular = -0.5, ",
            ["`singular` = -0.5 is not", "is the formula"],
        ),
        (
            "singular-smooth",
            "q = \"-exp(-0.5*(t - s))\", singular = 0.5",
            "q = \"(t - s)^(-0.5)\"",
            ["q(t, s) is inf at s = t", "singular = a"],
        ),
    ] {
        let said = refusal(edited(&text(name), from, to));
        assert!(parts.iter().all(|part| said.contains(part)), "{to}: {said}");
    }
}

/// A region that alone has such a kernel is named by its line, by a rule that cannot have it and by a command.
#[test]
fn a_region_with_such_a_kernel_is_named() {
    let region = "[[material.region]]\nname = \"low\"\nwhere = \"y - 0.5\"\nlambda = 1.0\nmu_L = 1.0\n[material.region.memory]\nkernel = \"-exp(-t)\"\nsingular = 0.4\nlambda = 0.25\nmu = 0.15\n[contact]";
    let alone = edited(&text("singular-contact"), "singular = 0.4\n", "");
    let alone = edited(&alone, "[contact]", region);
    let line = 1 + alone.lines().position(|text| text == "singular = 0.4").expect("the line");
    let place = format!("manufactured/edited.toml:{line}:");
    let by_rule = refusal(edited(&alone, "product-integration", "trapezoid"));
    let by_command = scene_of(alone).without(&Extension::ALL, "sweep audit", "why");
    for said in [by_rule, by_command.expect_err("a refusal").to_string()] {
        assert!(said.contains(&place), "{place} {said}");
    }
}
