//! Source: F(v) = ∫ σ:ε(v) + ∫ c v_ν (weak) against F(v) = ∫ f0·v + ∫ f2·v + ∫ h3·v (strong); docs/THEORY.md, section 7.
//! Goal: the two load vectors of a mesh agree, to rounding where σ is constant, to the quadrature of the jump of f0
//!   across yield curve and zone edge elsewhere; the quadrature of the compliance term does not decide the V error.
//! Mesh: n × n squares cut from lower left to upper right.
//! Data: affine, viscoelastic (smooth), sourced and pure-mild (jump, contact zones).

use std::sync::Arc;

use crate::shipped::{bodies, edited, on_mesh, relative, setup, setup_of, text, v_max};
use exact::{Exact, ExactData, ExactOnMesh, LoadForm, Truth};
use fem::contact::{BoundaryRule, Discretization, LoadError, stress_force};
use fem::norms::Moments;
use fem::space::quadrature::TruthRules;
use scene::Data;
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

/// Largest difference between nodal forces of the weak load and those that the solver's assembly makes of the same
/// cell stresses, relative to the largest; nodes of Γ3 left out, where the load has the contact pressure as well.
fn assemblies_differ(scene: &str, distort: impl Fn([f64; 3]) -> [f64; 3]) -> f64 {
    let setup = setup(scene);
    let data = on_mesh(&setup, 4);
    let (space, t) = (&data.space, 0.71);
    let load = data.truth.load(t).unwrap_or_else(|error| panic!("{error}"));
    let moments = data.truth.moments(t).unwrap_or_else(|error| panic!("{error}"));
    let mut force = vec![0.0; space.nodes.len()];
    for (c, stress) in moments.stress.at.chunks_exact(3).enumerate() {
        let stress = distort([stress[0], stress[1], stress[2]]);
        let stress = stress.map(|s| s * space.geometry.measure[c]);
        let (gradients, nodes) = (space.geometry.gradients(c), space.cell_nodes(c));
        stress_force::<2, 3>(gradients, nodes, &stress, &mut force);
    }
    let on_contact = |dof: usize| space.trace.points.iter().any(|p| p.node == dof as u32 / 2);
    let size = load.iter().fold(0f64, |size, f| size.max(f.abs()));
    let inner = (0..load.len()).filter(|&dof| !on_contact(dof));
    inner.map(|dof| (load[dof] - force[dof]).abs() / size).fold(0.0, f64::max)
}

/// Gradients in Mandel notation on the solver's side, edges and full tensors on the other: two routines, one result.
/// The stress of these scenes is constant on cells, so that no quadrature stands between them.
#[test]
fn the_two_assemblies_agree_and_a_wrong_one_is_seen() {
    for scene in ["affine", "affine-locked"] {
        let off = assemblies_differ(scene, |stress| stress);
        // Sums of six cells.
        assert!(off <= 1e-13, "{scene}: {off:e}");
        let without_factor = |[a, b, c]: [f64; 3]| [a, b, c / 2f64.sqrt()];
        let off = assemblies_differ(scene, without_factor);
        assert!(off > 1e-3, "{scene}, shear without √2: {off:e}");
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
        let mut mixed = changed(&setup, |_| {});
        let sound = difference(&setup, &mixed, 16, 0.37);
        // The pointwise law gets the new number; f0, derived already, keeps the old one.
        Arc::get_mut(&mut mixed).expect("one owner").data.material.lambda *= 1.5;
        let off = difference(&setup, &mixed, 16, 0.37);
        assert!(off > 5.0 * sound, "{scene}: {off:e} {sound:e}");
        let all_new = changed(&setup, |data| data.material.lambda *= 1.5);
        let again = difference(&setup, &all_new, 16, 0.37);
        assert!(
            again < 2.0 * sound,
            "{scene}, f0 with the new number as well: {again:e} {sound:e}"
        );
    }
}

