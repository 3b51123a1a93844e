//! Tables of several origins.

use super::*;
use fit::Direction;

fn tables(text: &str, dimension: Option<u32>) -> Result<Tables, String> {
    read(text.as_bytes(), &Reading { dimension, ..Reading::default() })
        .map_err(|error| error.to_string())
}

fn groups(text: &str) -> Vec<Group> {
    tables(text, None).unwrap().groups
}

fn plain(text: &str, dimension: Option<u32>) -> Vec<(String, Vec<(f64, f64)>)> {
    let groups = tables(text, dimension).unwrap().groups;
    let pair = |point: fit::Point| (if point.h.is_nan() { point.k } else { point.h }, point.error);
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
fn torn_bytes_and_long_lines_are_met() {
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

#[test]
fn a_norm_finds_its_column_in_typeset_form() {
    assert_eq!(named("H1", &["h", "|u-u_h|_{L^2}", "|u-u_h|_{H^1}"]), Ok(2));
    assert!(named("H1", &["h", "|u-u_h|_{L^2}"]).is_err());
}
