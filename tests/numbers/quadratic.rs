//! Source: tests/fixtures/quadratic.json by tests/independent/quadratic.py with scikit-fem; interpolation by quadratics.
//! Goal: P2 is what another program has; interpolants by quadratics are found; the tangent is the derivative of the
//!   residual; weights of another element in space are driven off their order. Wrong elements: docs/SABOTAGE.md.
//! Mesh: n × n squares cut from lower left to upper right, with their vertices moved for the reproduction.
//! Data: the scenes quadratic-…; a body that holds a quadratic displacement at all times.

use super::differences::mismatch;
use crate::program::repository;
use crate::shipped::{
    Change, edited, errors, fixture, on_mesh, refusal, run, setup_of, text, v_max_on_changed,
    weigh_facets,
};
use algebra::linalg::signed_unit;
use fem::contact::{ContactProblem, LastSlot};
use scene::setup::Setup;

fn independent(name: &str) -> Setup {
    setup_of(repository(&format!("tests/independent/quadratic-{name}.toml")))
}

/// A cuboid with memory and a law on its bottom.
fn in_space() -> String {
    text("quadratic-box")
}

/// Every displacement to 1e-9 of the largest: both solve the same discrete problem, to 1e-13.
#[test]
fn scikit_fem_finds_the_same() {
    let known = fixture("quadratic");
    let [n, steps] = ["n", "steps"].map(|key| known[key].as_u64().expect("a count") as u32);
    for name in ["elastic", "projection", "contact"] {
        let setup = independent(name);
        let (data, mut u) = (on_mesh(&setup, n), Vec::new());
        let info = run(&setup, &setup.model, &data, steps, |view| u = view.u.to_vec())
            .unwrap_or_else(|error| panic!("{error}"));
        assert!(info.kkt_residual < 1e-13, "{name}: {:e}", info.kkt_residual);
        let (space, largest) = (&data.space, u.iter().fold(0.0f64, |m, v| m.max(v.abs())));
        let rows = known["nodes"][name].as_array().expect("rows");
        assert_eq!(rows.len(), space.mesh.vertices());
        for row in rows {
            let [x, y, p, q] = [0, 1, 2, 3].map(|i| row[i].as_f64().expect("a number"));
            let here = |v: &u32| {
                let place = space.mesh.vertex(*v);
                (place[0] - x).hypot(place[1] - y) < 1e-12
            };
            let v = (0..rows.len() as u32).find(here).expect("a node there");
            let at_node = &u[2 * space.nodes.of_vertex[v as usize] as usize..][..2];
            let off = (at_node[0] - p).abs().max((at_node[1] - q).abs());
            assert!(off <= 1e-9 * largest, "{name} at ({x}, {y}): {off:e}");
        }
    }
}

/// Every term that P2 has, and a displacement that is quadratic on every mesh.
fn reproduced() -> Setup {
    let scene = text("quadratic-compliance");
    let start = scene.find("[exact]").expect("an exact solution");
    let moved =
        "contact = [\"bottom\"]\nmesh = { kind = \"perturbed\", amplitude = 0.2, seed = 3 }";
    let scene = edited(&scene[..start], "contact = [\"bottom\"]", moved);
    let scene = edited(&scene, "rule = { kind = \"gregory\", order = 4 }\n", "");
    let exact = "[exact]\nu = [\"(1 - y)*(x + 2*y)\", \"-0.3*(1 - y)*(x - 0.4 + y)\"]\n";
    let sweep = "[sweep]\nn = [3]\nsteps = [2]\n";
    let predicts =
        "[[predicts]]\nnorm = \"V_max\"\nvariable = \"h\"\norder = 2.0\nwhy = \"none\"\n";
    let scene = edited(&scene, "kernel = \"-exp(-t)\"", "kernel = \"-1\"");
    let power = "{ kind = \"power\", coefficient = 4.0, exponent = 2.0, until = 0.2 }";
    let scene = edited(&scene, power, "{ kind = \"linear\", stiffness = 0.5 }");
    setup_of(format!("{scene}{exact}{sweep}{predicts}"))
}

/// A truth that is, on each mesh, the interpolant by quadratics of something else, on a mesh with moved vertices.
fn interpolated(scene: &str, u: &str) -> Setup {
    let start = scene.find("u = [").expect("a solution");
    let end = start + scene[start..].find('\n').expect("a line");
    setup_of(format!("{}{u}\ninterpolated = true{}", &scene[..start], &scene[end..]))
}

/// Strains, stresses, pressures and displacements of an interpolant are those of the solver; in space the law's pressure is
/// shown between the midpoints as a linear function.
#[test]
fn interpolants_are_found_to_rounding() {
    let plane = reproduced().scene.source.text.clone();
    let u = "u = [\"(1 - y)*sin(3*x + y)\", \"-0.3*(1 - y)*cos(2*x)*exp(y)\"]";
    let plane = interpolated(&plane, u);
    let moved =
        "contact = [\"bottom\"]\nmesh = { kind = \"perturbed\", amplitude = 0.1, seed = 3 }";
    let space = edited(&in_space(), "contact = [\"bottom\"]", moved);
    let u = "u = [\"t*(1 - y)*sin(x + 2*y - z)\", \"-0.3*t*(1 - y)*exp(x*z)\", \"t*(1 - y)*cos(x + z)\"]";
    let space = interpolated(&space, u);
    for (setup, n) in [(&plane, 3), (&space, 2)] {
        let data = on_mesh(setup, n);
        for step in errors(setup, &setup.model, &data, 2) {
            // As for quadratic displacements.
            assert!(step.v < 1e-12 && step.l2 < 1e-12 && step.trace < 1e-12, "{step:?}");
            assert!(step.stress < 1e-11 && step.pressure < 1e-11, "{step:?}");
        }
        let wrong: [Change; 2] = [
            |space| weigh_facets(space, [0.5 / space.mesh.dimension as f64, 0.5 / 3.0]),
            |space| space.geometry.shares.iter_mut().for_each(|share| *share *= 1.01),
        ];
        for change in wrong {
            let found = v_max_on_changed(setup, n, 2, change);
            assert!(found.map_or(true, |(error, _)| error > 1e-4));
        }
    }
}

