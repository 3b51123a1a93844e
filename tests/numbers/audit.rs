//! Source: the proofs of Theorems 10 and 11: (2.9), (4.7), (4.9), (4.14), (4.16), (4.17), (4.20), (5.23).
//! Goal: every inequality holds on sound runs of all kinds of scenes, under every boundary rule; one that a scene has no right to
//!   fails; and every seeded defect is caught by an inequality, as in the tables below.
//! Mesh: 8 × 8 squares, N = 4 unless a test says otherwise.

use std::sync::{Arc, Mutex};

use crate::shipped::{edited, on_mesh, setup, setup_of, text};
use fem::contact::{BoundaryRule, MemoryTerm, Model, march};
use judge::claim::{Claim, Standing};
use scene::setup::{MeshData, Setup, TruthLoad};
use studies::theory::audit::{AuditConstants, Auditor, CaseLine, SceneAudit, audit_case};
use vhi::Newton;
use vhi::history::{TimeGrid, TimeRule, Trapezoid};
use vhi::law::{AnyProjection, MemoryKernel, PiecewiseLinear, VonMises, YieldLimit};

const LINES: [&str; 8] =
    ["(2.9)", "(4.7)", "(4.9)", "(4.14)", "(4.16)", "(4.17)", "(4.20)", "(5.23)"];

fn with_rule(name: &str, rule: BoundaryRule) -> Setup {
    let mut setup = setup(name);
    if let Some(boundary) = &mut setup.model.boundary {
        boundary.rule = rule;
    }
    setup
}

/// What fails in a run of `model`, audited as one of `setup`; `after` sees every ζ_n.
fn failing(
    setup: &Setup,
    model: &Model,
    data: &MeshData,
    constants: &AuditConstants,
    mut after: impl FnMut(f64),
) -> Vec<&'static str> {
    let steps = 4;
    let mut auditor = Auditor::new(setup, data, steps, constants).expect("an exact solution");
    let mut load = TruthLoad(&*data.truth);
    let grid = setup.grid(steps);
    march(&data.space, model, &grid, &mut load, &Newton::default(), &mut |view| {
        auditor.observe(view)?;
        after(view.zeta);
        Ok(())
    })
    .unwrap_or_else(|error| panic!("{error}"));
    let rows = CaseLine::of_levels(&auditor.claims());
    let failing = rows.iter().filter(|row| row.worst.standing() == Standing::Fails);
    failing.map(|row| row.worst.statement.source).collect()
}

/// What fails in a run of `model` under the constants of `setup`.
fn caught(setup: &Setup, model: &Model) -> Vec<&'static str> {
    let constants = AuditConstants::new(setup).expect("constants");
    failing(setup, model, &on_mesh(setup, 8), &constants, |_| ())
}

#[test]
fn every_inequality_holds_on_sound_runs() {
    // Regions, a polygon, graded steps, a jump and a nearly incompressible body stand beside the scenes of the other tests.
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
    ];
    for name in names {
        let audit = SceneAudit::new(&setup(name), &[8], &[4]).expect("an audit");
        let rows = audit.cases[0].rows.iter().map(|row| row.worst.statement.source);
        assert_eq!(rows.collect::<Vec<_>>(), LINES, "{name}");
        assert!(audit.holds(), "{name}: {:?}", audit.violations());
    }
    // What other rules on Γ3 add is E_q.
    for rule in [BoundaryRule::Vertex, BoundaryRule::Gauss, BoundaryRule::Exact] {
        for name in ["compliance", "pure-strong", "in-space"] {
            let audit = SceneAudit::new(&with_rule(name, rule), &[8], &[4]).expect("an audit");
            assert!(audit.holds(), "{name} {rule:?}: {:?}", audit.violations());
        }
    }
}

/// U^h is in U only if g is concave on each face: otherwise ∫ λ(u_h - g)₊ is missing on the right of (4.9), and nowhere else.
#[test]
fn a_gap_that_is_not_concave_fails_the_sum_alone() {
    let broken = setup("broken-gap");
    assert_eq!(caught(&broken, &broken.model), ["(4.9)"]);
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
    let audit = SceneAudit::new(&setup_of(scene), &[4], &[8]).expect("an audit");
    assert!(audit.holds(), "{:?}", audit.violations());
}

/// The trapezoidal rule with one full weight.
struct FullWeight {
    last: bool,
}

impl TimeRule for FullWeight {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        let full = if self.last { n > 0 && j == n } else { n > 0 && j == 0 };
        Trapezoid.weight(grid, n, j) * if full { 2.0 } else { 1.0 }
    }
}

/// A kernel whose value at lag 0 is lost.
struct NothingAtZero(Box<dyn MemoryKernel>);

impl MemoryKernel for NothingAtZero {
    fn value(&self, lag: f64) -> f64 {
        if lag == 0.0 { 0.0 } else { self.0.value(lag) }
    }
}

/// κ of the level before.
struct Lagged<L> {
    sound: L,
    zeta: Arc<Mutex<f64>>,
}

impl<L: YieldLimit> YieldLimit for Lagged<L> {
    fn value(&self, _: f64) -> f64 {
        self.sound.value(*self.zeta.lock().expect("a number"))
    }
    fn slope(&self, _: f64) -> f64 {
        0.0
    }
}

