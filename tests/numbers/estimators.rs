//! Source: the contract of `sweep estimators`: a bound is not below the error, an estimate's interval holds it, and no quotient
//!   with the error grows under refinement.
//! Goal: sound estimators pass on scenes of each kind; a bound without a term, bounds and estimates that drift from the error,
//!   and an estimate that is blind to locking fail, each by the claim that is made for it.
//! Mesh: n = 4 to 32, structured.
//! Data: signorini, viscoelastic, static-bilateral, affine, locking-linear.

use crate::shipped::setup;
use judge::claim::Standing;
use run::sweep::MemoryLimit;
use studies::guarantee::BoundedLevel;
use studies::study::Asked;
use studies::theory::estimators::{Estimators, Ladder, estimators};

/// The statements of a scene with their standings; each the worst of its claims.
fn standings(name: &str, n: &[u32], steps: &[u32], under_test: &Estimators<'_>) -> Vec<String> {
    let setup = setup(name);
    let list = |list: &[u32]| (!list.is_empty()).then(|| list.to_vec());
    let limit = MemoryLimit::of_bytes(1e9);
    let asked = Asked { n: list(n), steps: list(steps), limit, jobs: 1 };
    let ladder = Ladder::new(&setup, &asked).unwrap_or_else(|error| panic!("{error}"));
    let found = estimators(&setup, &ladder, under_test).unwrap_or_else(|error| panic!("{error}"));
    let fails = |standing| standing != Standing::Passes;
    let failed = found.claims.iter().filter(|claim| fails(claim.standing()));
    let mut names: Vec<String> = failed.map(|claim| claim.statement.source.to_owned()).collect();
    names.dedup();
    assert_eq!(found.holds(), names.is_empty());
    names
}

const N: [u32; 3] = [8, 16, 32];

#[test]
fn sound_estimators_are_reliable_and_efficient() {
    let sound = Estimators::default();
    for (name, n, steps) in [
        ("signorini", &N[..], &[4][..]),
        ("viscoelastic", &N, &[8]),
        ("static-bilateral", &N, &[]),
        ("affine", &[], &[]),
    ] {
        assert_eq!(standings(name, n, steps, &sound), Vec::<String>::new(), "{name}");
    }
}

/// Without ρ, what the strains of neighbouring cells leave between them, the bound of a smooth load is that of the load alone.
#[test]
fn a_bound_without_a_term_is_below_the_error() {
    let of_loads = |level: &BoundedLevel, _: f64| level.oscillation + level.gap.max(0.0).sqrt();
    let without = Estimators { bound: &of_loads, ..Estimators::default() };
    let failed = standings("viscoelastic", &N, &[8], &without);
    assert_eq!(failed, ["bound, reliable"]);
}

#[test]
fn what_drifts_from_the_error_is_refused() {
    let growing = |level: &BoundedLevel, h: f64| level.bound / h.sqrt();
    let growing = Estimators { bound: &growing, ..Estimators::default() };
    assert_eq!(standings("viscoelastic", &N, &[8], &growing), ["bound, efficient"]);
    // The interval moves with its estimate: it holds errors for a while.
    let falling = |value: f64, h: f64| value * (8.0 * h).sqrt();
    let falling = Estimators { estimate: &falling, ..Estimators::default() };
    let failed = standings("static-bilateral", &N, &[], &falling);
    assert!(failed.contains(&"estimate, reliable".to_owned()), "{failed:?}");
    let rising = |value: f64, h: f64| value / (8.0 * h).sqrt();
    let rising = Estimators { estimate: &rising, ..Estimators::default() };
    let failed = standings("static-bilateral", &N, &[], &rising);
    assert!(failed.contains(&"estimate, efficient".to_owned()), "{failed:?}");
    let silent = Estimators { bound: &|_, _| f64::NAN, ..Estimators::default() };
    let failed = standings("viscoelastic", &N, &[8], &silent);
    assert!(failed.contains(&"bound, reliable".to_owned()), "{failed:?}");
}

/// P1 that locks moves little from mesh to mesh, and its error does not fall: differences of runs do not see it.
#[test]
fn an_estimate_that_is_blind_to_locking_is_found_out() {
    let failed = standings("locking-linear", &N, &[], &Estimators::default());
    assert_eq!(failed, ["estimate, interval", "estimate, reliable"]);
}
