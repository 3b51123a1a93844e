//! Source: scene files, formulas, meshes and tables come from anywhere.
//! Goal: no text, however damaged, makes the readers panic, hang or take memory without bound.
//! Data: the shipped scenes, their formulas, a mesh of each format and a table of cases, with seeded damage: bytes
//!   flipped, parts lost, doubled or taken from another file, numbers made extreme, brackets nested deep.
//!   `make fuzz` runs ten million each (RUNS=…) or for so long (MINUTES=…, each), the tests a few thousand (SEED=… for
//!   others).

mod damage;
#[path = "../program/mod.rs"]
mod program;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use damage::fuzz;
use fem::mesh::read_gmsh;
use formula::{EvaluationPoint, Graph, Program, Scope, Variable};
use gronwall::cli::fitted;
use judge::fit::Direction;
use judge::record::{CaseRecord, Key, read};
use judge::table::Reading;
use judge::verdict::{Baseline, ComparedRun, read_earlier};
use program::{Folder, code, stderr, sweep};
use report::{convergence_svg, split_svg};
use run::external::{decode, encode, read_displacements};
use run::sweep::{Provenance, judge_scene};
use scene::setup::Subject;
use scene::{Scene, Source};
use studies::portrait::scene_summary;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("manufactured")
}

fn scenes() -> Vec<String> {
    let entries = std::fs::read_dir(folder()).expect("the scenes");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let scenes = paths.iter().filter(|path| path.extension().is_some_and(|e| e == "toml"));
    scenes.map(|path| std::fs::read_to_string(path).expect("a scene")).collect()
}

/// The strings of the scenes: formulas, mostly.
fn formulas() -> Vec<String> {
    let mut formulas: Vec<String> = scenes()
        .iter()
        .flat_map(|scene| {
            scene.split('"').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>()
        })
        .filter(|text| !text.contains('\n'))
        .collect();
    formulas.sort();
    formulas.dedup();
    formulas
}

#[test]
fn no_formula_breaks_parser_derivative_or_tape() {
    let variables = [Variable::X, Variable::Y, Variable::Z, Variable::T, Variable::Zeta];
    fuzz("formula", &formulas(), 20_000, |text| {
        let mut graph = Graph::new();
        let mut scope = Scope::new(&variables);
        for name in ["A0", "A1", "W", "R", "Y", "a", "b", "theta", "alpha"] {
            let value = graph.constant(0.7);
            scope.define(name, value);
        }
        let Ok(node) = graph.parse(text, &scope) else { return false };
        let slope = graph.derivative(node, Variable::X);
        let rate = graph.derivative(slope, Variable::T);
        let at = EvaluationPoint { x: 0.3, y: -0.2, z: 0.1, t: 0.4, zeta: 0.5 };
        let mut out = vec![Vec::new(); 3];
        let bound = Program::compile(&graph, &[node, slope, rate], 1.0);
        bound.bind(&[[0.3, -0.2, 0.1], [0.0; 3]]).evaluate(0.4, 0.5, &mut out);
        let _ = graph.evaluate(node, &at);
        out.iter().all(|values| values.len() == 2)
    });
}

#[test]
fn no_scene_file_breaks_the_reader() {
    // Beside the shipped meshes, which scenes name.
    let path = folder().join("fuzzed.toml");
    fuzz("scene", &scenes(), 2_000, |text| {
        match Scene::from_source(Source::from_text(path.clone(), text)) {
            Ok(_) => true,
            Err(error) => {
                let said = error.to_string();
                assert!(!said.trim().is_empty(), "a refusal without a word");
                false
            }
        }
    });
}

#[test]
fn no_mesh_file_breaks_the_reader() {
    let read = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name);
        std::fs::read_to_string(path).expect("a mesh")
    };
    let corpus = ["block-2.2.msh", "block-4.1.msh"].map(read);
    fuzz("mesh", &corpus, 20_000, |text| read_gmsh(text).is_ok());
}

/// Files of a short sweep of `affine` in a folder with room for damaged copies.
struct Swept {
    folder: Folder,
    count: AtomicU64,
}

impl Swept {
    fn new(name: &str) -> Self {
        let folder = Folder::new(name);
        let arguments = ["run", "affine", "--n", "4", "--steps", "4,8,16"];
        let output = sweep(&[&arguments[..], &["--out", &folder.argument("run")]].concat());
        // One scene on part of its grid: its verdicts do not matter here.
        assert!(code(&output) < 2, "{}", stderr(&output));
        Self { folder, count: AtomicU64::new(0) }
    }

    fn text(&self, file: &str) -> String {
        std::fs::read_to_string(self.folder.at("run").join(file)).expect("a file of a sweep")
    }

