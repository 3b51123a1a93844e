//! What leaving the special structure of a shipped scene costs. Informs where a user's scene would fall off an edge: the
//! ratio is to the shipped scene, in CPU seconds of one thread, both measured in turn.

use std::hint::black_box;
use std::path::Path;

use fem::norms::step_errors;
use scene::setup::{MeshData, Setup};
use scene::{Scene, Source};
use vhi::Newton;

use super::least;

/// A shipped scene, and the lines of it that are replaced.
struct Change {
    scene: &'static str,
    n: u32,
    steps: u32,
    what: &'static str,
    edits: &'static [(&'static str, &'static str)],
}

const fn change(
    scene: &'static str,
    [n, steps]: [u32; 2],
    what: &'static str,
    edits: &'static [(&'static str, &'static str)],
) -> Change {
    Change { scene, n, steps, what, edits }
}

const UNIFORM: &str = "grid = { kind = \"uniform\" }";
const GRADED: (&str, &str) = (UNIFORM, "grid = { kind = \"graded\", exponent = 2.0 }");
const RANDOM: (&str, &str) = (UNIFORM, "grid = { kind = \"random\", seed = 1 }");
const VERTEX: &str = "quadrature = \"vertex\"";
const GAUSS: (&str, &str) = (VERTEX, "quadrature = \"gauss\"");
const EXACT: (&str, &str) = (VERTEX, "quadrature = \"exact\"");
const SQUARE: &str = "shape = \"rectangle\"\nsize = [1.0, 1.0]";
const POLYGON: (&str, &str) = (
    SQUARE,
    "shape = \"polygon\"\nvertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]",
);
const FILE: (&str, &str) = (SQUARE, "shape = \"mesh\"\nfile = \"square.msh\"");
const MOVED: (&str, &str) = (
    SQUARE,
    "shape = \"rectangle\"\nsize = [1.0, 1.0]\nmesh = { kind = \"perturbed\", amplitude = 1e-6, seed = 1 }",
);
const BOX: &str = "size = [1.0, 1.0, 1.0]";
const MOVED_BOX: (&str, &str) =
    (BOX, "size = [1.0, 1.0, 1.0]\nmesh = { kind = \"perturbed\", amplitude = 1e-6, seed = 1 }");
const LAME: &str = "lambda = 1.0\nmu_L = 1.0";
const FULL: (&str, &str) = (
    LAME,
    "elasticity = { kind = \"full\", mandel = [[3.1, 1.0, 0.2], [1.0, 2.9, 0.1], [0.2, 0.1, 2.0]] }",
);
const GENERAL: (&str, &str) = ("kernel = \"-exp(-t)\"", "kernel = \"-(1 + 4*t)^(-1.5)\"");
const MEMORY: (&str, &str) = ("lambda = 0.25\nmu = 0.25", "lambda = 0.31\nmu = 0.25");
const LOAD: (&str, &str) = ("\"-3*t*x\"", "\"-3*sin(t*x)\"");

const CHANGES: [Change; 21] = [
    change("linear-punch", [128, 64], "memory that is no multiple of the elasticity", &[MEMORY]),
    change("linear-punch", [128, 64], "a kernel that is no sum of exponentials", &[GENERAL]),
    change("linear-punch", [128, 64], "full elasticity tensor", &[FULL]),
    change("linear-punch", [128, 64], "graded time grid", &[GRADED]),
    change("linear-punch", [128, 64], "random time grid", &[RANDOM]),
    change("linear-punch", [64, 64], "graded grid, memory, load", &[GRADED, MEMORY, LOAD]),
    change("elastic-punch", [64, 64], "Gauss points on Γ3", &[GAUSS]),
    change("elastic-punch", [64, 64], "exact integrals on Γ3", &[EXACT]),
    change("elastic-punch", [64, 64], "memory that is no multiple of the elasticity", &[MEMORY]),
    change("elastic-punch", [64, 64], "polygon", &[POLYGON]),
    change("punch", [48, 32], "Gauss points on Γ3", &[GAUSS]),
    change("punch", [48, 32], "graded time grid", &[GRADED]),
    change("punch", [48, 32], "a kernel that is no sum of exponentials", &[GENERAL]),
    change("punch", [48, 32], "full elasticity tensor", &[FULL]),
    change("punch", [48, 32], "file of gmsh", &[FILE]),
    change("pure-mild", [48, 16], "polygon", &[POLYGON]),
    change("pure-mild", [48, 16], "file of gmsh", &[FILE]),
    change("pure-mild", [48, 16], "vertices moved by 1e-6 h", &[MOVED]),
    change("pure-mild", [48, 16], "Gauss points on Γ3", &[GAUSS]),
    change("punch-box", [8, 8], "vertices moved by 1e-6 h", &[MOVED_BOX]),
    change("punch-box", [8, 8], "Gauss points on Γ3", &[GAUSS]),
];

