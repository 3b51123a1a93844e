//! A body in space seen from the left and slightly above: faces tinted by condition, edges where planes or conditions
//! meet.

use std::collections::BTreeMap;

use super::{ALONG, Surface, is_imported, moved, parts, polygons};
use report::{Ink, Sketch, Stroke};
use scene::{ContactScene, Scene};

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

/// A plane piece by its corners, the first repeated at the end.
fn closed((mut corners, normal): Surface) -> Surface {
    corners.extend(corners.first().copied());
    (corners, normal)
}

pub(super) fn sketch(scene: &Scene, body: &ContactScene) -> Sketch {
    let mut sketch = Sketch::default();
    let extent = body.domain.size.iter().copied().fold(0.0, f64::max);
    let key = |x: [f64; 3]| x.map(|x| (x / (SAME * extent)).round() as i64);
    let mut edges: BTreeMap<[[i64; 3]; 2], Edge> = BTreeMap::new();
    for (ink, _, sides) in parts(body) {
        for (corners, normal) in sides.iter().flat_map(|&side| polygons(body, side)) {
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
    for ([p, q], beside) in edges.into_values() {
        let (first, others) = (beside[0], &beside[1..]);
        let flat_there = |other: &Beside| {
            let apart: f64 = first.0.iter().zip(other.0).map(|(a, b)| (a - b).abs()).sum();
            apart < SAME && first.1 == other.1
        };
        let crease = !others.iter().all(flat_there);
        if !crease && !is_imported(body) {
            continue;
        }
        let seen = beside.iter().any(|(normal, _)| dot(*normal, EYE) > 0.0);
        if !crease && !seen {
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
    let contact = body.domain.contact.iter().flat_map(|&side| polygons(body, side));
    let surfaces: Vec<Surface> = contact.map(closed).collect();
    moved(scene, body, (&outline, &surfaces), flat, &mut sketch);
    sketch
}
