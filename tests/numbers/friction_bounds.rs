//! Source: -σ_τ ∈ S ∂|u_τ| on a face of a body, where S is given, falls with |u_τ| or follows p(u_ν); docs/THEORY.md.
//! Goal: the Jacobian is the derivative of the residual while vertices slip in all directions and others stick; wrong blocks
//!   of it are seen, each on the law that has it. A wrong sign, bound or stick set: docs/SABOTAGE.md.
//! Mesh: n × n × n cubes of six tetrahedra.
//! Data: friction-box, friction-box-falling, friction-box-coulomb.

use crate::shipped::{on_mesh, setup};
use algebra::linalg::signed_unit;
use fem::contact::Evolution;
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::{BoundaryGraph, HistoryInequality, StepInequality, StepState};

/// s(u) of each law, components one after another: S(|u_τ|) u_τ/|u_τ| for vectors.
fn pressures(graph: &BoundaryGraph, u: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; graph.coordinates.len()];
    for (i, coordinate) in graph.coordinates.iter().enumerate() {
        match coordinate.span {
            0 => {}
            1 => out[i] = graph.value_and_slope(i, 0, graph.normal(i, u)).0,
            _ => {
                let slip = [graph.normal(i, u), graph.normal(i + 1, u)];
                let length = slip[0].hypot(slip[1]);
                let bound = graph.value_and_slope(i, 1, length).0;
                (0..2).for_each(|k| out[i + k] = bound * slip[k] / length);
            }
        }
    }
    out
}

/// What the solver is told of the laws: slopes by coordinates, then between the two unknowns of each vector; pressures.
struct Told<'a> {
    graph: &'a BoundaryGraph,
    u: &'a [f64],
    slopes: Vec<f64>,
    pressures: Vec<f64>,
}

impl Told<'_> {
    /// Vectors by the number of their first coordinate.
    fn vectors(&self) -> Vec<usize> {
        let coordinates = self.graph.coordinates.iter().enumerate();
        coordinates.filter(|(_, coordinate)| coordinate.span > 1).map(|(i, _)| i).collect()
    }

    fn mixed(&mut self) -> &mut [f64] {
        &mut self.slopes[self.graph.coordinates.len()..]
    }
}

