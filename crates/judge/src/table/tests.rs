//! Tables of several origins.

use super::*;
use crate::fit::Direction;

fn tables(text: &str, dimension: Option<u32>) -> Result<Tables, String> {
    read(text.as_bytes(), &Reading { dimension, ..Reading::default() })
        .map_err(|error| error.to_string())
}

fn groups(text: &str) -> Vec<Group> {
    tables(text, None).unwrap().groups
}

fn plain(text: &str, dimension: Option<u32>) -> Vec<(String, Vec<(f64, f64)>)> {
    let groups = tables(text, dimension).unwrap().groups;
    let pair =
        |point: crate::fit::Point| (if point.h.is_nan() { point.k } else { point.h }, point.error);
    let all = |group: &Group| group.points().into_iter().map(pair).collect();
    groups.iter().map(|group| (group.norm.clone().unwrap_or_default(), all(group))).collect()
}

#[test]
fn every_separator_gives_one_table() {
    let wanted = [("L2", [(0.5, 0.1), (0.25, 0.025)]), ("H1", [(0.5, 1.0), (0.25, 0.5)])];
    let wanted = wanted.map(|(name, points)| (name.to_owned(), points.to_vec()));
    let texts = [
        "h,L2,H1\n0.5,0.1,1\n0.25,0.025,0.5\n",
        "h;L2;H1\n0.5;0.1;1\n0.25;0.025;0.5\n",
        "h\tL2\tH1\n0.5\t0.1\t1\n0.25\t0.025\t0.5\n",
        "  h     L2   H1\n  0.5  1.0e-01  1\n\n  1/4  2.5D-02  .5\n",
        "h L2 H1\n5,000D-01 1.0D-01 1\n2,500D-01 2.5D-02 .5\n",
        "# made by a program\n# h L2 H1\n0.5 0.1 1\n0.25 0.025 0.5\n",
        "% h, L2, H1\n0.5, 0.1, 1\n0.25, 0.025, 0.5\n",
        "| h | L2 | rate | H1 |\n|---|:--:|---|---|\n| 0.5 | 0.1 | - | 1 |\n| 0.25 | 0.025 | 2.00 | 0.5 |\n",
        "+------+-------+-----+\n| h    | L2    | H1  |\n+======+=======+=====+\n| 0.5  | 0.1   | 1   |\n| 2^-2 | 0.025 | 0.5 |\n+------+-------+-----+\n",
        "\\begin{tabular}{ccc}\n\\hline\n$h$ & $L_2$ & $H^1$ \\\\ \\hline\n$0.5$ & $1.0\\times 10^{-1}$ & 1 \\\\\n0.25 & \\num{2.5e-2} & \\textbf{0.5} \\\\\n\\hline\n\\end{tabular}\n",
        "h = 0.5, L2 = 0.1, H1 = 1\nh = 0.25, L2 = 0.025, H1 = 0.5, rate = 2.0\n",
    ];
    for text in texts {
        let mut found = plain(text, None);
        for (name, _) in &mut found {
            name.retain(|c| !"$_^".contains(c));
        }
        assert_eq!(found, wanted, "{text}");
    }
}

/// Layouts of deal.II's ConvergenceTable: names of two words, unnamed rates, counters, and `n cells` for one or two
/// columns.
#[test]
fn unnamed_rates_stand_behind_their_norms() {
    let two = "n cells         H1                   L2\n0   16 1.0 - - 0.1 - -\n1   64 0.5 2.0 1.0 0.025 4.0 2.0\n";
    let one =
        "n cells    H1             L2\n   16 1.0 - - 0.1 - -\n   64 0.5 2.0 1.0 0.025 4.0 2.0\n";
    for text in [two, one] {
        let dimension = Some(2);
        let found = plain(text, dimension);
        let wanted = [("H1", [(0.25, 1.0), (0.125, 0.5)]), ("L2", [(0.25, 0.1), (0.125, 0.025)])];
        assert_eq!(found, wanted.map(|(n, p)| (n.to_owned(), p.to_vec())), "{text}");
    }
    let words = "cells dofs   val L2    grad L2  val L2-post\n16 99 0.1 - 1.0 - 0.2 -\n64 400 0.025 2.0 0.5 1.0 0.1 1.0\n";
    let names: Vec<String> = plain(words, Some(2)).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["val L2", "grad L2", "val L2-post"]);
}

