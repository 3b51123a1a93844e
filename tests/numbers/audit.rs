//! Source: the proofs of Theorems 10 and 11: (2.9), (4.7), (4.9), (4.14), (4.16), (4.17), (4.19), (4.20), (5.23).
//! Goal: every inequality holds on sound runs of all kinds of scenes, under every boundary rule; one that a scene has no right to
//!   fails; and every wrong constant is caught by an inequality. Wrong solvers: the audit in docs/SABOTAGE.md.
//! Mesh: 8 × 8 squares, N = 4 unless a test says otherwise.

use crate::shipped::{edited, on_mesh, setup, setup_of, text};
use fem::contact::BoundaryRule;
use judge::claim::{Claim, Standing};
use report::Findings;
use scene::setup::Setup;
use studies::theory::audit::{AuditConstants, audit, audit_case, audit_under};

const LINES: [&str; 9] =
    ["(2.9)", "(4.7)", "(4.9)", "(4.14)", "(4.16)", "(4.17)", "(4.19)", "(4.20)", "(5.23)"];

fn audited(setup: &Setup, ns: &[u32], steps: &[u32]) -> Findings {
    audit(setup, ns, steps).expect("an audit")
}

fn violations(findings: &Findings) -> Vec<String> {
    findings.claims.iter().filter_map(Claim::reason).collect()
}

fn with_rule(name: &str, rule: BoundaryRule) -> Setup {
    let mut setup = setup(name);
    for boundary in &mut setup.model.boundary {
        boundary.rule = rule;
    }
    setup
}

/// What fails in a sound run under changed constants.
fn under(name: &str, change: impl Fn(&mut AuditConstants)) -> Vec<&'static str> {
    let (setup, steps) = (setup(name), 4);
    let (data, mut constants) =
        (on_mesh(&setup, 8), AuditConstants::new(&setup).expect("constants"));
    change(&mut constants);
    let claims = audit_case(&setup, &data, steps, &constants).expect("an audit");
    let failing = claims.iter().filter(|claim| claim.standing() == Standing::Fails).cloned();
    let failing: Vec<Claim> = failing.collect();
    Claim::worst(&failing).iter().map(|(claim, _)| claim.statement.source).collect()
}

#[test]
fn every_inequality_holds_on_sound_runs() {
    // Regions, a polygon, graded steps, a jump, a nearly incompressible body and curved laws stand beside the scenes of the other tests.
    let names = [
        "pure-mild",
        "pure-concave-gap",
        "sourced",
        "compliance",
        "unconstrained",
        "signorini",
        "viscoelastic",
        "steady",
        "affine",
        "affine-locked",
        "affine-kink",
        "affine-graded",
        "in-space",
        "layered",
        "v-groove",
        "state-jump",
        "bulk-shear",
        "locking-linear",
        "law-rational",
        "law-exponential",
        "law-power",
        "law-scaled",
        "law-jump",
    ];
    for name in names {
        let found = audited(&setup(name), &[8], &[4]);
        let rows = found.claims.iter().map(|claim| claim.statement.source);
        assert_eq!(rows.collect::<Vec<_>>(), LINES, "{name}");
        assert!(found.holds(), "{name}: {:?}", violations(&found));
    }
    // What other rules on Γ3 add is E_q.
    for rule in [BoundaryRule::Vertex, BoundaryRule::Gauss, BoundaryRule::Exact] {
        for name in ["compliance", "pure-strong", "in-space"] {
            let found = audited(&with_rule(name, rule), &[8], &[4]);
            assert!(found.holds(), "{name} {rule:?}: {:?}", violations(&found));
        }
    }
}

/// U^h is in U only if g is concave on each face: otherwise ∫ λ(u_h - g)₊ is missing on the right of (4.9), and nowhere else.
#[test]
fn a_gap_that_is_not_concave_fails_the_sum_alone() {
    assert_eq!(under("broken-gap", |_| ()), ["(4.9)"]);
}

/// u_ν stays at a jump of the law for 1/4 ≤ t ≤ 3/4, with ξ so near one end of the interval, then near the other, that the
/// error in time takes u_h off the jump: with one value of ∂j_ν there in place of all, j⁰ would be too small.
#[test]
fn set_valued_laws_take_the_whole_interval() {
    let jump = "points = [[0.0, 0.0], [0.03, 0.04], [0.03, 0.06], [0.10, 0.05]]";
    let scene = edited(&text("affine"), "points = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]]", jump);
    let scene = edited(
        &scene,
        "a = \"0.08*t*(2 - t)\"",
        "a = \"if(t < 0.25, 0.12*t, if(t < 0.75, 0.03, 0.03 + 0.1*(t - 0.75)))\"\nxi = \"if(t < 0.25, 0.16*t, if(t < 0.5, 0.0599999, if(t < 0.75, 0.0400001, 0.06 - (0.1/7)*(t - 0.75))))\"",
    );
    let scene = edited(&scene, "[exact.define]", "selection = \"xi\"\n[exact.define]");
    let found = audited(&setup_of(scene), &[4], &[8]);
    assert!(found.holds(), "{:?}", violations(&found));
}

