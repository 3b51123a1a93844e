//! A scene as a report shows it: equations, remarks and its picture.

use std::collections::{BTreeMap, BTreeSet};

use fem::mesh::Mesh;
use formula::{EvaluationPoint, Node, Program};
use report::{
    Axis, Chart, Group, Ink, Part, Scale, SceneSummary, Series, Sketch, StepLimits, Stroke, Terms,
    equations,
};
use scene::setup::{Subject, cell_regions, subject_bounds};
use scene::{Body, ContactScene, Data, Expectation, Face, MeshFamily, Scene, Shape, Side};

/// A scene's summary for a report; without a subject, the step size is omitted.
pub fn scene_summary(scene: &Scene, subject: Option<&Subject>) -> SceneSummary {
    SceneSummary {
        name: scene.name.clone(),
        question: scene.question.clone(),
        // A scene that breaks a hypothesis, or reaches its limit: the limiting scenes of docs/BROKEN-HYPOTHESES.md are named
        // after the others and read beside them.
        group: Group::of(
            terms(scene),
            !scene.violates.is_empty() || scene.name.starts_with("broken-"),
        ),
        remarks: remarks(scene),
        // If the body cannot be drawn, the picture is omitted.
        picture: Some(scene_picture(scene)),
        equations: equations(terms(scene)),
        text: scene.source.text.to_string(),
        violates: scene.violates.iter().map(|hypothesis| hypothesis.name().to_owned()).collect(),
        step: subject.and_then(step),
    }
}

/// The bounds on the step size, without a solve in time.
fn step(subject: &Subject) -> Option<StepLimits> {
    let bounds = subject_bounds(subject).ok()?;
    Some(StepLimits {
        m0: bounds.m0,
        paper: bounds.paper_limit(),
        theorem: bounds.limit(),
        sharpened: bounds.sharpened_limit(),
        solvable: bounds.solvable_limit(),
    })
}

fn terms(scene: &Scene) -> Terms {
    match &scene.body {
        Body::Contact(body) => Terms {
            is_abstract: false,
            projection: body.material.projection.is_some(),
            memory: !body.material.memory.is_empty(),
            contact: !body.contact.is_empty(),
            gap: body.has_gap(),
            law: body.laws().next().is_some(),
            friction: body.friction().is_some(),
            quadratic: body.element.degree() > 1,
        },
        Body::Abstract(problem) => {
            Terms { is_abstract: true, memory: !problem.kernels.is_empty(), ..Terms::default() }
        }
    }
}

fn remarks(scene: &Scene) -> Vec<String> {
    let truth = match scene.as_contact().map(|body| &body.data) {
        Some(Data::Loads { .. }) => {
            "The loads are given and no solution is known, so errors are measured against a run on a finer grid."
        }
        Some(Data::Exact { interpolated: true, .. }) => {
            "The exact solution is the nodal interpolant of a known displacement on each mesh, so all errors are errors in time."
        }
        Some(Data::Exact { .. }) => {
            "The solution is known in closed form; the loads are derived from it."
        }
        None => "The solution is known; the problem has no body and no mesh.",
    };
    let mut remarks = vec![truth.to_owned()];
    remarks.extend(match (scene.judge, scene.expect) {
        (false, _) => Some("It is measured but not judged, because the theory promises no order here.".into()),
        (true, Expectation::Pass) => None,
        (true, Expectation::Fail) => {
            Some("This scene shows that the predicted order is not reached, so the expected verdict is fail.".into())
        }
        (true, Expectation::Unresolved) => {
            Some("Its cases cannot decide, so the expected verdict is unresolved.".into())
        }
    });
    remarks
}

// The picture of a scene: its body with the parts of the boundary, or its solution over t.

/// Points along a deformed edge, and along a curve over t.
const ALONG: u32 = 8;
const CURVE: u32 = 64;
/// Largest displacement drawn, relative to the body's extent.
const REACH: f64 = 0.12;
/// Widest gap drawn, likewise.
const GAP_REACH: f64 = 0.25;
/// Meshes tried until none of a region's cells is cut; mesh lines are drawn on one of these.
const MESHES: [u32; 6] = [1, 2, 3, 4, 6, 8];

/// Cells beyond which none are drawn: they would be smaller than a line.
const MOST_CELLS: f64 = 65_536.0;

/// The picture of a scene as SVG; empty if its solution has no value.
pub fn scene_picture(scene: &Scene) -> String {
    match &scene.body {
        Body::Abstract(problem) => over_time(scene, &problem.u).unwrap_or_default(),
        Body::Contact(body) if body.domain.dimension() == 2 => plane(scene, body).svg(),
        Body::Contact(body) => in_space(scene, body).svg(),
    }
}

