//! Source: tests/fixtures/friction.json by tests/independent/friction.py, which knows nothing of this program: other
//!   matrices, and pressures that are projected vertex after vertex.
//! Goal: bounds that follow the pressure or the slip, and vectors of friction in space, are what another program finds; a
//!   wrong bound, direction or stress set is not.
//! Mesh: squares cut from lower left to upper right; cubes of six tetrahedra.
//! Data: tests/independent/friction-….toml.

use crate::program::repository;
use std::sync::Arc;

use crate::shipped::{fixture, on_mesh, run, setup_of};
use fem::contact::{Friction, StepView};
use scene::setup::Setup;
use serde_json::Value;
use vhi::law::PiecewiseLinear;

const CASES: [&str; 7] =
    ["coulomb", "falling", "bilateral", "box", "box-coulomb", "box-falling", "box-time"];

fn independent(name: &str) -> Setup {
    setup_of(repository(&format!("tests/independent/friction-{name}.toml")))
}

/// A vector at each place.
type Rows = Vec<(Vec<f64>, Vec<f64>)>;

fn known(case: &Value, key: &str, d: usize) -> Rows {
    let number = |value: &Value| value.as_f64().expect("a number");
    let row =
        |row: &Value| -> Vec<f64> { row.as_array().expect("a row").iter().map(number).collect() };
    let split = |value: &Value| {
        let numbers = row(value);
        (numbers[..d].to_vec(), numbers[d..].to_vec())
    };
    case[key].as_array().expect("rows").iter().map(split).collect()
}

/// u at all vertices, and s without its normal component on the bottom, at the end of the march of the fixture.
fn found(setup: &Setup, case: &Value) -> Option<[Rows; 2]> {
    let [n, steps] = ["n", "steps"].map(|key| case[key].as_u64().expect("a count") as u32);
    let (data, mut seen) = (on_mesh(setup, n), (Vec::new(), Vec::new()));
    let see = |view: &StepView<'_>| seen = (view.u.to_vec(), view.friction.to_vec());
    run(setup, &setup.model, &data, steps, see).ok()?;
    let (u, s) = seen;
    let (space, d) = (&data.space, setup.scene.dimension);
    let place = |v: u32| space.mesh.vertex(v)[..d].to_vec();
    let displacement = |v: usize| u[d * space.nodes.of_vertex[v] as usize..][..d].to_vec();
    let vertices = 0..space.mesh.vertices();
    let displacements = vertices.map(|v| (place(v as u32), displacement(v))).collect();
    let stresses = space.trace.points.iter().zip(s.chunks(d - 1)).map(|(point, s)| {
        let mut vector = vec![0.0; d];
        for (s, tangent) in s.iter().zip(point.tangents()) {
            vector.iter_mut().zip(tangent).for_each(|(sum, along)| *sum += s * along);
        }
        // The bottom is orthogonal to the second axis.
        assert_eq!(vector.remove(1), 0.0);
        (place(point.vertex), vector)
    });
    Some([displacements, stresses.collect()])
}

/// The largest difference of a number over the largest number.
fn off(found: &Rows, known: &Rows) -> f64 {
    assert_eq!(found.len(), known.len());
    let largest = known.iter().flat_map(|row| &row.1).fold(0.0f64, |m, v| m.max(v.abs()));
    let mut worst = 0.0f64;
    for (place, vector) in known {
        let here = |row: &&(Vec<f64>, Vec<f64>)| {
            row.0.iter().zip(place).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        let (_, value) = found.iter().find(here).expect("a vertex there");
        assert_eq!(value.len(), vector.len());
        worst = value.iter().zip(vector).fold(worst, |m, (a, b)| m.max((a - b).abs()));
    }
    worst / largest
}

/// The differences of u and s for a setup, infinite without an answer.
fn differences(setup: &Setup, name: &str) -> [f64; 2] {
    let (case, d) = (&fixture("friction")[name], setup.scene.dimension);
    let Some([u, s]) = found(setup, case) else { return [f64::INFINITY; 2] };
    [off(&u, &known(case, "u", d)), off(&s, &known(case, "friction", d))]
}

/// To 1e-9 of the largest: both solve the same discrete problem, the other program until pressures move by 1e-14.
#[test]
fn another_program_finds_the_same() {
    for name in CASES {
        let [u, s] = differences(&independent(name), name);
        println!("{name}: {u:.1e} of u, {s:.1e} of s");
        assert!(u <= 1e-9 && s <= 1e-9, "{name}: {u:e} {s:e}");
    }
}

/// The fixture has what it is to decide on: vertices that stick and that slip, in all directions in space.
#[test]
fn vertices_stick_and_slip() {
    for name in ["coulomb", "falling", "bilateral", "box", "box-coulomb", "box-falling"] {
        let case = &fixture("friction")[name];
        let d = independent(name).scene.dimension;
        let moved = |row: &(Vec<f64>, Vec<f64>)| {
            row.0[1] == 0.0 && (0..d).any(|i| i != 1 && row.1[i].abs() > 1e-9)
        };
        let u = known(case, "u", d);
        let side = u.iter().filter(|row| row.0[1] == 0.0).count();
        let slips = u.iter().filter(|row| moved(row)).count();
        assert!(slips >= 4 && slips + 2 <= side, "{name}: {slips} of {side}");
    }
}

fn changed(name: &str, change: impl Fn(Friction) -> Friction) -> Setup {
    let mut setup = independent(name);
    setup.model.friction = setup.model.friction.map(change);
    setup
}

#[test]
fn wrong_friction_is_not_what_another_program_finds() {
    let times = |name: &str, by: f64| {
        changed(name, |friction| {
            let sound = friction.factor;
            Friction { factor: Box::new(move |x, t| by * sound(x, t)), ..friction }
        })
    };
    let given = |friction: Friction| Friction {
        factor: Box::new(|_, _| 0.4 * 0.05),
        follows_pressure: false,
        ..friction
    };
    // The bound of no slip at all slips.
    let constant = |bound: f64| {
        move |friction: Friction| {
            let points = vec![(0.0, -bound), (0.0, bound)];
            let graph = PiecewiseLinear::new(points, 0.0, 0.0).expect("a graph");
            Friction { graph: Arc::new(graph), ..friction }
        }
    };
    let late = |friction: Friction| {
        let sound = friction.factor;
        Friction { factor: Box::new(move |x, t| sound(x, t - 1.0 / 3.0)), ..friction }
    };
    let of_all =
        CASES.iter().flat_map(|name| [(*name, times(name, 0.5)), (*name, times(name, 1.001))]);
    let of_one = [
        ("coulomb", changed("coulomb", given)),
        ("falling", changed("falling", constant(0.06))),
        ("bilateral", changed("bilateral", constant(0.08))),
        ("box-coulomb", changed("box-coulomb", given)),
        ("box-falling", changed("box-falling", constant(0.1))),
        ("box", changed("box", late)),
    ];
    for (name, wrong) in of_all.chain(of_one) {
        let [u, s] = differences(&wrong, name);
        // A thousandth of the bound is seen a hundred thousand times over what is allowed.
        assert!(u > 1e-5 && s > 1e-5, "{name}: {u:e} {s:e}");
    }
}