/// Weights, kernel, law and κ of the solver: (4.9) has S_n^{kh} u^{kh}, σ^{kh} and j_ν⁰ of the scene. It has one sign, so that
/// a small defect of the law shows where no error in space hides it: with u(t) ∈ V^h.
#[test]
fn another_scheme_fails_the_sum() {
    type Spoil = fn(&mut Model);
    let spoils: [(&str, [&str; 2], Spoil); 4] = [
        ("last weight", ["compliance", "pure-mild"], |model| {
            model.time_rule = Box::new(FullWeight { last: true });
        }),
        ("first weight", ["compliance", "pure-mild"], |model| {
            model.time_rule = Box::new(FullWeight { last: false });
        }),
        ("kernel", ["compliance", "pure-mild"], |model| {
            let MemoryTerm { kernel, tensor } = model.memory.remove(0);
            model.memory = vec![MemoryTerm { kernel: Box::new(NothingAtZero(kernel)), tensor }];
        }),
        ("law", ["affine", "in-space"], |model| {
            let points = vec![(0.0, 0.0), (0.04, 0.08), (0.10, 0.051)];
            let law = PiecewiseLinear::new(points, 0.0, 0.0).expect("a law");
            model.boundary.as_mut().expect("contact").potential = Arc::new(law);
        }),
    ];
    for (what, names, spoil) in spoils {
        for name in names {
            let (sound, mut wrong) = (setup(name), setup(name).model);
            spoil(&mut wrong);
            let found = caught(&sound, &wrong);
            assert!(found.contains(&"(4.9)"), "{what} of {name}: {found:?}");
        }
    }
    let (sound, zeta) = (setup("pure-mild"), Arc::new(Mutex::new(0.0)));
    let VonMises { mu, limit } = sound.scene_projection().expect("a projection");
    let lagged = VonMises { mu, limit: Lagged { sound: limit, zeta: zeta.clone() } };
    let wrong = Model { projection: Some(AnyProjection::new(lagged)), ..setup("pure-mild").model };
    let constants = AuditConstants::new(&sound).expect("constants");
    let found = failing(&sound, &wrong, &on_mesh(&sound, 8), &constants, |now| {
        *zeta.lock().expect("a number") = now;
    });
    assert!(found.contains(&"(4.9)"), "{found:?}");
}

/// What fails in a sound run under changed constants.
fn under(name: &str, change: impl Fn(&mut AuditConstants)) -> Vec<&'static str> {
    let setup = setup(name);
    let mut constants = AuditConstants::new(&setup).expect("constants");
    change(&mut constants);
    failing(&setup, &setup.model, &on_mesh(&setup, 8), &constants, |_| ())
}

#[test]
fn wrong_constants_are_caught() {
    type Change = fn(&mut AuditConstants);
    let cases: [(&[&str], &str, Change); 9] = [
        (&["(4.7)"], "pure-mild", |c| c.m_a = c.l_a),
        (&["(4.17)"], "pure-mild", |c| c.l_a = 1.0),
        (&["(4.14)"], "pure-mild", |c| c.alpha_phi = 0.0),
        (&["(4.14)"], "viscoelastic", |c| c.beta_phi = 0.0),
        (&["(4.16)"], "affine", |c| c.alpha_j = 0.0),
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
    let audited = |off: f64| {
        let mut audit = SceneAudit::new(&setup, &[4], &[2]).expect("an audit");
        // m0 = m_A - alpha_phi - alpha_j c_j^2.
        audit.constants.alpha_phi += audit.constants.m0() - off;
        let case = audit_case(&setup, &on_mesh(&setup, 4), 2, &audit.constants);
        audit.cases = vec![case.expect("an audit")];
        audit
    };
    let sound = audited(1e-3);
    assert!(sound.holds() && sound.undefined().is_empty(), "{:?}", sound.violations());
    for off in [0.0, -0.1] {
        let audit = audited(off);
        assert!(!audit.holds() && audit.violations().is_empty(), "{:?}", audit.violations());
        assert_eq!(audit.undefined().len(), 1);
        assert!(audit.undefined()[0].contains("(4.20) has no defined constant: m0 = "));
        let document = audit.json().expect("a document");
        assert_eq!(
            (&document["holds"], document["undefined"].as_array().map(Vec::len)),
            (&false.into(), Some(1))
        );
        for line in document["lines"].as_array().expect("lines") {
            let defined = line["line"] != "(4.20)";
            let [said, held] = [&line["defined"], &line["holds"]];
            assert_eq!((said, held), (&defined.into(), &defined.into()), "{line}");
            assert_eq!(line["right"].is_null(), !defined, "{line}");
        }
        let table = String::from_utf8(audit.csv().expect("a table")).expect("text");
        assert!(!table.contains("inf") && table.matches(",false,").count() == 1, "{table}");
    }
}

/// A violation names line, level, grid and both sides, and stands first; no run proves nothing.
#[test]
fn a_violation_is_spelt_out() {
    let mut audit = SceneAudit::new(&setup("affine"), &[4], &[2]).expect("an audit");
    let place = |audit: &SceneAudit| {
        let text = audit.document().text(132);
        let rows = text.find("\nline ").expect("a table");
        text[rows..].find("\n(4.17) ").expect("a row")
    };
    let before = place(&audit);
    let worst = &mut audit.cases[0].rows[5].worst;
    *worst = Claim { left: 2.0, right: 1.0, accuracy: 1e-12, ..*worst };
    let level = worst.place.level;
    assert!(!audit.holds() && place(&audit) < before);
    let said = &audit.violations()[0];
    assert!(said.starts_with(&format!("(4.17) at level {level} of n = 4, N = 2: 2.0")), "{said}");
    assert_eq!(audit.json().expect("a document")["holds"], false);
    let table = String::from_utf8(audit.csv().expect("a table")).expect("text");
    assert_eq!(table.lines().count(), 1 + 8);
    let row = table.lines().nth(6).expect("a row");
    assert!(row.contains(&format!(",false,{level},1e0")), "{row}");
    let none = SceneAudit { cases: Vec::new(), ..audit };
    assert!(!none.holds());
}
