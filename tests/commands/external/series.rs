//! Answers as a series of VTU files: by this program's writer and by hand, in other orders, damaged.

use std::path::{Path, PathBuf};

use run::external::{AnswerError, Wanted, decode, read_displacements};
use scene::setup::{MeshData, Scheme, Setup};
use studies::solution::{Field, VtuGrid, write_pvd, write_vtu};

use super::{answer, errors, place, results, verify};
use crate::program::{Folder, code, json, stderr, stdout, sweep};
use crate::shipped::{on_mesh, setup};

/// The answer in `dir` as an array, which is taken away: (N + 1) × vertices × d numbers.
fn taken(dir: &Path) -> Vec<f64> {
    let path = dir.join("displacement.npy");
    let array = decode(&std::fs::read(&path).expect("a file")).expect("an array");
    std::fs::remove_file(path).expect("removed");
    array.numbers
}

/// The vertices in another order: that of the k-th is i.
fn order(vertices: usize) -> Vec<usize> {
    // 7 divides no number of vertices here.
    assert_ne!(vertices % 7, 0);
    (0..vertices).map(|k| (7 * k + 3) % vertices).collect()
}

/// Points and cells in that order.
fn turned(data: &MeshData) -> (Vec<usize>, Vec<[f64; 3]>, Vec<u32>) {
    let mesh = &data.space.mesh;
    let order = order(mesh.vertices());
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &i)| place[i] = k as u32);
    let points = order.iter().map(|&i| mesh.point(&[i as u32], &[1.0])).collect();
    (order, points, mesh.cells.iter().map(|&vertex| place[vertex as usize]).collect())
}

/// Writes `u` with this program's writer and its index, levels from the last to the first.
fn write_series(dir: &Path, data: &MeshData, times: &[f64], u: &[f64]) {
    let (order, points, cells) = turned(data);
    let d = data.space.mesh.dimension;
    let grid = VtuGrid { points: &points, cells: &cells, vertices_per_cell: d + 1 };
    let mut steps = Vec::new();
    for (n, level) in u.chunks_exact(order.len() * d).enumerate().rev() {
        let values: Vec<f64> = order.iter().flat_map(|&i| level[i * d..][..d].to_vec()).collect();
        let scalar = vec![f64::NAN; order.len()];
        let fields = [
            Field { name: "contact pressure", components: 1, values: &scalar },
            Field { name: "displacement", components: d, values: &values },
        ];
        let file = format!("step{n}.vtu");
        write_vtu(&dir.join(&file), &grid, &fields, &[]).expect("a file");
        steps.push((times[n], file));
    }
    write_pvd(&dir.join("displacement.pvd"), &steps).expect("an index");
}

/// One level as text, points with six digits.
fn text(data: &MeshData, level: &[f64]) -> String {
    let (order, points, _) = turned(data);
    let d = data.space.mesh.dimension;
    let row = |i: &usize| level[i * d..][..d].iter().map(|u| format!("{u:e} ")).collect::<String>();
    let values: Vec<String> = order.iter().map(row).collect();
    let points: Vec<String> =
        points.iter().map(|[x, y, z]| format!("{x:.5e} {y:.5e} {z:.5e}")).collect();
    format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>\
         <Piece NumberOfPoints=\"{}\" NumberOfCells=\"0\"><Points>\
         <DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n{}\n</DataArray></Points>\
         <PointData><DataArray type=\"Float64\" Name=\"u\" NumberOfComponents=\"{d}\" format=\"ascii\">\n\
         {}\n</DataArray></PointData></Piece></UnstructuredGrid></VTKFile>",
        order.len(),
        points.join("\n"),
        values.join("\n")
    )
}

fn write_numbered(dir: &Path, data: &MeshData, u: &[f64]) {
    let length = data.space.mesh.vertices() * data.space.mesh.dimension;
    for (n, level) in u.chunks_exact(length).enumerate() {
        std::fs::write(dir.join(format!("displacement_{n:04}.vtu")), text(data, level)).unwrap();
    }
}

fn times(setup: &Setup, steps: u32) -> Vec<f64> {
    setup.grid(steps).times().to_vec()
}

