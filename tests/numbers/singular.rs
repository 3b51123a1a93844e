//! Source: product integration for kernels (t-s)^{-a} b(t,s), docs/THEORY.md.
//! Goal: orders at the regularity that such kernels give, for a solution that no scene writes down (wrong weights:
//!   docs/SABOTAGE.md); the bound (3.4) with k^{1-a}; commands that know kernels by their value
//!   at s = t refuse them.
//! Data: u + ∫ (t-s)^{-1/2}/√π u ds = 1, u = E_{1/2}(-√t), by its series; singular-*.toml and edited copies.

use crate::shipped::{abstract_of, edited, refusal, scene_of, setup_of, text};
use scene::Extension;
use studies::guarantee::guarantee;
use studies::theory::audit::audit;
use vhi::history::{ProductIntegration, TimeGrid, TimeRule};
use vhi::law::{Convolution, ExponentialSum, Singular};

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
