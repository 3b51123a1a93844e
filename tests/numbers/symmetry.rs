//! Source: reflection; where a body, its loads and its contact sides are symmetric, so is the solution.
//! Goal: planes of symmetry. A quarter of a block beside the whole one, equal at every vertex: in the plane with P1 and P2, in
//!   space (an eighth) with P1 and P2, with friction, and turned so that the planes are no axes. A plane that is forgotten, or
//!   held along itself, gives another solution.
//! Mesh: the lattice of the quarter, reflected, as a file: the mesh of the whole is symmetric whatever the diagonals.
//! Data: elasticity, memory, projection, a law and a gap that is reached, body force and traction.

use std::path::Path;

use crate::program::Folder;
use crate::shipped::{edited, on_mesh, refusal, run, text};
use fem::mesh::{Family, Mesh, lattice, write_gmsh};
use scene::setup::Setup;
use scene::{Scene, Source};

/// Cells along an edge of the quarter, in the plane and in space.
const N: [u32; 2] = [3, 2];
const STEPS: u32 = 3;

/// Displacements and pressures are below 1; Newton stops at 16 units of rounding of forces, which the stiffness (condition
/// below 1e3 on these meshes) turns into 1e-12.
const EQUAL: f64 = 1e-10;

/// A rotation in the plane of the first two coordinates.
fn turned(angle: f64, x: &[f64]) -> Vec<f64> {
    let (s, c) = angle.sin_cos();
    let mut y = x.to_vec();
    (y[0], y[1]) = (c * x[0] - s * x[1], s * x[0] + c * x[1]);
    y
}

/// The quarter (0, 1)^d, or what it is of when reflected in all coordinate planes, turned; normals are the file reader's.
fn block(d: usize, whole: bool, angle: f64) -> Mesh {
    let mut mesh = match d {
        2 => lattice([1.0; 2], N[0], Family::Structured),
        _ => lattice([1.0; 3], N[1], Family::Structured),
    };
    let axes = if whole { d } else { 0 };
    for axis in 0..axes {
        reflect(&mut mesh, axis);
    }
    mesh.coordinates = mesh.coordinates.chunks(d).flat_map(|x| turned(angle, x)).collect();
    mesh
}

/// Adds the mirror image in the plane x_axis = 0; the sides there go.
fn reflect(mesh: &mut Mesh, axis: usize) {
    let d = mesh.dimension;
    let (count, on_plane) = (mesh.vertices(), |x: &[f64]| x[axis] == 0.0);
    let mut image = Vec::new();
    for v in 0..count {
        let mut x = mesh.vertex(v as u32).to_vec();
        if on_plane(&x) {
            image.push(v as u32);
            continue;
        }
        image.push((mesh.coordinates.len() / d) as u32);
        x[axis] = -x[axis];
        mesh.coordinates.extend(x);
    }
    // Two vertices change places: a mirror turns cells over.
    let mirrored = |of: &[u32]| {
        let mut of: Vec<u32> = of.iter().map(|&v| image[v as usize]).collect();
        of.swap(0, 1);
        of
    };
    for c in 0..mesh.cell_count() {
        let cell = mirrored(mesh.cell(c));
        mesh.cells.extend(cell);
        mesh.cell_region.push(mesh.cell_region[c]);
    }
    let plane = mesh.side(["left", "bottom", "front"][axis]).expect("a side");
    let (mut facets, mut sides) = (Vec::new(), Vec::new());
    for (f, &side) in mesh.facet_side.iter().enumerate().filter(|(_, side)| **side != plane) {
        facets.extend_from_slice(mesh.facet(f));
        facets.extend(mirrored(mesh.facet(f)));
        sides.extend([side, side]);
    }
    (mesh.facets, mesh.facet_side) = (facets, sides);
}