#[test]
fn a_series_in_any_order_gives_the_errors_of_the_array() {
    for (name, n, steps) in [("signorini", 4, 3), ("affine-graded", 5, 6), ("pure-box", 2, 3)] {
        let (folder, setup) = (Folder::new("external-series"), setup(name));
        let data = on_mesh(&setup, n);
        let dir = place(&folder, name, data.space.mesh.n, steps);
        answer(&setup, &data, steps, &dir);
        let by_array = errors(&results(&folder), &setup, &data, steps);
        let u = taken(&dir);
        write_series(&dir, &data, &times(&setup, steps), &u);
        assert_eq!(errors(&results(&folder), &setup, &data, steps), by_array, "{name}");
        std::fs::remove_file(dir.join("displacement.pvd")).unwrap();
        write_numbered(&dir, &data, &u);
        assert_eq!(errors(&results(&folder), &setup, &data, steps), by_array, "{name}");
    }
}

#[test]
fn a_series_that_is_damaged_is_refused_with_file_and_value() {
    let (folder, setup, steps) = (Folder::new("external-damaged"), setup("signorini"), 3);
    let data = on_mesh(&setup, 4);
    let dir = place(&folder, "signorini", 4, steps);
    answer(&setup, &data, steps, &dir);
    let u = taken(&dir);
    let length = 2 * data.space.mesh.vertices();
    let good = text(&data, &u[length..2 * length]);
    let said = || {
        let outcome = results(&folder).march(&setup, &data, steps, &mut |_| Ok(()));
        outcome.expect_err("no answer").to_string()
    };
    let level = dir.join("displacement_0001.vtu");
    let first = |tag: &str| good.find(tag).expect("a tag") + tag.len();
    let with = |from: &str, to: &str| {
        let other = good.replacen(from, to, 1);
        assert_ne!(other, good, "{from}");
        other
    };
    // Points 0 and 1 are vertices 3 and 10 of a mesh of 5 × 5.
    let points = first("format=\"ascii\">\n");
    let lines: Vec<&str> = good[points..].lines().take(2).collect();
    let same = with(lines[1], lines[0]);
    let away = with(lines[0], "7.50200e-1 0 0");
    let near = with(lines[0], "7.50009e-1 0 0");
    let lifted = with(lines[0], "0.75 0 1e-3");
    let unknown = with(lines[0], "nan 0 0");
    let value = good[points..].find("Name=\"u\"").unwrap() + points;
    let value = value + good[value..].find(">\n").unwrap() + 2;
    let endless = format!("{}inf {}", &good[..value], &good[value..].split_once(' ').unwrap().1);
    let fewer = with("NumberOfPoints=\"25\"", "NumberOfPoints=\"24\"");
    write_numbered(&dir, &data, &u);
    for (other, says) in [
        (&same, "points 0 and 1 are both vertex 3"),
        (&away, "point 0 at [0.7502, 0.0, 0.0] is no vertex of the mesh"),
        (&lifted, "point 0 at [0.75, 0.0, 0.001] is no vertex of the mesh"),
        (&unknown, "point 0 at [NaN, 0.0, 0.0] is no vertex of the mesh"),
        (&endless, "inf at point 0"),
        (&fewer, "24 points where the mesh has 25 vertices"),
        (&good[..good.len() - 20].to_owned(), "no XML that can be read"),
    ] {
        std::fs::write(&level, other).unwrap();
        let said = said();
        assert!(said.contains(says) && said.contains("displacement_0001.vtu: "), "{said}");
    }
    std::fs::write(&level, near).unwrap();
    assert!(results(&folder).march(&setup, &data, steps, &mut |_| Ok(())).is_ok());
    std::fs::remove_file(&level).unwrap();
    assert!(said().contains("level 1 of 0 to 3 has no file"), "{}", said());
    for name in ["displacement_1.vtu", "displacement_0001.vtu", "displacement_4.vtu"] {
        std::fs::write(dir.join(name), &good).unwrap();
    }
    assert!(said().contains("two files of level 1"), "{}", said());
    std::fs::remove_file(&level).unwrap();
    assert!(said().contains("a file of level 4, where the last is 3"), "{}", said());
    // The index.
    write_series(&dir, &data, &times(&setup, steps), &u);
    let index = dir.join("displacement.pvd");
    let whole = std::fs::read_to_string(&index).unwrap();
    for (from, to, says) in [
        ("step1.vtu", "step9.vtu", "step9.vtu: No such file"),
        ("step1.vtu", "/etc/passwd", "`/etc/passwd` is not below the directory"),
        ("step1.vtu", "../step1.vtu", "`../step1.vtu` is not below the directory"),
        ("timestep=\"0\"", "timestep=\"1\"", "two files of level 3"),
        (
            "timestep=\"0\"",
            "timestep=\"0.1\"",
            "timestep 0.1 is no time of times.npy; the nearest is t_0 = 0",
        ),
        ("timestep=\"0\"", "timestep=\"x\"", "DataSet 3 has no number as timestep"),
        ("timestep=\"0\"", "timestep=\"nan\"", "timestep NaN is no time"),
        ("0.33333", "0.333300", "timestep 0.3333003333333333 is no time"),
        ("<VTKFile", "<<VTKFile", "displacement.pvd: no XML that can be read"),
    ] {
        let other = whole.replacen(from, to, 1);
        assert_ne!(other, whole, "{from}");
        std::fs::write(&index, other).unwrap();
        assert!(said().contains(says), "{}", said());
    }
    // Six digits do.
    let digits =
        whole.replace("0.3333333333333333", "0.333333").replace("0.6666666666666666", "0.666667");
    assert_ne!(digits, whole);
    std::fs::write(&index, digits).unwrap();
    let outcome = results(&folder).march(&setup, &data, steps, &mut |_| Ok(()));
    assert!(outcome.is_ok(), "{outcome:?}");
}

