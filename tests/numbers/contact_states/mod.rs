//! Source: (5.5), the states of a point of Γ3: open, on the rising or falling branch of the law, at its jump, locked.
//! Goal: the scenes `state-…` have one state each, on all of Γ3 and at all times; errors by state agree with other
//!   integrals and closed forms, sum to the error on Γ3, and see a defect in their state alone; the distance of
//!   contact sets likewise. Corner exponents, Hertz contact, the page of scenes and the tutorial: the modules beside
//!   this one.
//! Mesh: n = 8 … 32. Data: the scenes `state-…`, pure-mild, pure-strong, and seeded views and models.

mod catalogue;
mod corners;
mod hertz;
mod tutorial;

use crate::shipped::{edited, on_mesh, refusal, setup, setup_of, text};
use fem::contact::StepView;
use fem::norms::{ContactSamples, ContactState, StateErrors, state_errors};
use run::sweep::{Overrides, ScenePlan, run_contact_case};
use scene::Norm;
use scene::setup::MeshData;

const TIMES: [f64; 4] = [0.0, 0.25, 0.5, 1.0];

fn samples(data: &MeshData, t: f64) -> ContactSamples {
    data.truth.contact_samples(t).expect("finite").expect("an exact solution")
}

/// Errors of the discrete state u = 0 with pressures `compliance`: norms of the truth itself.
fn of_nothing(data: &MeshData, t: f64, compliance: &[f64]) -> StateErrors {
    let (u, multiplier) = (vec![0.0; data.space.nodes.len()], vec![0.0; compliance.len()]);
    let view = StepView {
        n: 0,
        t,
        u: &u,
        history: &[],
        zeta: 0.0,
        kappa: f64::INFINITY,
        strain_norm: 0.0,
        compliance,
        multiplier: &multiplier,
        friction: &[],
    };
    state_errors(&data.space, &view, &samples(data, t))
}

fn no_pressure(data: &MeshData) -> Vec<f64> {
    vec![0.0; data.space.trace.points.len()]
}

#[test]
fn each_state_scene_has_its_state_alone() {
    for (name, state) in [
        ("state-open", ContactState::Open),
        ("state-rising", ContactState::Rising),
        ("state-falling", ContactState::Falling),
        ("state-jump", ContactState::AtJump),
        ("state-locked", ContactState::Locked),
    ] {
        let data = on_mesh(&setup(name), 8);
        for t in TIMES {
            let found = samples(&data, t).state;
            assert!(
                found.len() == 8 * 24 && found.iter().all(|seen| *seen == state),
                "{name}: {t}"
            );
        }
    }
    // A zone that grazes at a moment, and one that is there between two moments alone.
    let locked = |name: &str, t: f64| {
        let data = on_mesh(&setup(name), 16);
        of_nothing(&data, t, &no_pressure(&data)).measure[ContactState::Locked as usize]
    };
    // Locked are the vertices x < 1/5 and what lies between them, 3/16, to the rule's h/8.
    for t in [0.25, 0.75] {
        assert!((locked("state-instant", t) - 0.1875).abs() <= 1.0 / 128.0, "{t}");
    }
    assert!((locked("state-instant", 0.5) - 1.0).abs() < 1e-12);
    assert_eq!([0.1, 0.9].map(|t| locked("zone-appears", t)), [0.0, 0.0]);
    // |x - 1/2| ≤ 3/16 at its largest, to the rule's h/8 at either end.
    assert!((locked("zone-appears", 0.5) - 0.375).abs() <= 2.0 / 128.0);
}

