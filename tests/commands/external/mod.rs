//! Source: the seam of solvers outside this program.
//! Goal: displacements that go out as files and come back give the records of the run that they are of, in every norm;
//!   a solver that fails, is silent, is too slow, or writes another shape, numbers that are not finite or an answer of
//!   before makes a failed case with the reason; a wrong answer fails its verdict; meshes and loads of the files are
//!   those of the case, as functions too where they are; a solver ends with all that it has started, its log is bounded, what is no file is refused.
//! Mesh: n = 4 and 8 in the plane, 2 in space.
//! Data: scenes signorini, compliance, oblique-trapezium, layered-in-space, pure-box; shell commands for solvers.
#![cfg(unix)]

mod densities;
mod elements;
mod kinds;
mod processes;
mod sizes;

use std::path::{Path, PathBuf};

use crate::program::{Folder, code, ends, json, stderr, stdout, sweep, unwrapped};
use crate::shipped::{on_mesh, setup, setup_of, text};
use fem::mesh::read_gmsh;
use fem::norms::{StepErrors, step_errors};
use run::external::{Array, ExternalSolver, Way, case_dir, decode, encode, write_case};
use scene::setup::{MeshData, NewtonMarch, Scheme, Setup};

fn errors(scheme: &dyn Scheme, setup: &Setup, data: &MeshData, steps: u32) -> Vec<StepErrors> {
    let mut found = Vec::new();
    let mut observe = |view: &fem::contact::StepView<'_>| {
        let moments = data.truth.moments(view.t)?;
        found.push(step_errors(&data.space, &setup.model, view, &moments));
        Ok(())
    };
    scheme.march(setup, data, steps, &mut observe).unwrap_or_else(|error| panic!("{error}"));
    found
}

/// The built-in solution of a case as the files that a solver would write.
pub fn answer(setup: &Setup, data: &MeshData, steps: u32, dir: &Path) {
    let nodes = &data.space.nodes;
    let (d, vertices) = (nodes.dimension, nodes.of_vertex.len());
    let (mut u, mut pressure) = (Vec::new(), Vec::new());
    let mut observe = |view: &fem::contact::StepView<'_>| {
        for &node in &nodes.of_vertex {
            let at = node as usize * d;
            u.extend_from_slice(&view.u[at..at + d]);
        }
        pressure.extend(view.compliance.iter().zip(view.multiplier).map(|(a, b)| a + b));
        Ok(())
    };
    NewtonMarch.march(setup, data, steps, &mut observe).unwrap_or_else(|error| panic!("{error}"));
    let (levels, points) = (steps as usize + 1, data.space.trace.points.len());
    std::fs::create_dir_all(dir).expect("a folder");
    let file = |name: &str, bytes: Vec<u8>| std::fs::write(dir.join(name), bytes).expect("a file");
    file("displacement.npy", encode(&[levels, vertices, d], &u));
    file("pressure.npy", encode(&[levels, points], &pressure));
}

fn results(folder: &Folder) -> ExternalSolver {
    ExternalSolver { way: Way::Results, folder: folder.at("cases"), pressures: true }
}

fn place(folder: &Folder, scene: &str, n: u32, steps: u32) -> PathBuf {
    case_dir(&folder.at("cases"), scene, n, steps)
}

/// The displacements of a run come back with its errors.
fn comes_back(setup: &Setup, n: u32) {
    let (folder, steps, name) = (Folder::new("external"), 6, &setup.scene.name);
    let data = on_mesh(setup, n);
    answer(setup, &data, steps, &place(&folder, name, data.space.mesh.n, steps));
    let built_in = errors(&NewtonMarch, setup, &data, steps);
    let found = errors(&results(&folder), setup, &data, steps);
    assert_eq!(built_in.len(), found.len());
    for (expected, found) in built_in.iter().zip(&found) {
        let pairs = [
            (expected.v, found.v),
            (expected.l2, found.l2),
            (expected.trace, found.trace),
            (expected.pressure, found.pressure),
            // Histories are summed over displacements here, over unknowns or coefficients there.
            (expected.stress, found.stress),
        ];
        for (a, b) in pairs {
            assert!((a - b).abs() <= 1e-10 * a.abs().max(1e-6), "{name}: {expected:?} {found:?}");
        }
    }
}

