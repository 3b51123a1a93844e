//! Source: tests/fixtures/nonconforming-space.json by tests/independent/nonconforming_space.py with scikit-fem; affine
//!   displacements.
//! Goal: CR on tetrahedra is what another program has; affine displacements are reproduced; the tangent is the derivative of
//!   the residual; loads in both forms are one; wrong jumps, means and loads lose the order or the constant.
//! Mesh: n × n × n cubes in six tetrahedra each, with their vertices moved for what holds on any mesh.
//! Data: the scene nonconforming-box, and that of tests/independent.

use super::differences::mismatch;
use crate::shipped::{
    Change, edited, errors, fixture, on_mesh, run, setup_of, text, v_max_on_changed,
};
use algebra::linalg::signed_unit;
use fem::contact::{ContactProblem, LastSlot};
use fem::space::Element;

/// Every displacement to 1e-9 of the largest: both solve the same discrete problem, to 1e-13.
#[test]
fn scikit_fem_finds_the_same() {
    let known = fixture("nonconforming-space");
    let [n, steps] = ["n", "steps"].map(|key| known[key].as_u64().expect("a count") as u32);
    let at = env!("CARGO_MANIFEST_DIR");
    let path = format!("{at}/tests/independent/nonconforming-box.toml");
    let setup = setup_of(std::fs::read_to_string(path).expect("a scene"));
    let (data, mut u) = (on_mesh(&setup, n), Vec::new());
    let info = run(&setup, &setup.model, &data, steps, |view| u = view.u.to_vec())
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(info.kkt_residual < 1e-12, "{:e}", info.kkt_residual);
    let (space, largest) = (&data.space, u.iter().fold(0.0f64, |m, v| m.max(v.abs())));
    let rows = known["nodes"]["box"].as_array().expect("rows");
    assert_eq!(rows.len(), space.nodes.vertex.len());
    for row in rows {
        let row: [f64; 6] = std::array::from_fn(|i| row[i].as_f64().expect("a number"));
        let here = |&v: &u32| {
            let pairs = space.mesh.vertex(v).iter().zip(&row);
            pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) < 1e-12
        };
        let node = space.nodes.vertex.iter().position(here).expect("a node there");
        let pairs = u[3 * node..][..3].iter().zip(&row[3..]);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= 1e-9 * largest, "at {row:?}: {off:e}");
    }
}

/// An affine displacement on a perturbed mesh of two materials, with memory, a layer of springs and loads in either form.
#[test]
fn affine_displacements_are_reproduced() {
    let scene = text("nonconforming-box");
    let start = scene.find("[exact]").expect("an exact solution");
    let moved =
        "contact = [\"bottom\"]\nmesh = { kind = \"perturbed\", amplitude = 0.15, seed = 3 }";
    let scene = edited(&scene[..start], "contact = [\"bottom\"]", moved);
    let law = "{ kind = \"power\", coefficient = 4.0, exponent = 2.0, until = 0.2 }";
    let scene = edited(&scene, law, "{ kind = \"linear\", stiffness = 0.5 }");
    for form in ["weak", "strong"] {
        let exact = format!(
            "[exact]\nform = \"{form}\"\nu = [\"0.7*(1 - y)\", \"-0.3*(1 - y)\", \"0.2*(1 - y)\"]\n"
        );
        let sweep = "[sweep]\nn = [3]\nsteps = [2]\n";
        let predicts =
            "[[predicts]]\nnorm = \"V_max\"\nvariable = \"h\"\norder = 1.0\nwhy = \"none\"\n";
        let setup = setup_of(format!("{scene}{exact}{sweep}{predicts}"));
        let data = on_mesh(&setup, 3);
        assert_eq!(data.space.element, Element::CR);
        assert!(!data.space.jumps.is_empty());
        for step in errors(&setup, &setup.model, &data, 2) {
            // Rounding: strains of size 1, by 1e2 of the condition.
            assert!(step.v < 1e-12 && step.l2 < 1e-12 && step.stress < 1e-11, "{form}: {step:?}");
        }
    }
}

/// ∫ f0·v by Div σ and by what integration by parts on each cell leaves. Integrands are polynomials that the rules have.
#[test]
fn loads_in_both_forms_are_one() {
    let weak = text("nonconforming-box");
    let strong = edited(&weak, "[exact]", "[exact]\nform = \"strong\"");
    let [strong, weak] = [strong, weak].map(|scene| on_mesh(&setup_of(scene), 3));
    let [a, b] = [&strong, &weak].map(|data| data.truth.load(0.7).expect("a load"));
    let largest = a.iter().fold(0.0f64, |m, f| m.max(f.abs()));
    let off = a.iter().zip(&*b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-12 * largest, "{off:e} of {largest:e}");
}

/// Where the body yields and remembers.
#[test]
fn the_tangent_with_jumps_is_the_derivative() {
    let scene = text("nonconforming-box");
    let (start, end) = (scene.find("[contact]"), scene.find("[discretization]"));
    let (start, end) = (start.expect("contact"), end.expect("an element"));
    let projection = "[material.projection]\nmu = 1.0\nkappa = \"0.10 + 0.05*zeta\"\n\n";
    let scene = format!("{}{projection}{}", &scene[..start], &scene[end..]);
    let scene = edited(&scene, "\"back\"]\ncontact = [\"bottom\"]", "\"back\", \"bottom\"]");
    let after = scene.rfind("[[predicts]]").expect("two predictions");
    let setup = setup_of(scene[..after].to_owned());
    let space = on_mesh(&setup, 2).space;
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

/// V_max on n = 2, 4; none where a run fails.
fn driven(change: Change) -> Option<[f64; 2]> {
    // A law that counts beside the error.
    let scene = text("nonconforming-box").replace("coefficient = 4.0", "coefficient = 400.0");
    let setup = setup_of(scene);
    let of = |n: u32| Some(v_max_on_changed(&setup, n, 1, change).ok()?.0);
    let [a, b] = [2, 4].map(of);
    Some([a?, b?])
}

#[test]
fn wrong_jumps_and_means_are_seen() {
    let order = |[a, b]: [f64; 2]| (a / b).log2();
    let sound = driven(|_| {}).expect("a sound run");
    assert!((order(sound) - 1.0).abs() < 0.1, "{sound:?}");
    let wrong: [(&str, Change); 5] = [
        ("no penalty", |s| s.jumps.iter_mut().for_each(|jump| jump.weight = 0.0)),
        ("sums in place of jumps", |s| {
            s.jumps.iter_mut().for_each(|jump| jump.signs = jump.signs.map(f64::abs));
        }),
        ("other corners beyond", |s| s.jumps.iter_mut().for_each(|jump| jump.nodes.swap(3, 4))),
        ("a penalty of 1e-3", |s| s.jumps.iter_mut().for_each(|jump| jump.weight *= 1e-3)),
        ("areas of Γ3 counted twice", |s| {
            s.trace.points.iter_mut().for_each(|point| point.weight *= 2.0);
        }),
    ];
    for (name, change) in wrong {
        // No answer at all is caught, too.
        let Some(found) = driven(change) else { continue };
        let off = (order(found) - 1.0).abs() > 0.1 || found[1] > 1.05 * sound[1];
        assert!(off, "{name}: {found:?} for {sound:?}");
    }
}