#[test]
fn sizes_follow_from_numbers_and_counts() {
    let first = |text: &str, dimension| plain(text, dimension)[0].1[0].0;
    assert_eq!(first("n,error\n8,1\n16,0.5\n", None), 0.125);
    assert_eq!(first("N,error\n8,1\n16,0.5\n", None), 0.125);
    assert_eq!(first("steps,error\n8,1\n16,0.5\n", None), 0.125);
    assert_eq!(first("dofs,error\n64,1\n512,0.5\n", Some(3)), 0.25);
    // Cells before unknowns, lengths before both.
    assert_eq!(first("dofs,cells,error\n64,16,1\n", Some(2)), 0.25);
    assert_eq!(first("dofs,h,error\n64,0.3,1\n", Some(2)), 0.3);
    assert!(tables("dofs,error\n64,1\n", None).unwrap_err().contains("1: the mesh is known by"));
}

#[test]
fn runs_at_one_level_are_one_point_with_a_spread() {
    let groups = |text: &str| {
        let reading = Reading { runs: true, ..Reading::default() };
        read(text.as_bytes(), &reading).unwrap().groups
    };
    let text = "h,error\n0.5,1\n0.5,4\n0.25,1\n0.25,1\n";
    let found = groups(text)[0].measurements();
    assert_eq!(found.len(), 2);
    // Mean of logarithms; two levels of two runs: squares 2 ln²2 over two degrees of freedom, over two runs.
    assert!((found[0].0.error - 2.0).abs() < 1e-14);
    let sigma = found[0].1.unwrap();
    assert!((sigma - 2f64.ln() / 2f64.sqrt()).abs() < 1e-14, "{sigma}");
    let equal = groups("h,error\n0.5,1\n0.5,1\n0.25,1\n")[0].measurements();
    assert_eq!((equal.len(), equal[0].1), (2, None));
    let given = groups("h,error,sigma\n0.5,2,0.1\n0.25,1,0.2\n")[0].measurements();
    assert_eq!([given[0].1, given[1].1], [Some(0.05), Some(0.2)]);
    let values = groups("h,value\n0.5,1\n0.5,4\n0.25,1\n")[0].measurements();
    assert_eq!((values[0].0.error, values[0].1), (2.5, None));
}

#[test]
fn rows_of_one_scene_and_norm_are_a_table() {
    let text = "scene,norm,h,k,error,status\n\
        a,V,0.5,1,1.0,converged\n\
        b,V,0.5,1,2.0,converged\n\
        a,L,0.5,1,3.0,converged\n\
        a,V,0.25,1,4.0,converged\n\
        a,,0.125,1,,failed\n";
    let read = groups(text);
    let names: Vec<String> = read.iter().filter_map(Group::heading).collect();
    assert_eq!(names, ["a V", "b V", "a L"]);
    let errors: Vec<f64> = read[0].points().iter().map(|point| point.error).collect();
    assert_eq!(errors, [1.0, 4.0]);
    // The failed case is a gap in both norms of its scene only.
    let gap = Some("line 6: the case is failed".to_owned());
    assert_eq!(read[0].gaps_in_words(), gap);
    assert_eq!(read[2].gaps_in_words(), gap);
    assert_eq!(read[1].gaps_in_words(), None);
    assert!(read[0].refined(Direction::Space) && !read[0].refined(Direction::Time));
}

#[test]
fn the_longest_line_is_taken_and_the_finest_of_several() {
    let grid = "h,k,error\n0.5,0.1,1\n0.25,0.1,2\n0.5,0.05,3\n0.25,0.05,4\n0.5,0.2,5\n";
    let read = groups(grid);
    let errors = |direction| -> Vec<f64> {
        read[0].line(direction).iter().map(|(point, _)| point.error).collect()
    };
    assert_eq!(errors(Direction::Space), [3.0, 4.0]);
    assert_eq!(errors(Direction::Time), [1.0, 3.0, 5.0]);
    let rounded = "h,k,error\n0.5,0.3333333333,1\n0.25,0.33333333334,2\n0.125,0.33333333333,3\n";
    assert_eq!(groups(rounded)[0].line(Direction::Space).len(), 3);
    let single = groups("H, Error\n0.5,1\n0.25,2\n");
    assert_eq!(single[0].line(Direction::Space).len(), 2);
    assert!(single[0].line(Direction::Time).is_empty());
}