#[test]
fn displacements_that_come_back_give_the_errors_of_their_run() {
    for (name, n) in [
        ("signorini", 4),
        ("compliance", 4),
        ("oblique-trapezium", 4),
        ("layered-in-space", 4),
        ("pure-box", 2),
    ] {
        comes_back(&setup(name), n);
    }
}

/// V has u = 0 on Γ1. An answer that is wrong there alone is refused, also where all of it has moved and no strain says so;
/// what a penalty of 1e10 leaves there is measured like any other value, not taken for zero.
#[test]
fn values_where_the_body_is_clamped_are_judged_or_refused() {
    for (name, n) in [("affine", 2), ("signorini", 4), ("pure-box", 2), ("quadratic-elastic", 2)] {
        let (folder, setup, steps) = (Folder::new("external-clamped"), setup(name), 3);
        let data = on_mesh(&setup, n);
        let dir = place(&folder, name, data.space.mesh.n, steps);
        answer(&setup, &data, steps, &dir);
        let file = dir.join("displacement.npy");
        let sound = decode(&std::fs::read(&file).expect("an answer")).expect("an array");
        let [_, vertices, d] = sound.shape[..] else { panic!("three axes") };
        let size = sound.numbers.iter().fold(0f64, |most, u| most.max(u.abs()));
        let nodes = &data.space.nodes;
        let clamped = &nodes.vertex[nodes.free..];
        let judged = |change: &dyn Fn(&mut [f64])| {
            let mut u = sound.numbers.clone();
            change(&mut u);
            std::fs::write(&file, encode(&sound.shape, &u)).expect("an answer");
            let mut found = Vec::new();
            let run = results(&folder).march(&setup, &data, steps, &mut |view| {
                found.push(step_errors(
                    &data.space,
                    &setup.model,
                    view,
                    &*data.truth.moments(view.t)?,
                ));
                Ok(())
            });
            run.map(|_| found).map_err(|error| error.to_string())
        };
        let at = |n: usize, vertex: u32| (n * vertices + vertex as usize) * d;
        let one = |u: &mut [f64]| u[at(2, clamped[0]) + 1] = 2e-8 * size;
        let message = judged(&one).expect_err("a value on Gamma1");
        let place = format!("level 2, vertex {}, which is clamped", clamped[0]);
        assert!(message.contains(&place) && message.contains("Gamma1"), "{name}: {message}");
        let moved = |u: &mut [f64]| u.iter_mut().skip(d - 1).step_by(d).for_each(|u| *u += size);
        judged(&moved).expect_err("a body that has moved as a whole");
        // 1e-9 of the largest at every clamped vertex: a strain of 1e-9/h in the cells beside them, beside which the
        // rounding of an error is 1e-16. The exact solution is not that: the square of the V error moves by it.
        let sound_errors = judged(&|_| ()).expect("the sound answer");
        let little = |u: &mut [f64]| {
            clamped
                .iter()
                .enumerate()
                .for_each(|(i, &v)| u[at(3, v)] = 1e-9 * size * (-1f64).powi(i as i32));
        };
        let errors = judged(&little).expect("what a penalty leaves");
        assert_eq!(errors[..3], sound_errors[..3], "{name}");
        assert_ne!(errors[3].v, sound_errors[3].v, "{name}");
    }
}

