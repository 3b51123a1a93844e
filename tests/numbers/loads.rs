//! Source: F(v) = ∫ σ:ε(v) + ∫ c v_ν (weak) against F(v) = ∫ f0·v + ∫ f2·v + ∫ h3·v (strong); docs/THEORY.md, section 7.
//! Goal: the two load vectors of a mesh agree, to rounding where σ is constant, to the quadrature of the jump of f0
//!   across yield curve and zone edge elsewhere.
//! Mesh: n × n squares cut from lower left to upper right.
//! Data: affine, viscoelastic (smooth), sourced and pure-mild (jump, contact zones).

use std::sync::Arc;

use crate::shipped::{on_mesh, setup};
use exact::{Exact, ExactData, ExactOnMesh, LoadForm, Truth};
use fem::contact::LoadError;
use fem::space::quadrature::TruthRules;
use scene::setup::{MeshData, Setup, side_numbers};

/// Both load vectors on the mesh n at t, and the largest nodal force.
fn loads(
    setup: &Setup,
    exact: &Arc<Exact>,
    n: u32,
    t: f64,
) -> Result<[Arc<Vec<f64>>; 2], LoadError> {
    let space = setup.space(n).unwrap_or_else(|error| panic!("{error}"));
    let sides = side_numbers(&setup.body.domain.traction);
    let rules = TruthRules::of(2);
    let on_mesh =
        |form| ExactOnMesh::new(exact.clone(), space.clone(), form, &sides, &rules).load(t);
    Ok([on_mesh(LoadForm::Weak)?, on_mesh(LoadForm::Strong)?])
}

/// Largest difference of a nodal force, relative to the largest nodal force of the weak form.
fn difference(setup: &Setup, exact: &Arc<Exact>, n: u32, t: f64) -> f64 {
    let [weak, strong] = loads(setup, exact, n, t).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(weak.len(), strong.len());
    let size = weak.iter().fold(0f64, |size, f| size.max(f.abs()));
    let pairs = weak.iter().zip(strong.iter());
    let worst = pairs.fold(0f64, |worst, (a, b)| {
        let here = (a - b).abs();
        if here.is_nan() { f64::NAN } else { worst.max(here) }
    });
    worst / size
}

fn exact(setup: &Setup) -> Arc<Exact> {
    setup.exact.clone().expect("an exact solution")
}

#[test]
fn affine_loads_agree_to_rounding() {
    for scene in ["affine", "affine-locked"] {
        let setup = setup(scene);
        for t in [0.37, 1.0] {
            let off = difference(&setup, &exact(&setup), 4, t);
            // Sums of a dozen terms, each with a history good to 1e-13.
            assert!(off <= 1e-12, "{scene}, t = {t}: {off:e}");
        }
    }
}

/// Without a jump what remains is the rule of degree 4 on a smooth load: (πh)⁵/720 on single forces, and falling.
#[test]
fn smooth_loads_agree_to_their_quadrature() {
    let setup = setup("viscoelastic");
    let [coarse, fine] = [8, 16].map(|n| difference(&setup, &exact(&setup), n, 0.71));
    assert!(fine <= 1e-6, "{fine:e}");
    assert!(fine < coarse / 16.0, "{coarse:e} {fine:e}");
}

/// f0 jumps across the yield curve, by about μ|∂ε|. A cell that the curve cuts errs by a share of jump × h², against
/// nodal forces of size σh: O(h). At t = 0.37 there is no locked zone; at t = 0.75 its edge, where W_xxx jumps, lies on
/// the mesh line x = 1/4. Measured: 0.06/n to 0.11/n of the largest nodal force.
#[test]
fn loads_agree_to_the_quadrature_of_the_jump_across_the_yield_curve() {
    for scene in ["sourced", "pure-mild"] {
        let setup = setup(scene);
        for (t, n) in [(0.37, 8), (0.37, 32), (0.75, 8), (0.75, 32)] {
            let off = difference(&setup, &exact(&setup), n, t);
            assert!(off <= 0.2 / f64::from(n), "{scene}, t = {t}, n = {n}: {off:e}");
        }
    }
}

/// Where the edge of the zone runs through cells, f0 jumps there by 3 [W_xxx] ≈ 35 and dominates: 0.3/n to 1.2/n.
/// Loads in the strong form are a check, not a driver: the scenes use the weak form.
#[test]
fn the_edge_of_a_zone_inside_cells_costs_more_and_vanishes_too() {
    for scene in ["sourced", "pure-mild"] {
        let setup = setup(scene);
        let [coarse, fine] = [8, 64].map(|n| difference(&setup, &exact(&setup), n, 0.71));
        assert!(coarse <= 1.0 / 8.0 && fine <= 1.0 / 64.0, "{scene}: {coarse:e} {fine:e}");
        assert!(fine <= coarse / 4.0, "{scene}: {coarse:e} {fine:e}");
    }
}

/// The same formulas with other data.
fn changed(setup: &Setup, change: impl Fn(&mut ExactData)) -> Arc<Exact> {
    let mut data = exact(setup).data.clone();
    change(&mut data);
    Arc::new(Exact::new(data))
}

/// σ:ε and σν of one material beside f0 of another: the two forms must then disagree.
#[test]
fn a_body_force_of_another_material_is_seen() {
    for scene in ["viscoelastic", "pure-mild"] {
        let setup = setup(scene);
        let sound = difference(&setup, &exact(&setup), 16, 0.37);
        let mut mixed = changed(&setup, |data| data.material.lambda *= 1.5);
        let again = difference(&setup, &mixed, 16, 0.37);
        // The stress keeps the new number, f0 gets the old one.
        Arc::get_mut(&mut mixed).expect("one owner").forces = exact(&setup).forces.clone();
        let off = difference(&setup, &mixed, 16, 0.37);
        assert!(off > 5.0 * sound, "{scene}: {off:e} {sound:e}");
        assert!(
            again < 2.0 * sound,
            "{scene}, f0 with the new number as well: {again:e} {sound:e}"
        );
    }
}

/// A load is the same whether the moments at its time are known or not.
#[test]
fn loads_do_not_depend_on_what_is_known() {
    for scene in [
        "affine",
        "compliance",
        "layered",
        "state-instant",
        "pure-box",
        "pure-mild",
        "viscoelastic",
    ] {
        let setup = setup(scene);
        let (alone, beside) = (on_mesh(&setup, 4), on_mesh(&setup, 4));
        beside.truth.expect(&[0.5]).unwrap_or_else(|error| panic!("{error}"));
        let load = |data: &MeshData| data.truth.load(0.5).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(load(&alone), load(&beside), "{scene}");
        assert!(load(&alone).iter().any(|force| *force != 0.0));
    }
}