#[test]
fn gaps_are_named_with_their_lines() {
    let text = "h,k,error,floor\n0.5,1,nan,\n,1,1,\n0.25,1,-,\n0.125,1,1,-1\n0.1,1,1,\n";
    let read = groups(text);
    assert_eq!(read[0].points().len(), 1);
    assert_eq!(
        read[0].gaps_in_words().unwrap(),
        "line 2: the error NaN is no error; line 3: no h; line 4: no error; and 1 more"
    );
    let sigmas = groups("h,error,sigma\n0.5,1,nan\n0.25,1,0\n0.2,1,11\n0.1,1,0.1\n");
    assert_eq!(
        sigmas[0].gaps_in_words().unwrap(),
        "line 2: sigma NaN is no standard deviation; line 3: sigma 0.0 is no standard deviation; line 4: the relative standard deviation 11.0 is none: it is positive and at most 10; 0.01 is 1 %"
    );
    let values = groups("h,value\n0.5,-1\n0.25,inf\n0.125,\n0.1,0\n");
    assert_eq!(values[0].quantity, Quantity::Value);
    assert_eq!(values[0].points().len(), 2);
    assert_eq!(
        values[0].gaps_in_words().unwrap(),
        "line 3: the value inf is no number; line 4: no value"
    );
    let wide = groups("h,L2,H1\n0.5,1,-\n0.25,2,3\n");
    assert_eq!([wide[0].points().len(), wide[1].points().len()], [2, 1]);
}

#[test]
fn what_is_no_table_is_refused() {
    let cases = [
        ("h,x\n1,1\n", "1: no column of errors among `x`: --p x=2 makes `x` one"),
        ("x,error\n1,1\n", "1: no column of sizes: --ratio 2 if each row halves the step"),
        ("M,S\n1,0.5\n2,0.1\n4,0.02\n", "1: no column of errors among `M`, `S`"),
        ("Re,error\n100,0.1\n200,0.2\n400,0.4\n", "1: no column of sizes"),
        ("n,time\n1,0.9\n2,0.4\n4,0.2\n", "1: no column of errors"),
        ("n,S\n1,9\n2,4\n4,2\n", "1: no column of errors among `S`"),
        ("n,S,T\n1,0.9,0.5\n2,0.1,0.6\n4,0.03,0.4\n", "1: no column of errors among `S`, `T`"),
        ("grid,error\n20x40,1\n40x40,2\n", "2: grid = 20x40 is no mesh of the shape of the others"),
        ("h,error\n", "1: no table"),
        ("", "1: no table"),
        ("0.5,1\n0.25,2\n", "1: no header"),
        ("h,error\n1,1\n1\n", "3: 1 field, the header has 2"),
        ("h,error\n0,5,0,1\n", "2: 4 fields, the header has 2; decimal commas"),
        ("h;error\n0,5;1\n0.25;1\n", "2: `0,5` has a decimal comma, other numbers of h a point"),
        ("h error\n1,234 1\n", "2: `1,234` may be 1234 or 1.234: write one of them"),
        ("n,error\n0.5,1\n", "2: n = 0.5 is no whole number"),
        ("level,error\n1,1\n2.5,1\n", "3: level = 2.5 is no level"),
        ("h,error\n0.5,1\n0.5,2\n0.25,1\n", "3: the level of line 2 comes again: --runs"),
        ("k,error\n1,1\n2,1\n3,1\n", "1: `k` is 1, 2, 3, ...: is it a counter?"),
        (
            "level,N,error\n1,4,1\n2,16,1\n3,64,1\n",
            "3: two columns of sizes disagree: `N` and `level`",
        ),
        ("h,error\n1ms,1\n2s,1\n", "3: `2s`: h has numbers of two units"),
        ("h,error\n0.5,1\nfoo\n0.25,1\n", "3: 1 field, the header has 2"),
        ("h,error\n1,x\n", "2: error = `x` is not a number"),
        ("h,error\n0,1\n", "2: h = 0 is no step size"),
        ("h,k,error\n1,-2,1\n", "2: k = -2 is no step size"),
        ("h,error\nnan,1\n", "2: h = NaN is no step size"),
        ("h,error\ninf,1\n", "2: h = inf is no step size"),
        ("n,error\n0,1\n", "2: n = 0 is no step size"),
    ];
    for (text, words) in cases {
        let refused = tables(text, None).map(|_| ()).unwrap_err();
        assert!(refused.starts_with(words) || refused.contains(words), "{text}: {refused}");
    }
    for (text, words) in [
        ("h,error,h\n1,1,2\n", "1: a column stands twice: `h` is column 1, `h` column 3"),
        ("h,error,err\n1,1,1\n", "`error` is column 2, `err` column 3"),
        ("h,error,floor,floor\n1,1,0,1\n", "`floor` is column 3"),
        ("h,L2,L2\n1,1,1\n", "`L2` is column 2, `L2` column 3"),
        ("h,dx,L2\n1,1,1\n1,0.5,1\n", "3: two columns of sizes disagree: `h` and `dx`"),
        ("dx,h,L2\n1,1,1\n1,0.5,1\n", "3: two columns of sizes disagree: `h` and `dx`"),
        ("tau,dt,L2\n1,1,1\n0.5,1,1\n", "3: two columns of sizes disagree: `dt` and `tau`"),
        ("n,N,L2\n1,8,1\n2,32,1\n", "3: two columns of sizes disagree: `n` and `N`"),
    ] {
        let refused = tables(text, None).map(|_| ()).unwrap_err();
        assert!(refused.contains(words), "{text}: {refused}");
    }
    // Sizes of two kinds in one ratio, of two digits; rates and norms of other names.
    let fine = "h,hmax,L2,rate,H1,rate\n0.25,0.35,1,-,1,-\n0.12,0.18,1,0,1,0\n";
    assert_eq!(groups(fine)[0].points()[1].h, 0.12);
    let binary = read(b"h,error\n\xff,1\n", &Reading::default()).unwrap_err();
    assert_eq!((binary.line, binary.to_string().contains("not UTF-8")), (2, true));
    // A line of a log that names nothing took minutes.
    let long = format!("{}\n\nh error\n0.5 1\n0.25 1\n", "mean 3.91 ".repeat(1700));
    assert_eq!(groups(&long)[0].points().len(), 2);
    // Beside known norms, an unknown column is named and left out.
    let said = tables("h,L2,colour\n1,1,7\n", None).unwrap().said;
    assert_eq!(said, ["read 1 row: h from `h`, errors `L2`; left out: `colour`"]);
}