#[test]
fn the_files_are_those_of_the_case() {
    for (name, n) in [("signorini", 4), ("layered-in-space", 4), ("pure-box", 2)] {
        let (folder, setup, steps) = (Folder::new("external-files"), setup(name), 3);
        let data = on_mesh(&setup, n);
        let (dir, mesh) = (folder.at("case"), &data.space.mesh);
        write_case(&dir, &setup, &data, steps).expect("a case");
        let text = |file: &str| std::fs::read_to_string(dir.join(file)).expect("a text");
        let array =
            |file: &str| decode(&std::fs::read(dir.join(file)).expect("a file")).expect("an array");
        // Read back by the reader of gmsh's files.
        let coarse = read_gmsh(&text("mesh.msh")).expect("a mesh");
        assert_eq!(coarse.vertices.len(), mesh.vertices());
        for (v, at) in coarse.vertices.iter().enumerate() {
            assert_eq!(*at, mesh.point(&[v as u32], &[1.0]));
        }
        // Loads act on the hat functions of all vertices: those of free ones are the case's.
        let (loads, nodes) = (array("loads.npy"), &data.space.nodes);
        assert_eq!(loads.shape, [4, mesh.vertices(), mesh.dimension]);
        let times = array("times.npy").numbers;
        for (n, &t) in times.iter().enumerate() {
            let forces = data.truth.load(t).expect("a load");
            let level = &loads.numbers[n * nodes.len()..(n + 1) * nodes.len()];
            let sums = [forces.iter().sum::<f64>(), level.iter().sum::<f64>()];
            assert!(
                (sums[0] - sums[1]).abs() <= 1e-12 * forces.iter().map(|f| f.abs()).sum::<f64>()
            );
            for (dof, force) in forces.iter().enumerate() {
                let (node, c) = (dof / mesh.dimension, dof % mesh.dimension);
                assert_eq!(*force, level[nodes.vertex[node] as usize * mesh.dimension + c]);
            }
        }
        let rows = text("contact.csv").lines().count() - 1;
        assert_eq!(rows, data.space.trace.points.len());
        let case: serde_json::Value = serde_json::from_str(&text("case.json")).expect("JSON");
        assert_eq!(case["displacement"], serde_json::json!([4, mesh.vertices(), mesh.dimension]));
        assert_eq!(case["as_written"]["scene"]["name"], name);
        let terms = case["memory"].as_array().expect("a list").len();
        assert_eq!(terms, setup.model.memory.len());
        if terms > 0 {
            let kernels = array("kernels.npy");
            assert_eq!(kernels.shape, [terms, 4]);
            let last = setup.model.memory[0].kernel.value(times[3]);
            assert_eq!(kernels.numbers[3], last);
        }
    }
}

fn rows(table: &Path) -> Vec<csv::StringRecord> {
    let rows = csv::Reader::from_path(table).expect("a table").into_records();
    rows.collect::<Result<_, _>>().expect("rows of one length")
}

#[test]
fn kernels_of_a_graded_grid_are_those_of_all_pairs_of_times() {
    let (folder, setup) = (Folder::new("external-kernels"), setup("affine-graded"));
    let data = on_mesh(&setup, 4);
    write_case(&folder.at("case"), &setup, &data, 4).expect("a case");
    let bytes = std::fs::read(folder.at("case").join("kernels.npy")).expect("a file");
    let kernels = decode(&bytes).expect("an array");
    assert_eq!(kernels.shape, [1, 5, 5]);
    // t_j = (j/4)^2 and b(t) = -exp(-t), as the scene says; a lag of the uniform grid is off by a tenth and more.
    let time = |j: usize| (j as f64 / 4.0).powi(2);
    for (n, row) in kernels.numbers.chunks(5).enumerate() {
        for (j, &value) in row.iter().enumerate() {
            let expected = if j <= n { -(time(j) - time(n)).exp() } else { 0.0 };
            assert!((value - expected).abs() < 1e-15, "b(t_{n} - t_{j}) is {value}");
        }
    }
}

