//! `[domain]`: where vertices lie, which of them are held, which normals there are.

use fem::mesh::Mesh;

use super::{BLOCK, Tie, block, near, scene, with};

pub const TIES: &[Tie] = &[
    (&["domain.shape", "domain.size"], rectangle),
    (&["domain.clamped", "domain.traction", "domain.contact"], sides_of_a_rectangle),
    (&["domain.symmetry"], symmetry_of_a_rectangle),
    (&["domain.rest"], rest_of_a_rectangle),
    (&["domain.vertices", "domain.sides"], polygon),
    (&["domain.points", "domain.triangles"], triangles),
    (&["domain.file"], file),
    (&["domain.mesh.kind", "domain.mesh.corner", "domain.mesh.exponent"], graded),
    (&["domain.mesh.amplitude", "domain.mesh.seed", "domain.mesh.axes"], perturbed),
];

fn mesh_of(edits: &[(&str, &str)], n: u32) -> Mesh {
    mesh_in(&with(BLOCK, edits), n)
}

fn mesh_in(text: &str, n: u32) -> Mesh {
    let setup = crate::shipped::setup_of(text.to_owned());
    setup.space(n).unwrap_or_else(|error| panic!("{error}")).mesh.clone()
}

/// A displacement in place of loads: a reference run asks for nested meshes.
const EXACT: [(&str, &str); 2] = [
    ("[loads]\nbody = [\"0\", \"-1\"]\n", "[exact]\nu = [\"0\", \"0.01*t*(0.5 - y)*(1 - y)\"]\n"),
    ("reference = { n = 8, steps = 12 }\n", ""),
];

/// Points with these coordinates, whatever their order.
#[track_caller]
fn has_vertex(mesh: &Mesh, x: f64, y: f64) {
    let found = (0..mesh.vertices() as u32).any(|v| {
        let at = mesh.vertex(v);
        (at[0] - x).abs() < 1e-14 && (at[1] - y).abs() < 1e-14
    });
    assert!(found, "no vertex at ({x}, {y})");
}

/// 4 cells a unit length: 5 × 3 vertices of 1 × 0.5; the longer side along x.
fn rectangle() {
    let mesh = mesh_of(&[], 4);
    assert_eq!((mesh.vertices(), mesh.cell_count()), (15, 16));
    has_vertex(&mesh, 1.0, 0.5);
    has_vertex(&mesh, 0.75, 0.25);
    near(block(&[]).as_contact().expect("a body").domain.measure(), 0.5);
}

/// Held are 5 vertices of the top or 3 of the right side; the outward normal of the contact side.
fn sides_of_a_rectangle() {
    /// Edits, numbers of free nodes, outward normal.
    type Row<'a> = (&'a [(&'a str, &'a str)], usize, [f64; 2]);
    let rows: [Row; 2] = [
        (&[], 10, [0.0, -1.0]),
        (
            &[
                ("clamped = [\"top\"]", "clamped = [\"right\"]"),
                ("traction = [\"left\", \"right\"]", "traction = [\"bottom\", \"top\"]"),
                ("contact = [\"bottom\"]", "contact = [\"left\"]"),
            ],
            12,
            [-1.0, 0.0],
        ),
    ];
    for (edits, free, normal) in rows {
        let law = ("[contact]", "[contact]\ngap = \"0.1\"");
        let setup = crate::shipped::setup_of(with(BLOCK, &[edits, &[law]].concat()));
        let space = setup.space(4).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(space.dofs(), 2 * free);
        let point = &space.trace.points[0];
        assert_eq!(&point.normal[..2], &normal);
        // Γ3 is a whole side: its measure is that of the lumped weights.
        let weight: f64 = space.trace.points.iter().map(|point| point.weight).sum();
        near(weight, if normal[0] == 0.0 { 1.0 } else { 0.5 });
        let domain = &setup.body.domain;
        let traction: Vec<&str> = domain.traction.iter().map(|side| domain.name(*side)).collect();
        assert_eq!(traction, if free == 10 { ["left", "right"] } else { ["bottom", "top"] });
    }
}

/// On the left u_x = 0 at its two vertices that are not clamped, with the outward normal; u_y stays free.
fn symmetry_of_a_rectangle() {
    let edits = [
        ("traction = [\"left\", \"right\"]", "symmetry = [\"left\"]\ntraction = [\"right\"]"),
        ("[contact]", "[contact]\ngap = \"0.1\""),
    ];
    let setup = crate::shipped::setup_of(with(BLOCK, &edits));
    let space = setup.space(4).unwrap_or_else(|error| panic!("{error}"));
    let held: Vec<(&[f64], [f64; 3])> =
        space.supports.iter().map(|at| (space.mesh.vertex(at.vertex), at.normal)).collect();
    assert_eq!(held, [(&[0.0, 0.0][..], [-1.0, 0.0, 0.0]), (&[0.0, 0.25], [-1.0, 0.0, 0.0])]);
    assert_eq!(space.dofs(), 20);
}