/// The unit square as two triangles.
const SQUARE_FILE: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n1 4 \"left\"\n2 5 \"body\"\n$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n6\n1 1 2 1 1 1 2\n2 1 2 2 2 2 3\n3 1 2 3 3 3 4\n4 1 2 4 4 4 1\n5 2 2 5 5 1 2 3\n6 2 2 5 5 1 3 4\n$EndElements\n";

fn setup(change: &Change, edits: &[(&str, &str)], folder: &Path) -> Setup {
    let shipped = format!("{}/manufactured/{}.toml", env!("CARGO_MANIFEST_DIR"), change.scene);
    let mut text = std::fs::read_to_string(&shipped).unwrap_or_else(|error| panic!("{error}"));
    for (old, new) in edits {
        assert!(text.contains(old), "{}: no `{old}` to replace", change.scene);
        text = text.replacen(old, new, 1);
    }
    // Moved vertices do not nest, which a reference run would need; nothing is judged here.
    if text.contains("judge = false") {
        text.truncate(text.find("[sweep]").unwrap_or(text.len()));
    }
    let source = Source::from_text(folder.join(format!("{}.toml", change.scene)), text);
    let scene = Scene::from_source(source).unwrap_or_else(|error| panic!("{error}"));
    Setup::new(scene).unwrap_or_else(|error| panic!("{error}"))
}

/// One case: mesh, exact fields, loads, march, errors.
fn case(setup: &Setup, n: u32, steps: u32) -> f64 {
    least(1, || {
        let data = MeshData::new(setup, n, None).unwrap_or_else(|error| panic!("{error}"));
        let times = setup.grid(steps).times().to_vec();
        data.truth.expect(&times).unwrap_or_else(|error| panic!("{error}"));
        data.march(setup, steps, &Newton::default(), &mut |view| {
            if setup.exact.is_some() {
                let moments = data.truth.moments(view.t)?;
                black_box(step_errors(&data.space, &setup.model, view, &moments));
            }
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
    })
}

/// Every change on meshes of at most `largest`, the least of `runs` in turn with the shipped scene.
pub fn cliffs(largest: u32, runs: usize) {
    let folder = std::env::temp_dir().join(format!("gronwall-cliffs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap_or_else(|error| panic!("{error}"));
    std::fs::write(folder.join("square.msh"), SQUARE_FILE)
        .unwrap_or_else(|error| panic!("{error}"));
    println!(
        "| scene | n/N | change | shipped, ms | changed, ms | ratio |\n|---|---|---|---|---|---|"
    );
    for change in &CHANGES {
        let [shipped, changed] = [&[], change.edits].map(|edits| setup(change, edits, &folder));
        let [n, steps] = [change.n, change.steps].map(|number| number.min(largest));
        let mut seconds = [f64::INFINITY; 2];
        for _ in 0..runs {
            for (least, setup) in seconds.iter_mut().zip([&shipped, &changed]) {
                *least = least.min(case(setup, n, steps));
            }
        }
        let [before, after] = seconds.map(|seconds| 1e3 * seconds);
        let (scene, what) = (change.scene, change.what);
        println!(
            "| `{scene}` | {n}/{steps} | {what} | {before:.0} | {after:.0} | {:.1} |",
            after / before
        );
    }
    // What stays behind is a file of some bytes.
    drop(std::fs::remove_dir_all(&folder));
}