/// V errors of the vertex and the Gauss rule agree to three digits; the pressures of the two rules differ.
#[test]
fn the_contact_quadrature_does_not_decide_the_v_error() {
    for scene in ["pure-mild", "compliance"] {
        let vertex = setup(scene);
        let gauss =
            setup_of(edited(&text(scene), "quadrature = \"vertex\"", "quadrature = \"gauss\""));
        let rule = |setup: &Setup| setup.model.boundary.as_ref().map(|boundary| boundary.rule);
        assert_eq!(rule(&vertex), Some(BoundaryRule::Vertex));
        assert_eq!(rule(&gauss), Some(BoundaryRule::Gauss));
        let [a, b] = [&vertex, &gauss].map(|s| v_max(s, &s.model, &on_mesh(s, 16), 8));
        let off = relative(a, b);
        assert!(off <= 1e-3, "{scene}: {a:e} {b:e}");
        // Two runs of one rule would agree exactly: the comparison compares two.
        assert!(off > 0.0, "{scene}");
    }
}

/// Largest difference of two lists relative to the largest number of the second.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(0f64, |size, value| size.max(value.abs()));
    let pairs = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    pairs.fold(0f64, |worst, off| if off.is_nan() { f64::NAN } else { worst.max(off) })
        / if size > 0.0 { size } else { 1.0 }
}

/// Loads and moments of two truths at a time, and how far they are apart.
fn truths_apart(a: &dyn Truth, b: &dyn Truth, [t, s]: [f64; 2]) -> f64 {
    let load = |truth: &dyn Truth, t: f64| truth.load(t).unwrap_or_else(|error| panic!("{error}"));
    let moments =
        |truth: &dyn Truth, t: f64| truth.moments(t).unwrap_or_else(|error| panic!("{error}"));
    let (m, l) = (moments(a, t), moments(b, s));
    assert_eq!(m.locked, l.locked);
    // Remainders against the size of their field: those of an affine one are rounding.
    let rests = |moments: &Moments| -> [(f64, f64); 3] {
        let size = |values: &[f64]| values.iter().fold(f64::MIN_POSITIVE, |s, v| s.max(v.abs()));
        let Moments { strain, stress, displacement, .. } = moments;
        [
            (strain.rest.sqrt(), size(&strain.at)),
            (stress.rest.sqrt(), size(&stress.at)),
            (displacement.rest.sqrt(), size(&displacement.node)),
        ]
    };
    let rests =
        rests(&m).into_iter().zip(rests(&l)).map(|((a, _), (b, size))| (a - b).abs() / size);
    [
        apart(&load(a, t), &load(b, s)),
        apart(&m.strain.at, &l.strain.at),
        apart(&m.stress.at, &l.stress.at),
        apart(&m.displacement.node, &l.displacement.node),
        apart(&m.normal.node, &l.normal.node),
        apart(&m.pressure.node, &l.pressure.node),
    ]
    .into_iter()
    .chain(rests)
    .fold(0f64, |worst, off| if off.is_nan() { f64::NAN } else { worst.max(off) })
}

/// Setups with an exact solution that no run interpolates, each with that solution and the mesh of its sweep's first n.
fn integrated() -> impl Iterator<Item = (Setup, Arc<Exact>, Arc<Discretization>)> {
    let interpolated =
        |setup: &Setup| matches!(setup.body.data, Data::Exact { interpolated: true, .. });
    bodies().filter(move |setup| !interpolated(setup)).filter_map(|setup| {
        let exact = setup.exact.clone()?;
        let n = setup.scene.sweep.as_ref().and_then(|sweep| sweep.n.iter().min().copied());
        let space = setup.space(n.unwrap_or(4)).unwrap_or_else(|error| panic!("{error}"));
        Some((setup, exact, space))
    })
}

/// 1e-11, and where λ is far above μ the rounding of λ div u, whose terms cancel.
fn allowed(setup: &Setup) -> f64 {
    let (least, largest) = setup.model.elasticity.eigenvalues(setup.scene.dimension);
    f64::max(1e-11, f64::EPSILON * largest / least)
}