/// Found by tests/fuzz/tables.py: each was read as something else, or left out without a word.
#[test]
fn torn_and_mixed_texts_are_read_as_a_person_reads_them() {
    let sized = |text: &str, asked: &Reading| {
        let tables = read(text.as_bytes(), asked).unwrap();
        let points = tables.groups.iter().flat_map(Group::points);
        (points.map(|p| (p.h, p.error)).collect::<Vec<_>>(), tables.said.join("\n"))
    };
    let plain = Reading::default();
    // `dofs energy` is no name, nor `4  0` that of a row.
    let commas = "dofs    energy\n   4  0,000399937\n  16  4,63776e-06\n";
    let asked = Reading { dimension: Some(2), ..Reading::default() };
    assert_eq!(sized(commas, &asked).0, [(0.5, 0.000399937), (0.25, 4.63776e-6)]);
    let asked = Reading { ratio: Some(2.0), ..Reading::default() };
    assert_eq!(sized(commas, &asked).0, [(1.0, 0.000399937), (0.5, 4.63776e-6)]);
    let torn = "level _h||  L2\n0 0.1 0.4\n1 0.02 0.1\n";
    assert_eq!(sized(torn, &plain).0[2..], [(1.0, 0.4), (0.5, 0.1)]);
    // LaTeX that has lost its ends of lines.
    let bare = "scheme & n & error\ne & 2 & 1\ne & 4 & 0.5\nf & 2 & 1\nf & 4 & 0.4\n";
    let asked = Reading { ratio: Some(2.0), runs: true, ..Reading::default() };
    assert!(sized(bare, &asked).1.starts_with("read 4 rows: h from `n`, errors `error`"));
    let titled = "L2 errors\n   N   error\n1   8 0.016\n2  16 0.004\n";
    assert_eq!(sized(titled, &plain).0, [(0.125, 0.016), (0.0625, 0.004)]);
    // `#` names the column that counts.
    let counted = "#\tlevel\tenergy\trate\n1\t0\t0.1\t\n2\t1\t0.025\t2\n";
    assert_eq!(sized(counted, &plain).0, [(1.0, 0.1), (0.5, 0.025)]);
    // A row that has lost two cells is not one without rates.
    let torn = "h,L2,rate,H1,rate\n0.5,0.1,-,1,-\n0.25,0.025,2\n";
    for text in [torn.to_owned(), format!("{torn}0.125,0.006,2,0.25,1\n")] {
        assert!(tables(&text, None).unwrap_err().starts_with("3: 3 fields, the header has 5"));
    }
    let torn = "| h | L2 |\n| 1 | 1 |\n| 0.5 | 0.5 |\n| 0.25 0.25 |\n";
    assert!(tables(torn, None).unwrap_err().starts_with("4: 1 field, the header has 2"));
    // Tables of two kinds, rows that are taken out, and a torn row below the last.
    let said = |text: &str| sized(text, &plain).1;
    let blanks = "h error\n0.5 1\n0.25 0.5\n";
    for (text, words) in [
        (
            format!("h|L2\n1|1\n0.5|0.5\n\nn,H1\n2,1\n4,0.5\n\n{blanks}"),
            "; not read: the rows of line 6",
        ),
        (format!("{blanks}\nh|L2\n1|1\n"), "; not read: the rows of line 2"),
        (format!("{blanks}run3 of a b 0.125 0.2\n"), "; left out: line 4"),
        ("h,L2\n1,1\n0.5,0.5\n\"0.25,0.25\n".into(), "; left out: line 4"),
        ("h,L2\n1,1\n# 0.5,0.5,7\n0.25,0.25\n".into(), "; left out: line 3"),
        (
            "| h | L2 |\n| 1 | 1 |\n| 0.5 | 0.5 |\ne| 0.25 | 0.25 |\n".into(),
            "; not read: the rows of line 4",
        ),
    ] {
        assert!(said(&text).ends_with(words), "{text}: {}", said(&text));
    }
    // What MATLAB and pandas print, and the size at the end of a sentence.
    let printed =
        "h =\n\n    0.5000    0.2500\n\nerr =\n\n   1.0e-02 *\n\n    4.0000    1.0000\n\n";
    assert_eq!(sized(printed, &plain).0, [(0.25, 0.01), (0.5, 0.04)]);
    let unnamed = tables("ans =\n\n    0.5000    0.0400\n    0.2500    0.0100\n", None);
    assert!(unnamed.unwrap_err().contains(": no header"));
    let indexed = "          h     L2  rate\nscheme                  \nCN      0.5   0.04   NaN\nCN      0.25  0.01   2.0\nBE      0.5   0.4    NaN\nBE      0.25  0.2    1.0\n";
    assert!(said(indexed).contains("errors `L2`; a table for each `scheme`"), "{}", said(indexed));
    let run = "Running with N = 2\nL2 error: 0.04\nRunning with N = 4\nL2 error: 0.01\n";
    assert_eq!(sized(run, &plain).0, [(0.5, 0.04), (0.25, 0.01)]);
    let asked = Reading { errors: vec!["L2".into()], ..Reading::default() };
    let named = "h,x,||u - u_h||_L2,rate L2\n0.5,1,0.04,-\n0.25,1,0.01,2\n";
    assert_eq!(sized(named, &asked).0, [(0.5, 0.04), (0.25, 0.01)]);
    // A program that is run three times.
    let again = "h error\n0.5 1\n\nh error\n0.25 0.25\n\nh error\n0.125 0.0625\n";
    assert_eq!(said(again), "read 3 rows: h from `h`, errors `error`");
}