/// Sides that no list names: both uprights beside a top and a bottom that are listed.
fn rest_of_a_rectangle() {
    let scene = block(&[("traction = [\"left\", \"right\"]", "rest = \"traction\"")]);
    let domain = &scene.as_contact().expect("a body").domain;
    let names = |sides: &[scene::Side]| {
        sides.iter().map(|side| domain.name(*side).to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names(&domain.traction), ["left", "right"]);
    assert_eq!(
        (names(&domain.clamped), names(&domain.contact)),
        (vec!["top".to_owned()], vec!["bottom".to_owned()])
    );
}

/// A right triangle with legs 2 and 1: `sides` name the edges from each vertex to the next.
const TRIANGLE: &str = "shape = \"polygon\"\nvertices = [[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]]\nsides = [\"foot\", \"slope\", \"wall\"]\nclamped = [\"wall\"]\ntraction = [\"slope\"]\ncontact = [\"foot\"]";
const RECTANGLE: &str = "shape = \"rectangle\"\nsize = [1.0, 0.5]\nclamped = [\"top\"]\ntraction = [\"left\", \"right\"]\ncontact = [\"bottom\"]";

fn polygon() {
    let text = with(BLOCK, &[(RECTANGLE, TRIANGLE)]);
    let read = scene(&text);
    let domain = &read.as_contact().expect("a body").domain;
    near(domain.measure(), 1.0);
    let length = |name: &str| {
        let side = [&domain.clamped, &domain.traction, &domain.contact]
            .into_iter()
            .flatten()
            .find(|side| domain.name(**side) == name);
        let faces = domain.faces(*side.expect("a side"));
        faces.iter().map(scene::Face::measure).sum::<f64>()
    };
    near(length("foot"), 2.0);
    near(length("slope"), 5f64.sqrt());
    near(length("wall"), 1.0);
}

/// The square cut into four triangles at (0.3, 0.4), which is a vertex then.
fn triangles() {
    let text = "shape = \"polygon\"\nvertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\npoints = [[0.3, 0.4]]\ntriangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]\nclamped = [\"top\"]\ntraction = [\"left\", \"right\"]\ncontact = [\"bottom\"]";
    let mesh = mesh_in(&with(BLOCK, &[(RECTANGLE, text)]), 1);
    assert_eq!((mesh.vertices(), mesh.cell_count()), (5, 4));
    has_vertex(&mesh, 0.3, 0.4);
}

/// layers-2.2.msh is the unit square with a vertex line at y = 1/2.
fn file() {
    let text = crate::shipped::edited(
        &crate::shipped::text("layered"),
        "shape = \"rectangle\"\nsize = [1.0, 1.0]",
        "shape = \"mesh\"\nfile = \"../tests/fixtures/layers-2.2.msh\"",
    );
    let setup = crate::shipped::setup_of(text);
    near(setup.body.domain.measure(), 1.0);
    assert_eq!(setup.space(1).unwrap_or_else(|e| panic!("{e}")).mesh.regions, ["lower", "upper"]);
}

/// Distances from the corner (1, 0), as parts of the larger side, become their squares along each axis.
fn graded() {
    let family = "mesh = { kind = \"graded\", corner = [1.0, 0.0], exponent = 2.0 }";
    let square = ("size = [1.0, 0.5]", "size = [1.0, 1.0]");
    let text = with(&with(BLOCK, &EXACT), &[square, ("[time]", &format!("{family}\n[time]"))]);
    let mesh = mesh_in(&text, 4);
    has_vertex(&mesh, 1.0 - 1.0 / 16.0, 0.0);
    has_vertex(&mesh, 1.0, 1.0 / 16.0);
    has_vertex(&mesh, 0.0, 1.0);
}

/// Inner vertices move by up to 0.2 h, along y alone; another seed moves them elsewhere.
fn perturbed() {
    let moved = |seed: u32| {
        let family = format!(
            "mesh = {{ kind = \"perturbed\", amplitude = 0.2, seed = {seed}, axes = [\"y\"] }}"
        );
        let text = with(&with(BLOCK, &EXACT), &[("[time]", &format!("{family}\n[time]"))]);
        mesh_in(&text, 8)
    };
    let (plain, first, second) = (mesh_of(&[], 8), moved(1), moved(2));
    let mut largest = 0.0f64;
    for v in 0..plain.vertices() as u32 {
        assert_eq!(first.vertex(v)[0], plain.vertex(v)[0]);
        largest = largest.max((first.vertex(v)[1] - plain.vertex(v)[1]).abs());
    }
    // 21 inner vertices: the largest of as many random parts is above a half of the bound.
    assert!(largest <= 0.2 / 8.0 && largest > 0.1 / 8.0, "{largest}");
    assert_ne!(first.coordinates, second.coordinates);
    assert_eq!(first.coordinates, moved(1).coordinates);
}