/// What the scripts of the fixtures give to nine points, and reads of it.
struct Given {
    vertices: Vec<[f64; 3]>,
}

impl Given {
    fn new() -> Self {
        let at = |i: i32| [f64::from(i % 3) / 2.0, f64::from(i / 3) / 2.0, 0.0];
        Self { vertices: (0..9).map(at).collect() }
    }

    fn read(&self, dir: &Path) -> Result<Vec<f64>, AnswerError> {
        let wanted = Wanted { times: &[0.0], vertices: &self.vertices, dimension: 2 };
        read_displacements(dir, &wanted)
    }

    /// The script computes the field in the same doubles, perhaps fused.
    #[track_caller]
    fn check(&self, dir: &Path, digits: f64) {
        let found = self.read(dir).unwrap_or_else(|error| panic!("{error}"));
        let u = |[x, y, _]: &[f64; 3]| [0.1 + x - y / 3.0, x * y / 7.0 - 1e-9];
        let expected: Vec<f64> = self.vertices.iter().flat_map(u).collect();
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < digits, "{found} {expected}");
        }
    }
}

fn fixtures(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(folder);
    let entries = std::fs::read_dir(folder).expect("the files");
    entries.map(|entry| entry.expect("an entry").path()).collect()
}

/// Written by VTK 9.7.2 and by meshio 5.3.5, which share nothing with the reader: tests/fixtures/vtu.py.
#[test]
fn files_of_vtk_and_meshio_are_read() {
    let (given, paths) = (Given::new(), fixtures("vtu"));
    assert_eq!(paths.len(), 8);
    for path in paths {
        let folder = Folder::new("external-fixtures");
        std::fs::copy(&path, folder.at("displacement_0.vtu")).expect("a copy");
        // meshio's text has twelve digits.
        given
            .check(&folder.at("."), if path.ends_with("meshio-ascii.vtu") { 1e-12 } else { 1e-15 });
    }
}

