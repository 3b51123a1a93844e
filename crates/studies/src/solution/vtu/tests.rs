//! Bits, a refusal and the index. Whole files are read by meshio in a test of the Python package.

use std::path::PathBuf;

use std::fs;

use super::*;

const SQUARE: [[f64; 3]; 5] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.25, 0.0]];
const TRIANGLES: [u32; 12] = [0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4];

fn triangles() -> VtuGrid<'static> {
    VtuGrid { points: &SQUARE, cells: &TRIANGLES, vertices_per_cell: 3 }
}

/// A path for one test, in the system's folder for temporary files.
fn scratch(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("gronwall-{}-{name}", std::process::id()))
}

#[test]
fn every_bit_pattern_is_kept() {
    let odd = [f64::NAN, f64::NEG_INFINITY, -0.0, f64::from_bits(0x3c3c_3c26_2d5d_0a3e), 5e-324];
    let path = scratch("bits.vtu");
    let field = Field { name: "odd", components: 1, values: &odd };
    write_vtu(&path, &triangles(), &[field], &[]).expect("written");
    let file = fs::read(&path).expect("readable");
    fs::remove_file(&path).expect("removable");
    // The point data come first: their bytes in number, then bit for bit; and the points behind them.
    let begin = file.windows(2).position(|pair| pair == b"\n_").expect("appended data") + 2;
    let bits = |numbers: &[f64]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let block = |numbers: &[f64]| {
        [(8 * numbers.len() as u64).to_le_bytes().to_vec(), bits(numbers)].concat()
    };
    let expected = [block(&odd), block(SQUARE.as_flattened())].concat();
    assert_eq!(file[begin..begin + expected.len()], expected);
    let text = String::from_utf8_lossy(&file[..begin]);
    for (name, offset) in [("odd", 0), ("Points", 48), ("connectivity", 176)] {
        let there = text.lines().find(|line| line.contains(&format!("Name=\"{name}\"")));
        assert!(there.is_some_and(|line| line.contains(&format!("offset=\"{offset}\""))), "{text}");
    }
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let absent = scratch("absent").join("grid.vtu");
    let error = write_vtu(&absent, &triangles(), &[], &[]).expect_err("no such folder");
    assert_eq!(error.path, absent);
}

#[test]
fn the_index_lists_times_with_all_digits() {
    let path = scratch("series.pvd");
    let steps = [(0.0, "a_0.vtu".to_owned()), (0.1 + 0.2, "a&b.vtu".to_owned())];
    write_pvd(&path, &steps).expect("written");
    let text = fs::read_to_string(&path).expect("readable");
    fs::remove_file(&path).expect("removable");
    assert!(text.contains("<DataSet timestep=\"0\" part=\"0\" file=\"a_0.vtu\"/>"));
    let last = "<DataSet timestep=\"0.30000000000000004\" part=\"0\" file=\"a&amp;b.vtu\"/>";
    assert!(text.contains(last) && text.ends_with("</VTKFile>\n"));
}
