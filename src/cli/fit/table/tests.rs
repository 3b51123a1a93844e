//! Files of several origins.

use super::*;

fn groups(name: &str, text: &str) -> Result<Vec<Group>, String> {
    let path = std::env::temp_dir().join(format!("gronwall-{name}-{}.csv", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let read = read(&path).map_err(|error| error.to_string());
    std::fs::remove_file(&path).unwrap();
    read
}

#[test]
fn rows_of_one_scene_and_norm_are_a_table() {
    let text = "scene,norm,h,k,error,status\n\
        a,V,0.5,1,1.0,converged\n\
        b,V,0.5,1,2.0,converged\n\
        a,L,0.5,1,3.0,converged\n\
        a,V,0.25,1,4.0,converged\n\
        a,,0.125,1,,failed\n";
    let read = groups("groups", text).unwrap();
    let names: Vec<String> = read.iter().filter_map(Group::heading).collect();
    assert_eq!(names, ["a V", "b V", "a L"]);
    let errors: Vec<f64> = read[0].points().iter().map(|point| point.error).collect();
    assert_eq!(errors, [1.0, 4.0]);
    // The failed case is a gap in both norms of its scene, and in no other scene.
    let gap = Some("line 6: the case is failed".to_owned());
    assert_eq!(read[0].gaps_in_words(), gap);
    assert_eq!(read[2].gaps_in_words(), gap);
    assert_eq!(read[1].gaps_in_words(), None);
    assert!(read[0].refined(Direction::Space) && !read[0].refined(Direction::Time));
}

#[test]
fn the_longest_line_is_taken_and_the_finest_of_several() {
    let grid = "h,k,error\n0.5,0.1,1\n0.25,0.1,2\n0.5,0.05,3\n0.25,0.05,4\n0.5,0.2,5\n";
    let read = groups("lines", grid).unwrap();
    let errors = |direction| -> Vec<f64> {
        read[0].line(direction).iter().map(|point| point.error).collect()
    };
    assert_eq!(errors(Direction::Space), [3.0, 4.0]);
    assert_eq!(errors(Direction::Time), [1.0, 3.0, 5.0]);
    let rounded = "h,k,error\n0.5,0.3333333333,1\n0.25,0.33333333334,2\n0.125,0.33333333333,3\n";
    assert_eq!(groups("rounded", rounded).unwrap()[0].line(Direction::Space).len(), 3);
    let single = groups("single", "H, Error\n0.5,1\n0.25,2\n").unwrap();
    assert_eq!(single[0].line(Direction::Space).len(), 2);
    assert!(single[0].line(Direction::Time).is_empty());
}

#[test]
fn gaps_are_named_with_their_lines() {
    let text = "h,k,error,floor\n0.5,1,nan,\n,1,1,\n0.25,1,,\n0.125,1,1,-1\n0.1,1,1,\n";
    let read = groups("gaps", text).unwrap();
    assert_eq!(read[0].points().len(), 1);
    assert_eq!(
        read[0].gaps_in_words().unwrap(),
        "line 2: the error NaN is no error; line 3: no h; line 4: no error; and 1 more"
    );
    let values = groups("values", "h,value\n0.5,-1\n0.25,inf\n0.125,\n0.1,0\n").unwrap();
    assert_eq!(values[0].quantity, Quantity::Value);
    assert_eq!(values[0].points().len(), 2);
    assert_eq!(
        values[0].gaps_in_words().unwrap(),
        "line 3: the value inf is no number; line 4: no value"
    );
}

#[test]
fn what_is_no_table_is_refused() {
    let cases = [
        ("h,e\n1,1\n", "no column `error` (or `value`)"),
        ("x,error\n1,1\n", "no column `h` and no column `k`"),
        ("h,error,value\n1,1,1\n", "both `error` and `value`"),
        ("h,error\n", "no rows below the header"),
        ("h,error\n1,1\n1\n", "line 3: 1 field, the header has 2"),
        ("h,error\n1,x\n", "line 2: `x` is not a number"),
        ("h,error\n0,1\n", "line 2: h = 0 is no step size"),
        ("h,k,error\n1,-2,1\n", "line 2: k = -2 is no step size"),
        ("h,error\nnan,1\n", "line 2: h = NaN is no step size"),
        ("h,error\ninf,1\n", "line 2: h = inf is no step size"),
    ];
    for (text, words) in cases {
        let refused = groups("refused", text).map(|_| ()).unwrap_err();
        assert!(refused.contains(words), "{refused}");
    }
}