/// What a fuzzed text met first.
#[test]
fn a_cell_that_spans_nothing_is_a_cell() {
    let rows = "\\multicolumn{0}{c}{h} & L2 \\\\\n0.5 & 0.1 \\\\\n0.25 & 0.025 \\\\\n";
    assert_eq!(groups(rows)[0].rows.len(), 2);
}

#[test]
fn a_norm_finds_its_column_in_typeset_form() {
    assert_eq!(named("H1", &["h", "|u-u_h|_{L^2}", "|u-u_h|_{H^1}"]), Ok(2));
    assert!(named("H1", &["h", "|u-u_h|_{L^2}"]).is_err());
}

#[test]
fn values_under_a_name_of_errors_are_refused() {
    let log = "h = 0.1, max deflection uz = -3.4121\nh = 0.05, max deflection uz = -3.5712\nh = 0.025, max deflection uz = -3.6115\n";
    let said = tables(log, None).err().unwrap_or_default();
    assert!(said.contains("`max deflection uz` seems to hold values, not errors"), "{said}");
    let asked = Reading { errors: vec!["max deflection uz".into()], ..Reading::default() };
    assert!(read(log.as_bytes(), &asked).is_ok());
    // Beside errors values are left out, and an error that stagnates stays one.
    let both = "h max_stress L2\n0.1 11.2 9.6\n0.05 12.1 2.6\n0.025 12.3 0.7\n";
    let found = plain(both, None);
    assert!(found.len() == 1 && found[0].1[2] == (0.025, 0.7), "{found:?}");
    assert!(tables("h,L2\n0.1,0.024\n0.05,0.0238\n0.025,0.0237\n", None).is_ok());
}
