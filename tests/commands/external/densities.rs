//! Loads as functions: what a solver that assembles them itself gets, and the mistakes that it can make with them.

use exact::{Densities, Truth};
use fem::contact::{Discretization, LoadError};
use fem::norms::Moments;
use judge::verdict::Decision;
use run::external::{Cause, Explanation, by_density, cause_of, decode, write_case};
use run::sweep::{Overrides, ScenePlan, foresee, judge_scene, run_contact_case};
use scene::Scene;
use scene::setup::{MeshData, NewtonMarch, Scheme, Setup, Subject};
use std::sync::Arc;

use super::{errors, rows};
use crate::program::{Folder, refuses};
use crate::shipped::{on_mesh, setup as shipped};

/// The shipped scene with loads that are functions.
fn strong(name: &str) -> Setup {
    let scene: Scene = by_density(shipped(name).scene).unwrap_or_else(|error| panic!("{error}"));
    Setup::new(scene).unwrap_or_else(|error| panic!("{error}"))
}

/// By hat functions, which are barycentric coordinates, from the files alone; they give what stands in `loads.npy` to rounding.
#[test]
fn the_files_assemble_to_the_loads_of_the_case() {
    for (name, n) in [("viscoelastic", 4), ("signorini", 4), ("friction-front", 4), ("pure-box", 2)]
    {
        let (folder, setup) = (Folder::new("external-densities"), strong(name));
        let data = on_mesh(&setup, n);
        let dir = folder.at("case");
        write_case(&dir, &setup, &data, 3).expect("a case");
        let array =
            |file: &str| decode(&std::fs::read(dir.join(file)).expect("a file")).expect("an array");
        let (loads, mesh) = (array("loads.npy"), &data.space.mesh);
        let (vertices, d) = (loads.shape[1], mesh.dimension);
        let clamped: Vec<bool> =
            rows(&dir.join("vertices.csv")).iter().map(|row| &row[d + 1] == "1").collect();
        let mut sums = vec![0.0; loads.numbers.len()];
        for (of, corners) in [("cell", d + 1), ("facet", d)] {
            let (rule, values) =
                (array(&format!("{of}_rule.npy")), array(&format!("{of}_loads.npy")));
            let weights: f64 = rule.numbers.chunks(corners + 1).map(|row| row[corners]).sum();
            assert!((weights - 1.0).abs() < 1e-14, "{name}, {of}: {weights}");
            let simplices = rows(&dir.join(format!("{of}s.csv")));
            let points = rule.shape[0];
            assert_eq!(values.shape, [4, simplices.len(), points, d]);
            for (at, simplex) in simplices.iter().enumerate() {
                let nodes: Vec<usize> =
                    (1..=corners).map(|i| simplex[i].parse().expect("v")).collect();
                let place = |v: usize| nalgebra::Vector3::from(mesh.point(&[v as u32], &[1.0]));
                let edge = |i: usize| place(nodes[i]) - place(nodes[0]);
                let measure = match corners {
                    2 => edge(1).norm(),
                    3 => edge(1).cross(&edge(2)).norm() / 2.0,
                    _ => edge(1).cross(&edge(2)).dot(&edge(3)).abs() / 6.0,
                };
                for level in 0..4 {
                    for (q, row) in rule.numbers.chunks(corners + 1).enumerate() {
                        let first = ((level * simplices.len() + at) * points + q) * d;
                        for (&node, b) in nodes.iter().zip(row) {
                            for i in 0..d {
                                sums[(level * vertices + node) * d + i] +=
                                    measure * row[corners] * b * values.numbers[first + i];
                            }
                        }
                    }
                }
            }
        }
        let largest = loads.numbers.iter().fold(0.0f64, |most, f| most.max(f.abs()));
        for (at, (sum, load)) in sums.iter().zip(&loads.numbers).enumerate() {
            let free = !clamped[at / d % vertices];
            // Sums of some hundred terms.
            assert!(!free || (sum - load).abs() <= 1e-13 * largest, "{name}, {at}: {sum} {load}");
        }
    }
}

/// Both forms are the same functional: what differs is quadrature of degree 4 and more, beside errors of order h.
#[test]
fn errors_differ_from_those_of_assembled_loads_by_quadrature() {
    for name in ["viscoelastic", "state-grazing"] {
        let apart = [8, 16].map(|n| {
            let (weak, strong) = (shipped(name), strong(name));
            let of = |setup: &Setup| errors(&NewtonMarch, setup, &on_mesh(setup, n), 4);
            let pairs = of(&weak).into_iter().zip(of(&strong)).skip(1);
            pairs.map(|(a, b)| (a.v - b.v).abs() / a.v).fold(0.0, f64::max)
        });
        println!("{name}: {apart:?}");
        // The rule of degree 4 leaves the fifth power of h and more.
        assert!(apart[0] < 1e-5 && apart[1] < 0.1 * apart[0], "{name}: {apart:?}");
    }
}

#[test]
fn loads_that_are_no_functions_are_refused() {
    let folder = Folder::new("external-no-densities");
    let export = folder.argument("cases");
    let verify = ["verify", "state-instant", "--loads", "density", "--export", &export];
    refuses(&verify, &["no functions", "--loads"]);
}

/// Loads that a solver has assembled in its own way.
struct Own<F> {
    sound: Arc<dyn Truth>,
    space: Arc<Discretization>,
    assemble: F,
}

impl<F: Fn(Densities, &Discretization) -> Vec<f64> + Send + Sync> Truth for Own<F> {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        let densities = self.sound.densities(t)?.expect("loads that are functions");
        Ok(Arc::new((self.assemble)(densities, &self.space)))
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        self.sound.moments(t)
    }
}

