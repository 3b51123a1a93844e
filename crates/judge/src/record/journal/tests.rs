//! Interruptions, duplicates, bits and sorting of `cases.csv`.

use super::*;
use crate::record::{NormError, Status};

fn case(n: u32, steps: u32, errors: &[(&str, f64)]) -> CaseRecord {
    CaseRecord {
        scene: "a, \"b\"".into(),
        dimension: 2,
        n: Some(n),
        steps,
        h: Some(1.0 / f64::from(n)),
        k: 1.0 / f64::from(steps),
        dofs: 10,
        elements: 5,
        status: Status::Converged,
        newton_iterations: 3,
        active_set_changes: 2,
        factorizations: 1,
        seconds_load: 0.1,
        seconds_assemble: 0.2,
        seconds_factor: 0.3,
        seconds_solve: 0.1 + 0.2,
        seconds_total: 1e-300,
        peak_history_bytes: 99,
        errors: errors
            .iter()
            .map(|&(norm, error)| NormError {
                norm: norm.into(),
                error: Some(error),
                floor: Some(1e-14),
            })
            .collect(),
    }
}

fn file(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("gronwall-{name}-{}.csv", std::process::id()));
    let _ = fs::remove_file(&path);
    path
}

#[test]
fn reads_back_bit_identically() {
    let path = file("bits");
    let mut written = vec![
        case(3, 7, &[("V_max", 0.1 + 0.2), ("L2_max", f64::MIN_POSITIVE)]),
        case(6, 7, &[("V_max", 1.0 / 3.0)]),
    ];
    // Without a mesh, which comes first.
    written.insert(0, CaseRecord { n: None, h: None, errors: vec![], ..case(1, 1, &[]) });
    written[0].status = Status::Skipped;
    let mut journal = Journal::open(&path).unwrap();
    written.iter().for_each(|case| journal.append(case).unwrap());
    assert_eq!(read(&path).unwrap(), written);
    let header = fs::read_to_string(&path).unwrap();
    assert!(
        header.starts_with("scene,dimension,n,steps,h,k,dofs,elements,norm,error,floor,status")
    );
    fs::remove_file(&path).unwrap();
}

#[test]
fn a_torn_tail_is_dropped_at_every_byte_and_cut_on_reopening() {
    let path = file("torn");
    let first = case(4, 4, &[("V_max", 0.5)]);
    let second = case(8, 4, &[("V_max", 0.25), ("L2_max", 0.125)]);
    let mut journal = Journal::open(&path).unwrap();
    journal.append(&first).unwrap();
    let start = fs::metadata(&path).unwrap().len() as usize;
    journal.append(&second).unwrap();
    let whole = fs::read(&path).unwrap();
    for end in 0..whole.len() {
        fs::write(&path, &whole[..end]).unwrap();
        let cases = read(&path).unwrap();
        assert!(end < start || cases[0] == first);
        Journal::open(&path).unwrap().append(&second).unwrap();
        let cases = read(&path).unwrap();
        assert_eq!(cases.last(), Some(&second), "torn at byte {end}");
    }
    fs::remove_file(&path).unwrap();
}

#[test]
fn a_short_last_line_is_torn_and_one_before_it_is_an_error() {
    let path = file("short");
    Journal::open(&path).unwrap().append(&case(4, 4, &[("V_max", 0.5)])).unwrap();
    let good = fs::read_to_string(&path).unwrap();
    fs::write(&path, format!("{good}x,2,3\n")).unwrap();
    assert_eq!(read(&path).unwrap().len(), 1);
    let row = good.lines().nth(1).unwrap();
    fs::write(&path, format!("{good}x,2,3\n{row}\n")).unwrap();
    assert!(matches!(read(&path), Err(RecordError::Fields { line: 3, found: 3, .. })));
    assert!(Journal::open(&path).is_err());
    fs::write(&path, good.replace("0.25", "a quarter")).unwrap();
    assert!(matches!(read(&path), Err(RecordError::Changed { line: 2, .. })));
    let found = read_table(&path).unwrap();
    assert!(found.cases.is_empty() && found.changed == [2] && found.checked && !found.torn);
    // Without checksums a table is read, but not appended to.
    let bare: String =
        good.lines().map(|row| row.rsplit_once(',').unwrap().0.to_owned() + "\n").collect();
    fs::write(&path, &bare).unwrap();
    assert_eq!(read(&path).unwrap().len(), 1);
    assert!(!read_table(&path).unwrap().checked && Journal::open(&path).is_err());
    fs::write(&path, bare.replace("0.25", "a quarter")).unwrap();
    assert!(matches!(read(&path), Err(RecordError::Value { line: 2, column: "h", .. })));
    fs::remove_file(&path).unwrap();
}

