//! Cases of quadratic elements, of friction and of kernels that are infinite at lag zero.

use crate::program::{Folder, code, json, sweep};
use crate::shipped::{midpoints_between_corners, on_mesh, run, setup, setup_of, text};
use fem::mesh::read_gmsh;
use run::external::{Answer, Array, Given, InProcess, Solve, case_dir, decode, encode, write_case};
use scene::setup::{MeshData, NewtonMarch, Scheme, Setup};

use super::{comes_back, errors, rows};

#[test]
fn answers_on_quadratic_elements_with_friction_and_singular_kernels_come_back() {
    for (name, n) in [
        ("quadratic-compliance", 4),
        ("quadratic-friction", 4),
        ("friction-coulomb", 4),
        ("friction-box", 2),
        ("singular-contact", 2),
        ("quadratic-box", 2),
    ] {
        comes_back(&setup(name), n);
    }
}

/// The files of a case, alone in a folder.
struct Files {
    folder: Folder,
    data: MeshData,
}

impl Files {
    fn of(setup: &Setup, n: u32, steps: u32) -> Self {
        let (folder, data) = (Folder::new("external-elements"), on_mesh(setup, n));
        write_case(&folder.at("case"), setup, &data, steps).expect("a case");
        Self { folder, data }
    }

    fn array(&self, name: &str) -> Array {
        let bytes = std::fs::read(self.folder.at("case").join(name)).expect("a file");
        decode(&bytes).expect("an array")
    }

    fn numbers(&self, name: &str) -> Vec<Vec<f64>> {
        let number = |text: &str| text.parse().unwrap_or(f64::NAN);
        let rows = rows(&self.folder.at("case").join(name));
        rows.iter().map(|row| row.iter().map(number).collect()).collect()
    }
}

/// Pairs of corners between which the further nodes of a cell stand, as the README of a case has them.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

#[test]
fn midpoints_stand_behind_the_vertices_and_between_their_corners() {
    for (setup, n) in [(setup("quadratic-elastic"), 4), (setup("quadratic-box"), 2)] {
        let files = Files::of(&setup, n, 1);
        let d = setup.scene.dimension;
        let case = std::fs::read_to_string(files.folder.at("case/case.json")).expect("a text");
        let case: serde_json::Value = serde_json::from_str(&case).expect("JSON");
        // Vertices and edges of squares or cubes cut by one diagonal each: rows of the grid with half the step.
        let corners = (n as usize + 1).pow(d as u32);
        let all = (2 * n as usize + 1).pow(d as u32);
        assert_eq!(case["element"], "P2");
        assert_eq!((&case["vertices"], &case["midpoints"]), (&all.into(), &(all - corners).into()));
        let points = files.numbers("vertices.csv");
        assert_eq!(points.len(), all);
        let mesh = std::fs::read_to_string(files.folder.at("case/mesh.msh")).expect("a text");
        assert_eq!(read_gmsh(&mesh).expect("a mesh").vertices.len(), corners);
        let between = |row: &[f64], corners: usize| {
            for (m, [a, b]) in row[corners..].iter().zip(EDGES) {
                for i in 1..=d {
                    let at = |node: f64| points[node as usize][i];
                    assert!((at(*m) - 0.5 * (at(row[a]) + at(row[b]))).abs() < 1e-15);
                }
            }
            row[..corners].iter().all(|v| (*v as usize) < all)
        };
        for row in files.numbers("cells.csv") {
            assert_eq!(row.len(), 2 + (d + 1) * (d + 2) / 2);
            assert!(between(&row[1..row.len() - 1], d + 1));
        }
        for row in files.numbers("facets.csv") {
            assert_eq!(row.len(), 2 + d * (d + 1) / 2);
            assert!(between(&row[1..row.len() - 1], d));
        }
        assert_eq!(files.array("loads.npy").shape, [2, all, d]);
        // All midpoints on a side are clamped with its ends.
        assert!(points.iter().all(|row| (row[2] == 1.0) == (row[d + 1] == 1.0)));
    }
    // The bottom has length 1: Simpson's weights of 4 edges.
    let files = Files::of(&setup("quadratic-compliance"), 4, 1);
    let weights: Vec<f64> = files.numbers("contact.csv").iter().map(|row| row[4]).collect();
    let count = |share: f64| weights.iter().filter(|w| (*w * 24.0 - share).abs() < 1e-14).count();
    assert_eq!((weights.len(), count(1.0), count(2.0), count(4.0)), (9, 2, 3, 4));
}

