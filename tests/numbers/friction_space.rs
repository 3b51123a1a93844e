//! Source: -σ_τ ∈ S ∂|u_τ| on a face of a body, where u_τ is a vector; docs/THEORY.md.
//! Goal: the rows of the KKT system see a friction stress that is aside of its slip or beyond the ball; a turned body has
//!   the same friction; the trace constant is attained; what is wrong is refused.
//! Mesh: n × n × n cubes of six tetrahedra; a frustum with a slanted foot, turned about an axis.
//! Data: friction-box, frustum.msh.

use crate::program::repository;
use crate::shipped::{edited, on_mesh, refusal, run, setup, setup_of, text};
use algebra::linalg::signed_unit;
use exact::{Status, check};
use fem::contact::{
    Friction, StepView, TraceMass, TracePart, kkt_residual, strain_norm, trace_constants,
};
use scene::setup::{Setup, sides};
use scene::{Scene, Source};
use vhi::law::TensorField;

/// A stress that is turned in the face, one that is a little beyond the ball, and one whose components are within S while
/// their vector is not.
#[test]
fn the_kkt_rows_see_a_wrong_vector() {
    let setup = setup("friction-box");
    let (data, mut sound) = (on_mesh(&setup, 6), 0.0f64);
    let mut least = [f64::INFINITY; 2];
    let (mut sticks, mut slips) = (0, 0);
    run(&setup, &setup.model, &data, 2, |view| {
        let load = data.truth.load(view.t).expect("a load");
        let residual = |view: &StepView<'_>| kkt_residual(&data.space, &setup.model, view, &load);
        sound = sound.max(residual(view));
        let turned: Vec<f64> = view.friction.chunks(2).flat_map(|s| [-s[1], s[0]]).collect();
        least[0] = least[0].min(residual(&StepView { friction: &turned, ..*view }));
        let mut model = setup.scene_model();
        let Friction { factor, graph, .. } = model.friction.take().expect("friction");
        let factor = Box::new(move |x: [f64; 3], t: f64| 0.999 * factor(x, t));
        model.friction = Some(Friction { factor, graph, follows_pressure: false });
        least[1] = least[1].min(kkt_residual(&data.space, &model, view, &load));
        for point in data.space.trace.points.iter().filter(|point| !point.clamped) {
            let at_rest = point.slip(view.u) == [0.0; 2];
            sticks += usize::from(at_rest);
            slips += usize::from(!at_rest);
        }
    })
    .expect("a run");
    // Rounding of some 300 nodal forces.
    assert!(sound < 1e-12, "{sound}");
    // A thousandth of w S beside the largest force of a node.
    assert!(least[0] > 1e-3 && least[1] > 1e-6, "{least:?}");
    assert!(sticks > 20 && slips > 20, "{sticks} {slips}");
}

type Matrix = [[f64; 3]; 3];

fn times(matrix: &Matrix, v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum())
}

/// The frustum, turned, pulled by a turned load over a foot with friction.
fn frustum(turn: &Matrix) -> Setup {
    let mesh = repository("manufactured/frustum.msh");
    let (before, rest) = mesh.split_once("$Nodes").expect("nodes");
    let (nodes, after) = rest.split_once("$EndNodes").expect("their end");
    let line = |line: &str| match line.split_whitespace().map(str::parse).collect::<Vec<_>>()[..] {
        [Ok(x), Ok(y), Ok(z)] => {
            let [x, y, z] = times(turn, [x, y, z]);
            format!("{x:?} {y:?} {z:?}\n")
        }
        _ => format!("{line}\n"),
    };
    let nodes: String = nodes.lines().map(line).collect();
    let name = format!("gronwall-friction-{}-{:x}", std::process::id(), turn[0][0].to_bits());
    let folder = std::env::temp_dir().join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("turned.msh"), format!("{before}$Nodes{nodes}$EndNodes{after}"))
        .expect("a mesh");
    let [x, y, z] = times(turn, [0.3, 0.2, -0.25]);
    let [a, b, c] = times(turn, [1.0, 0.0, 0.0]);
    let scene = format!(
        "[scene]\nname = \"turned\"\nquestion = \"?\"\ndimension = 3\njudge = false\n\
         [domain]\nshape = \"mesh\"\nfile = \"turned.msh\"\nclamped = [\"top\"]\ntraction = [\"walls\"]\ncontact = [\"foot\"]\n\
         [time]\nhorizon = 1.0\n[material]\nlambda = 1.0\nmu_L = 0.8\n\
         [material.memory]\nkernel = \"-0.5*exp(-2*t)\"\nlambda = 0.25\nmu = 0.3\n\
         [contact]\nlaw = {{ kind = \"linear\", stiffness = 0.7 }}\n[contact.friction]\nbound = \"0.3*(1 + t)*({a:?}*x + {b:?}*y + {c:?}*z)\"\n\
         [loads]\nbody = [\"{x:?}*t\", \"{y:?}*t\", \"{z:?}*t\"]\n"
    );
    let source = Source::from_text(folder.join("turned.toml"), scene);
    let setup = Setup::new(Scene::from_source(source).unwrap_or_else(|error| panic!("{error}")));
    let setup = setup.unwrap_or_else(|error| panic!("{error}"));
    std::fs::remove_dir_all(&folder).expect("removed");
    setup
}

/// u and s at the vertices of the foot, by their place.
type Foot = Vec<([f64; 3], [f64; 3], [f64; 3])>;