#[test]
fn the_table_of_the_contact_boundary_holds_its_measure_normals_and_gaps() {
    let (folder, setup) = (Folder::new("external-tables"), setup("signorini"));
    write_case(&folder.at("case"), &setup, &on_mesh(&setup, 4), 2).expect("a case");
    let contact = rows(&folder.at("case/contact.csv"));
    // The bottom of the unit square: length 1, normal (0, -1), the gap of the scene; its ends are not clamped.
    let column = |i: usize| contact.iter().map(move |row| row[i].parse::<f64>().expect("a number"));
    assert!((column(4).sum::<f64>() - 1.0).abs() < 1e-15);
    for (i, value) in [(2, 0.0), (3, -1.0), (5, 0.08), (6, 0.0), (7, 1.0), (8, 0.0)] {
        assert!(column(i).all(|found| found == value), "column {i} is not {value}");
    }
    assert!(!folder.at("case/gap.npy").exists());
}

/// 0.07 + 0.02 sin 4t at t = 0, 1/2, 1 and the five vertices; in the table that of t = 0.
#[test]
fn a_gap_that_moves_is_a_table_of_levels() {
    let (folder, setup) = (Folder::new("external-moving"), setup("moving-obstacle-time"));
    write_case(&folder.at("case"), &setup, &on_mesh(&setup, 4), 2).expect("a case");
    let Array { shape, numbers } =
        decode(&std::fs::read(folder.at("case/gap.npy")).expect("gap.npy")).expect("an array");
    assert_eq!(shape, [3, 5]);
    for (n, gaps) in numbers.chunks(5).enumerate() {
        let expected = 0.07 + 0.02 * (2.0 * n as f64).sin();
        assert!(gaps.iter().all(|gap| (gap - expected).abs() < 1e-15), "{n}: {gaps:?}");
    }
    assert!(rows(&folder.at("case/contact.csv")).iter().all(|row| &row[5] == "0.07"));
}

#[test]
fn sides_of_any_name_stand_in_the_tables() {
    let (folder, name) = (Folder::new("external-sides"), "below, \"left\" and right");
    let setup = setup_of(text("oblique-trapezium").replace("\"foot\"", &format!("'{name}'")));
    write_case(&folder.at("case"), &setup, &on_mesh(&setup, 4), 2).expect("a case");
    let facets = rows(&folder.at("case/facets.csv"));
    assert_eq!(facets.iter().filter(|row| &row[3] == name).count(), 4);
}

/// `sweep verify signorini` on two small cases with a shell command as the solver.
fn verify(folder: &Folder, command: &str, more: &[&str]) -> std::process::Output {
    let out = folder.argument("out");
    let mut arguments = vec!["verify", "signorini", "--n", "4", "--steps", "2", "--out", &out];
    arguments.extend(["--solver", command]);
    arguments.extend(more);
    sweep(&arguments)
}

#[test]
fn a_solver_without_an_answer_is_a_failed_case_with_the_reason() {
    let folder = Folder::new("external-failures");
    let script = |name: &str, text: &str| {
        let path = folder.file(name, text);
        format!("sh {path}")
    };
    let nan = encode(&[3, 25, 2], &[f64::NAN; 150]);
    std::fs::write(folder.at("nan.npy"), nan).expect("a file");
    std::fs::write(folder.at("short.npy"), encode(&[2, 25, 2], &[0.0; 100])).expect("a file");
    let copy = |file: &str| format!("cp {} \"$1/displacement.npy\"\n", folder.argument(file));
    for (command, says) in [
        ("no-such-program-anywhere".to_owned(), "cannot be started"),
        (script("fails.sh", "echo the mesh is odd >&2\nexit 3\n"), "the mesh is odd"),
        (script("silent.sh", "exit 0\n"), "neither displacement.npy nor displacement.csv"),
        (script("slow.sh", "exec sleep 60\n"), "stopped after 1 s"),
        (script("nan.sh", &copy("nan.npy")), "NaN at level 0, vertex 0: ux"),
        (script("short.sh", &copy("short.npy")), "[2, 25, 2] where [3, 25, 2]"),
        (script("text.sh", "echo 1,2 > \"$1/displacement.npy\"\n"), "no .npy file"),
    ] {
        let output = verify(&folder, &command, &["--time-limit", "1"]);
        let said = stdout(&output) + &stderr(&output);
        assert_eq!(code(&output), 2, "{command}: {said}");
        assert!(said.contains(says) && said.contains("1 failed"), "{command}: {said}");
    }
    // A quote without end is bad input, before anything is written.
    let output = verify(&Folder::new("external-quote"), "sh 'x", &[]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("a quote without end"), "{}", stderr(&output));
}