#[test]
fn bounds_of_friction_and_factors_of_kernels_are_those_of_the_scene() {
    let files = Files::of(&setup("friction-front"), 4, 2);
    let bounds = files.array("friction.npy");
    let rows = files.data.space.trace.points.len();
    assert_eq!(bounds.shape, [3, rows]);
    for (n, level) in bounds.numbers.chunks(rows).enumerate() {
        // bound = "0.05*(1 + t/2)" at t = 0, 1/2, 1.
        let expected = 0.05 * (1.0 + n as f64 / 4.0);
        assert!(level.iter().all(|found| (found - expected).abs() < 1e-15), "{level:?}");
    }
    let files = Files::of(&setup_of(text("singular-contact")), 2, 3);
    let kernels = files.array("kernels.npy");
    let case = std::fs::read_to_string(files.folder.at("case/case.json")).expect("a text");
    let case: serde_json::Value = serde_json::from_str(&case).expect("JSON");
    assert_eq!(case["singular"], serde_json::json!([0.4]));
    assert!(kernels.numbers.iter().all(|value| value.is_finite()));
    let scene = text("singular-contact");
    assert!(scene.contains("kernel = \"-exp(-t)\""), "the factor below is another");
    // t_j = (j/3)²: the factor over the whole interval, without its power.
    assert!((kernels.numbers[4 * 3] + (-1f64).exp()).abs() < 1e-15);
}

/// A solver in this process: the same displacements have the same errors.
#[test]
fn midpoints_come_back_within_the_process() {
    struct Found;
    impl Solve for Found {
        fn solve(&self, given: &Given, data: &MeshData) -> Result<Answer, String> {
            let setup = setup("quadratic-memory");
            let steps = given.document["steps"].as_u64().expect("steps") as u32;
            let mut displacement = Vec::new();
            run(&setup, &setup.model, data, steps, |view| {
                let of_vertex =
                    |&node: &u32| [view.u[2 * node as usize], view.u[2 * node as usize + 1]];
                displacement.extend(data.space.nodes.of_vertex.iter().flat_map(of_vertex));
            })
            .map_err(|error| error.to_string())?;
            Ok(Answer { displacement, pressure: None })
        }
    }
    let setup = setup("quadratic-memory");
    let data = on_mesh(&setup, 4);
    let [built_in, found] = [&NewtonMarch as &dyn Scheme, &InProcess(Found)]
        .map(|scheme| errors(scheme, &setup, &data, 4));
    for (expected, found) in built_in.iter().zip(&found) {
        assert!((expected.v - found.v).abs() <= 1e-12 * expected.v, "{expected:?} {found:?}");
    }
    assert_eq!((built_in.len(), found.len()), (5, 5));
}

/// What `sweep verify quadratic-elastic` says of answers that are changed level by level.
fn judged(change: impl Fn(&MeshData, &[f64]) -> Vec<f64>) -> (i32, String) {
    let name = "quadratic-elastic";
    let (folder, setup) = (Folder::new("external-midpoints"), setup(name));
    for n in [4, 8, 16] {
        let (data, mut answer) = (on_mesh(&setup, n), Vec::new());
        let nodes = &data.space.nodes;
        run(&setup, &setup.model, &data, 4, |view| {
            let u = change(&data, view.u);
            let of = |&node: &u32| [u[2 * node as usize], u[2 * node as usize + 1]];
            answer.extend(nodes.of_vertex.iter().flat_map(of));
        })
        .unwrap_or_else(|error| panic!("{error}"));
        let dir = case_dir(&folder.at("cases"), name, n, 4);
        std::fs::create_dir_all(&dir).expect("a folder");
        let bytes = encode(&[5, nodes.of_vertex.len(), 2], &answer);
        std::fs::write(dir.join("displacement.npy"), bytes).expect("a file");
    }
    let (cases, out) = (folder.argument("cases"), folder.argument("out"));
    let output =
        sweep(&["verify", name, "--n", "4,8,16", "--results", &cases, "--out", &out, "--json"]);
    (code(&output), json(&output)["verdicts"].to_string())
}

/// A linear solution that is interpolated at the midpoints, and midpoints in each other's rows.
#[test]
fn midpoints_without_values_of_their_own_are_caught() {
    let (status, said) = judged(|_, u| u.to_vec());
    assert_eq!(status, 0, "{said}");
    let (status, said) = judged(|data, u| midpoints_between_corners(&data.space, u));
    assert!(status == 1 && said.contains("has every midpoint of an edge"), "{said}");
    let (status, said) = judged(|data, u| {
        let (mut u, space) = (u.to_vec(), &data.space);
        let free = |v: usize| (space.nodes.of_vertex[v] as usize) < space.nodes.free;
        let midpoints: Vec<usize> =
            (space.mesh.corners()..space.mesh.vertices()).filter(|&v| free(v)).collect();
        for pair in midpoints.chunks_exact(2) {
            let [a, b] = [pair[0], pair[1]].map(|v| 2 * space.nodes.of_vertex[v] as usize);
            (0..2).for_each(|i| u.swap(a + i, b + i));
        }
        u
    });
    assert!(status == 1 && said.contains("\"fail\""), "{said}");
}