#[test]
fn wrong_constants_are_caught() {
    type Change = fn(&mut AuditConstants);
    let cases: [(&[&str], &str, Change); 10] = [
        (&["(4.7)"], "pure-mild", |c| c.m_a = c.l_a),
        (&["(4.17)"], "pure-mild", |c| c.l_a = 1.0),
        (&["(4.14)"], "pure-mild", |c| c.alpha_phi = 0.0),
        (&["(4.14)"], "viscoelastic", |c| c.beta_phi = 0.0),
        (&["(4.16)"], "affine", |c| c.alpha_j = 0.0),
        (&["(4.19)"], "viscoelastic", |c| c.history = 0.0),
        (&["(2.9)"], "affine", |c| c.c_j_squared = 0.9),
        (&["(5.23)"], "pure-concave-gap", |c| c.c0 = -0.2),
        (&["(4.20)"], "pure-mild", |c| c.m_a = 1000.0),
        // A number that is none holds nowhere.
        (&["(4.14)", "(4.20)"], "affine", |c| c.alpha_phi = f64::NAN),
    ];
    for (lines, name, change) in cases {
        let found = under(name, change);
        assert!(lines.iter().all(|line| found.contains(line)), "{lines:?} on {name}: {found:?}");
    }
}

/// m0 <= 0: (4.20) divides by it and has no constant. It is no violation and does not hold; with m0 a hair above zero it holds.
#[test]
fn a_bound_without_a_constant_is_not_defined_and_does_not_hold() {
    let setup = setup("affine");
    let with = |off: f64| {
        let mut constants = AuditConstants::new(&setup).expect("constants");
        // m0 = m_A - alpha_phi - alpha_j c_j^2.
        constants.alpha_phi += constants.m0() - off;
        audit_under(&setup, &constants, &[4], &[2]).expect("an audit")
    };
    let sound = with(1e-3);
    assert!(sound.holds(), "{:?}", violations(&sound));
    for off in [0.0, -0.1] {
        let found = with(off);
        let said = violations(&found);
        assert!(!found.holds() && said.len() == 1, "{said:?}");
        assert!(said[0].starts_with("(4.20) at level "), "{said:?}");
        assert!(said[0].contains("a constant in it is not defined (m0 = "), "{said:?}");
        let document = found.json();
        assert_eq!(document["holds"], false);
        for claim in document["claims"].as_array().expect("claims") {
            let defined = claim["line"] != "(4.20)";
            let standing = if defined { "pass" } else { "unresolved" };
            assert_eq!((&claim["standing"], &claim["holds"]), (&standing.into(), &defined.into()));
            assert_eq!(claim["right"].is_null(), !defined, "{claim}");
        }
        let table = String::from_utf8(Claim::csv(&found.claims).expect("a table")).expect("text");
        assert!(!table.contains(",inf,") && table.matches(",false,").count() == 1, "{table}");
    }
}

/// Where u is in V^h and level 0 is rounding alone, what the solver leaves of it is allowed: fine meshes fail without.
#[test]
fn the_floor_of_a_run_is_allowed() {
    let found = audited(&setup("state-instant"), &[64], &[2]);
    assert!(found.holds(), "{:?}", violations(&found));
    let setup = setup("state-instant");
    let (data, constants) = (on_mesh(&setup, 64), AuditConstants::new(&setup).expect("constants"));
    let claims = audit_case(&setup, &data, 2, &constants).expect("an audit");
    assert!(claims.iter().all(|claim| claim.accuracy < 1e-11), "{claims:?}");
}

/// A violation names line, level, grid and both sides, and stands first; no run proves nothing.
#[test]
fn a_violation_is_spelt_out() {
    let setup = setup("affine");
    let mut constants = AuditConstants::new(&setup).expect("constants");
    let place = |found: &Findings| {
        let text = found.document.text(132);
        let rows = text.find("\nclaim ").expect("a table");
        text[rows..].find("\n(2.9) ").expect("a row")
    };
    let sound = audit_under(&setup, &constants, &[4], &[2]).expect("an audit");
    constants.c_j_squared = 0.1;
    let found = audit_under(&setup, &constants, &[4], &[2]).expect("an audit");
    assert!(!found.holds() && place(&found) < place(&sound));
    let said = &violations(&found)[0];
    assert!(said.starts_with("(2.9) at level ") && said.contains(" of n = 4, N = 2: "), "{said}");
    assert!(said.contains("exceeds by"), "{said}");
    assert!(found.document.text(132).contains(&said[..40]));
    let none = audit_under(&setup, &constants, &[], &[2]).expect("an audit");
    assert!(!none.holds() && none.document.text(132).contains("nothing was compared"));
}
