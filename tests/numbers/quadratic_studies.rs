//! Source: (3.4), the proofs of Theorems 10 and 11, and [`studies::theory`], for quadratic elements: tensors vary in a cell, and
//!   the law sits at vertices and midpoints.
//! Goal: every line of the proof holds on runs with P2, those with a gap with what functions pass it by between nodes, and
//!   a defect of the scheme is caught; trace constants are those of a dense problem with the mass of quadratics on edges; the
//!   factor of Λ is that of differences; a finer run of quadratics is a truth.
//! Mesh: 4 × 4 to 16 × 16 squares.
//! Data: quadratic-elastic, quadratic-front, quadratic-memory; pure-mild, signorini and elastic-punch on P2.

use std::sync::Arc;

use crate::bound::dense;
use crate::judged::errors;
use crate::samples::sample;
use crate::shipped::{at_level, edited, on_mesh, setup, setup_of, text};
use crate::wrong::{nothing_at_zero, see_kernels};
use fem::contact::{BoundaryRule, TraceMass, TracePart, march, trace_constants};
use judge::claim::Standing;
use scene::Norm;
use scene::setup::{MeshData, Setup, TruthLoad, constants, reference_run};
use studies::theory::audit::{AuditConstants, Auditor, audit};
use studies::theory::bound::{BoundStudy, contraction, finite_factor};
use studies::trade::estimate::{companions, norm_estimate};
use vhi::Newton;
use vhi::law::{PiecewiseLinear, TensorField};

/// A scene of linear elements on quadratic ones; these have the law at their nodes.
fn on_quadratics(name: &str, before: &str) -> Setup {
    let element = format!("[discretization]\nelement = \"P2\"\n\n{before}");
    with_law_at_nodes(setup_of(edited(&text(name), before, &element)))
}

fn with_law_at_nodes(mut setup: Setup) -> Setup {
    for boundary in &mut setup.model.boundary {
        boundary.rule = BoundaryRule::Vertex;
    }
    setup
}

#[test]
fn every_line_of_the_proof_holds() {
    let front = setup("quadratic-front");
    for setup in [setup("quadratic-elastic"), front, on_quadratics("pure-mild", "[exact]\n")] {
        let name = &setup.scene.name;
        let found = audit(&setup, &[4, 8], &[4]).expect("an audit");
        assert!(found.holds(), "{name}: {:?}", found.claims);
    }
}

/// Between the nodes a quadratic function passes the gap, so that U^h is no part of U: E_q has ∫ λ(u_h - g)₊, without which
/// (4.9) would fail.
#[test]
fn what_passes_the_gap_between_nodes_is_counted() {
    let setup = on_quadratics("signorini", "[exact]\n");
    let found = audit(&setup, &[8], &[8]).expect("an audit");
    assert!(found.holds(), "{:?}", found.claims);
    // Interpolants of u as quadratic functions.
    let found = audit(&on_quadratics("in-space", "[exact]\n"), &[8], &[4]);
    assert!(found.expect("an audit").holds());
}

/// The lines that a run of another model violates.
fn violated(spoil: impl FnOnce(&mut Setup)) -> Vec<&'static str> {
    let (sound, mut other) = (setup("quadratic-front"), setup("quadratic-front"));
    spoil(&mut other);
    let data = on_mesh(&sound, 8);
    let known = AuditConstants::new(&sound).expect("constants");
    let mut auditor = Auditor::new(&sound, &data, 4, &known).expect("an exact solution");
    let (grid, mut load) = (sound.grid(4), TruthLoad(&*data.truth));
    let info =
        march(&data.space, &other.model, &grid, &mut load, &Newton::default(), &mut |view| {
            auditor.observe(view)?;
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
    let claims = auditor.claims(info.floors.v);
    let failing = claims.iter().filter(|claim| claim.standing() == Standing::Fails);
    failing.map(|claim| claim.statement.source).collect()
}

#[test]
fn defects_of_the_scheme_violate_lines() {
    assert_eq!(violated(|_| {}), Vec::<&str>::new());
    let of_memory = violated(|setup| see_kernels(&mut setup.model, nothing_at_zero));
    let of_law = violated(|setup| {
        let points = vec![(0.0, 0.0), (0.04, 0.09), (0.10, 0.05)];
        let law = PiecewiseLinear::new(points, 0.0, 0.0).expect("a law");
        setup.model.boundary.first_mut().expect("contact").potential = Arc::new(law);
    });
    for found in [of_memory, of_law] {
        assert!(found.contains(&"(4.9)"), "{found:?}");
    }
}

/// ∫ of products of quadratics on an edge are (4, -1, 2; -1, 4, 2; 2, 2, 16)/30; Simpson's rule has (1, 1, 4)/6.
#[test]
fn trace_constants_are_those_of_quadratics() {
    let setup = setup("quadratic-front");
    let space = setup.space(3).expect("a mesh");
    let exact = [[4.0, -1.0, 2.0], [-1.0, 4.0, 2.0], [2.0, 2.0, 16.0]].map(|r| r.map(|m| m / 30.0));
    let simpson = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 4.0]].map(|r| r.map(|m| m / 6.0));
    // The mass matrix of functions that are linear between the nodes, which gives another constant.
    let linear = [[4.0, 0.0, 2.0], [0.0, 4.0, 2.0], [2.0, 2.0, 8.0]].map(|r| r.map(|m| m / 24.0));
    for tensor in [TensorField::identity(), setup.model.elasticity.clone()] {
        let found = |mass| {
            let square = (TracePart::Normal, mass);
            trace_constants(&space, &tensor, [square]).expect("a constant")[0].value
        };
        let off = |mass, on_edge| (found(mass) / dense(&space, &tensor, on_edge) - 1.0).abs();
        // Both to rounding, as for linear elements.
        assert!(off(TraceMass::Consistent, exact) < 1e-12);
        assert!(off(TraceMass::Lumped, simpson) < 1e-12);
        assert!(off(TraceMass::Consistent, linear) > 1e-9);
        // Simpson's rule overestimates squares of quadratics.
        assert!(found(TraceMass::Lumped) >= found(TraceMass::Consistent) * (1.0 - 1e-12));
    }
}