#[test]
fn a_traceback_is_shown_once_and_as_it_was_written() {
    let folder = Folder::new("external-traceback");
    let lines =
        ["Traceback (most recent call last):", "  File \"solve.py\", line 3", "KeyError: 'gap'"];
    let print: String =
        lines.map(|line| format!("echo '{}' >&2\n", line.replace('\'', "'\\''"))).concat();
    let path = folder.file("raises.sh", &format!("{print}exit 1\n"));
    let output = verify(&folder, &format!("sh {path}"), &[]);
    let said = stdout(&output);
    assert!(said.contains(&format!("{}\n", lines.join("\n"))), "{said}");
    assert_eq!(said.matches(lines[1].trim()).count(), 1, "{said}");
    let words = unwrapped(&said);
    assert!(words.contains("exit status: 1: KeyError: 'gap'"), "{said}");
}

/// A solver that is not found fails in every case and every norm for one reason.
#[test]
fn one_reason_of_many_cases_is_said_once() {
    let folder = Folder::new("external-one-reason");
    let path = folder.file("missing.sh", "echo 'no module named skfem' >&2\nexit 2\n");
    let (out, command) = (folder.argument("out"), format!("sh {path}"));
    let output = sweep(&["verify", "prony", "--solver", &command, "--out", &out]);
    let reason = "no module named skfem";
    assert_eq!(code(&output), 2);
    let (said, noted) = (stdout(&output), stderr(&output));
    let said = unwrapped(&said);
    assert_eq!(said.matches(reason).count(), 1, "{said}");
    assert!(said.contains("3 more for the same reason"), "{said}");
    assert_eq!(noted.matches(reason).count(), 1, "{noted}");
}

#[test]
fn an_answer_of_before_does_not_pass_for_one_of_now() {
    let folder = Folder::new("external-stale");
    let zero = encode(&[3, 25, 2], &[0.0; 150]);
    std::fs::write(folder.at("zero.npy"), zero).expect("a file");
    let write = folder
        .file("write.sh", &format!("cp {} \"$1/displacement.npy\"\n", folder.argument("zero.npy")));
    let output = verify(&folder, &format!("sh {write}"), &[]);
    assert!(stdout(&output).contains("1 case, 0 failed"), "{}", stdout(&output));
    let output = verify(&folder, "true", &[]);
    assert!(stdout(&output).contains("1 failed"), "{}", stdout(&output));
}

#[test]
fn a_table_does_as_well_and_says_what_is_wrong_with_it() {
    let folder = Folder::new("external-table");
    let (setup, steps) = (setup("signorini"), 2);
    let data = on_mesh(&setup, 4);
    let dir = place(&folder, "signorini", 4, steps);
    answer(&setup, &data, steps, &dir);
    let by_array = errors(&results(&folder), &setup, &data, steps);
    let array = decode(&std::fs::read(dir.join("displacement.npy")).unwrap()).unwrap();
    std::fs::remove_file(dir.join("displacement.npy")).unwrap();
    let rows: Vec<String> = array
        .numbers
        .chunks_exact(2)
        .enumerate()
        .map(|(i, u)| format!("{},{},{},{}", i / 25, i % 25, u[0], u[1]))
        .collect();
    let table = |rows: &[String]| {
        let text = format!("n,vertex,ux,uy\n{}\n", rows.join("\n"));
        std::fs::write(dir.join("displacement.csv"), text).unwrap();
    };
    table(&rows);
    assert_eq!(errors(&results(&folder), &setup, &data, steps), by_array);
    let said = |rows: &[String]| {
        table(rows);
        let outcome = results(&folder).march(&setup, &data, steps, &mut |_| Ok(()));
        outcome.expect_err("no answer").to_string()
    };
    let with = |row: &str| [&rows[..74], &[row.to_owned()]].concat();
    assert!(said(&rows[..74]).contains("level 2, vertex 24 is missing"));
    assert!(said(&with("2,23,0,0")).contains("occur twice"));
    assert!(said(&with("2,25,0,0")).contains("`25` is no vertex from 0 to 24"));
    assert!(said(&with("2,24,0,x")).contains("`x` is no number"));
    assert!(said(&with("2,24,0,inf")).contains("inf at level 2"));
}