#[test]
fn a_foreign_file_is_refused_and_left_alone() {
    let path = file("foreign");
    for text in ["notes", "h,k,error\n1,1,1\n"] {
        fs::write(&path, text).unwrap();
        assert!(matches!(Journal::open(&path), Err(RecordError::Header { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
    fs::remove_file(&path).unwrap();
}

#[test]
fn the_later_of_two_entries_wins_whole() {
    let path = file("later");
    let mut journal = Journal::open(&path).unwrap();
    let partial = case(4, 4, &[("V_max", 0.5)]);
    let full = case(4, 4, &[("V_max", 0.4), ("L2_max", 0.1)]);
    journal.append(&partial).unwrap();
    journal.append(&full).unwrap();
    assert_eq!(read(&path).unwrap(), vec![full]);
    let failed =
        CaseRecord { status: Status::Failed { reason: "no descent".into() }, ..partial.clone() };
    journal.append(&failed).unwrap();
    let last = read(&path).unwrap().remove(0);
    assert_eq!(last.status, Status::Failed { reason: String::new() });
    assert_eq!(last.errors, vec![NormError { error: None, ..failed.errors[0].clone() }]);
    fs::remove_file(&path).unwrap();
}

#[test]
fn sorted_by_key_and_norm_whatever_the_order_of_arrival() {
    let path = file("sorted");
    let a = case(8, 4, &[("mine", 1.0), ("L2_max", 0.1), ("V_max", 0.2)]);
    let b = case(4, 16, &[("V_max", 0.3)]);
    let c = case(4, 8, &[("V_max", 0.4)]);
    write_sorted(&path, &[a.clone(), b.clone(), c.clone()]).unwrap();
    let once = fs::read(&path).unwrap();
    write_sorted(&path, &[c, a, b]).unwrap();
    assert_eq!(fs::read(&path).unwrap(), once);
    let cases = read(&path).unwrap();
    let keys: Vec<_> = cases.iter().map(|case| (case.n, case.steps)).collect();
    assert_eq!(keys, [(Some(4), 8), (Some(4), 16), (Some(8), 4)]);
    assert_eq!(cases[2].norms().collect::<Vec<_>>(), ["V_max", "L2_max", "mine"]);
    fs::remove_file(&path).unwrap();
}

/// Rows of four cases with two norms, of a horizon of 2 and a graded grid, in every rotation of a shuffle.
#[test]
fn shuffled_rows_are_the_same_cases() {
    let path = file("shuffled");
    let written: Vec<CaseRecord> = [(4, 8), (4, 16), (8, 8), (8, 16)]
        .map(|(n, steps)| CaseRecord {
            // t_n = 2 (n/N)²: the last step is 2 (2N - 1)/N².
            k: 2.0 * f64::from(2 * steps - 1) / f64::from(steps * steps),
            seconds_total: f64::from(n * steps),
            ..case(n, steps, &[("V_max", 1.0 / f64::from(n)), ("L2_max", 0.1)])
        })
        .into();
    write_sorted(&path, &written).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    let mut rows: Vec<&str> = text.lines().skip(1).collect();
    for _ in 0..rows.len() {
        // The odd rows, then the even ones backwards: no two rows of a case side by side.
        let odd = rows.iter().skip(1).step_by(2);
        let shuffled: Vec<&str> = odd.chain(rows.iter().step_by(2).rev()).copied().collect();
        fs::write(&path, format!("{}{}\n", header(), shuffled.join("\n"))).unwrap();
        assert_eq!(read(&path).unwrap(), written);
        assert_eq!(read_finished(&path).unwrap(), written);
        rows.rotate_left(1);
    }
    fs::remove_file(&path).unwrap();
}

#[test]
fn a_line_break_in_a_name_is_refused() {
    let path = file("break");
    let mut journal = Journal::open(&path).unwrap();
    let broken = CaseRecord { scene: "a\nb".into(), ..case(1, 1, &[]) };
    assert!(matches!(journal.append(&broken), Err(RecordError::Name { .. })));
    fs::remove_file(&path).unwrap();
}