fn over_time(scene: &Scene, u: &[Node]) -> Option<String> {
    let curve = |(i, &component): (usize, &Node)| {
        let at = |step: u32| {
            let t = scene.time.horizon * f64::from(step) / f64::from(CURVE);
            let at = EvaluationPoint { t, ..EvaluationPoint::default() };
            (t, scene.formulas.evaluate(component, &at))
        };
        Series::new(format!("u_{}", i + 1), vec![Part::Line((0..=CURVE).map(at).collect())])
    };
    let (x, y) = (Axis::new("time t", Scale::Linear), Axis::default());
    let series = u.iter().enumerate().map(curve).collect();
    Chart { series, small: true, ..Chart::new("", "", x, y) }.svg()
}

fn plane(scene: &Scene, body: &ContactScene) -> Sketch {
    let (domain, mut sketch) = (&body.domain, Sketch::default());
    let whole = match &domain.shape {
        Shape::Box => MESHES.iter().find(|n| divides(scene, **n)).map(|&n| domain.mesh(n)),
        Shape::Refined(_) => Some(domain.mesh(1)),
    };
    if let Some(whole) = &whole {
        sketch.areas.extend((0..whole.cell_count()).map(|c| (cell(whole, c), Ink::Thin, 0.15)));
    }
    regions(scene, body, &mut sketch);
    if domain.mesh != MeshFamily::Structured || matches!(domain.shape, Shape::Refined(_)) {
        let fine = if domain.mesh == MeshFamily::Structured { 1 } else { 4 };
        let mesh = if divides(scene, fine) { Some(domain.mesh(fine)) } else { whole };
        sketch.strokes.extend(mesh.iter().flat_map(lines));
    }
    for (ink, _, sides) in parts(body) {
        for face in sides.iter().flat_map(|&side| domain.faces(side)) {
            let flat = |[x, y, _]: [f64; 3]| (x, y);
            let mut path: Vec<(f64, f64)> = face.points(1).into_iter().map(flat).collect();
            let (dx, dy) = (path[1].0 - path[0].0, path[1].1 - path[0].1);
            // Hatches are drawn on the left of a line.
            if -dy * face.normal[0] + dx * face.normal[1] < 0.0 {
                path.reverse();
            }
            sketch.strokes.push(Stroke { ink, path });
        }
    }
    let sides = domain.all_sides().flat_map(|side| domain.faces(side));
    let outline: Vec<Vec<[f64; 3]>> = sides.map(|face| face.points(ALONG)).collect();
    let surfaces = surfaces(body, |face| face.points(CURVE));
    moved(scene, body, (&outline, &surfaces), |[x, y, _]| (x, y), &mut sketch);
    sketch
}

/// Points of a plane piece of a contact side, and its normal.
struct Surface {
    side: Side,
    points: Vec<[f64; 3]>,
    normal: [f64; 3],
}

/// The plane pieces of the contact sides.
fn surfaces(body: &ContactScene, points: impl Fn(&Face) -> Vec<[f64; 3]>) -> Vec<Surface> {
    let of_side = |&side: &Side| body.domain.faces(side).into_iter().map(move |face| (side, face));
    let faces = body.domain.contact.iter().flat_map(of_side);
    faces.map(|(side, face)| Surface { side, points: points(&face), normal: face.normal }).collect()
}

fn divides(scene: &Scene, n: u32) -> bool {
    let few = |body: &ContactScene| body.domain.cells(n) <= MOST_CELLS;
    scene.check_cells(n).is_ok() && scene.as_contact().is_none_or(few)
}

/// Planes of symmetry, Γ2, Γ3, then Γ1, as far as they exist, with their legend.
fn parts(body: &ContactScene) -> impl Iterator<Item = (Ink, &str, &[Side])> {
    let domain = &body.domain;
    let all = [
        (Ink::Symmetry, "symmetry", &domain.symmetry[..]),
        (Ink::Traction, "traction", &domain.traction[..]),
        (Ink::Contact, "contact", &domain.contact[..]),
        (Ink::Clamped, "clamped", &domain.clamped[..]),
    ];
    all.into_iter().filter(|(_, _, sides)| !sides.is_empty())
}

fn cell(mesh: &Mesh, c: usize) -> Vec<(f64, f64)> {
    mesh.cell(c).iter().map(|&v| mesh.vertex(v)).map(|x| (x[0], x[1])).collect()
}

