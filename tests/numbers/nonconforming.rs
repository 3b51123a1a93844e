//! Source: tests/fixtures/nonconforming.json by tests/independent/nonconforming.py with scikit-fem; affine displacements;
//!   the locking of linear elements (Babuska and Suri 1992).
//! Goal: CR is what another program has; affine displacements are reproduced; the tangent is the derivative of the residual;
//!   loads in both forms are one; P1 locks where CR does not; wrong jumps and means lose the order or the constant.
//! Mesh: n × n squares cut from lower left to upper right, with their vertices moved for what holds on any mesh.
//! Data: the scenes nonconforming-… and locking-nonconforming, and those of tests/independent.

use super::differences::mismatch;
use crate::shipped::{
    Change, edited, errors, fixture, on_mesh, run, setup, setup_of, text, v_max, v_max_on_changed,
};
use algebra::linalg::signed_unit;
use fem::contact::{ContactProblem, Discretization, KKT_ALLOWED, LastSlot, StepView, kkt_residual};
use fem::space::Element;
use scene::setup::Setup;
use scene::{Extension, Scene, Source};

/// Every displacement to 1e-9 of the largest: both solve the same discrete problem, to 1e-13.
#[test]
fn scikit_fem_finds_the_same() {
    let known = fixture("nonconforming");
    let [n, steps] = ["n", "steps"].map(|key| known[key].as_u64().expect("a count") as u32);
    for name in ["elastic", "contact"] {
        let at = env!("CARGO_MANIFEST_DIR");
        let path = format!("{at}/tests/independent/nonconforming-{name}.toml");
        let setup = setup_of(std::fs::read_to_string(path).expect("a scene"));
        let (data, mut u) = (on_mesh(&setup, n), Vec::new());
        let info = run(&setup, &setup.model, &data, steps, |view| u = view.u.to_vec())
            .unwrap_or_else(|error| panic!("{error}"));
        assert!(info.kkt_residual < 1e-12, "{name}: {:e}", info.kkt_residual);
        let (space, largest) = (&data.space, u.iter().fold(0.0f64, |m, v| m.max(v.abs())));
        let rows = known["nodes"][name].as_array().expect("rows");
        assert_eq!(rows.len(), space.nodes.vertex.len());
        for row in rows {
            let [x, y, p, q] = [0, 1, 2, 3].map(|i| row[i].as_f64().expect("a number"));
            let here = |&v: &u32| {
                let place = space.mesh.vertex(v);
                (place[0] - x).hypot(place[1] - y) < 1e-12
            };
            let node = space.nodes.vertex.iter().position(here).expect("a node there");
            let at_node = &u[2 * node..][..2];
            let off = (at_node[0] - p).abs().max((at_node[1] - q).abs());
            assert!(off <= 1e-9 * largest, "{name} at ({x}, {y}): {off:e}");
        }
    }
}

/// An affine displacement on a perturbed mesh of two materials, with memory, a layer of springs and loads in either form.
#[test]
fn affine_displacements_are_reproduced() {
    let scene = text("nonconforming-signorini");
    let start = scene.find("[exact]").expect("an exact solution");
    let moved =
        "contact = [\"bottom\"]\nmesh = { kind = \"perturbed\", amplitude = 0.2, seed = 3 }";
    let scene = edited(&scene[..start], "contact = [\"bottom\"]", moved);
    let scene = edited(&scene, "kernel = \"-exp(-t)\"", "kernel = \"-1\"");
    let scene = edited(&scene, "{ kind = \"none\" }", "{ kind = \"linear\", stiffness = 0.5 }");
    let scene = edited(&scene, "gap = \"0.08\"\n", "");
    for form in ["weak", "strong"] {
        let exact =
            format!("[exact]\nform = \"{form}\"\nu = [\"0.7*(1 - y)\", \"-0.3*(1 - y)\"]\n");
        let sweep = "[sweep]\nn = [3]\nsteps = [2]\n";
        let predicts =
            "[[predicts]]\nnorm = \"V_max\"\nvariable = \"h\"\norder = 1.0\nwhy = \"none\"\n";
        let setup = setup_of(format!("{scene}{exact}{sweep}{predicts}"));
        let data = on_mesh(&setup, 3);
        assert_eq!(data.space.element, Element::CR);
        for step in errors(&setup, &setup.model, &data, 2) {
            // Rounding: strains of size 1, by 1e2 of the condition.
            assert!(step.v < 1e-12 && step.l2 < 1e-12 && step.stress < 1e-11, "{form}: {step:?}");
        }
    }
}