    /// Shows a damaged copy, in a new folder, to `look`.
    fn with(&self, file: &str, text: &str, look: impl FnOnce(&Path) -> bool) -> bool {
        let folder = self.folder.at(&self.count.fetch_add(1, Relaxed).to_string());
        std::fs::create_dir(&folder).expect("a folder");
        let path = folder.join(file);
        std::fs::write(&path, text).expect("a file");
        let taken = look(&path);
        std::fs::remove_dir_all(&folder).expect("removed");
        taken
    }

    fn records(&self) -> Vec<CaseRecord> {
        read(&self.folder.at("run/cases.csv")).expect("records")
    }
}

fn affine() -> Scene {
    Scene::read(&folder().join("affine.toml")).unwrap_or_else(|error| panic!("{error}"))
}

/// What `report` and `--resume` do with a table: reader, fits, verdicts, pictures.
#[test]
fn no_table_breaks_the_reader_or_what_comes_after() {
    let (swept, scene) = (Swept::new("fuzz-table"), affine());
    let subject = Subject::new(scene.clone()).expect("a subject");
    let summary = scene_summary(&scene, Some(&subject));
    // With a checksum hardly a damaged row would come through.
    let text = swept.text("cases.csv");
    let bare = text.lines().map(|row| row.rsplit_once(',').expect("fields").0.to_owned() + "\n");
    fuzz("table", &[bare.collect(), text.clone()], 5_000, |text| {
        swept.with("cases.csv", text, |path| {
            let Ok(records) = read(path) else { return false };
            let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
            let verdicts = judge_scene(&scene, &records, &keys, &[]);
            let along = |direction| convergence_svg(&summary, &records, &verdicts, direction);
            let drawn =
                [along(Direction::Space), along(Direction::Time), split_svg(&summary, &records)];
            // There is a whole picture, or none.
            drawn.into_iter().flatten().all(|svg| svg.ends_with("</svg>\n"))
        })
    });
}

/// The tables of `tests/pasted`, by their keys `text`.
fn pasted() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pasted");
    let entries = std::fs::read_dir(folder).expect("the pasted tables");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let read = |path: &PathBuf| std::fs::read_to_string(path).expect("a document");
    let texts = |text: String| -> Vec<String> {
        let bodies = text.split("text = '''\n").skip(1);
        bodies.map(|body| body.split("'''").next().unwrap_or_default().to_owned()).collect()
    };
    paths.iter().map(read).flat_map(texts).collect()
}

/// The reader alone, with what a caller may say.
#[test]
fn no_text_breaks_the_reader_of_tables() {
    fuzz("text of a table", &pasted(), 3_000, |text| {
        let asked = Reading { dimension: Some(2), ratio: Some(2.0), ..Reading::default() };
        let read = |reading| judge::table::read(text.as_bytes(), reading);
        [asked, Reading { runs: true, ..Reading::default() }].iter().all(|r| read(r).is_ok())
    });
}

#[test]
fn no_table_breaks_the_fits() {
    let swept = Swept::new("fuzz-fit");
    let corpus = [
        swept.text("cases.csv"),
        "h,k,error\n0.125,0.01,0.11\n0.0625,0.01,0.052\n0.03125,0.01,0.0255\n0.015625,0.01,0.0126\n".into(),
        "h,k,error,floor\n0.25,0.5,0.4,1e-9\n0.25,0.25,0.3,1e-9\n0.125,0.5,0.25,0\n0.125,0.25,0.2,0\n0.0625,0.5,0.2,0\n0.0625,0.25,0.1,0\n".into(),
        "norm,h,value\nforce,0.1,1.04\nforce,0.05,1.01\nforce,0.025,1.0025\nforce,0.0125,1.0006\n".into(),
        "n cells         H1                   L2\n   16 1.0 - - 0.1 - -\n   64 0.5 2.0 1.0 0.025 4.0 2.0\n".into(),
        "| level | L2 | rate |\n|---|---|---|\n| 1 | 0.1 | - |\n| 2 | 0.025 | 2.0 |\n| 3 | 0.00625 | 2.0 |\n".into(),
        "\\begin{tabular}{rr}\n$h$ & $L_2$ \\\\\n1/2 & $1.0\\times 10^{-1}$ \\\\\n1/4 & 2.5D-2 \\\\\n\\end{tabular}\n".into(),
        "h = 0.5, L2 = 0.1\nh = 0.25, L2 = 0.025, rate = 2.0\nh = 0.125, L2 = 0.00625\n".into(),
        "k,error,status\n0.5,1,converged\n0.25,0.25,converged\n0.125,,failed\n0.0625,0.016,converged\n".into(),
        "# made elsewhere\n# n L2 H1\n8 1e-1 1\n8 1.1D-1 1.1\n16 2.5e-2 .5\n32 6.2e-3 1/4\n".into(),
        "h;L2;sigma\n0.5;0.1;1e-3\n2^-2;0.025;1e-3\n0.125;0.006;1e-3\n".into(),
        "| h | L2 | rate |\n|---|:--:|---|\n| 0.5 | 0.1 | - |\n| 0.25 | 0.025 | 2 |\n| 0.125 | 0.006 | 2.06 |\n".into(),
        "n cells    H1             L2\n   16 1.0 - - 0.1 - -\n   64 0.5 2.0 1.0 0.025 4.0 2.0\n".into(),
        "\\begin{tabular}{cc}\n$h$ & $L^2$ \\\\ \\hline\n$0.5$ & $1.0\\times 10^{-1}$ \\\\\n0.25 & \\num{2.5e-2} \\\\\n\\end{tabular}\n".into(),
        "h = 0.5, E = 0.1\nh = 0.25, E = 0.025, rate = 2.0\nh: 0.125 E: 0.006\n".into(),
    ];
    let corpus: Vec<String> = corpus.into_iter().chain(pasted()).collect();
    fuzz("fit", &corpus, 5_000, |text| {
        swept.with("table.csv", text, |path| {
            [[None, None], [Some(1.0), Some(2.0)]]
                .iter()
                .all(|&orders| fitted(path, orders).is_ok())
        })
    });
}

