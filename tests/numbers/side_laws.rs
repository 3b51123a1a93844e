//! Source: Problem 12 with a gap, a shift and a law for each contact side; (2.9) for all of them together.
//! Goal: two tables with one law are one table; a side with neither law nor gap is a side without contact; gaps, shifts and
//!   laws stay on their sides, by each rule, P1 and P2; c_ν² bounds what all laws take, and is attained.
//! Mesh: 6 cells along an edge, in space 2; 4 steps. Data: `two-laws` and `gap-and-law`, contact on two sides with a common corner.
//! Defects: laws and gaps exchanged between sides; the descent of one side alone in (2.9).

use crate::shipped::{edited, on_mesh, refusal, run, scene_of, setup_of, text};
use algebra::linalg::signed_unit;
use fem::contact::{Discretization, TraceMass, TracePart, weighted_trace_constants};
use scene::setup::{Setup, constants, falling_sides};
use vhi::law::TensorField;

const STEPS: u32 = 4;
/// Displacements are below 1, and both runs do the same operations but for the order in which laws are looked up.
const EQUAL: f64 = 1e-12;

/// u of all levels on the mesh n.
fn levels(setup: &Setup, n: u32) -> Vec<f64> {
    let data = on_mesh(setup, n);
    let mut found = Vec::new();
    run(setup, &setup.model, &data, STEPS, |view| found.extend_from_slice(view.u))
        .unwrap_or_else(|error| panic!("{error}"));
    found
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

const BOTTOM: &str =
    "points = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]], slope_before = 0.0, slope_after = 0.0 }";
const RIGHT: &str = "shift = \"0.01\"\nlaw = { kind = \"piecewise-linear\", points = [[0.0, 0.0]], slope_before = 0.0, slope_after = 1.5 }";

/// A text of `two-laws` with other tables of contact.
fn between(written: &str, tables: &str) -> Setup {
    let (start, end) = (written.find("[[contact]]"), written.find("[exact]"));
    let (start, end) = (start.expect("tables"), end.expect("a solution"));
    setup_of(format!("{}{tables}\n\n{}", &written[..start], &written[end..]))
}

fn with_contact(tables: &str) -> Setup {
    between(&text("two-laws"), tables)
}

#[test]
fn two_tables_with_one_law_are_one_table() {
    let law = format!(
        "shift = \"0.005*x\"\ngap = \"0.081\"\nlaw = {{ kind = \"piecewise-linear\", {BOTTOM}"
    );
    for more in ["", "quadrature = \"gauss\"\n", "quadrature = \"exact\"\n"] {
        let one = with_contact(&format!("[contact]\n{more}{law}"));
        let two = with_contact(&format!(
            "[[contact]]\nsides = [\"right\"]\n{more}{law}\n[[contact]]\nsides = [\"bottom\"]\n{more}{law}"
        ));
        assert_eq!([one.model.boundary.len(), two.model.boundary.len()], [1, 2]);
        let off = apart(&levels(&one, 6), &levels(&two, 6));
        assert!(off <= EQUAL, "{more}: {off:e}");
        let [one, two] = [one, two].map(|setup| constants(&setup).expect("constants"));
        assert!((one.m0 - two.m0).abs() <= EQUAL, "{} {}", one.m0, two.m0);
    }
}

#[test]
fn a_side_without_law_and_gap_is_a_side_without_contact() {
    let law = format!("law = {{ kind = \"piecewise-linear\", {BOTTOM}");
    for element in ["", "[discretization]\nelement = \"P2\"\n"] {
        let table = format!("[[contact]]\nsides = [\"bottom\"]\n{law}\n");
        let idle = "[[contact]]\nsides = [\"right\"]\nlaw = { kind = \"none\" }\n";
        let beside = with_contact(&format!("{table}{idle}{element}"));
        let written = edited(&text("two-laws"), "[\"left\"]", "[\"left\", \"right\"]");
        let written =
            edited(&written, "contact = [\"bottom\", \"right\"]", "contact = [\"bottom\"]");
        let alone = between(&written, &format!("[contact]\n{law}\n{element}"));
        let [off, seen] = [
            &beside,
            &with_contact(&format!("{table}[[contact]]\nsides = [\"right\"]\n{RIGHT}\n{element}")),
        ]
        .map(|setup| apart(&levels(setup, 6), &levels(&alone, 6)));
        assert!(off <= EQUAL, "{element}: {off:e}");
        // The weak loads are those of the scene's own law: another law moves the body by its pressure, 0.05 times 1.5.
        assert!(seen > 0.0, "{element}");
    }
}

/// The errors of the solver that has the scene's laws, and of one that has them on the wrong sides.
#[test]
fn laws_and_gaps_stay_on_their_sides() {
    for (name, what) in [("two-laws", "laws"), ("gap-and-law", "gap and law")] {
        for more in ["", "quadrature = \"gauss\"\n", "quadrature = \"exact\"\n"] {
            let written = text(name).replace("[[contact]]\n", &format!("[[contact]]\n{more}"));
            let mut setup = setup_of(written);
            let data = on_mesh(&setup, 6);
            let error = |setup: &Setup| {
                let mut worst = 0.0f64;
                run(setup, &setup.model, &data, STEPS, |view| {
                    let truth = data.truth.moments(view.t).expect("moments");
                    let errors = fem::norms::step_errors(&data.space, &setup.model, view, &truth);
                    worst = worst.max(errors.trace);
                })
                .map(|_| worst)
            };
            let sound = error(&setup).unwrap_or_else(|error| panic!("{error}"));
            let [a, b] = [0, 1].map(|i| setup.model.boundary[i].sides.clone());
            (setup.model.boundary[0].sides, setup.model.boundary[1].sides) = (b, a);
            // An error of the solver is a finding as well.
            let wrong = error(&setup).unwrap_or(f64::INFINITY);
            assert!(sound < 2e-2 && wrong > 3.0 * sound, "{name}, {what}: {sound:e} {wrong:e}");
        }
    }
}

/// In space, with the tables of two faces that meet in an edge.
#[test]
fn faces_of_a_box_have_their_laws() {
    let of = |tables: &str| {
        let written = text("pure-box");
        let start = written.find("[contact]").expect("a table");
        let body = edited(&written[..start], "\"left\", \"right\"", "\"left\"");
        let body = edited(&body, "contact = [\"bottom\"]", "contact = [\"bottom\", \"right\"]");
        let loads = "[loads]\nbody = [\"0.8*t\", \"-1.5*x\", \"0.2\"]\n[sweep]\nn = [2]\nsteps = [4]\nreference = { n = 4, steps = 8 }\n";
        setup_of(edited(
            &format!("{body}{tables}\n{loads}"),
            "dimension = 3\n",
            "dimension = 3\njudge = false\n",
        ))
    };
    let law = "law = { kind = \"linear\", stiffness = 2.0 }";
    let one = levels(&of(&format!("[contact]\ngap = \"0.05\"\n{law}")), 2);
    let table = |side: &str, law: &str| format!("[[contact]]\nsides = [\"{side}\"]\n{law}\n");
    let both = format!("gap = \"0.05\"\n{law}");
    let two = levels(&of(&format!("{}{}", table("right", &both), table("bottom", &both))), 2);
    assert!(apart(&one, &two) <= EQUAL, "{:e}", apart(&one, &two));
    let other = levels(&of(&format!("{}{}", table("right", ""), table("bottom", &both))), 2);
    assert!(apart(&one, &other) > 1e-3, "{:e}", apart(&one, &other));
}

/// Σ α_i ‖v_ν‖² on the sides and ‖ε(v)‖² of a nodal vector of linear elements, by sums of their own.
fn squares(space: &Discretization, alpha: impl Fn(u32) -> f64, v: &[f64]) -> [f64; 2] {
    let (mesh, node) =
        (&space.mesh, |vertex: u32| 2 * space.nodes.of_vertex[vertex as usize] as usize);
    let at = |vertex: u32, i: usize| v.get(node(vertex) + i).copied().unwrap_or(0.0);
    let mut taken = 0.0;
    for f in 0..mesh.facet_side.len() {
        let (side, ends) = (mesh.facet_side[f], mesh.facet(f));
        let normal = mesh.normal(f);
        let [a, b] = [0, 1].map(|e| (0..2).map(|i| normal[i] * at(ends[e], i)).sum::<f64>());
        taken += alpha(side) * mesh.measure_of(ends) * (a * a + a * b + b * b) / 3.0;
    }
    let mut strain = 0.0;
    for c in 0..mesh.cell_count() {
        let cell = mesh.cell(c);
        let x = |k: usize| [0, 1].map(|i| mesh.vertex(cell[k])[i] - mesh.vertex(cell[0])[i]);
        let ([x1, y1], [x2, y2]) = (x(1), x(2));
        let twice = x1 * y2 - x2 * y1;
        let slope = |i: usize| {
            let [p, q] = [1, 2].map(|k| at(cell[k], i) - at(cell[0], i));
            [(p * y2 - q * y1) / twice, (q * x1 - p * x2) / twice]
        };
        let ([xx, xy], [yx, yy]) = (slope(0), slope(1));
        strain += 0.5 * twice.abs() * (xx * xx + yy * yy + 0.5 * (xy + yx).powi(2));
    }
    [taken, strain]
}

#[test]
fn all_sides_together_take_at_most_what_is_printed() {
    let falling = |alpha: f64| {
        format!(
            "law = {{ kind = \"piecewise-linear\", points = [[0.0, 0.0], [0.04, 0.08], [0.10, {:?}]], slope_before = 0.0, slope_after = 0.0 }}",
            0.08 - 0.06 * alpha
        )
    };
    let setup = with_contact(&format!(
        "[[contact]]\nsides = [\"bottom\"]\n{}\n[[contact]]\nsides = [\"right\"]\n{}",
        falling(0.2),
        falling(0.05)
    ));
    let alpha = |side: u32| match setup.body.domain.name(scene::Side(side)) {
        "bottom" => 0.2,
        "right" => 0.05,
        _ => 0.0,
    };
    let known = constants(&setup).expect("constants");
    let weights = falling_sides(&setup);
    let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
    assert!(close(known.alpha_nu, 0.2) && weights.len() == 2, "{weights:?}");
    assert!(
        weights.iter().all(|(side, weight)| close(*weight, alpha(side.0) / 0.2)),
        "{weights:?}"
    );
    let space = setup.space(8).expect("a mesh");
    let weight = |side: u32| alpha(side) / 0.2;
    let square = [(TracePart::Normal, TraceMass::Consistent)];
    let [found] = weighted_trace_constants(&space, &TensorField::identity(), square, &weight)
        .expect("an eigenvalue");
    let [taken, strain] = squares(&space, alpha, &found.vector);
    // The eigenvalue settles to 1e-13, its vector to the root of that.
    assert!((taken / strain - 0.2 * found.value).abs() < 1e-6 * found.value, "{taken} {strain}");
    assert!(taken <= known.alpha_nu * known.c_nu_range[1] * strain);
    let mut seed = 7;
    for _ in 0..20 {
        let v: Vec<f64> = (0..space.dofs()).map(|_| signed_unit(&mut seed)).collect();
        let [taken, strain] = squares(&space, alpha, &v);
        assert!(taken <= 0.2 * found.value * strain);
    }
    // One side alone: its constant is less than that field takes.
    for name in ["bottom", "right"] {
        let one =
            |side: u32| f64::from(u8::from(setup.body.domain.name(scene::Side(side)) == name));
        let [alone] = weighted_trace_constants(&space, &TensorField::identity(), square, &one)
            .expect("an eigenvalue");
        let side = space.mesh.side(name).expect("a side");
        assert!(alpha(side) * alone.value * strain < (1.0 - 1e-3) * taken, "{name}");
    }
    // No more than the largest descent on all of Γ3, no less than without the other side.
    assert!(known.c_nu_squared < known.c_j_squared);
}

/// On a line two laws would have one vertex with one u_ν in common; at a corner it has two.
#[test]
fn sides_that_go_straight_on_share_their_law() {
    let text = |middle: &str| {
        format!(
            "[scene]\nname = \"straight\"\nquestion = \"?\"\ndimension = 2\njudge = false\n\
             [domain]\nshape = \"polygon\"\nvertices = [[0.0, 0.0], {middle}, [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]\n\
             clamped = [\"s4\"]\ntraction = [\"s3\", \"s5\"]\ncontact = [\"s1\", \"s2\"]\n\
             [time]\nhorizon = 1.0\n[material]\nlambda = 1.0\nmu_L = 1.0\n\
             [[contact]]\nsides = [\"s1\"]\ngap = \"0.1\"\n[[contact]]\nsides = [\"s2\"]\n\
             [loads]\nbody = [\"0\", \"-t\"]\n"
        )
    };
    let refused = refusal(text("[0.5, 0.0]"));
    assert!(refused.contains("meet at") && refused.contains("go straight on"), "{refused}");
    scene_of(text("[0.5, -0.1]"));
}