fn foot(setup: &Setup) -> Foot {
    let (data, mut seen) = (on_mesh(setup, 2), Vec::new());
    run(setup, &setup.model, &data, 3, |view| {
        let points = data.space.trace.points.iter().zip(view.friction_stresses(&data.space));
        let vertex = |(point, s): (&fem::contact::TracePoint, &[f64])| {
            let mut stress = [0.0; 3];
            for (s, tangent) in s.iter().zip(point.tangents()) {
                stress.iter_mut().zip(tangent).for_each(|(sum, along)| *sum += s * along);
            }
            let u = [0, 1, 2].map(|i| view.u[3 * point.node as usize + i]);
            (data.space.mesh.point(&[point.vertex], &[1.0]), u, stress)
        };
        seen = points.map(vertex).collect();
    })
    .unwrap_or_else(|error| panic!("{error}"));
    seen
}

/// Axes are no part of the law: |s| ≤ S is a ball. The normal and the tangents of the turned foot are other ones.
#[test]
fn a_turned_body_has_the_same_friction() {
    const UNTURNED: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Angles 0.7 about z, then 0.4 about x.
    let ([c, s], [p, q]) = ([0.7f64.cos(), 0.7f64.sin()], [0.4f64.cos(), 0.4f64.sin()]);
    let turn = [[c, -s, 0.0], [p * s, p * c, -q], [q * s, q * c, p]];
    let (plain, turned) = (foot(&frustum(&UNTURNED)), foot(&frustum(&turn)));
    let size = |v: &[f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let largest = plain.iter().map(|vertex| size(&vertex.1)).fold(0.0, f64::max);
    assert_eq!(plain.len(), turned.len());
    for (x, u, stress) in &plain {
        let apart = |a: [f64; 3], b: &[f64; 3]| size(&[a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
        let image = turned.iter().find(|vertex| apart(times(&turn, *x), &vertex.0) < 1e-12);
        let image = image.expect("the image of a vertex");
        // Two solutions with residuals of rounding.
        assert!(apart(times(&turn, *u), &image.1) < 1e-11 * largest, "{u:?} {image:?}");
        assert!(apart(times(&turn, *stress), &image.2) < 1e-10, "{stress:?} {image:?}");
    }
    // S = 0.6 x at the end.
    let slips = plain.iter().filter(|vertex| size(&vertex.2) > 0.6 * vertex.0[0] - 1e-9).count();
    assert!(slips > 0 && slips < plain.len(), "{slips} of {} slip", plain.len());
}

/// Σ w |v_τ|²/‖ε(v)‖² of the field that comes with it, by components in x and z; other fields have less.
#[test]
fn the_tangential_trace_constant_is_attained() {
    let setup = setup("friction-box");
    let space = on_mesh(&setup, 4).space;
    let quotient = |free: &[f64]| {
        let mut v = free.to_vec();
        v.resize(space.nodes.len(), 0.0);
        let squares = space.trace.points.iter().map(|point| {
            let at_node = &v[3 * point.node as usize..];
            point.weight * (at_node[0] * at_node[0] + at_node[2] * at_node[2])
        });
        squares.sum::<f64>() / strain_norm(&space, &v).powi(2)
    };
    let square = (TracePart::Tangential, TraceMass::Lumped);
    let [found] = trace_constants(&space, &TensorField::identity(), [square]).expect("a constant");
    // The tolerance of the eigenvalue.
    let largest = quotient(&found.vector);
    assert!((largest - found.value).abs() < 1e-8 * largest, "{largest} {}", found.value);
    let mut seed = 11;
    for _ in 0..20 {
        let v: Vec<f64> =
            found.vector.iter().map(|v| v * (1.0 + 0.2 * signed_unit(&mut seed))).collect();
        assert!(quotient(&v) < found.value);
    }
}

#[test]
fn what_is_wrong_in_space_is_refused() {
    let vector = "friction = [\"s*cos(theta)\", \"0\", \"s*sin(theta)\"]";
    let bottom = "contact = [\"bottom\"]";
    for (from, to, words) in [
        (vector, "friction = \"s\"", "a friction stress of one component"),
        (vector, "friction = [\"s\", \"0\"]", "has 2 components in dimension 3"),
        (vector, "friction = [\"s\", \"0\", \"s\"]", "beyond the bound"),
        (vector, "friction = [\"s*sin(theta)\", \"0\", \"s*cos(theta)\"]", "slips and the bound"),
        ("traction = [\"left\", \"right\", ", "traction = [\"right\", ", "two contact sides"),
    ] {
        let mut text = edited(&text("friction-box"), from, to);
        if words == "two contact sides" {
            text = edited(&text, bottom, "contact = [\"bottom\", \"left\"]");
        }
        let said = refusal(text);
        assert!(said.contains(words), "{to}: {said}");
    }
    let plane = edited(&text("friction-front"), "friction = \"s\"", "friction = [\"s\", \"0\"]");
    let said = refusal(plane);
    assert!(said.contains("a friction stress of several components"), "{said}");
}

/// The loads of a front that is not straight agree to rounding, as those of a straight one: the quadrature of the check is
/// cut at the front on every line. With the cuts of the straight front the difference is 2e-5.
#[test]
fn loads_of_a_front_that_bends_are_verified() {
    let front =
        edited(&text("friction-box"), "x0 = \"0.3 + 0.3*t\"", "x0 = \"0.3 + 0.2*t*sin(3*z)\"");
    let setup = setup_of(front);
    let findings = check(setup.exact.as_ref().expect("an exact solution"), &sides(&setup.body));
    let loads = findings.iter().find(|finding| finding.subject == "loads").expect("a finding");
    // Rounding of some 1e5 terms.
    assert!(loads.status == Status::Verified && loads.value < 1e-13, "{}", loads.text);
}
