//! Files that are longer than any answer cost nothing: sparse files of 100 GB, refused before they are read.

use std::fs::File;
use std::io::Write;
use std::time::{Duration, Instant};

use run::external::{encode, read_displacements};

use crate::program::Folder;

const HUGE: u64 = 100 << 30;

/// What reading a file of the given beginning and length comes to.
fn said(name: &str, beginning: &[u8], length: u64) -> String {
    let folder = Folder::new("external-sizes");
    let mut file = File::create(folder.at(name)).expect("a file");
    file.write_all(beginning).expect("written");
    file.set_len(length).expect("a sparse file");
    let start = Instant::now();
    let outcome = read_displacements(&folder.at("."), [3, 2, 2], None);
    // Reading 100 GB takes a minute at the least, and fails for want of memory on most machines.
    assert!(start.elapsed() < Duration::from_secs(5), "{name}");
    outcome.expect_err("no answer").to_string()
}

#[test]
fn an_array_is_known_by_its_header_and_length_before_it_is_read() {
    let right = encode(&[3, 2, 2], &[0.0; 12]);
    assert!(said("displacement.npy", &right, HUGE).contains("wants 96 bytes, 1073741"));
    assert!(said("displacement.npy", &right, 200).contains("wants 96 bytes, 72 follow"));
    // A header and a length that agree with each other, and not with the case.
    let many = (HUGE / 32) as usize;
    let text: String = right.iter().map(|&byte| char::from(byte)).collect();
    let shape = format!("({many},2,2,), }}");
    let other = text.replacen(&format!("(3,2,2,), }}{}", " ".repeat(shape.len() - 12)), &shape, 1);
    assert_ne!(other, text);
    let other: Vec<u8> = other.chars().map(|c| c as u8).collect();
    let found = said("displacement.npy", &other, HUGE + right.len() as u64 - 96);
    assert!(found.contains(&format!("shape [{many}, 2, 2] where [3, 2, 2]")), "{found}");
    // A header of 4 GB.
    let mut long = right[..8].to_vec();
    long[6] = 2;
    long.extend(u32::MAX.to_le_bytes());
    assert!(said("displacement.npy", &long, HUGE).contains("no length that is understood"));
}

#[test]
fn tables_are_no_longer_than_the_case_needs() {
    let table = b"n,vertex,ux,uy\n0,0,0,0\n";
    let found = said("displacement.csv", table, HUGE);
    assert!(found.contains("107374182400 bytes, but at most"), "{found}");
    // A row too many is where reading stops.
    let rows = "n,vertex,ux,uy\n".to_owned() + &"0,0,0,0\n".repeat(100);
    let found = said("displacement.csv", rows.as_bytes(), rows.len() as u64);
    assert!(found.contains("line 3: this level and vertex occur twice"), "{found}");
}