#[test]
fn exported_cases_come_back_through_results_and_a_wrong_answer_fails() {
    let folder = Folder::new("external-results");
    let (cases, out) = (folder.argument("cases"), folder.argument("out"));
    let grid = ["--n", "4,8,16", "--steps", "4"];
    let common = [&["verify", "viscoelastic"][..], &grid].concat();
    let exported = sweep(&[&common[..], &["--export", &cases]].concat());
    assert_eq!((code(&exported), stdout(&exported).lines().count()), (0, 3));
    let setup = setup("viscoelastic");
    let judged = |factor: f64| {
        for n in [4, 8, 16] {
            let (data, dir) = (on_mesh(&setup, n), place(&folder, "viscoelastic", n, 4));
            assert!(dir.join("case.json").exists());
            answer(&setup, &data, 4, &dir);
            let path = dir.join("displacement.npy");
            let array = decode(&std::fs::read(&path).unwrap()).unwrap();
            let numbers: Vec<f64> = array.numbers.iter().map(|u| u * factor).collect();
            std::fs::write(&path, encode(&array.shape, &numbers)).unwrap();
        }
        let given = ["--results", &cases, "--beside", "--json", "--out", &out];
        sweep(&[&common[..], &given].concat())
    };
    let sound = judged(1.0);
    assert_eq!(code(&sound), 0, "{}", stderr(&sound));
    let document = json(&sound);
    assert_eq!(document["verdicts"][0]["verdict"], "pass");
    assert!(document["cause"].is_null(), "{}", document["cause"]);
    for row in document["beside"].as_array().expect("a list") {
        assert!(row["difference"].as_f64().expect("a number") < 1e-10, "{row}");
    }
    // Displacements a tenth too large leave an error that no mesh takes away; what is said begins with what the equations
    // of the scene say of them.
    let wrong = judged(1.1);
    assert_eq!(code(&wrong), 1);
    let document = json(&wrong);
    let reason = document["verdicts"][0]["reason"].to_string();
    let says = "the loads are taken 1.1000 times";
    assert!(reason.starts_with(&format!("\"look at the solver first: {says};")), "{reason}");
    let cause = &document["cause"];
    assert!(cause["cause"] == "loads" && cause["says"] == says && cause["fits"] == true, "{cause}");
    // For CI: the same answers as JUnit and as annotations.
    let junit = folder.argument("junit.xml");
    let given = ["--results", &cases, "--out", &out, "--junit", &junit, "--github"];
    let annotated = ends(1, &[&common[..], &given].concat());
    assert!(stdout(&annotated).contains("::error file="), "{}", stdout(&annotated));
    assert!(std::fs::read_to_string(&junit).expect("JUnit").contains("<failure"));
}

