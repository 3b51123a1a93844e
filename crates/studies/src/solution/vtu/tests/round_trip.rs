//! Files read back with vtkio. Its XML parser takes a byte `<` for markup and drops an array that
//! it cannot decode, so the data here hold no such byte (asserted) and every array is asked for by
//! name.

use std::fs;

use vtkio::model::CellType;

use super::super::{Field, VtuGrid, write_vtu};
use super::reading::{attribute, block, read};
use super::{same, scratch, triangles};

const TETRAHEDRA: [u32; 8] = [0, 1, 2, 4, 0, 2, 3, 4];
const NAME: &str = "σ <\"D\"> & it's";

/// Pseudorandom values in (-1, 1), none with a byte `<`.
fn values(count: usize, mut seed: u64) -> Vec<f64> {
    let draw = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    std::iter::repeat_with(draw).filter(|x| !x.to_le_bytes().contains(&b'<')).take(count).collect()
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
    let appended = bytes.windows(2).position(|pair| pair == b"\n_").expect("appended data");
    let markup = bytes[appended..].iter().filter(|&&byte| byte == b'<').count();
    assert_eq!(markup, 2, "the data hold a byte that vtkio takes for markup");
    (bytes, fields)
}

fn check(grid: &VtuGrid<'_>, cell_type: CellType, name: &str) {
    let (file, [zeta, vector, stress]) = written(grid, name);
    let back = read(&file).expect("vtkio reads the file");
    assert!(same(&back.points, grid.points.as_flattened()));
    assert!(back.connectivity.iter().copied().eq(grid.cells.iter().map(|&v| u64::from(v))));
    let (cells, per_cell) =
        (grid.cells.len() / grid.vertices_per_cell, grid.vertices_per_cell as u64);
    assert!(back.offsets.iter().copied().eq((1..=cells as u64).map(|cell| cell * per_cell)));
    assert_eq!(back.types, vec![cell_type; cells]);
    assert_eq!((back.attributes.point.len(), back.attributes.cell.len()), (2, 1));
    let (found, components) = attribute(&back.attributes.point, "zeta").expect("zeta");
    assert!(components == 1 && same(&found, &zeta));
    let (found, components) = attribute(&back.attributes.point, NAME).expect("name unescaped");
    let in_space: Vec<f64> = vector.chunks(2).flat_map(|v| [v[0], v[1], 0.0]).collect();
    assert!(components == 3 && same(&found, &in_space));
    let (found, components) = attribute(&back.attributes.cell, "stress").expect("stress");
    assert!(components == 9 && same(&found, &stress));
}

#[test]
fn an_independent_reader_finds_every_number_of_triangles() {
    check(&triangles(), CellType::Triangle, "triangles.vtu");
}

#[test]
fn an_independent_reader_finds_every_number_of_tetrahedra() {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.25, 1.0]];
    let grid = VtuGrid { points: &points, cells: &TETRAHEDRA, vertices_per_cell: 4 };
    check(&grid, CellType::Tetra, "tetrahedra.vtu");
}

#[test]
fn a_wrong_byte_count_and_a_truncated_file_are_noticed() {
    let (file, _) = written(&triangles(), "damaged.vtu");
    let start = file.windows(2).position(|pair| pair == b"\n_").expect("appended data") + 2;
    let position = |name| block(&file, name).as_ptr() as usize - file.as_ptr() as usize - 8;
    assert_eq!(position("zeta"), start);
    let mut damaged = file.clone();
    damaged[start] += 8;
    let back = read(&damaged).expect("vtkio drops the array alone");
    assert!(attribute(&back.attributes.point, "zeta").is_none());
    for array in ["Points", "connectivity", "offsets", "types"] {
        let mut damaged = file.clone();
        damaged[position(array)] += 1;
        assert!(read(&damaged).is_err(), "{array}");
    }
    for kept in [start - 40, start + 100, file.len() - 40] {
        assert!(read(&file[..kept]).is_err(), "{kept} of {} bytes", file.len());
    }
}