/// The built-in solver with loads of its own.
struct Assembling<F>(F);

impl<F: Fn(Densities, &Discretization) -> Vec<f64> + Send + Sync + Copy + 'static> Scheme
    for Assembling<F>
{
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut fem::contact::Observer<'_>,
    ) -> Result<fem::contact::CaseInfo, fem::contact::CaseError> {
        let (sound, space) = (data.truth.clone(), data.space.clone());
        let own = Own { sound, space: space.clone(), assemble: self.0 };
        // Loads of a strong form are checked by the built-in solver, which would refuse these.
        let weak = shipped(&setup.scene.name);
        NewtonMarch.march(&weak, &MeshData::with_truth(space, Arc::new(own)), steps, observe)
    }
}

fn found<F>(name: &str, assemble: F) -> Explanation
where
    F: Fn(Densities, &Discretization) -> Vec<f64> + Send + Sync + Copy + 'static,
{
    let setup = strong(name);
    let data = on_mesh(&setup, 8);
    let found = cause_of(&setup, &Assembling(assemble), &data, 4);
    found.unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The first facet on a loaded side without its traction.
fn facet_dropped(mut loads: Densities, space: &Discretization) -> Vec<f64> {
    let count = loads.traction.len() / space.mesh.facet_side.len();
    let middle =
        space.mesh.facet_side.iter().rposition(|&side| space.mesh.sides[side as usize] == "left");
    let at = middle.expect("a facet on the left") - 3;
    loads.traction[count * at..count * (at + 1)].fill(0.0);
    loads.assembled(space, false)
}

fn one_point(mut loads: Densities, space: &Discretization) -> Vec<f64> {
    let weights = &mut loads.rules[1].weights;
    weights.fill(0.0);
    weights[2] = 1.0;
    loads.assembled(space, false)
}

fn side_dropped(mut loads: Densities, space: &Discretization) -> Vec<f64> {
    let count = loads.traction.len() / space.mesh.facet_side.len();
    for (values, &side) in loads.traction.chunks_mut(count).zip(&space.mesh.facet_side) {
        values
            .iter_mut()
            .filter(|_| space.mesh.sides[side as usize] == "left")
            .for_each(|f| *f = 0.0);
    }
    loads.assembled(space, false)
}

#[test]
fn mistakes_in_assembling_are_named() {
    for name in ["viscoelastic", "state-grazing"] {
        let sound = found(name, |loads, space| loads.assembled(space, false));
        assert_eq!(sound.cause, Cause::Nothing, "{name}: {sound:?}");
        let wrong = [
            ("all other rows balance", found(name, facet_dropped)),
            ("lumped: cells and facets", found(name, |loads, space| loads.assembled(space, true))),
            ("facets take point 2 of their rule alone", found(name, one_point)),
            ("f2 on side left is left out", found(name, side_dropped)),
        ];
        for (says, found) in wrong {
            println!("{name}: {found:?}");
            assert!(found.cause == Cause::Loads && found.fits, "{name}: {found:?}");
            assert!(found.says.contains(says), "{name}, {says}: {found:?}");
        }
    }
}

/// The verdicts, predicted constants included, of a solver that assembles its loads so, on the scene's own grid.
fn verdicts<F>(name: &str, assemble: F) -> Vec<(String, Decision)>
where
    F: Fn(Densities, &Discretization) -> Vec<f64> + Send + Sync + Copy + 'static,
{
    let scene = strong(name).scene;
    let subject = Subject::new(scene).unwrap_or_else(|error| panic!("{error}"));
    let overrides = Overrides { n: Some(vec![8, 16, 32, 64]), steps: Some(vec![8]) };
    let plan = ScenePlan::new(subject, &overrides);
    let setup = Setup { scheme: Arc::new(Assembling(assemble)), ..strong(name) };
    let record = |case: &_| {
        plan.record(case, || {
            Ok(run_contact_case(&setup, &on_mesh(&setup, case.n.expect("n")), case))
        })
    };
    let records: Vec<_> = plan.cases.iter().map(record).collect();
    let foreseen = foresee(&plan.subject, &records);
    let verdicts = judge_scene(plan.scene(), &records, &plan.keys(), &foreseen);
    verdicts.into_iter().map(|verdict| (verdict.norm, verdict.decision)).collect()
}

/// Contact scenes that docs/EXTERNAL.md recommends in h. f0 jumps along lines that move through the cells. What is no more than
/// coarse quadrature may leave the orders; then it is named.
#[test]
fn scenes_whose_force_jumps_pass_a_sound_solver_and_fail_wrong_ones() {
    type Assemble = fn(Densities, &Discretization) -> Vec<f64>;
    let wrong: [(&str, Assemble); 4] = [
        ("a side dropped", side_dropped),
        ("a facet dropped", facet_dropped),
        ("lumped", |loads, space| loads.assembled(space, true)),
        ("one point", one_point),
    ];
    for name in ["signorini", "compliance"] {
        let assembled: Assemble = |loads, space| loads.assembled(space, false);
        let sound = verdicts(name, assembled);
        println!("{name}: {sound:?}");
        assert!(sound.iter().all(|(_, decision)| *decision == Decision::Pass), "{name}: {sound:?}");
        assert_eq!(found(name, assembled).cause, Cause::Nothing, "{name}");
        for (i, (what, assemble)) in wrong.into_iter().enumerate() {
            let (seen, named) = (verdicts(name, assemble), found(name, assemble));
            println!("{name}, {what}: {seen:?} {named:?}");
            let fails = seen.iter().any(|(_, decision)| *decision != Decision::Pass);
            assert!(fails || i > 0 && named.cause == Cause::Loads, "{name}, {what}: {seen:?}");
        }
    }
}