/// VTK's index of pieces, as programs write it from one process too.
#[test]
fn an_index_of_one_piece_is_followed() {
    let (given, folder) = (Given::new(), Folder::new("external-pieces"));
    for path in fixtures("pvtu") {
        std::fs::copy(&path, folder.at(&path.file_name().unwrap().to_string_lossy())).unwrap();
    }
    let index =
        "<VTKFile type=\"Collection\"><DataSet timestep=\"0\" file=\"vtk.pvtu\"/></VTKFile>";
    folder.file("displacement.pvd", index);
    given.check(&folder.at("."), 1e-15);
    let whole = std::fs::read_to_string(folder.at("vtk.pvtu")).expect("a text");
    let said = |text: String| {
        assert_ne!(text, whole);
        folder.file("vtk.pvtu", &text);
        given.read(&folder.at(".")).expect_err("no answer").to_string()
    };
    let piece = "<Piece Source=\"vtk_0.vtu\"/>";
    let twice = said(whole.replace(piece, &piece.repeat(2)));
    assert!(twice.contains("vtk.pvtu: a parallel file of 2 pieces"), "{twice}");
    assert!(said(whole.replace("vtk_0", "../vtk_0")).contains("a parallel file of 1 piece:"));
    assert!(said(whole.replace("vtk_0", "vtk_1")).contains("No such file"));
    // Itself.
    assert!(said(whole.replace("vtk_0.vtu", "vtk.pvtu")).contains("a parallel file of 1 piece:"));
}

#[test]
fn a_solver_may_write_a_series_and_one_of_before_does_not_pass() {
    let folder = Folder::new("external-vtu-solver");
    let (setup, steps) = (setup("signorini"), 2);
    let data = on_mesh(&setup, 4);
    let dir = place(&folder, "signorini", 4, steps);
    answer(&setup, &data, steps, &dir);
    let u = taken(&dir);
    write_numbered(&dir, &data, &u);
    let numbered = format!("cp {}/displacement_*.vtu \"$1\"\n", dir.display());
    let script = folder.file("numbered.sh", &numbered);
    let output = verify(&folder, &format!("sh {script}"), &[]);
    assert!(stdout(&output).contains("1 case, 0 failed"), "{}", stdout(&output));
    // Of the files of before none is left; of the new ones one is missing.
    let some =
        folder.file("some.sh", &format!("cp {}/displacement_000[02].vtu \"$1\"\n", dir.display()));
    let output = verify(&folder, &format!("sh {some}"), &[]);
    let said = stdout(&output).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("1 failed") && said.contains("level 1 of 0 to 2 has no file"), "{said}");
    write_series(&dir, &data, &times(&setup, steps), &u);
    let collected = format!("cp {0}/displacement.pvd {0}/step*.vtu \"$1\"\n", dir.display());
    let collected = folder.file("collected.sh", &collected);
    let output = verify(&folder, &format!("sh {collected}"), &[]);
    assert!(stdout(&output).contains("1 case, 0 failed"), "{}", stdout(&output));
    let output = verify(&folder, "true", &[]);
    let said = stdout(&output);
    assert!(said.contains("1 failed") && said.contains("displacement_0000.vtu"), "{said}");
}

#[test]
fn series_come_back_through_results_and_wrong_ones_fail() {
    let folder = Folder::new("external-vtu-results");
    let (cases, out) = (folder.argument("cases"), folder.argument("out"));
    let setup = setup("viscoelastic");
    let judged = |factor: f64| {
        for n in [4, 8, 16] {
            let (data, dir) = (on_mesh(&setup, n), place(&folder, "viscoelastic", n, 4));
            answer(&setup, &data, 4, &dir);
            let u: Vec<f64> = taken(&dir).iter().map(|u| u * factor).collect();
            write_series(&dir, &data, &times(&setup, 4), &u);
        }
        let given = ["--results", &cases, "--beside", "--json", "--out", &out];
        sweep(&[&["verify", "viscoelastic", "--n", "4,8,16", "--steps", "4"][..], &given].concat())
    };
    let sound = judged(1.0);
    assert_eq!(code(&sound), 0, "{}", stderr(&sound));
    for row in json(&sound)["beside"].as_array().expect("a list") {
        assert!(row["difference"].as_f64().expect("a number") < 1e-10, "{row}");
    }
    assert_eq!(code(&judged(1.1)), 1);
}