#[test]
fn no_baseline_breaks_the_comparison() {
    let swept = Swept::new("fuzz-baseline");
    let (records, scene) = (swept.records(), affine());
    let sound = Baseline::of(&records, &[(&scene.name, &scene.source.hash)]);
    let path = swept.folder.at("baseline.json");
    sound.write(&path).expect("a baseline");
    let text = std::fs::read_to_string(&path).expect("a baseline");
    let run = ComparedRun {
        scene: scene.name.clone(),
        hash: scene.source.hash.clone(),
        planned: records.iter().map(CaseRecord::key).collect(),
        own_grids: true,
    };
    fuzz("baseline", &[text], 5_000, |text| {
        swept.with("baseline.json", text, |path| {
            let Ok(Some(baseline)) = Baseline::read(path) else { return false };
            let comparison = baseline.compare(std::slice::from_ref(&run), &records, &[]);
            let changes = baseline.changes(&sound);
            // Both are printed.
            comparison.lines().len() + changes.len() < 1_000_000
        })
    });
}

/// The other two files that `report` and `--resume` read.
#[test]
fn no_verdict_and_no_provenance_breaks_the_report() {
    let swept = Swept::new("fuzz-report");
    let mut verdict: serde_json::Value =
        serde_json::from_str(&swept.text("verdict.json")).expect("JSON");
    let key = serde_json::json!({"scene": "affine", "n": 4, "steps": 8, "reason": "a reason"});
    verdict["failures"] = serde_json::json!([key]);
    let corpus = [swept.text("verdict.json"), verdict.to_string()];
    fuzz("verdict", &corpus, 5_000, |text| {
        swept.with("verdict.json", text, |path| read_earlier(path).is_ok())
    });
    fuzz("provenance", &[swept.text("provenance.json")], 2_000, |text| {
        swept.with("provenance.json", text, |path| {
            let dir = path.parent().expect("a folder");
            let Ok(Some(provenance)) = Provenance::read(dir) else { return false };
            let scene = provenance.scene(dir, "affine");
            provenance.json().is_object() && matches!(scene, Ok(Some(_)))
        })
    });
}

/// Three levels of two vertices in the plane.
const SHAPE: [usize; 3] = [3, 2, 2];
const WANTED: [usize; 3] = [3, 2, 2];

/// Bytes as a text and back, a character each: what damage adds of other characters is cut to a byte.
fn as_text(bytes: &[u8]) -> String {
    bytes.iter().map(|&byte| char::from(byte)).collect()
}

#[test]
fn no_array_of_a_solver_breaks_the_reader() {
    let numbers: Vec<f64> = (0..12).map(|i| 0.1 * f64::from(i)).collect();
    let bytes = encode(&SHAPE, &numbers);
    // Version 2 of the format has a length of four bytes.
    let later = [&bytes[..6], &[2, 0], &bytes[8..10], &[0, 0], &bytes[10..]].concat();
    let corpus = [bytes, later].map(|bytes| as_text(&bytes));
    fuzz("array", &corpus, 20_000, |text| {
        let bytes: Vec<u8> = text.chars().map(|c| c as u32 as u8).collect();
        decode(&bytes)
            .is_ok_and(|array| array.numbers.len() == array.shape.iter().product::<usize>())
    });
}

#[test]
fn no_table_of_a_solver_breaks_the_reader() {
    let swept = Swept::new("fuzz-answer");
    let row = |i: usize| format!("{},{},{},-1e-3\n", i / 2, i % 2, 0.5 * i as f64);
    let corpus = ["n,vertex,ux,uy\n".to_owned() + &(0..6).map(row).collect::<String>()];
    fuzz("answer", &corpus, 5_000, |text| {
        swept.with("displacement.csv", text, |path| {
            let dir = path.parent().expect("a folder");
            read_displacements(dir, WANTED, None).is_ok_and(|numbers| numbers.len() == 12)
        })
    });
}