/// The edges of a mesh, each once.
fn lines(mesh: &Mesh) -> Vec<Stroke> {
    let mut edges = BTreeSet::new();
    for corners in (0..mesh.cell_count()).map(|c| mesh.cell(c)) {
        for (a, &p) in corners.iter().enumerate() {
            edges.extend(corners[..a].iter().map(|&q| [p.min(q), p.max(q)]));
        }
    }
    let at = |v: u32| (mesh.vertex(v)[0], mesh.vertex(v)[1]);
    edges.into_iter().map(|[a, b]| Stroke { ink: Ink::Thin, path: vec![at(a), at(b)] }).collect()
}

/// The cells of the regions, on the coarsest mesh whose lines follow them.
fn regions(scene: &Scene, body: &ContactScene, sketch: &mut Sketch) {
    let known = |&n: &u32| {
        let mesh = divides(scene, n).then(|| body.domain.mesh(n))?;
        let of_cells = cell_regions(scene, &body.material, &mesh, n).ok()?;
        Some((mesh, of_cells))
    };
    let Some((mesh, of_cells)) = MESHES.iter().find_map(known) else { return };
    for (index, region) in body.material.regions.iter().enumerate() {
        let inside = of_cells.iter().enumerate().filter(|(_, of)| usize::from(**of) == index + 1);
        let opacity = 0.8 - 0.3 * (index % 2) as f64;
        sketch.areas.extend(inside.map(|(c, _)| (cell(&mesh, c), Ink::Region, opacity)));
        sketch.legend.push((Ink::Region, region.name.chars().take(9).collect()));
    }
}

/// The sides moved by u(T) and the obstacle at distance g from the contact sides, in one scale of one digit, with the
/// legend.
fn moved(
    scene: &Scene,
    body: &ContactScene,
    (lines, surfaces): (&[Vec<[f64; 3]>], &[Surface]),
    flat: impl Fn([f64; 3]) -> (f64, f64),
    sketch: &mut Sketch,
) {
    let entries = parts(body).map(|(ink, name, _)| (ink, name.to_owned()));
    sketch.legend.splice(0..0, entries);
    let extent = body.domain.size.iter().copied().fold(0.0, f64::max);
    let t = scene.time.horizon;
    // Points with their displacement at T; none without an exact solution.
    let mut values: Vec<Vec<([f64; 3], [f64; 3])>> = Vec::new();
    if let Data::Exact { u, .. } = &body.data {
        let program = Program::compile(&scene.formulas, u, t);
        values.extend(lines.iter().map(|line| {
            let out = program.bind(line).values_at(t, 0.0);
            let at = |p: usize| [0, 1, 2].map(|i| out.get(i).map_or(0.0, |component| component[p]));
            line.iter().enumerate().map(|(p, &x)| (x, at(p))).collect()
        }));
    }
    let farthest = largest(values.iter().flatten().flat_map(|(_, u)| u.iter().copied()));
    // None on a side without a gap.
    let along = |surface: &Surface| {
        let gap = body.contact_on(surface.side).and_then(|contact| contact.gap)?;
        let at = |&x: &[f64; 3]| EvaluationPoint { t, ..x.into() };
        Some(surface.points.iter().map(|x| scene.formulas.evaluate(gap, &at(x))).collect())
    };
    let gaps: Vec<Option<Vec<f64>>> = surfaces.iter().map(along).collect();
    let widest = largest(gaps.iter().flatten().flatten().copied());
    let seen = |size: f64| size > 1e-12 * extent;
    // Whichever is drawn larger stays beside the body.
    let reaches =
        [(farthest, REACH), (widest, GAP_REACH)].into_iter().filter(|reach| seen(reach.0));
    let factor = reaches.map(|(size, reach)| reach * extent / size).fold(f64::INFINITY, f64::min);
    if !factor.is_finite() {
        return;
    }
    // Rounded down to one digit; the quotient avoids 0.30000000000000004.
    let decade = 10f64.powf(factor.log10().floor());
    let digit = (factor / decade).floor();
    let factor = if decade < 1.0 { digit / (1.0 / decade).round() } else { digit * decade };
    let mut draw = |ink: Ink, line: Vec<([f64; 3], [f64; 3])>| {
        let shifted = |(x, u): ([f64; 3], [f64; 3])| flat([0, 1, 2].map(|i| x[i] + factor * u[i]));
        let path: Vec<(f64, f64)> = line.into_iter().map(shifted).collect();
        if path.iter().all(|(x, y)| x.is_finite() && y.is_finite()) {
            sketch.strokes.push(Stroke { ink, path });
        }
    };
    for (Surface { points, normal, .. }, gaps) in surfaces.iter().zip(&gaps) {
        let Some(gaps) = gaps else { continue };
        let ends = points.iter().zip(gaps).map(|(&x, &g)| (x, normal.map(|n| g * n)));
        draw(Ink::Obstacle, ends.collect());
    }
    if seen(farthest) {
        values.into_iter().for_each(|line| draw(Ink::Moved, line));
        sketch.legend.push((Ink::Moved, format!("u(T) × {factor}")));
    }
    if body.has_gap() {
        let when = if body.gap_moves(&scene.formulas) { "(T)" } else { "" };
        sketch.legend.push((Ink::Obstacle, format!("gap g{when} × {factor}")));
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).filter(|size| size.is_finite()).fold(0.0, f64::max)
}