#[test]
fn the_step_bound_holds_and_wrong_constants_do_not() {
    for name in ["quadratic-memory", "quadratic-front"] {
        let setup = setup(name);
        let bound = BoundStudy::new(&setup, 2, 4).unwrap_or_else(|error| panic!("{error}"));
        assert!(bound.holds(), "{name}: {:?}", bound.claims);
        assert!(bound.study.thresholds.norm.is_some(), "{name}: memory makes a threshold");
    }
    // Samples at the strain points need the constants, and no smaller ones.
    let setup = setup("quadratic-memory");
    let (space, sound) = (setup.space(4).expect("a mesh"), constants(&setup).expect("constants"));
    let fails = |wrong| -> Vec<&'static str> {
        let rows = sample(&setup, &wrong, &space);
        let failing = rows.iter().filter(|row| row.reason().is_some());
        failing.map(|row| row.statement.source).collect()
    };
    let half = 0.5 * sound.alpha_phi;
    let mut spoilt = constants(&setup).expect("constants");
    spoilt.beta_phi *= 0.5;
    assert_eq!(fails(sound), Vec::<&str>::new());
    let told = fails(spoilt);
    assert!(half > 0.0 && told.iter().any(|what| what.contains("beta_phi")), "{told:?}");
}

/// Differences of 1e-6 lose six of sixteen digits, times the condition.
#[test]
fn the_factor_is_that_of_differences() {
    let setup = setup("quadratic-memory");
    let data = on_mesh(&setup, 4);
    let off = at_level(&setup, &data, 4, 4, |level, state| {
        let found = contraction(level, &state.u, &state).expect("a factor");
        let finite = finite_factor(level, &state.u, &state, &found.direction).expect("a solve");
        Ok((finite / found.norm - 1.0).abs())
    });
    let off = off.unwrap_or_else(|error| panic!("{error}"));
    assert!(off < 1e-5, "{off:e}");
}

/// Of a scene without exact solution: the estimate against a run with four times the cells and steps.
#[test]
fn a_finer_run_is_a_truth_for_quadratic_elements() {
    let setup = on_quadratics("elastic-punch", "[loads]\n");
    let found = companions(&setup, 8, 4, &mut |_, _| ());
    let found = found.unwrap_or_else(|error| panic!("{error}"));
    let differences = found.norms.iter().find(|found| found.norm == Norm::VMax).expect("the norm");
    let (value, interval) =
        norm_estimate(&setup, &found, differences).total().expect("an estimate");
    let finer = reference_run(&setup, 32, 16, 1).unwrap_or_else(|error| panic!("{error}"));
    let data = MeshData::new(&setup, 8, Some(Arc::new(finer))).expect("nested meshes");
    let real = errors(&setup, &data, 8, 4, &[Norm::VMax])[0];
    println!("{value:.3e} in {interval:?}, {real:.3e}");
    // The corners are singular, and the finer run has a fourth of the error at order 1.
    assert!((0.7..1.4).contains(&(value / real)) && interval.contains(real), "{value} {real}");
}
