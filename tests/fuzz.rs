//! Source: own; scene files, formulas, meshes and tables come from anywhere.
//! Goal: no text, however damaged, makes the readers panic, hang or take memory without bound.
//! Data: the shipped scenes, their formulas, a mesh of each format and a table of cases, with seeded damage: bytes
//!   flipped, parts lost, doubled or taken from another file, numbers made extreme, brackets nested deep.
//!   `make fuzz` runs ten million each (RUNS=…), the tests a few thousand (SEED=… for others).

mod program;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

use gronwall::cli::fitted;
use gronwall::fit::Direction;
use gronwall::formula::{Graph, Point, Program, Scope, Variable};
use gronwall::linalg::signed_unit;
use gronwall::mesh::read_gmsh;
use gronwall::record::{CaseRecord, Key, read};
use gronwall::report::{convergence_svg, surface_svg};
use gronwall::scene::{Scene, Source};
use gronwall::sweep::{Provenance, judge_scene, scene_summary};
use gronwall::verdict::{Baseline, Run, compare_with_baseline, read_failures, read_foreseen};
use program::{Folder, code, stderr, sweep};

/// Nothing that is read takes a person's patience: a guard against hanging, which decides nothing else.
const PATIENCE: Duration = Duration::from_secs(60);

/// What replaces a number.
const NUMBERS: [&str; 20] = [
    "0",
    "-0.0",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "1e",
    "0x10",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "4294967296",
    "1_000",
    "0.1.2",
    "00",
    "-1",
];

/// What is put in anywhere.
const WORDS: [&str; 30] = [
    "(", ")", "[", "]", "{", "}", "\"", "'", "\"\"\"", "=", ",", "\n", "\r", "\0", "#", "$End",
    "d(", "if(", "relax(", "sin", "zeta", "x^", "^-1", "/0", "ζ", "\u{202e}", "\u{feff}", "e", "-",
    "[[a]]",
];

/// Seeded damage.
struct Damage<'a> {
    corpus: &'a [String],
    state: u64,
}

