//! The command from outside: exit codes, files, keys.

use crate::program::{Folder, code, ends, json, refuses, stdout, sweep};

#[test]
fn a_ladder_is_a_table_and_three_files() {
    let folder = Folder::new("extremes");
    let out = folder.argument("out");
    let output = ends(0, &["extremes", "one-vertex", "step-falling", "--out", &out]);
    let printed = stdout(&output);
    assert!(printed.contains("and every one holds"), "{printed}");
    let csv = folder.read("out/one-vertex-step-falling-extremes-claims.csv");
    assert!(csv.starts_with("line,says,n,steps,level,at,left,"), "{csv}");
    let of = |ladder: &str| csv.lines().filter(|line| line.starts_with(ladder)).count();
    assert_eq!([of("one-vertex,"), of("step-falling,")], [8, 9], "{csv}");
    let svg = folder.read("out/one-vertex-step-falling-extremes.svg");
    assert!(svg.contains("step-falling") && svg.contains("refused as expected"));
    let document = folder.json("out/one-vertex-step-falling-extremes.json");
    assert_eq!(document["ladders"].as_array().map(Vec::len), Some(2));
}

#[test]
fn json_has_its_keys_and_an_unknown_ladder_is_refused() {
    let output = ends(0, &["extremes", "step-lambda", "--json"]);
    let document = json(&output);
    let claims = document["claims"].as_array().expect("claims");
    let refused = claims.iter().find(|claim| claim["relation"] == "refused").expect("a refusal");
    assert_eq!(refused["standing"], "pass", "{refused}");
    assert!(refused["left"].is_null() && refused["line"] == "step-lambda");
    assert!(document["ladders"][0]["why"].as_str().is_some_and(|why| why.contains("(3.15)")));
    refuses(&["extremes", "stairs"], &["no ladder `stairs`; there are unit-length"]);
    let listed = sweep(&["extremes", "--list"]);
    assert!(code(&listed) == 0 && stdout(&listed).contains("unit-stiffness"));
}
