//! Polygons, mesh files and graded meshes: what is taken, and what is refused with which words.

use super::good::{EXACT, LOADED, refused};
use crate::scene::{MeshFamily, Scene, Shape, Side, Source};

const RECTANGLE: &str = "shape = \"rectangle\"\nsize = [1.0, 0.5]";
const CORNERS: &str = "vertices = [[0, 0], [2, 0], [2, 1], [0, 1]]";
const NAMES: &str = "sides = [\"bottom\", \"right\", \"top\", \"left\"]";

/// The good scene with another shape.
fn shaped(shape: &str) -> String {
    assert!(LOADED.contains(RECTANGLE));
    LOADED.replace(RECTANGLE, shape)
}

fn polygon(corners: &str, names: &str) -> String {
    shaped(&format!("shape = \"polygon\"\n{corners}\n{names}"))
}

fn accepted(text: &str) -> Scene {
    Scene::from_source(Source::from_text("block.toml", text))
        .unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_polygon_has_its_sides_and_meshes() {
    let scene = accepted(&polygon(CORNERS, NAMES));
    let domain = &scene.as_contact().unwrap().domain;
    assert_eq!(
        (domain.dimension(), domain.measure(), domain.size.clone()),
        (2, 2.0, vec![2.0, 1.0])
    );
    assert_eq!(domain.contact, [Side(0)]);
    assert_eq!(domain.faces(Side(1))[0].normal, [1.0, 0.0, 0.0]);
    // Two triangles, and h is their diagonal.
    let mesh = domain.mesh(4);
    assert_eq!((mesh.cell_count(), mesh.h()), (32, 5f64.sqrt() / 4.0));
    assert_eq!(domain.h(4), mesh.h());
    assert_eq!(mesh.sides, domain.sides);
    // Without names, s1, s2, …; several edges may share one.
    let unnamed = polygon(CORNERS, "").replace("\"bottom\"", "\"s1\"").replace("\"top\"", "\"s3\"");
    accepted(&unnamed.replace("\"left\", \"right\"", "\"s2\", \"s4\"").replace("left =", "s4 ="));
    let walls = polygon(CORNERS, "sides = [\"bottom\", \"left\", \"top\", \"left\"]");
    let scene = accepted(&walls.replace("[\"left\", \"right\"]", "[\"left\"]"));
    assert_eq!(scene.as_contact().unwrap().domain.faces(Side(1)).len(), 2);
}

#[test]
fn a_coarse_triangulation_may_be_given() {
    let fan = "points = [[0.5, 0.4]]\ntriangles = [[0, 1, 4], [1, 2, 4], [4, 3, 2], [3, 0, 4]]";
    let scene = accepted(&polygon(CORNERS, &format!("{NAMES}\n{fan}")));
    let domain = &scene.as_contact().unwrap().domain;
    assert_eq!((domain.mesh(1).cell_count(), domain.measure()), (4, 2.0));
}

#[test]
fn what_is_no_polygon_is_refused() {
    let cases = [
        ("vertices = [[0, 0], [2, 1], [2, 0], [0, 1]]", NAMES, "crosses or touches itself"),
        ("vertices = [[0, 0], [0, 1], [2, 1], [2, 0]]", NAMES, "clockwise (area -2)"),
        ("vertices = [[0, 0], [2, 0], [2, 0], [0, 1]]", NAMES, "vertices 1 and 2 are the same"),
        ("vertices = [[0, 0], [2, 0]]", NAMES, "three vertices or more, not 2"),
        ("vertices = [[0, 0], [2, nan], [2, 1], [0, 1]]", NAMES, "is not finite"),
        (
            "vertices = [[0, 0, 0], [2, 0], [2, 1], [0, 1]]",
            NAMES,
            "3 numbers, a point of the plane has two",
        ),
        ("", NAMES, "shape `polygon` needs the key `vertices`"),
        (CORNERS, "sides = [\"bottom\", \"right\", \"top\"]", "3 names for 4 edges"),
        (CORNERS, "sides = [\"bottom\", \"right\", \"top\", \" \"]", "a side without name"),
        (CORNERS, "sides = [\"botom\", \"right\", \"top\", \"left\"]", "did you mean `botom`?"),
        (CORNERS, "sides = [\"bottom\", \"right\", \"top\", \"rest\"]", "unknown value `left`"),
        (CORNERS, "", "unknown value `top` of `clamped`"),
        (CORNERS, &format!("{NAMES}\nsize = [2, 1]"), "shape `polygon` takes no `size`"),
        (CORNERS, &format!("{NAMES}\npoints = [[1, 0.5]]"), "and there are none"),
        (CORNERS, &format!("{NAMES}\ntriangles = [[0, 1, 4]]"), "there is no vertex 4"),
        (CORNERS, &format!("{NAMES}\ntriangles = [[0, 1, 2]]"), "does not bound the triangles"),
        (CORNERS, &format!("{NAMES}\ntriangles = [[0, 1]]"), "2 numbers, a triangle has three"),
        (CORNERS, &format!("{NAMES}\ntriangles = []"), "does not bound the triangles"),
        (CORNERS, &format!("{NAMES}\nfile = \"x.msh\""), "shape `polygon` takes no `file`"),
    ];
    for (corners, names, phrase) in cases {
        let shown = refused(&polygon(corners, names)).to_string();
        assert!(shown.contains(phrase), "`{phrase}` is not said:\n{shown}");
        assert!(shown.contains("block.toml:"), "{shown}");
    }
    let unclamped = polygon(CORNERS, NAMES).replace("clamped = [\"top\"]", "clamped = []");
    let unclamped = unclamped.replace("[\"left\", \"right\"]", "[\"left\", \"right\", \"top\"]");
    assert!(refused(&unclamped).to_string().contains("no side is clamped"));
}

#[test]
fn mesh_files_are_read_beside_the_scene() {
    let text = |file: &str| {
        let text = shaped(&format!("shape = \"mesh\"\nfile = \"{file}\""));
        text.replace("\"bottom\"", "\"foot\"").replace("\"right\"", "\"right side\"")
    };
    let scene = accepted(&text("tests/fixtures/block-4.1.msh"));
    let domain = &scene.as_contact().unwrap().domain;
    let Shape::Refined(coarse) = &domain.shape else { panic!("{:?}", domain.shape) };
    assert_eq!(coarse.regions, ["layer", "body"].map(String::from));
    let mesh = domain.mesh(2);
    assert_eq!((mesh.cell_count(), mesh.regions.len()), (128, 2));
    assert_eq!(mesh.cell_region[4..8], [coarse.region[1]; 4]);
    let shown = refused(&text("tests/fixtures/missing.msh")).to_string();
    assert!(shown.contains("cannot read the mesh") && shown.contains("block.toml:8"), "{shown}");
    let shown = refused(&text("tests/fixtures/punch.json")).to_string();
    assert!(shown.contains("punch.json:1:1") && shown.contains("$MeshFormat"), "{shown}");
    let three = EXACT.replace("dimension = 2", "dimension = 3");
    let shown = refused(&three.replace("\"rectangle\"", "\"mesh\"")).to_string();
    assert!(shown.contains("the shape `mesh` is plane"), "{shown}");
}

#[test]
fn graded_meshes_name_a_corner() {
    let graded = |corner: &str, exponent: &str| {
        let mesh = format!("kind = \"graded\", corner = {corner}, exponent = {exponent}");
        LOADED
            .replace("kind = \"structured\"", &mesh)
            .replace("reference = { n = 64, steps = 64 }\n", "")
            .replace("judge = true", "judge = false")
    };
    let swept = graded("[1.0, 0.5]", "2");
    assert!(refused(&swept).to_string().contains("no reference run"));
    let start = swept.find("[sweep]").unwrap();
    let end = swept.find("[[predicts]]").unwrap();
    let alone =
        |corner: &str, exponent: &str| graded(corner, exponent).replace(&swept[start..end], "");
    let scene = accepted(&alone("[1.0, 0.5]", "2"));
    let family = MeshFamily::Graded { corner: [1.0, 0.5], exponent: 2.0 };
    assert_eq!(scene.as_contact().unwrap().domain.mesh, family);
    let said = |text: &str| refused(text).to_string();
    assert!(said(&alone("[0.5, 0.5]", "2")).contains("(0.5, 0.5) is no corner of the rectangle"));
    assert!(said(&alone("[1.0, 0.5]", "0.5")).contains("outside [1, 8]"));
    let off = LOADED.replace("kind = \"structured\"", "kind = \"structured\", exponent = 2");
    assert!(said(&off).contains("takes no `exponent`"));
    let reference =
        LOADED.replace("kind = \"structured\"", "kind = \"graded\", corner = [0, 0], exponent = 2");
    assert!(said(&reference).contains("meshes that do not nest"));
}
