//! Source: rotations leave the problem (5.1)-(5.5) and its discrete form as they are.
//! Goal: contact sides whose normals are no axes. A scene on a turned mesh, with turned loads, has the turned solution, to
//!   rounding; a wrong normal has another one.
//! Mesh: unit square, top clamped, contact below, or below and right (two normals at one vertex), turned by an angle.
//! Data: punch (memory, projection, nonmonotone law, gap), all three boundary rules, Newton and the fixed point Λ.
//! Then whole scenes on polygons, from the file to the records: turned vertices, formulas, gap and loads give the same errors.

use crate::shipped::{on_mesh, setup};
use fem::contact::{BoundaryRule, CaseInfo, Discretization, Load, LoadError, Model, march};
use fem::mesh::{Family, Mesh, lattice};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::{FixedPoint, Newton, StepSolver};

const N: u32 = 6;
const STEPS: u32 = 6;

/// A rotation by an angle.
#[derive(Clone, Copy)]
struct Turn(f64);

impl Turn {
    fn apply(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = self.0.sin_cos();
        [c * x - s * y, s * x + c * y]
    }

    fn pairs(self, values: &[f64]) -> Vec<f64> {
        values.chunks_exact(2).flat_map(|pair| self.apply([pair[0], pair[1]])).collect()
    }

    fn mesh(self, mesh: &Mesh) -> Mesh {
        Mesh {
            coordinates: self.pairs(&mesh.coordinates),
            facet_normal: self.pairs(&mesh.facet_normal),
            ..mesh.clone()
        }
    }
}

/// The load of the straight scene, turned.
struct Turned<'a> {
    source: TruthLoad<'a>,
    turn: Turn,
}

impl Load for Turned<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        self.source.assemble(t, out)?;
        out.copy_from_slice(&self.turn.pairs(out));
        Ok(())
    }
}

/// The square turned by `turn`, with contact on `contact`.
fn space(turn: Turn, contact: &[&str]) -> Discretization {
    let mesh = turn.mesh(&lattice([1.0, 1.0], N, Family::Structured));
    let numbers: Vec<u32> = contact.iter().map(|name| mesh.side(name).unwrap()).collect();
    let top = mesh.side("top").unwrap();
    Discretization::new(mesh, &[top], &numbers)
}

struct Solved {
    displacements: Vec<Vec<f64>>,
    pressures: Vec<Vec<f64>>,
    info: CaseInfo,
}

fn solve(
    setup: &Setup,
    model: &Model,
    data: &MeshData,
    space: &Discretization,
    turn: Turn,
    solver: &dyn StepSolver,
) -> Solved {
    let mut load = Turned { source: TruthLoad(&*data.truth), turn };
    let (mut displacements, mut pressures) = (Vec::new(), Vec::new());
    let info = march(space, model, &setup.grid(STEPS), &mut load, solver, &mut |view| {
        displacements.push(view.u.to_vec());
        pressures.push(view.compliance.iter().zip(view.multiplier).map(|(a, b)| a + b).collect());
        Ok(())
    })
    .unwrap_or_else(|error| panic!("{error}"));
    Solved { displacements, pressures, info }
}

/// Largest difference of the turned straight solution and the solution of the turned scene.
fn difference(straight: &Solved, turned: &Solved, turn: Turn) -> f64 {
    let gap =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let u = straight.displacements.iter().zip(&turned.displacements);
    let p = straight.pressures.iter().zip(&turned.pressures);
    let u = u.map(|(a, b)| gap(&turn.pairs(a), b)).fold(0.0, f64::max);
    u.max(p.map(|(a, b)| gap(a, b)).fold(0.0, f64::max))
}

/// Displacements and pressures are below 1; Newton stops at 16 units of rounding of forces, which the stiffness (condition
/// below 1e3 on this mesh) and the weights of the pressures (1/12 at least) turn into this.
const ROUNDING: f64 = 1e-11;
const ANGLES: [f64; 4] = [0.3, 1.0, -2.2, std::f64::consts::FRAC_PI_4];

#[test]
fn a_turned_scene_has_the_turned_solution() {
    for rule in [BoundaryRule::Vertex, BoundaryRule::Gauss, BoundaryRule::Exact] {
        let mut setup = setup("punch");
        let boundary = setup.model.boundary.first_mut().unwrap();
        boundary.rule = rule;
        // On all contact sides of the spaces below.
        boundary.sides.clear();
        let data = on_mesh(&setup, N);
        for contact in [&["bottom"][..], &["bottom", "right"]] {
            let at = |turn: Turn| {
                let space = space(turn, contact);
                solve(&setup, &setup.model, &data, &space, turn, &Newton::default())
            };
            let straight = at(Turn(0.0));
            let contacts = straight.pressures.last().unwrap().iter().filter(|p| **p > 0.0).count();
            assert!(contacts > 2, "{contacts}");
            for angle in ANGLES {
                let turned = at(Turn(angle));
                let found = difference(&straight, &turned, Turn(angle));
                assert!(found < ROUNDING, "{rule:?} {contact:?} {angle}: {found:e}");
                assert_eq!(straight.info.newton_iterations, turned.info.newton_iterations);
            }
        }
    }
}

#[test]
fn the_fixed_point_turns_as_well() {
    let setup = setup("punch");
    let data = on_mesh(&setup, N);
    let at = |turn: Turn| {
        let solver = FixedPoint::default();
        solve(&setup, &setup.model, &data, &space(turn, &["bottom"]), turn, &solver)
    };
    let found = difference(&at(Turn(0.0)), &at(Turn(0.7)), Turn(0.7));
    // The iteration stops at its tolerance.
    assert!(found < 1e-9, "{found:e}");
}

/// Errors are differences of fields a hundred times as large, which agree to [`ROUNDING`] and better; formulas in turned
/// coordinates round their arguments.
const OF_ERRORS: f64 = 1e-9;

#[test]
fn a_turned_scene_file_has_the_same_errors() {
    for kind in crate::turned::Kind::ALL {
        let straight = crate::turned::records(&crate::turned::text(kind, 0.0), None);
        for angle in [0.3, 2.0, -2.2, std::f64::consts::FRAC_PI_2, 5.1] {
            let records = crate::turned::records(&crate::turned::text(kind, angle), None);
            let (off, what) = crate::turned::difference(&straight, &records);
            assert!(off < OF_ERRORS, "{kind:?} {angle}: {what}");
        }
    }
}

/// A normal that is negated, not turned, or turned by too little is another problem, in every kind of scene.
#[test]
fn a_wrong_normal_of_a_scene_is_seen() {
    type Wrong = fn([f64; 2]) -> [f64; 2];
    let defects: [Wrong; 3] =
        [|[x, y]| [-x, -y], |_| [0.0, -1.0], |[x, y]| [x - 1e-3 * y, y + 1e-3 * x]];
    for kind in crate::turned::Kind::ALL {
        let straight = crate::turned::records(&crate::turned::text(kind, 0.0), None);
        for (d, defect) in defects.into_iter().enumerate() {
            // A corner of two sides has two normals, which must stay two.
            if kind == crate::turned::Kind::Loaded && d == 1 {
                continue;
            }
            let scheme = std::sync::Arc::new(crate::turned::Normals(defect));
            let records = crate::turned::records(&crate::turned::text(kind, 0.3), Some(scheme));
            let (off, what) = crate::turned::difference(&straight, &records);
            assert!(off > 1e3 * OF_ERRORS, "{kind:?}, defect {d}: {what}");
        }
    }
}
