//! Files of gmsh 4.15 (a block with a round foot and two layers) in both versions, and broken ones.

use super::*;

const V4: &str = include_str!("../../../tests/fixtures/block-4.1.msh");
const V2: &str = include_str!("../../../tests/fixtures/block-2.2.msh");

#[test]
fn both_versions_hold_the_same_domain() {
    let (four, two) = (read_gmsh(V4).unwrap(), read_gmsh(V2).unwrap());
    assert_eq!(four, two);
    assert_eq!(four.sides, ["foot", "right side", "left", "top"].map(String::from));
    assert_eq!(four.regions, ["layer", "body"].map(String::from));
    assert_eq!((four.vertices.len(), four.triangles.len(), four.edges.len()), (23, 32, 12));
    // Above y = 0.7 the body is a rectangle of 2 × 0.5.
    let upper: f64 = (0..32).filter(|&t| four.region[t] == 1).map(|t| four.area(t)).sum();
    assert!((upper - 1.0).abs() < 1e-9, "{upper}");
    // The foot bends: its four edges have four normals, all pointing down.
    let foot: Vec<[f64; 2]> =
        four.edges.iter().filter(|e| e.side == 0).map(|e| four.segment(e).1).collect();
    assert!(foot.len() == 4 && foot.windows(2).all(|pair| pair[0] != pair[1]));
    assert!(foot.iter().all(|normal| normal[1] < -0.7));
}

/// The text with one part replaced; it must stand there.
fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn broken_files_are_refused_with_line_and_value() {
    let cases = [
        (edited(V4, "4.1 0 8", "4.0 0 8"), 2, "version 4.0"),
        (edited(V4, "4.1 0 8", "4.1 1 8"), 2, "binary"),
        (edited(V4, "$MeshFormat", "$Mesh"), 1, "`$Mesh` where $MeshFormat should stand"),
        (edited(V2, "$Nodes\n23", "$Nodes\n-23"), 14, "`-23` where the number of nodes"),
        (edited(V2, "3 1 1.2 0", "3 1 one 0"), 17, "`one` where a coordinate should stand"),
        (edited(V2, "3 1 1.2 0", "3 1 nan 0"), 17, "`nan` where a coordinate should stand"),
        (edited(V2, "3 1 1.2 0", "3 1 1.2 0.5"), 17, "node 3 has z = 0.5"),
        (edited(V2, "4 -1 1.2 0", "3 -1 1.2 0"), 18, "node 3 is defined twice"),
        (edited(V2, "$Nodes\n23", "$Nodes\n24"), 38, "`$EndNodes` where the tag of a node"),
        (edited(V2, "1 1 2 1 1 1 7", "1 4 2 1 1 1 7 8 9"), 41, "type 4 (tetrahedron)"),
        (edited(V2, "1 1 2 1 1 1 7", "1 1 2 1 1 1 77"), 41, "there is no node 77"),
        (edited(V2, "1 1 2 1 1 1 7", "1 1 2 0 1 1 7"), 39, "belongs to no side"),
        (edited(V2, "1 1 2 1 1 1 7", "1 1 2 1 1 1 9"), 39, "does not bound the triangles"),
        (edited(V2, "13 2 2 5 1 1 7 18", "13 2 2 5 1 1 7 7"), 53, "has no area"),
        (edited(V4, "2 6 \"body\"", "2 5 \"body\""), 11, "physical group 5 is defined twice"),
        (edited(V4, "$EndEntities", "$EndEntity"), 0, "$EndEntities should stand"),
        (V2[..V2.len() / 2].to_string(), 0, "the file ends where"),
        (edited(V2, "$Elements", "$Others"), 0, "the end of a part should stand"),
        (
            edited(V2, "$PhysicalNames\n6", "$PhysicalNames\n99999999999999999999"),
            5,
            "number of names",
        ),
        (String::new(), 1, "the file ends where $MeshFormat"),
    ];
    for (text, line, message) in cases {
        let error = read_gmsh(&text).unwrap_err();
        assert!(error.to_string().contains(message), "{error}, not {message}");
        assert!(line == 0 || error.line == line, "{error}, not line {line}");
        assert!(error.span.end <= text.len() && text.is_char_boundary(error.span.start));
    }
}

/// Cut anywhere, or with any one word replaced, a file is read or refused, and nothing panics.
#[test]
fn no_damage_ends_in_a_panic() {
    for text in [V4, V2] {
        for end in (0..text.len()).step_by(7) {
            assert!(read_gmsh(&text[..end]).is_err() || end + 2 > text.trim_end().len());
        }
        let mut start = 0;
        for word in text.split_inclusive(char::is_whitespace) {
            let end = start + word.trim_end().len();
            for other in [
                "",
                "-1",
                "0",
                "99999999999999999999",
                "-9223372036854775808",
                "1e999",
                "\u{3bc}",
                "\"",
            ] {
                let damaged = format!("{}{other}{}", &text[..start], &text[end..]);
                let _ = read_gmsh(&damaged);
            }
            start += word.len();
        }
    }
}