/// The corners of a plane piece in space, in order.
fn corners(face: &Face) -> Vec<[f64; 3]> {
    let mut corners = face.points(1);
    if let ([_, _, _, _], false) = (&corners[..], face.triangle) {
        corners.swap(2, 3);
    }
    corners
}

// A body in space seen from the left and slightly above: faces tinted by condition, edges where planes or conditions
// meet.

/// Unit vectors to the right and up in the picture, and towards the eye: 35° around the vertical axis, 20° above.
const RIGHT: [f64; 3] = [0.819152, 0.0, 0.573576];
const UP: [f64; 3] = [0.196175, 0.939693, -0.280166];
const EYE: [f64; 3] = [-0.538985, 0.342020, 0.769751];

/// Tolerance for equal normals and positions.
const SAME: f64 = 1e-6;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn flat(x: [f64; 3]) -> (f64, f64) {
    (dot(x, RIGHT), dot(x, UP))
}

/// A plane piece at an edge: its normal and condition.
type Beside = ([f64; 3], Ink);

/// The ends of an edge with the pieces that meet there.
type Edge = ([[f64; 3]; 2], Vec<Beside>);

fn in_space(scene: &Scene, body: &ContactScene) -> Sketch {
    let mut sketch = Sketch::default();
    let extent = body.domain.size.iter().copied().fold(0.0, f64::max);
    let key = |x: [f64; 3]| x.map(|x| (x / (SAME * extent)).round() as i64);
    let mut edges: BTreeMap<[[i64; 3]; 2], Edge> = BTreeMap::new();
    for (ink, _, sides) in parts(body) {
        for face in sides.iter().flat_map(|&side| body.domain.faces(side)) {
            let (corners, normal) = (corners(&face), face.normal);
            let opacity = if ink == Ink::Traction { 0.07 } else { 0.35 };
            sketch.areas.push((corners.iter().map(|&x| flat(x)).collect(), ink, opacity));
            for (i, &p) in corners.iter().enumerate() {
                let q = corners[(i + 1) % corners.len()];
                let mut ends = [key(p), key(q)];
                ends.sort_unstable();
                edges.entry(ends).or_insert(([p, q], Vec::new())).1.push((normal, ink));
            }
        }
    }
    let mut outline = Vec::new();
    let imported = matches!(body.domain.shape, Shape::Refined(_));
    for ([p, q], beside) in edges.into_values() {
        let (first, others) = (beside[0], &beside[1..]);
        let flat_there = |other: &Beside| {
            let apart: f64 = first.0.iter().zip(other.0).map(|(a, b)| (a - b).abs()).sum();
            apart < SAME && first.1 == other.1
        };
        let crease = !others.iter().all(flat_there);
        let seen = beside.iter().any(|(normal, _)| dot(*normal, EYE) > 0.0);
        // Flat edges are drawn where the eye sees them on a mesh from a file.
        if !(crease || seen && imported) {
            continue;
        }
        let ink = if seen && crease { Ink::Edge } else { Ink::Thin };
        sketch.strokes.push(Stroke { ink, path: vec![flat(p), flat(q)] });
        if seen && crease {
            let at = |i: u32| {
                let s = f64::from(i) / f64::from(ALONG);
                [0, 1, 2].map(|a| (1.0 - s) * p[a] + s * q[a])
            };
            outline.push((0..=ALONG).map(at).collect());
        }
    }
    let surfaces = surfaces(body, |face| {
        let corners = corners(face);
        [&corners[..], &corners[..1]].concat()
    });
    moved(scene, body, (&outline, &surfaces), flat, &mut sketch);
    sketch
}