/// Fields that separate in time are integrated once and combined; the same as at each time alone. What moves in
/// space, and what is projected, does not separate.
#[test]
fn fields_in_parts_are_those_of_each_time() {
    let mut separated = Vec::new();
    for (setup, exact, space) in integrated() {
        let name = setup.scene.name.clone();
        let Some(separation) = &exact.separation else { continue };
        let sides = side_numbers(&setup.body.domain.traction);
        let rules = TruthRules::of(setup.scene.dimension);
        for form in [LoadForm::Weak, LoadForm::Strong] {
            let truth = || ExactOnMesh::new(exact.clone(), space.clone(), form, &sides, &rules);
            let (parts, whole) = (truth(), truth().time_by_time());
            let horizon = setup.scene.time.horizon;
            for t in [0.0, 0.31 * horizon, horizon] {
                let off = truths_apart(&parts, &whole, [t, t]);
                // Sums of at most eight parts, of terms that hardly cancel; remainders are squares of small differences.
                assert!(off < allowed(&setup), "{name}, {form:?}, t = {t}: {off:e}");
            }
            let moves =
                separation.factors.at(0.31 * horizon) != separation.factors.at(0.32 * horizon);
            let off = truths_apart(&parts, &whole, [0.31 * horizon, 0.32 * horizon]);
            assert!(off > 1e-4 || !moves, "{name}: another time, {off:e}");
        }
        separated.push(name);
    }
    for name in ["law-linear", "orthotropic", "viscoelastic"] {
        assert!(separated.iter().any(|known| known == name), "{name} separates: {separated:?}");
    }
    for name in ["affine", "compliance", "pure-mild"] {
        assert!(separated.iter().all(|known| known != name), "{name} does not separate");
    }
}

/// Memory by a multiple of 𝒜 is a matter of factors in time; by other numbers it adds parts. With a multiple that
/// is not the material's σ is another.
#[test]
fn memory_that_is_a_multiple_has_no_parts() {
    for (scene, parts, alone) in [
        ("viscoelastic", 2, 0),
        ("sourced-box", 3, 0),
        ("law-linear", 1, 0),
        // λ and μ_L of the memory have another ratio; kernels of bulk and shear differ.
        ("layered", 1, 1),
        ("bulk-shear", 2, 4),
    ] {
        let exact = exact(&setup(scene));
        let separation = exact.separation.as_ref().expect("fields that separate");
        let by_itself = separation.remembered_alone.iter().filter(|alone| !**alone).count();
        assert_eq!([by_itself, separation.factors.parts - by_itself], [parts, alone], "{scene}");
    }
    let setup = setup("viscoelastic");
    let mut mixed = changed(&setup, |_| {});
    // The law point by point gets the new number; the factors, derived already, keep the old one.
    let material = &mut Arc::get_mut(&mut mixed).expect("one owner").data.material;
    material.memory[0] = (1.5 * material.memory[0].0, 1.5 * material.memory[0].1);
    let space = on_mesh(&setup, 4).space;
    let sides = side_numbers(&setup.body.domain.traction);
    let new = || {
        let rules = TruthRules::of(2);
        ExactOnMesh::new(mixed.clone(), space.clone(), LoadForm::Weak, &sides, &rules)
    };
    let off = truths_apart(&new(), &new().time_by_time(), [0.7, 0.7]);
    assert!(off > 1e-3, "{off:e}");
}

/// Fields that separate are integrated in parts: loads and moments are those of each point at each time.
#[test]
fn shorter_ways_to_the_moments_are_those_of_each_point() {
    for (setup, exact, space) in integrated() {
        let name = &setup.scene.name;
        let sides = side_numbers(&setup.body.domain.traction);
        let rules = TruthRules::of(setup.scene.dimension);
        let horizon = setup.scene.time.horizon;
        let [early, late] = [0.31 * horizon, 0.32 * horizon];
        for form in [LoadForm::Weak, LoadForm::Strong] {
            let new = || ExactOnMesh::new(exact.clone(), space.clone(), form, &sides, &rules);
            let (short, points) = (new(), new().time_by_time());
            for t in [0.0, early, horizon] {
                let off = truths_apart(&short, &points, [t, t]);
                // Sums over 12 points and a few products of numbers of order one; remainders are squares of small differences.
                assert!(off < allowed(&setup), "{name}, {form:?}, t = {t}: {off:e}");
            }
            let load = |truth: &ExactOnMesh, t: f64| {
                truth.load(t).unwrap_or_else(|error| panic!("{error}"))
            };
            let moves = load(&points, early) != load(&points, late);
            let off = apart(&load(&short, early), &load(&points, late));
            assert!(off > 1e-4 || !moves, "{name}: another time, {off:e}");
        }
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