type Seed = fn(&mut Told<'_>);

/// S′ û ûᵀ counted with the other sign.
fn rising(told: &mut Told<'_>) {
    let count = told.graph.coordinates.len();
    for (number, i) in told.vectors().into_iter().enumerate() {
        let slip = [told.graph.normal(i, told.u), told.graph.normal(i + 1, told.u)];
        let length = slip[0].hypot(slip[1]);
        let slope = told.graph.value_and_slope(i, 1, length).1;
        let twice = 2.0 * told.graph.coordinates[i].weight * slope / (length * length);
        (0..2).for_each(|k| told.slopes[i + k] -= twice * slip[k] * slip[k]);
        told.slopes[count + number] -= twice * slip[0] * slip[1];
    }
}

/// ‖J⁻¹(F(u + s d) - F(u - s d))/2s - d‖/‖d‖ with the Jacobian of what is told, the vertices of every second vector held if
/// `stick`.
fn mismatch(setup: &Setup, data: &MeshData, stick: bool, seed: Seed) -> f64 {
    const STEP: f64 = 1e-7;
    let mut load = TruthLoad(&*data.truth);
    let grid = setup.grid(4);
    let mut level =
        Evolution::new(&data.space, &setup.model, &grid, &mut load).expect("an analysis");
    level.open().expect("a level");
    let free = &data.space.nodes.vertex[..data.space.nodes.free];
    // Slip in all directions and both branches of p; no vertex is near a corner of its law.
    let at = |&v: &u32| -> [f64; 3] {
        let [x, y, z] = [0, 1, 2].map(|i| data.space.mesh.vertex(v)[i]);
        [
            (1.0 - y) * 0.05 * (x - 0.4),
            -(1.0 - y) * (0.012 + 0.06 * x),
            (1.0 - y) * 0.04 * (z - 0.3 * x - 0.25),
        ]
    };
    let u: Vec<f64> = free.iter().flat_map(at).collect();
    let mut random = 5;
    let d: Vec<f64> = u.iter().map(|_| signed_unit(&mut random)).collect();
    let force = |level: &mut Evolution<'_>, u: &[f64]| {
        let mut out = vec![0.0; u.len()];
        level.residual(u, &mut out);
        let graph = level.graph();
        for (coordinate, s) in graph.coordinates.iter().zip(pressures(graph, u)) {
            out[coordinate.dof as usize] += coordinate.sign * coordinate.weight * s;
        }
        out
    };
    let moved =
        |sign: f64| -> Vec<f64> { u.iter().zip(&d).map(|(u, d)| u + sign * STEP * d).collect() };
    let (plus, minus) = (force(&mut level, &moved(1.0)), force(&mut level, &moved(-1.0)));
    let mut x: Vec<f64> = plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * STEP)).collect();
    force(&mut level, &u);
    let graph = level.graph();
    let state = StepState { pressure: pressures(graph, &u), u: u.clone() };
    let (slopes, mut prescribed) = graph.pieces(&state);
    // A normal law and a vector at each of the 16 vertices of the face.
    assert_eq!((prescribed.len(), slopes.len()), (3 * 16, 4 * 16));
    assert!(prescribed.iter().all(Option::is_none), "all slip");
    let mut told = Told { graph, u: &u, slopes, pressures: state.pressure };
    seed(&mut told);
    let vectors = told.vectors();
    for (number, i) in
        vectors.into_iter().enumerate().filter(|(number, _)| stick && number % 2 == 0)
    {
        told.mixed()[number] = 0.0;
        for k in i..i + 2 {
            told.slopes[k] = 0.0;
            prescribed[k] = Some(d[told.graph.coordinates[k].dof as usize]);
        }
    }
    let Told { slopes, pressures, .. } = told;
    level.take_pressures(&pressures);
    level.linearize(&slopes, &prescribed).expect("a positive definite tangent");
    level.solve(&mut x, 1e-12).expect("a solve");
    let size = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>().sqrt();
    size(&mut x.iter().zip(&d).map(|(x, d)| x - d)) / size(&mut d.iter().copied())
}

const SCENES: [&str; 3] = ["friction-box", "friction-box-falling", "friction-box-coulomb"];

#[test]
fn the_jacobian_is_the_derivative_of_the_residual() {
    let blocks: [(&str, Seed, &[&str]); 5] = [
        ("nothing between the two unknowns", |told| told.mixed().fill(0.0), &SCENES),
        ("the other sign there", |told| told.mixed().iter_mut().for_each(|m| *m = -*m), &SCENES),
        ("a bound that rises as it falls", rising, &SCENES[1..2]),
        ("no entries in u_nu", |told| told.pressures.fill(0.0), &SCENES[2..]),
        (
            "entries in u_nu with the other sign",
            |told| told.pressures.iter_mut().for_each(|s| *s = -*s),
            &SCENES[2..],
        ),
    ];
    for scene in SCENES {
        let setup = setup(scene);
        let data = on_mesh(&setup, 3);
        for stick in [false, true] {
            // STEP² times S/|u_τ|³ of 1e6 at most, rounding 1e-16/1e-7, times a condition of 1e2.
            let sound = mismatch(&setup, &data, stick, |_| {});
            assert!(sound < 1e-5, "{scene}, {stick}: {sound:e}");
            for (what, seed, scenes) in blocks {
                let off = mismatch(&setup, &data, stick, seed);
                println!("{scene}, {stick}, {what}: {off:.1e} beside {sound:.1e}");
                // A block that the law does not have is none of its Jacobian.
                let seen = if scenes.contains(&scene) { off > 1e-3 } else { off < 1e-5 };
                assert!(seen, "{scene}, {stick}, {what}: {off:e}");
            }
        }
    }
}