/// ∫ f0·v by Div σ and by what integration by parts on each cell leaves: with the rules of the truth, to what they miss.
#[test]
fn loads_in_both_forms_are_one() {
    let strong = text("nonconforming-elastic");
    let weak = edited(&strong, "form = \"strong\"", "form = \"weak\"");
    let [strong, weak] = [strong, weak].map(|scene| on_mesh(&setup_of(scene), 8));
    let [a, b] = [&strong, &weak].map(|data| data.truth.load(0.7).expect("a load"));
    let largest = a.iter().fold(0.0f64, |m, f| m.max(f.abs()));
    let off = a.iter().zip(&*b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // Degrees 4 and 6 on cells of size 1/8: h⁵/5! of a wave.
    assert!(off < 1e-6 * largest, "{off:e} of {largest:e}");
}

/// γ ⟦v⟧ in the norm of jumps: 2μ times it for one tensor, the sum of both for two on one field.
#[test]
fn stresses_of_jumps_are_weighed_by_shear() {
    let setup = setup("nonconforming-memory");
    let space = on_mesh(&setup, 3).space;
    let mut seed = 3;
    let v: Vec<f64> = (0..space.nodes.len()).map(|_| signed_unit(&mut seed)).collect();
    let (elastic, memory) = (&setup.model.elasticity, &setup.model.memory[0].tensor);
    let jumps = space.jump_square(&v);
    // 2 μ_L = 2 and 2 μ = 1/2 in the scene.
    for (terms, gamma) in [
        (vec![(elastic, &v[..])], 2.0f64),
        (vec![(memory, &v[..])], 0.5),
        (vec![(elastic, &v[..]), (memory, &v[..])], 2.5),
    ] {
        let found = space.jump_stress_square(terms.into_iter());
        assert!((found - gamma * gamma * jumps).abs() < 1e-12 * found, "{gamma}: {found} {jumps}");
    }
    // The norm of V^h, by its square from the strains and the jumps.
    let strains = fem::contact::strain_norm(&space, &v).powi(2);
    let distance = fem::contact::strain_distance(&space, &v, &vec![0.0; v.len()]);
    assert!((distance.powi(2) - strains - jumps).abs() < 1e-12 * strains && jumps > 0.1 * strains);
}

/// Where the body yields and remembers.
#[test]
fn the_tangent_with_jumps_is_the_derivative() {
    let written = text("nonconforming-memory");
    let setup = setup_of(edited(&written, "0.02 + 0.05*zeta", "0.10 + 0.05*zeta"));
    let space = on_mesh(&setup, 3).space;
    let mut seed = 5;
    let u: Vec<f64> = (0..space.dofs()).map(|_| 0.05 * signed_unit(&mut seed)).collect();
    let memory = setup.model.memory.iter().map(|term| 0.125 * term.kernel.value(0.0)).collect();
    let mut problem = ContactProblem::new(&space, &setup.model).expect("an analysis");
    problem.begin(&LastSlot { zeta: 0.125, memory }, 0.1, &vec![0.0; space.dofs()], &[]);
    let d: Vec<f64> = u.iter().map(|_| signed_unit(&mut seed)).collect();
    let off = mismatch(&mut problem, &u, &d);
    // As in tests/numbers/tangent.rs: truncation and rounding.
    assert!(off < 1e-7, "{off:e}");
}

/// The locking scene with this λ and element.
fn incompressible(lambda: &str, element: &str) -> Setup {
    let scene =
        text("locking-nonconforming").replace("lambda = 1e6", &format!("lambda = {lambda}"));
    setup_of(edited(&scene, "element = \"CR\"", &format!("element = \"{element}\"")))
}

/// V_max on n = 8, 16.
fn on_two_meshes(setup: &Setup) -> [f64; 2] {
    [8, 16].map(|n| v_max(setup, &setup.model, &on_mesh(setup, n), 1))
}

/// P1 comes as near as fields without divergence on its mesh do, (a(y) + b(x - y), b(x - y)) with b = 0 above the diagonal:
/// a'/2 is the mean of ε_xy over x, and b' that of ε_xx along x - y. What they leave of ‖ε(u)‖ at t = 1 is 0.4933373, by
/// the midpoint rule with 200 points an axis.
#[test]
fn linear_elements_lock_and_these_do_not() {
    let [soft, stiff] = ["1e3", "1e6"].map(|lambda| on_two_meshes(&incompressible(lambda, "CR")));
    assert!(((stiff[0] / stiff[1]).log2() - 1.0).abs() < 0.05, "{stiff:?}");
    // The constant is that of μ_L, up to a share μ_L/λ.
    assert!((stiff[1] / soft[1] - 1.0).abs() < 2e-3, "{soft:?} {stiff:?}");
    let linear = on_two_meshes(&incompressible("1e8", "P1"));
    // Means over cells in place of values: h²/24 of second derivatives of about 2.
    let off = [8.0f64, 16.0].map(|n| n * n * (linear[n as usize / 8 - 1] / 0.4933373 - 1.0));
    assert!(off.iter().all(|off| off.abs() < 1.0 / 12.0), "{linear:?} {off:?}");
}

/// At λ/μ_L = 1e6 rounding of u alone leaves 1e-8 of the nodal forces. A load off by 1e-6 and a node off by 1e-12 leave more.
#[test]
fn rounding_of_an_incompressible_body_is_no_defect_and_a_defect_is_one() {
    for element in ["CR", "P1"] {
        let setup = incompressible("1e6", element);
        let data = on_mesh(&setup, 32);
        let mut residuals = [0.0f64; 3];
        let solved = run(&setup, &setup.model, &data, 1, |view| {
            let load = data.truth.load(view.t).expect("a load");
            let more: Vec<f64> = load.iter().map(|f| (1.0 + 1e-6) * f).collect();
            let mut moved = view.u.to_vec();
            moved[2 * (data.space.nodes.free / 2)] += 1e-12;
            let moved = StepView { u: &moved, ..*view };
            for (largest, (view, load)) in
                residuals.iter_mut().zip([(view, &load[..]), (view, &more), (&moved, &load)])
            {
                *largest = largest.max(kkt_residual(&data.space, &setup.model, view, load));
            }
        });
        solved.unwrap_or_else(|error| panic!("{error}"));
        let [sound, more, moved] = residuals;
        assert!(sound <= KKT_ALLOWED, "{element}: {sound:e}");
        assert!(more > KKT_ALLOWED && moved > KKT_ALLOWED, "{element}: {more:e} {moved:e}");
    }
}

/// V_max on n = 4, 8, 16 of a march on a changed space; none where a run fails.
fn driven(name: &str, change: Change) -> Option<[f64; 3]> {
    let scene = text(name).replace("element = \"P2\"", "element = \"CR\"");
    // A law that counts beside the error.
    let setup: Setup = setup_of(scene.replace("coefficient = 4.0", "coefficient = 400.0"));
    let of = |n: u32| Some(v_max_on_changed(&setup, n, 8, change).ok()?.0);
    let [a, b, c] = [4, 8, 16].map(of);
    Some([a?, b?, c?])
}

fn weigh_jumps(space: &mut Discretization, factor: f64) {
    // A jump enters by its square.
    let scale = factor.abs().sqrt();
    space.jumps.iter_mut().for_each(|jump| jump.signs = jump.signs.map(|sign| scale * sign));
}

#[test]
fn wrong_jumps_and_means_are_seen() {
    let order = |[_, b, c]: [f64; 3]| (b / c).log2();
    let sound = |name| driven(name, |_| {}).expect("a sound run");
    let wrong: [(&str, &str, Change); 5] = [
        ("no penalty", "nonconforming-memory", |s| weigh_jumps(s, 0.0)),
        ("a penalty of 1e-3", "nonconforming-memory", |s| weigh_jumps(s, 1e-3)),
        ("sums in place of jumps", "nonconforming-memory", |s| {
            s.jumps.iter_mut().for_each(|jump| jump.signs = jump.signs.map(f64::abs));
        }),
        ("the other end beyond", "nonconforming-memory", |s| {
            s.jumps.iter_mut().for_each(|jump| jump.nodes.swap(2, 3));
        }),
        ("lengths of Γ3 counted twice", "quadratic-compliance", |s| {
            s.trace.points.iter_mut().for_each(|point| point.weight *= 2.0);
        }),
    ];
    for (name, scene, change) in wrong {
        let sound = sound(scene);
        assert!((order(sound) - 1.0).abs() < 0.1, "{scene}: {sound:?}");
        // No answer at all is caught, too.
        let Some(found) = driven(scene, change) else { continue };
        let off = (order(found) - 1.0).abs() > 0.1 || found[2] > 1.1 * sound[2];
        assert!(off, "{name}: {found:?} for {sound:?}");
    }
}

/// The largest error of u_ν in L²(Γ3) on n = 8, 16, 32 with the gap times a factor: of order 1, since functions count by
/// their means on edges.
fn with_gap(factor: f64) -> [f64; 3] {
    [8, 16, 32].map(|n| {
        let mut setup = setup("nonconforming-signorini");
        let boundary = setup.model.boundary.as_mut().expect("a gap");
        let sound = std::mem::replace(&mut boundary.gap, Box::new(|_| f64::INFINITY));
        boundary.gap = Box::new(move |x| factor * sound(x));
        let steps = errors(&setup, &setup.model, &on_mesh(&setup, n), 16);
        steps.iter().map(|step| step.trace).fold(0.0, f64::max)
    })
}

/// V_max of the scene hardly feels the gap. One midpoint in two without it is an error of higher order, since its
/// neighbours hold it: that is left to the comparison with scikit-fem.
#[test]
fn a_gap_that_is_ignored_or_wrong_is_seen() {
    let order = |[_, b, c]: [f64; 3]| (b / c).log2();
    let sound = with_gap(1.0);
    assert!((order(sound) - 1.0).abs() < 0.05, "{sound:?}");
    for factor in [f64::INFINITY, 0.5, 1.2] {
        let wrong = with_gap(factor);
        assert!(order(wrong) < 0.3, "{factor}: {wrong:?}");
    }
}

/// What CR cannot have, and what knows other elements alone, says so at the key.
#[test]
fn what_jumps_leave_out_is_refused() {
    let scene = text("nonconforming-signorini");
    let refused = |text: String| {
        let read = Scene::from_source(Source::from_text("manufactured/edited.toml", text));
        read.expect_err("a refusal").to_string()
    };
    let gauss = refused(edited(&scene, "quadrature = \"vertex\"", "quadrature = \"gauss\""));
    assert!(gauss.contains("CR by barycentres") && gauss.contains("take P1"), "{gauss}");
    let interpolated = edited(&scene, "u = [", "interpolated = true\nu = [");
    assert!(refused(interpolated).contains("V^h of CR is not in V"));
    let by_state = refused(edited(&scene, "steps = [16]", "steps = [16]\nby_state = true"));
    assert!(by_state.contains("continuous functions alone"), "{by_state}");
    let setup = setup_of(scene);
    for asked in [&Extension::ALL[..], &[Extension::Nonconforming]] {
        let refused = setup.scene.without(asked, "sweep audit", "it is so").expect_err("a refusal");
        let told = refused.to_string();
        assert!(told.contains("`sweep audit` does not treat CR elements: it is so"), "{told}");
        assert!(told.contains("gate, verify, solve, trade and gronwall do"), "{told}");
    }
    let body =
        edited(&text("friction-box"), "[exact]", "[discretization]\nelement = \"CR\"\n\n[exact]");
    assert!(refused(body).contains("known for P1 alone"));
}