/// In a body of two materials each point has that of its cell: u is the same, and the stress jumps between them.
#[test]
fn two_materials_are_those_of_their_cells() {
    let scene = reproduced().scene.source.text.clone();
    let moved = "mesh = { kind = \"perturbed\", amplitude = 0.2, seed = 3 }";
    let stiff = "[[material.region]]\nname = \"stiff\"\nwhere = \"y - 0.5\"\nlambda = 2.5\nmu_L = 3.0\n[contact]\n";
    let scene = edited(&edited(&scene, moved, ""), "[contact]\n", stiff);
    let setup = setup_of(edited(&scene, "n = [3]", "n = [4]"));
    let data = on_mesh(&setup, 4);
    assert!(data.space.regions.contains(&1) && data.space.regions.contains(&0));
    for step in errors(&setup, &setup.model, &data, 2) {
        assert!(step.v < 1e-12 && step.stress < 1e-11, "{step:?}");
    }
}

/// Where the body yields in part and κ follows ζ.
#[test]
fn the_tangent_at_quadrature_points_is_the_derivative() {
    let setup = setup_of(edited(&text("quadratic-memory"), "0.02 + 0.05*zeta", "0.10 + 0.05*zeta"));
    let space = on_mesh(&setup, 3).space;
    let free = &space.nodes.vertex[..space.nodes.free];
    let u: Vec<f64> = free
        .iter()
        .flat_map(|&v| {
            let [x, y, _] = space.mesh.point(&[v], &[1.0]);
            [(1.0 - y) * (0.25 * x - 0.02), -(1.0 - y) * (0.013 + 0.06 * x)]
        })
        .collect();
    let memory = setup.model.memory.iter().map(|term| 0.125 * term.kernel.value(0.0)).collect();
    let slot = LastSlot { zeta: 0.125, memory };
    let mut problem = ContactProblem::new(&space, &setup.model).expect("an analysis");
    problem.begin(&slot, 0.1, &vec![0.0; space.dofs()], &[]);
    let mut seed = 5;
    let d: Vec<f64> = u.iter().map(|_| signed_unit(&mut seed)).collect();
    let off = mismatch(&mut problem, &u, &d);
    // As in tests/numbers/tangent.rs: truncation and rounding.
    assert!(off < 1e-7, "{off:e}");
}

/// No vertex of Γ3 carries a law in space, every midpoint does; other weights are driven off the order.
#[test]
fn midpoints_of_facets_carry_the_law() {
    let setup = setup_of(in_space());
    let space = setup.space(2).expect("a mesh");
    for f in 0..space.trace.measure.len() {
        for (a, &i) in space.trace.facet(f).iter().enumerate() {
            let point = &space.trace.points[i as usize];
            assert_eq!(point.carries(), a >= 3 && !point.clamped);
        }
    }
    let found = |change: Change| {
        [2, 4].map(|n| {
            let (error, info) = v_max_on_changed(&setup, n, 1, change).ok()?;
            // Rounding of forces, by some 1e3 of the condition.
            (info.kkt_residual < 1e-12).then_some(error)
        })
    };
    let order = |[coarse, fine]: [Option<f64>; 2]| Some((coarse? / fine?).log2());
    let sound = order(found(|_| {})).expect("a sound run");
    // From n = 2 to 4 it is 1.84 by what cubics leave.
    assert!((sound - 2.0).abs() < 0.25, "{sound}");
    let wrong: [(&str, Change); 3] = [
        ("equal weights", |space| weigh_facets(space, [1.0 / 6.0; 2])),
        ("vertices alone", |space| weigh_facets(space, [1.0 / 3.0, 0.0])),
        ("weights of points", |space| space.geometry.shares = vec![0.4, 0.2, 0.2, 0.2]),
    ];
    for (name, change) in wrong {
        // No answer at all is caught, too.
        let Some(found) = order(found(change)) else { continue };
        assert!((found - 2.0).abs() > 0.25, "{name}: {found}");
    }
}

/// What P2 cannot have, and what knows linear elements alone, says so at the key.
#[test]
fn what_has_no_quadratic_form_is_refused() {
    let scene = text("quadratic-compliance");
    let p3 = refusal(edited(&scene, "element = \"P2\"", "element = \"P3\""));
    assert!(p3.contains("unknown value `P3` of `element`") && p3.contains("P1, P2"), "{p3}");
    let gauss = refusal(edited(&scene, "quadrature = \"vertex\"", "quadrature = \"gauss\""));
    assert!(gauss.contains("Simpson") && gauss.contains("take P1"), "{gauss}");
}