/// Pressures that are handed over are judged, or it is said that nothing judges them; claims that lack them are named.
#[test]
fn what_becomes_of_pressures_is_said() {
    let folder = Folder::new("external-pressures");
    let (cases, out) = (folder.argument("cases"), folder.argument("out"));
    let said = |name: &str, steps: u32, n: u32, more: &[&str]| {
        let (setup, grid) = (setup(name), [n.to_string(), steps.to_string()]);
        answer(&setup, &on_mesh(&setup, n), steps, &place(&folder, name, n, steps));
        let verify = ["verify", name, "--n", &grid[0], "--steps", &grid[1], "--results", &cases];
        let output = sweep(&[&verify[..], &["--out", &out], more].concat());
        unwrapped(&stdout(&output))
    };
    let handed = said("affine", 4, 2, &["--pressure"]);
    assert!(handed.contains("note: no claim of affine needs the pressures"), "{handed}");
    assert!(!said("affine", 4, 2, &[]).contains("note:"));
    let lacking = said("signorini", 2, 4, &[]);
    assert!(
        lacking.contains("note: one claim of signorini needs pressures: --pressure"),
        "{lacking}"
    );
    let judged = said("signorini", 2, 4, &["--pressure"]);
    assert!(judged.contains("pressure_L2_") && !judged.contains("note:"), "{judged}");
    let document = said("affine", 4, 2, &["--pressure", "--json"]);
    assert!(document.contains("\"pressures\": \"no claim of affine"), "{document}");
}

/// What the action for other repositories runs, with `command` as its input and records in `report`.
fn judged_elsewhere(command: &str, report: &str) -> std::process::Output {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/.github/actions/gate/judge.sh");
    let mut judge = std::process::Command::new("bash");
    judge.arg(script).env("SWEEP", env!("CARGO_BIN_EXE_sweep")).env("COMMAND", command);
    judge.env("REPORT", report).env("SOURCE", env!("CARGO_MANIFEST_DIR")).env_remove("SCENES");
    judge.env_remove("GITHUB_ACTIONS").env_remove("GITHUB_STEP_SUMMARY");
    judge.output().expect("bash")
}

#[test]
fn the_gate_of_other_repositories_takes_words_in_quotes_and_passes_the_exit_code_on() {
    let folder = Folder::new("external-gate");
    let (cases, report) = (folder.argument("all cases"), folder.argument("a report"));
    let (grid, setup) = ("--n 4,8,16 --steps 4", setup("viscoelastic"));
    for n in [4, 8, 16] {
        let at = case_dir(Path::new(&cases), "viscoelastic", n, 4);
        answer(&setup, &on_mesh(&setup, n), 4, &at);
    }
    let verify =
        judged_elsewhere(&format!("verify viscoelastic {grid} --results '{cases}'"), &report);
    assert_eq!(code(&verify), 0, "{}", stderr(&verify));
    let written = |name: &str| std::fs::read_to_string(Path::new(&report).join(name));
    assert!(written("junit.xml").expect("JUnit").contains("viscoelastic"));
    assert!(written("index.html").is_ok() && written("cases.csv").is_ok());
    // A solver that fails, a gate of a wrong grid, a table of order 1 where 2 is predicted, and no judgement at all.
    let failing = judged_elsewhere(
        &format!("verify viscoelastic {grid} --solver 'sh -c \"exit 3\"'"),
        &report,
    );
    assert_eq!(code(&failing), 2, "{}", stderr(&failing));
    assert!(stdout(&failing).contains("status: 3"), "{}", stdout(&failing));
    let gate = judged_elsewhere("gate steady --n 4,8,16", &report);
    assert!(code(&gate) < 2 && written("index.html").expect("a page").contains("steady"));
    let table = folder.file("table.csv", "h,error\n0.5,0.5\n0.25,0.25\n0.125,0.125\n");
    assert_eq!(code(&judged_elsewhere(&format!("fit {table} --p 1"), &report)), 0);
    assert_eq!(code(&judged_elsewhere(&format!("fit {table} --p 2"), &report)), 1);
    let junit = written("junit.xml").expect("JUnit");
    assert!(junit.contains("<failure") && junit.contains("table.csv"), "{junit}");
    let annotated = stdout(&sweep(&["fit", &table, "--p", "2", "--github"]));
    assert!(annotated.contains(&format!("::error file={table},line=2,title=")), "{annotated}");
    assert_eq!(code(&judged_elsewhere("list", &report)), 2);
}