/// The scene on the mesh of a file; `planes` is the line of [domain] for what the quarter has in place of its other parts.
fn scene(folder: &Path, d: usize, mesh: &Mesh, (planes, angle): (&str, f64), more: &str) -> Setup {
    let name = format!("{}.msh", mesh.vertices());
    std::fs::write(folder.join(&name), write_gmsh(mesh)).expect("a folder");
    let (s, c) = (-angle).sin_cos();
    // Odd in X (and Z), and with the normal of the contact sides Y = ±1.
    let (x, y) = (format!("({c}*x - {s}*y)"), format!("({s}*x + {c}*y)"));
    let along = [format!("0.4*{x}*t"), format!("(2 - {x}^2)*{y}*(1 + t)")];
    let (s, c) = angle.sin_cos();
    let mut force = vec![
        format!("{c}*{} - {s}*{}", along[0], along[1]),
        format!("{s}*{} + {c}*{}", along[0], along[1]),
    ];
    force.extend((d == 3).then(|| "0.3*t*z".to_owned()));
    // zeta is of the whole body, which is 2^d times as large: so is the square of the norm.
    let share = if planes.is_empty() { 2f64.powi(d as i32).sqrt() } else { 1.0 };
    let free = if d == 3 { "\"back\"" } else { "" };
    let text = format!(
        "[scene]\nname = \"block\"\nquestion = \"?\"\ndimension = {d}\njudge = false\n\
         [domain]\nshape = \"mesh\"\nfile = \"{name}\"\nclamped = [\"right\"]\ncontact = [\"top\"]\n\
         traction = [{free}]\n{planes}\n[time]\nhorizon = 1.0\n\
         [material]\nlambda = 1.0\nmu_L = 1.0\n\
         [material.memory]\nkernel = \"-exp(-t)\"\nlambda = 0.25\nmu = 0.25\n\
         [material.projection]\nmu = 1.0\nkappa = \"0.1 + 0.05*zeta/{share}\"\n\
         [contact]\ngap = \"0.12\"\nlaw = {{ kind = \"piecewise-linear\", points = [[0.0, 0.0], [0.04, 0.08], [0.1, 0.05]], \
         slope_before = 0.0, slope_after = 0.0 }}\n{more}\n\
         [loads]\nbody = {force:?}\n[sweep]\nn = [1]\nsteps = [{STEPS}]\nreference = {{ n = 2, steps = {STEPS} }}\n"
    );
    let scene = Scene::from_source(Source::from_text(folder.join("block.toml"), text));
    Setup::new(scene.unwrap_or_else(|error| panic!("{error}")))
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The displacements of all levels by places, turned back.
fn displacements(setup: &Setup, angle: f64) -> Vec<(Vec<f64>, Vec<f64>)> {
    let data = on_mesh(setup, 1);
    let (space, d) = (&*data.space, setup.scene.dimension);
    let mut found = Vec::new();
    let mut touches = false;
    run(setup, &setup.model, &data, STEPS, |view| {
        touches |= view.multiplier.iter().any(|lambda| *lambda > 0.0);
        for (node, &v) in space.nodes.vertex.iter().enumerate() {
            let place = turned(-angle, space.mesh.vertex(v));
            let u = turned(-angle, &view.u[d * node..d * (node + 1)]);
            found.push((place.into_iter().chain([view.t]).collect(), u));
        }
    })
    .unwrap_or_else(|error| panic!("{error}"));
    assert!(touches, "the gap is not reached: nothing is shown of the constraint");
    found
}

/// The largest difference at the vertices of the quarter, and the largest displacement.
fn difference(part: &[(Vec<f64>, Vec<f64>)], whole: &[(Vec<f64>, Vec<f64>)]) -> [f64; 2] {
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
    part.iter().fold([0.0; 2], |[most, size], (place, u)| {
        let (_, other) = whole.iter().find(|(at, _)| near(at, place)).expect("the same vertex");
        let off = u.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let large = u.iter().map(|u| u.abs()).fold(0.0, f64::max);
        assert!(off.is_finite());
        [most.max(off), size.max(large)]
    })
}

/// What the reader or the set-up says of a shipped scene with edits.
fn refused(name: &str, edits: &[(&str, &str)]) -> String {
    refusal(edits.iter().fold(text(name), |text, (from, to)| edited(&text, from, to)))
}

/// Displacements across a plane or tractions along it, a body that is left to move, and conditions that are not independent.
#[test]
fn what_is_no_plane_of_symmetry_is_refused() {
    let first = "u = [\"d(W,x)*y*(1 - y)";
    let second = "\"-W*(1 - y^2)";
    let held = "clamped = [\"top\"]\n";
    let free = (
        "symmetry = [\"left\"]\ntraction = [\"right\"]",
        "symmetry = [\"left\"]\ntraction = [\"right\", \"top\"]",
    );
    let across = refused("symmetry", &[(first, "u = [\"1e-6*t*y*(1 - y) + d(W,x)*y*(1 - y)")]);
    assert!(across.contains("u_nu is ") && across.contains("on a plane of symmetry"), "{across}");
    let along = refused("symmetry", &[(second, "\"1e-3*t*x*(1 - y) - W*(1 - y^2)")]);
    assert!(along.contains("|sigma_tau| is "), "{along}");
    let moving = refused("symmetry", &[(held, ""), free]);
    assert!(moving.contains("can move along its planes of symmetry"), "{moving}");
    let three = (
        "symmetry = [\"left\", \"front\", \"top\"]\ntraction = [\"right\", \"back\"]",
        "symmetry = [\"left\", \"front\"]\ntraction = [\"right\", \"back\", \"top\"]",
    );
    let moving = refused("symmetry-box", &[three]);
    assert!(moving.contains("can move along its planes of symmetry"), "{moving}");
    // The foot in two parts, of which one is a plane of symmetry; and friction beside an oblique plane.
    let straight = refused(
        "symmetry-oblique",
        &[
            (
                "vertices = [[0.0, 0.0], [1.0, 0.0],",
                "vertices = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0],",
            ),
            ("sides = [\"foot\",", "sides = [\"foot\", \"heel\","),
            ("symmetry = [\"left\",", "symmetry = [\"heel\", \"left\","),
        ],
    );
    assert!(straight.contains("meet at x = 0.5, y = 0 along one line"), "{straight}");
    let leaning = refused(
        "symmetry-oblique",
        &[("[contact]\n", "[contact]\nfriction = { bound = \"0.1\" }\n")],
    );
    assert!(leaning.contains("at another angle than a right one"), "{leaning}");
}

const P2: &str = "[discretization]\nelement = \"P2\"";
const FRICTION: &str = "friction = { bound = \"0.02\" }";

#[test]
fn a_quarter_of_a_block_beside_the_whole() {
    let folder = Folder::new("symmetry");
    for (d, angle, more) in [
        (2, 0.0, P2),
        (2, 0.4, ""),
        (2, 0.4, FRICTION),
        (3, 0.0, P2),
        (3, 0.0, FRICTION),
        (3, 0.4, ""),
    ] {
        let planes = match d {
            2 => "symmetry = [\"left\", \"bottom\"]",
            _ => "symmetry = [\"left\", \"bottom\", \"front\"]",
        };
        let at = |whole: bool, planes: &str| {
            let setup = scene(&folder.at(""), d, &block(d, whole, angle), (planes, angle), more);
            displacements(&setup, angle)
        };
        let whole = at(true, "");
        let [off, size] = difference(&at(false, planes), &whole);
        assert!(size > 0.05, "{d} {angle} {more}: {size}");
        assert!(off < EQUAL, "{d} {angle} {more}: {off:e}");
        // A plane that is forgotten is seen; whatever the element and the law, it is the same rows that are held.
        if !more.is_empty() {
            continue;
        }
        for (named, kept) in [("left", "bottom"), ("bottom", "left")] {
            let wrong = format!(
                "symmetry = [\"{kept}\"{}]\nrest = \"traction\"",
                if d == 3 { ", \"front\"" } else { "" }
            );
            let [off, _] = difference(&at(false, &wrong), &whole);
            assert!(off > 1e-4, "{d} {angle} {more}: {off:e} without {named}");
        }
    }
}
