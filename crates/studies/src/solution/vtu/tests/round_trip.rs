//! Every number of a file, read back.

use std::fs;

use super::super::{Field, VtuGrid, write_vtu};
use super::reading::{floats, integers, read};
use super::{same, scratch, triangles};

const TETRAHEDRA: [u32; 8] = [0, 1, 2, 4, 0, 2, 3, 4];
const NAME: &str = "σ <\"D\"> & it's";

/// Pseudorandom values in (-1, 1).
fn values(count: usize, mut seed: u64) -> Vec<f64> {
    let draw = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    std::iter::repeat_with(draw).take(count).collect()
}

/// Writes the grid with a scalar, a plane vector and a tensor, and returns the file and the fields.
fn written(grid: &VtuGrid<'_>, name: &str) -> (Vec<u8>, [Vec<f64>; 3]) {
    let cells = grid.cells.len() / grid.vertices_per_cell;
    let fields =
        [values(grid.points.len(), 1), values(2 * grid.points.len(), 2), values(9 * cells, 3)];
    let path = scratch(name);
    let at_points = [
        Field { name: "zeta", components: 1, values: &fields[0] },
        Field { name: NAME, components: 2, values: &fields[1] },
    ];
    let in_cells = [Field { name: "stress", components: 9, values: &fields[2] }];
    write_vtu(&path, grid, &at_points, &in_cells).expect("written");
    let bytes = fs::read(&path).expect("readable");
    fs::remove_file(&path).expect("removable");
    (bytes, fields)
}

fn check(grid: &VtuGrid<'_>, cell_type: u8, name: &str) {
    let (file, [zeta, vector, stress]) = written(grid, name);
    let back = read(&file).expect("a file");
    let per_cell = grid.vertices_per_cell as i64;
    let cells = grid.cells.len() / grid.vertices_per_cell;
    assert_eq!((back.points, back.cells), (grid.points.len(), cells));
    let bytes = |name: &str| back.arrays[name].bytes;
    assert!(same(&floats(bytes("Points")), grid.points.as_flattened()));
    assert!(
        integers(bytes("connectivity")).into_iter().eq(grid.cells.iter().copied().map(i64::from))
    );
    assert!(
        integers(bytes("offsets")).into_iter().eq((1..=cells as i64).map(|cell| cell * per_cell))
    );
    assert_eq!(bytes("types"), vec![cell_type; cells]);
    let in_space: Vec<f64> = vector.chunks(2).flat_map(|v| [v[0], v[1], 0.0]).collect();
    for (name, of, components, expected) in [
        ("zeta", "PointData", 1, &zeta),
        (NAME, "PointData", 3, &in_space),
        ("stress", "CellData", 9, &stress),
    ] {
        let array = &back.arrays[name];
        assert_eq!((array.of.as_str(), array.components), (of, components));
        assert!(same(&floats(array.bytes), expected), "{name}");
    }
    assert_eq!(back.arrays.len(), 7);
}

#[test]
fn every_number_of_triangles_is_found() {
    check(&triangles(), 5, "triangles.vtu");
}

#[test]
fn every_number_of_tetrahedra_is_found() {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.25, 1.0]];
    let grid = VtuGrid { points: &points, cells: &TETRAHEDRA, vertices_per_cell: 4 };
    check(&grid, 10, "tetrahedra.vtu");
}

#[test]
fn a_wrong_byte_count_and_a_truncated_file_are_noticed() {
    let (file, _) = written(&triangles(), "damaged.vtu");
    let back = read(&file).expect("a file");
    let start = file.windows(2).position(|pair| pair == b"\n_").expect("appended data") + 2;
    for (name, array) in &back.arrays {
        let mut damaged = file.clone();
        damaged[array.bytes.as_ptr() as usize - file.as_ptr() as usize - 8] += 1;
        assert!(read(&damaged).is_err(), "{name}");
    }
    for kept in [start - 40, start + 100, file.len() - 40] {
        assert!(read(&file[..kept]).is_err(), "{kept} of {} bytes", file.len());
    }
}