impl Damage<'_> {
    /// A number below `bound`, 0 for none.
    fn below(&mut self, bound: usize) -> usize {
        let unit = 0.5 * (1.0 + signed_unit(&mut self.state));
        ((unit * bound as f64) as usize).min(bound.saturating_sub(1))
    }

    fn part(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        // Mostly short parts.
        let most = [4, 40, length][self.below(3)];
        start..(start + self.below(most + 1)).min(length)
    }

    fn text(&mut self) -> String {
        let own = self.below(self.corpus.len());
        let mut bytes = self.corpus[own].clone().into_bytes();
        let times = [0, 0, 1, 5][self.below(4)];
        for _ in 0..=self.below(times + 1) {
            let part = self.part(bytes.len());
            match self.below(8) {
                0 if !bytes.is_empty() => {
                    let at = self.below(bytes.len());
                    bytes[at] ^= 1 << self.below(8);
                }
                1 => drop(bytes.drain(part)),
                2 => {
                    let copy = bytes[part.clone()].to_vec();
                    let times = [1, 3, 300][self.below(3)].min(1 + 40_000 / (copy.len() + 1));
                    bytes.splice(part.end..part.end, copy.repeat(times));
                }
                3 => {
                    let other = self.below(self.corpus.len());
                    let from = self.part(self.corpus[other].len());
                    bytes.splice(part, self.corpus[other].as_bytes()[from].to_vec());
                }
                4 | 5 => {
                    let digit = |at: &usize| bytes[*at].is_ascii_digit();
                    let Some(at) = (part.start..bytes.len()).find(digit) else { continue };
                    let ends = |byte: &u8| !(byte.is_ascii_alphanumeric() || b".+-".contains(byte));
                    let length = bytes[at..].iter().position(ends).unwrap_or(bytes.len() - at);
                    let number = NUMBERS[self.below(NUMBERS.len())];
                    bytes.splice(at..at + length, number.bytes());
                }
                6 => {
                    let open = ["(", "[", "-", "sin(", "{a=", "if(x<", "d("][self.below(7)];
                    let deep = open.repeat([1, 30, 5000][self.below(3)]);
                    bytes.splice(part, deep.into_bytes());
                }
                _ => {
                    let word = WORDS[self.below(WORDS.len())];
                    bytes.splice(part.start..part.start, word.bytes());
                }
            }
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

/// How many texts a target is given.
fn runs(few: u64) -> u64 {
    std::env::var("RUNS").map_or(few, |runs| runs.parse().expect("RUNS: a number"))
}

fn seed() -> u64 {
    std::env::var("SEED").map_or(1, |seed| seed.parse().expect("SEED: a number"))
}

/// What one worker reads, and since when.
type Current = Mutex<Option<(Instant, String)>>;

/// Gives `read` many damaged texts of `corpus`. It answers whether it took the text.
///
/// # Panics
/// With the text that made it panic, or that it did not come to an end with.
fn fuzz(target: &str, corpus: &[String], few: u64, read: impl Fn(&str) -> bool + Sync) {
    let total = runs(few);
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let current: Vec<Current> = (0..workers).map(|_| Mutex::new(None)).collect();
    let (next, taken, ended) = (AtomicU64::new(0), AtomicU64::new(0), AtomicU64::new(0));
    let found: Mutex<Option<String>> = Mutex::new(None);
    let found_one = || found.lock().expect("the finding").is_some();
    std::thread::scope(|scope| {
        for own in &current {
            let work = || {
                while let Some(run) = Some(next.fetch_add(1, Relaxed)).filter(|&run| run < total) {
                    if found_one() {
                        break;
                    }
                    let state = (seed() << 40) ^ run.wrapping_mul(0x9e37_79b9_7f4a_7c15);
                    let text = Damage { corpus, state }.text();
                    *own.lock().expect("the text") = Some((Instant::now(), text.clone()));
                    match catch_unwind(AssertUnwindSafe(|| read(&text))) {
                        Ok(good) => drop(taken.fetch_add(u64::from(good), Relaxed)),
                        Err(_) => *found.lock().expect("the finding") = Some(text),
                    }
                    *own.lock().expect("the text") = None;
                }
                ended.fetch_add(1, Relaxed);
            };
            // Deep nesting must be refused, not survived by a large stack: that of a second thread, 2 MB.
            scope.spawn(work);
        }
        while ended.load(Relaxed) < workers as u64 {
            std::thread::sleep(Duration::from_millis(20));
            for own in &current {
                if let Some((since, text)) = &*own.lock().expect("the text")
                    && since.elapsed() > PATIENCE
                {
                    eprintln!("{target}: {}", kept(target, text).display());
                    // A thread that hangs cannot be ended in another way.
                    std::process::abort();
                }
            }
        }
    });
    if let Some(text) = found.into_inner().expect("the finding") {
        panic!("{target}: a panic, text in {}", kept(target, &text).display());
    }
    let taken = taken.into_inner();
    println!("{target}: {total} texts, {taken} taken");
    // Texts that are all refused, or all taken, test nothing.
    assert!(taken > total / 1000 && taken < total - total / 20, "{target}: {taken} of {total}");
}

/// Where the text of a finding is kept.
fn kept(target: &str, text: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{target}.txt"));
    std::fs::write(&path, text).expect("the text is kept");
    path
}

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
        let at = Point { x: 0.3, y: -0.2, z: 0.1, t: 0.4, zeta: 0.5 };
        let mut out = vec![Vec::new(); 3];
        let bound = Program::compile(&mut graph, &[node, slope, rate], 1.0);
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

/// Files of a short sweep of `affine` in a folder of their own, with room for damaged copies.
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

    /// Shows a damaged copy, in a folder of its own, to `look`.
    fn with(&self, file: &str, text: &str, look: impl FnOnce(&Path) -> bool) -> bool {
        let own = self.folder.at(&self.count.fetch_add(1, Relaxed).to_string());
        std::fs::create_dir(&own).expect("a folder");
        let path = own.join(file);
        std::fs::write(&path, text).expect("a file");
        let taken = look(&path);
        std::fs::remove_dir_all(&own).expect("removed");
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
    let summary = scene_summary(&scene);
    fuzz("table", &[swept.text("cases.csv")], 5_000, |text| {
        swept.with("cases.csv", text, |path| {
            let Ok(records) = read(path) else { return false };
            let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
            let verdicts = judge_scene(&scene, &records, &keys, &[]);
            let drawn = [Direction::Space, Direction::Time]
                .map(|direction| convergence_svg(&summary, &records, &verdicts, direction).is_ok());
            // A picture that cannot be drawn is a typed error.
            drawn[0] && drawn[1] && surface_svg(&summary, &records).is_ok()
        })
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
        "k,error,status\n0.5,1,converged\n0.25,0.25,converged\n0.125,,failed\n0.0625,0.016,converged\n".into(),
    ];
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
    let own = Baseline::of(&records, &[(&scene.name, &scene.source.hash)]);
    let path = swept.folder.at("baseline.json");
    own.write(&path).expect("a baseline");
    let text = std::fs::read_to_string(&path).expect("a baseline");
    let run = Run {
        scene: scene.name.clone(),
        hash: scene.source.hash.clone(),
        planned: records.iter().map(CaseRecord::key).collect(),
        own_grids: true,
    };
    fuzz("baseline", &[text], 5_000, |text| {
        swept.with("baseline.json", text, |path| {
            let Ok(Some(baseline)) = Baseline::read(path) else { return false };
            let comparison = compare_with_baseline(&baseline, std::slice::from_ref(&run), &records);
            let changes = baseline.changes(&own);
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
        swept.with("verdict.json", text, |path| {
            read_failures(path).is_ok() && read_foreseen(path).is_ok()
        })
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
