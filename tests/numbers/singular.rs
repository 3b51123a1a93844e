//! Source: product integration for kernels (t-s)^{-a} b(t,s), docs/THEORY.md.
//! Goal: the bound (3.4) with k^{1-a}; the guaranteed bound takes such kernels, commands that know kernels by their value at
//!   s = t refuse them. Orders: the main job. Wrong weights: docs/SABOTAGE.md.
//! Data: singular-*.toml and edited copies.

use crate::shipped::{abstract_of, edited, refusal, scene_of, setup_of, text};
use scene::Extension;
use studies::guarantee::guarantee;
use studies::theory::audit::audit;

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
