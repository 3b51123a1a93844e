//! Polygons, mesh files and graded meshes: valid ones, and messages for others.

use super::good::{EXACT, LOADED, refused};
use scene::{MeshFamily, Place, Scene, Shape, Side, Source};

const RECTANGLE: &str = "shape = \"rectangle\"\nsize = [1.0, 0.5]";
const CORNERS: &str = "vertices = [[0, 0], [2, 0], [2, 1], [0, 1]]";
const NAMES: &str = "sides = [\"bottom\", \"right\", \"top\", \"left\"]";

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
    // Default names are s1, s2, …; several edges may share a name.
    let unnamed = polygon(CORNERS, "").replace("\"bottom\"", "\"s1\"").replace("\"top\"", "\"s3\"");
    accepted(&unnamed.replace("\"left\", \"right\"", "\"s2\", \"s4\"").replace("left =", "s4 ="));
    let walls = polygon(CORNERS, "sides = [\"bottom\", \"left\", \"top\", \"left\"]");
    let scene = accepted(&walls.replace("[\"left\", \"right\"]", "[\"left\"]"));
    assert_eq!(scene.as_contact().unwrap().domain.faces(Side(1)).len(), 2);
}

/// h by hand: 1/n on rectangles and boxes, whatever moves their vertices; else the longest edge of the coarse simplices over
/// n, here the diagonal of 2 by 1, the side 2 of two triangles that meet at (1, 1/2), and the diagonal of the head of a
/// frustum, the unit square. Of meshes that nothing moves the longest edge of all cells is h, on squares and cubes √d h.
#[test]
fn every_family_reports_the_size_of_its_mesh() {
    let plane = [
        "kind = \"structured\"",
        "kind = \"perturbed\", amplitude = 0.2, seed = 3",
        "kind = \"graded\", corner = [0.0, 0.0], exponent = 2.0",
    ];
    let fan = "points = [[1, 0.5]]\ntriangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]";
    let file = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n1 1 \"bottom\"\n1 2 \"right\"\n\
                1 3 \"top\"\n1 4 \"left\"\n$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 2 0 0\n3 2 1 0\n4 0 1 0\n\
                $EndNodes\n$Elements\n6\n1 1 2 1 1 1 2\n2 1 2 2 1 2 3\n3 1 2 3 1 3 4\n4 1 2 4 1 4 1\n\
                5 2 2 0 1 1 2 3\n6 2 2 0 1 1 3 4\n$EndElements\n";
    let shapes = [
        (RECTANGLE.to_owned(), 1.0, 2f64.sqrt()),
        (format!("shape = \"polygon\"\n{CORNERS}\n{NAMES}"), 5f64.sqrt(), 1.0),
        (format!("shape = \"polygon\"\n{CORNERS}\n{NAMES}\n{fan}"), 2.0, 1.0),
        ("shape = \"mesh\"\nfile = \"block.msh\"".to_owned(), 5f64.sqrt(), 1.0),
    ];
    let mut domains = Vec::new();
    for (shape, h, longest) in &shapes {
        for family in plane {
            // A reference run needs meshes that nest.
            let text = shaped(shape).replace("kind = \"structured\"", family);
            let text = text.replace("reference = { n = 64, steps = 64 }\n", "");
            let text = text.replace("judge = true", "judge = false");
            let (start, end) = (text.find("[sweep]").unwrap(), text.find("[[predicts]]").unwrap());
            let text = text.replace(&text[start..end], "");
            let source = Source::from_text("block.toml", text).with_mesh(file.to_owned());
            let scene = Scene::from_source(source).unwrap_or_else(|error| panic!("{error}"));
            let moved = family != plane[0];
            domains.push((scene, *h, (!moved).then_some(*longest)));
        }
    }
    let cube = include_str!("../../../../manufactured/pure-box.toml");
    domains.push((accepted(cube), 1.0, Some(3f64.sqrt())));
    domains.push((accepted(&frustum(str::to_owned)), 2f64.sqrt(), None));
    for (scene, h, longest) in domains {
        let domain = &scene.as_contact().unwrap().domain;
        for n in [2u32, 4] {
            let (mesh, h) = (domain.mesh(n), h / f64::from(n));
            // Roundings of a root and of coordinates.
            assert!((mesh.h() - h).abs() < 1e-14, "{domain:?} {n}: {} for {h}", mesh.h());
            assert!((domain.h(n) - h).abs() < 1e-14, "{domain:?} {n}");
            if let Some(longest) = longest {
                assert!((mesh.quality().longest - longest * h).abs() < 1e-14, "{domain:?} {n}");
            }
        }
    }
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
        ("vertices = [[0, 0, 0], [2, 0], [2, 1], [0, 1]]", NAMES, "3 entries, but 2 are expected"),
        ("", NAMES, "shape `polygon` needs the key `vertices`"),
        (CORNERS, "sides = [\"bottom\", \"right\", \"top\"]", "3 names for 4 edges"),
        (CORNERS, "sides = [\"bottom\", \"right\", \"top\", \" \"]", "`sides` is empty"),
        (CORNERS, "sides = [\"botom\", \"right\", \"top\", \"left\"]", "did you mean `botom`?"),
        (CORNERS, "sides = [\"bottom\", \"right\", \"top\", \"rest\"]", "unknown value `left`"),
        (CORNERS, "", "unknown value `top` of `clamped`"),
        (CORNERS, &format!("{NAMES}\nsize = [2, 1]"), "shape `polygon` takes no `size`"),
        (CORNERS, &format!("{NAMES}\npoints = [[1, 0.5]]"), "and there are none"),
        (
            CORNERS,
            &format!("{NAMES}\ntriangles = [[0, 1, 4]]"),
            "4 is no vertex: 4 are numbered from 0",
        ),
        (CORNERS, &format!("{NAMES}\ntriangles = [[0, 1, 2]]"), "does not bound the domain"),
        (CORNERS, &format!("{NAMES}\ntriangles = [[0, 1]]"), "2 entries, but 3 are expected"),
        (CORNERS, &format!("{NAMES}\ntriangles = []"), "does not bound the domain"),
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
    let scene = accepted(&text("../../tests/fixtures/block-4.1.msh"));
    let domain = &scene.as_contact().unwrap().domain;
    let Shape::Refined(coarse) = &domain.shape else { panic!("{:?}", domain.shape) };
    assert_eq!(coarse.regions, ["layer", "body"].map(String::from));
    let mesh = domain.mesh(2);
    assert_eq!((mesh.cell_count(), mesh.regions.len()), (128, 2));
    assert_eq!(mesh.cell_region[4..8], [coarse.region[1]; 4]);
    let shown = refused(&text("../../tests/fixtures/missing.msh")).to_string();
    assert!(shown.contains("cannot read the mesh") && shown.contains("block.toml:8"), "{shown}");
    let shown = refused(&text("../../tests/fixtures/punch.json")).to_string();
    assert!(shown.contains("punch.json:1:1") && shown.contains("$MeshFormat"), "{shown}");
    let three = EXACT.replace("dimension = 2", "dimension = 3");
    let shown = refused(&three.replace("\"rectangle\"", "\"polygon\"")).to_string();
    assert!(shown.contains("unknown value `polygon` of `shape`"), "{shown}");
    let shown =
        refused(&text("../../tests/fixtures/block-2.2.msh").replace("= 2\n", "= 3\n")).to_string();
    assert!(shown.contains("triangles and no tetrahedra, and dimension = 3"), "{shown}");
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
    assert!(refused(&swept).to_string().contains("nor a reference run"));
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

fn frustum(change: impl Fn(&str) -> String) -> String {
    let text = include_str!("../../../../manufactured/frustum.toml");
    change(&text.replace("\"frustum.msh\"", "\"../../manufactured/frustum.msh\""))
}

#[test]
fn tetrahedra_from_a_file_have_sides_meshes_and_points() {
    let scene = accepted(&frustum(str::to_owned));
    let domain = &scene.as_contact().unwrap().domain;
    assert_eq!((domain.dimension(), domain.sides.len()), (3, 3));
    // ∫ (0.8 + 0.2 y)² dy over (0, 1).
    assert!((domain.measure() - (1.0 - 0.512) / 0.6).abs() < 1e-12);
    let foot = domain.faces(Side(0));
    let area: f64 = foot.iter().map(|face| face.measure()).sum();
    assert!((area - 0.64).abs() < 1e-12, "{area}");
    // The diagonal is the longest edge of both triangles, whichever edges leave the corner.
    assert!(foot.iter().all(|face| (face.longest() - 0.8 * 2f64.sqrt()).abs() < 1e-12));
    for face in &foot {
        let [a, b] = [face.tangents()[0], face.tangents()[1]];
        let dot = |p: [f64; 3], q: [f64; 3]| p.iter().zip(q).map(|(p, q)| p * q).sum::<f64>();
        let off = [dot(a, b), dot(a, face.normal), dot(b, face.normal), dot(b, b) - 1.0];
        assert!(off.into_iter().all(|x| x.abs() < 1e-12), "{off:?}");
        // 1 + 2 + … + 5 points, all in the plane of the foot.
        let points = face.points(4);
        assert_eq!(points.len(), 15);
        assert!(points.iter().all(|p| (0.75f64.sqrt() * p[1] - 0.5 * p[0]).abs() < 1e-12));
    }
    let mesh = domain.mesh(3);
    assert_eq!((mesh.cell_count(), mesh.sides.clone()), (24 * 27, domain.sides.clone()));
    assert_eq!(domain.h(3), mesh.h());
    assert!(domain.inner_points(6).iter().all(|p| p[2] > 0.0 && p[2] < 1.0));
}

#[test]
fn what_tetrahedra_cannot_be_is_refused() {
    let cases: [(&str, &str, &str); 8] = [
        ("dimension = 3", "dimension = 2", "has tetrahedra, and dimension = 2"),
        ("[\"walls\"]", "[\"wals\"]", "did you mean `walls`?"),
        ("file = \"", "size = [1.0, 1.0, 1.0]\nfile = \"", "shape `mesh` takes no `size`"),
        (
            "contact = [\"foot\"]",
            "contact = [\"foot\"]\nmesh = { kind = \"perturbed\", amplitude = 0.1, seed = 1 }",
            "are not made of tetrahedra",
        ),
        (
            "contact = [\"foot\"]",
            "contact = [\"foot\"]\nmesh = { kind = \"graded\", corner = [0.0, 0.0], exponent = 2.0 }",
            "are not made of tetrahedra",
        ),
        ("quadrature = \"vertex\"", "quadrature = \"exact\"", "quadrature"),
        (
            "gap = \"0.08\"",
            "gap = \"0.08 + 0.1*(z - 0.5)^2\"",
            "the gap is not concave on the side foot",
        ),
        // A kink that only second differences detect.
        (
            "gap = \"0.08\"",
            "gap = \"0.08 + abs(z - 0.4999)\"",
            "the gap is not concave on the side foot",
        ),
    ];
    for (from, to, phrase) in cases {
        let shown = refused(&frustum(|text| {
            assert_eq!(text.matches(from).count(), 1, "{from}");
            text.replace(from, to)
        }));
        assert!(shown.to_string().contains(phrase), "`{phrase}` is not said:\n{shown}");
    }
    // Two normals meet on an edge of the walls, three at a corner of the foot: all independent.
    let all = frustum(|text| {
        text.replace("[\"foot\"]", "[\"foot\", \"walls\"]").replace("[\"walls\"]", "[]")
    });
    accepted(&all);
    // A vertex moved out of the walls has a normal per face.
    let mesh = include_str!("../../../../manufactured/frustum.msh");
    let place = "-0.20669872981077803 0.4580127018922194 0.05";
    assert_eq!(mesh.matches(place).count(), 1);
    let source =
        Source::from_text("block.toml", all).with_mesh(mesh.replace(place, "-0.25 0.45 0.0"));
    let shown = Scene::from_source(source).unwrap_err().to_string();
    assert!(shown.contains("faces of the contact sides with different normals meet"), "{shown}");
}

#[test]
fn regions_may_be_physical_groups() {
    let region = |lines: &str| {
        let table = format!(
            "[[material.region]]\nname = \"stiff\"\n{lines}lambda = 2.0\nmu_L = 1.5\n\n[contact]"
        );
        frustum(|text| text.replace("[contact]", &table))
    };
    let scene = accepted(&region("physical = \"upper\"\n"));
    let material = &scene.as_contact().unwrap().material;
    assert_eq!(material.regions[0].place, Place::Physical(1));
    let said = |lines: &str| refused(&region(lines)).to_string();
    let unknown = said("physical = \"uper\"\n");
    assert!(unknown.contains("did you mean `upper`?") && unknown.contains("lower"), "{unknown}");
    assert!(said("").contains("has no place"));
    assert!(said("where = \"y\"\nphysical = \"upper\"\n").contains("has two places"));
    let table =
        "mu_L = 1.0\n[[material.region]]\nname = \"a\"\nphysical = \"b\"\nE = 1.0\nnu = 0.3\n";
    assert!(LOADED.contains("mu_L = 1.0\n"));
    let shown = refused(&LOADED.replacen("mu_L = 1.0\n", table, 1)).to_string();
    assert!(shown.contains("physical groups are in mesh files"), "{shown}");
}
