//! Files of gmsh 4.15 (a block with a round foot and two layers) in both versions, a frustum of two layers of tetrahedra
//! in both, and broken ones.

use super::*;

const V4: &str = include_str!("../../../../../tests/fixtures/block-4.1.msh");
const V2: &str = include_str!("../../../../../tests/fixtures/block-2.2.msh");

#[test]
fn both_versions_hold_the_same_domain() {
    let (four, two) = (read_gmsh(V4).unwrap(), read_gmsh(V2).unwrap());
    assert_eq!(four, two);
    assert_eq!(four.sides, ["foot", "right side", "left", "top"].map(String::from));
    assert_eq!(four.regions, ["layer", "body"].map(String::from));
    assert_eq!((four.vertices.len(), four.cells.len(), four.facets.len()), (23, 32, 12));
    // Above y = 0.7 the body is a rectangle of 2 × 0.5.
    let upper: f64 = (0..32).filter(|&t| four.region[t] == 1).map(|t| four.measure_of(t)).sum();
    assert!((upper - 1.0).abs() < 1e-9, "{upper}");
    // The foot bends: its four edges have four normals, all pointing down.
    let foot: Vec<[f64; 3]> =
        four.facets.iter().filter(|edge| edge.side == 0).map(|edge| edge.normal).collect();
    assert!(foot.len() == 4 && foot.windows(2).all(|pair| pair[0] != pair[1]));
    assert!(foot.iter().all(|normal| normal[1] < -0.7));
}

const SOLID_V4: &str = include_str!("../../../../../manufactured/frustum.msh");
const SOLID_V2: &str = include_str!("../../../../../tests/fixtures/frustum-2.2.msh");

#[test]
fn tetrahedra_of_both_versions_are_one_body() {
    let (four, two) = (read_gmsh(SOLID_V4).unwrap(), read_gmsh(SOLID_V2).unwrap());
    assert_eq!(four, two);
    let solid = four;
    assert_eq!(solid.sides, ["foot", "walls", "top"].map(String::from));
    assert_eq!(solid.regions, ["lower", "upper"].map(String::from));
    assert_eq!((solid.vertices.len(), solid.cells.len(), solid.facets.len()), (14, 24, 20));
    // Half of the tetrahedra in the file are negatively oriented.
    assert!((0..24).all(|c| solid.measure_of(c) > 0.0));
    // ∫ (0.8 + 0.2 y)² over (0, 1/2) and (1/2, 1), by hand.
    for (region, expected) in [(0, (0.729 - 0.512) / 0.6), (1, (1.0 - 0.729) / 0.6)] {
        let of_region = (0..24).filter(|&c| solid.region[c] == region);
        let volume: f64 = of_region.map(|c| solid.measure_of(c)).sum();
        assert!((volume - expected).abs() < 1e-12, "{region}: {volume}");
    }
    // Each of the four walls is one plane, and so are foot and top.
    let of_side = |side: u32| {
        let mut normals: Vec<[f64; 3]> = Vec::new();
        for face in solid.facets.iter().filter(|face| face.side == side) {
            if !normals.contains(&face.normal) {
                normals.push(face.normal);
            }
        }
        normals.len()
    };
    assert_eq!([0, 1, 2].map(of_side), [1, 4, 1]);
}

/// The upper layer with the other diagonal on the interface: two layers that do not meet face to face, and one with a
/// vertex in the middle of the interface.
#[test]
fn layers_that_do_not_meet_are_refused() {
    let other = edited(SOLID_V2, " 5 6 7 14", " 5 6 8 14");
    let other = edited(&other, " 5 7 8 14", " 6 7 8 14");
    let error = read_gmsh(&other).unwrap_err().to_string();
    assert!(error.contains("lies on another one of the boundary"), "{error}");
    // Node 15 halves the edge 5-7 of the interface for the upper layer alone.
    let [p, q] = [5, 7].map(|tag| {
        let line = SOLID_V2.lines().find(|line| line.starts_with(&format!("{tag} "))).unwrap();
        line.split(' ').skip(1).map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>()
    });
    let middle: Vec<String> = (0..3).map(|i| (0.5 * (p[i] + q[i])).to_string()).collect();
    let node = format!("15 {}\n$EndNodes", middle.join(" "));
    let text = edited(SOLID_V2, "$Nodes\n14", "$Nodes\n15").replace("$EndNodes", &node);
    let text = text.replace(" 5 6 7 14", " 5 6 15 14").replace(" 5 7 8 14", " 5 15 8 14");
    let count = SOLID_V2.split("$Elements\n").nth(1).unwrap().lines().next().unwrap();
    let more = format!("$Elements\n{}", count.parse::<u32>().unwrap() + 2);
    let text = text.replace(&format!("$Elements\n{count}"), &more);
    let text =
        text.replace("$EndElements", "98 4 2 5 5 15 6 7 14\n99 4 2 5 5 15 7 8 14\n$EndElements");
    let error = read_gmsh(&text).unwrap_err();
    assert!(error.to_string().contains("hangs on the face"), "{error}");
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
        (edited(V2, "3 1 1.2 0", "3 1 1.2 0.5"), 17, "node 3 has z = 0.5, and the first one z = 0"),
        (edited(V2, "4 -1 1.2 0", "3 -1 1.2 0"), 18, "node 3 is defined twice"),
        (edited(V2, "$Nodes\n23", "$Nodes\n24"), 38, "`$EndNodes` where the tag of a node"),
        (edited(V2, "1 1 2 1 1 1 7", "1 5 2 1 1 1 7 8 9"), 41, "type 5 (hexahedron)"),
        (edited(V2, "1 1 2 1 1 1 7", "1 4 2 1 1 1 7 8 9"), 41, "has no volume"),
        (edited(V2, "1 1 2 1 1 1 7", "1 1 2 1 1 1 77"), 41, "there is no node 77"),
        (edited(V2, "1 1 2 1 1 1 7", "1 1 2 1 1 1 9"), 41, "does not bound the domain"),
        (edited(V2, "13 2 2 5 1 1 7 18", "13 2 2 5 1 1 7 7"), 53, "has no area"),
        (edited(V4, "2 6 \"body\"", "2 5 \"body\""), 11, "physical group 5 is defined twice"),
        (edited(V4, "$EndEntities", "$EndEntity"), 0, "$EndEntities should stand"),
        (V2[..V2.len() / 2].to_string(), 0, "the file ends where"),
        (edited(V2, "$Elements", "$Others"), 0, "the end of a part is expected"),
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
    for text in [V4, V2, SOLID_V4, SOLID_V2] {
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