/// pure-mild at t = 1: θ = 2.6 - 1.4 x, locked for x ≤ 3/7, on the falling branch beyond (θ > 1.2).
#[test]
fn measures_and_norms_by_state_have_their_closed_forms() {
    let data = on_mesh(&setup("pure-mild"), 32);
    let part = 1.0 / 32.0 / 8.0;
    let found = of_nothing(&data, 1.0, &no_pressure(&data));
    let at = |state: ContactState| state as usize;
    let (locked, falling) = (at(ContactState::Locked), at(ContactState::Falling));
    let zone = 3.0 / 7.0;
    assert!((found.measure[locked] - zone).abs() <= part, "{found:?}");
    assert!((found.measure[falling] - (1.0 - zone)).abs() <= part);
    assert_eq!(
        found.measure[at(ContactState::Open)] + found.measure[at(ContactState::Rising)],
        0.0
    );
    // ‖0.08‖ on the zone; ‖0.06 + ½ (θ - 2)³‖ there, θ - 2 = 1.4 (3/7 - x), by its antiderivative.
    let width = |square: f64| (found.trace[locked].powi(2) - square).abs();
    assert!(width(0.0064 * zone) <= 0.0064 * part);
    let cube = 0.6f64.powi(4) / 4.0;
    let square = 0.0036 * zone + 0.06 * cube / 1.4 + 0.25 * 0.6f64.powi(7) / 7.0 / 1.4;
    assert!((found.pressure[locked].powi(2) - square).abs() <= 0.0036 * part, "{found:?}");
    // Nothing is locked in the discrete state: the sets differ by the whole zone.
    assert!((found.set_difference - found.measure[locked]).abs() < 1e-14);
}

#[test]
fn a_defect_shows_in_its_state_alone() {
    let data = on_mesh(&setup("pure-mild"), 32);
    let exact = samples(&data, 1.0);
    let mut pressure = no_pressure(&data);
    let sound = of_nothing(&data, 1.0, &pressure);
    // A pressure added at the vertices left of x = 3/8, inside the locked zone.
    for (value, point) in pressure.iter_mut().zip(&data.space.trace.points) {
        if data.space.mesh.vertex(point.vertex)[0] < 0.3749 {
            *value = 0.5;
        }
    }
    let seeded = of_nothing(&data, 1.0, &pressure);
    let (locked, falling) = (ContactState::Locked as usize, ContactState::Falling as usize);
    assert!(seeded.pressure[locked] > 2.0 * sound.pressure[locked]);
    assert_eq!(seeded.pressure[falling], sound.pressure[falling]);
    assert_eq!(seeded.trace, sound.trace);
    // NaN in the discrete solution is no small error.
    pressure[0] = f64::NAN;
    assert!(of_nothing(&data, 1.0, &pressure).pressure.iter().any(|error| error.is_nan()));
    assert_eq!(exact.gap.len(), 64);
}

#[test]
fn norms_by_state_are_measured_where_asked_for() {
    let plan = |text: String| {
        let setup = setup_of(text);
        let plan =
            ScenePlan::new(scene::setup::Subject::Contact(Box::new(setup)), &Overrides::default());
        plan.cases[0].norms.clone()
    };
    let by_state = |norms: &[Norm]| norms.iter().filter(|norm| norm.by_state()).count();
    let written = text("state-locked");
    assert_eq!(by_state(&plan(written.clone())), 11);
    let silent = edited(&written, "by_state = true\n", "");
    assert_eq!(by_state(&plan(silent.clone())), 0);
    let judged = edited(&silent, "norm = \"V_max\"", "norm = \"pressure_locked_max\"");
    assert_eq!(by_state(&plan(judged)), 1);
    // The record: states that never occur have no error.
    let setup = setup("state-locked");
    let data = on_mesh(&setup, 8);
    let subject = scene::setup::Subject::Contact(Box::new(self::setup("state-locked")));
    let plan = ScenePlan::new(subject, &Overrides { n: Some(vec![8]), steps: Some(vec![2]) });
    let record = run_contact_case(&setup, &data, &plan.cases[0]);
    let error = |norm: &str| {
        let found = record.errors.iter().find(|entry| entry.norm == norm);
        found.unwrap_or_else(|| panic!("no {norm}")).error
    };
    assert!(error("pressure_locked_max").is_some_and(|error| error > 0.0));
    assert_eq!(error("pressure_open_max"), None);
    assert_eq!(error("contact_measure_max"), Some(0.0));
}

#[test]
fn states_of_a_scene_with_given_loads_are_refused() {
    let listed = edited(&text("punch"), "n = [8, 16, 32]\n", "n = [8, 16, 32]\nby_state = true\n");
    let message = refusal(listed);
    assert!(message.contains("need the state of the truth"), "{message}");
    assert!(message.contains("by_state"), "{message}");
    let free = edited(&text("viscoelastic"), "norm = \"V_max\"", "norm = \"trace_open_max\"");
    assert!(refusal(free).contains("measured on Γ3"));
}
