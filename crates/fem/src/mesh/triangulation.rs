//! A triangulation of a simple polygon without further vertices: ears are cut, then edges flipped until
//! the triangulation is Delaunay's.
//!
//! Comparisons have a tolerance and fall back on the order of the vertices, so that a turned polygon has
//! the turned triangulation. Cost: O(m³) for m vertices.
//!
//! Sources: G. H. Meisters, Amer. Math. Monthly 82 (1975), for ears; C. L. Lawson (1977), for flips.

/// Why vertices make no polygon; edges and vertices count from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PolygonError {
    /// Fewer than three vertices.
    #[error("a polygon has three vertices or more, not {count}")]
    TooFew { count: usize },
    /// Vertices at one place.
    #[error("vertices {first} and {second} are the same point ({}, {})", place[0], place[1])]
    Repeated { first: usize, second: usize, place: [f64; 2] },
    #[error(
        "the edges from vertex {first} and from vertex {second} meet: the polygon crosses or touches itself"
    )]
    Crossing { first: usize, second: usize },
    /// A negative area.
    #[error("the vertices run clockwise (area {area})")]
    Clockwise { area: f64 },
    /// A boundary too thin to be triangulated in floating point.
    #[error("no triangulation is found: the polygon is too thin near vertex {vertex}")]
    TooThin { vertex: usize },
}

/// Lengths below this part of the polygon's extent are rounding.
const ROUNDING: f64 = 1e-12;
/// Cosines that differ by less are equal: of two diagonals of a rectangle, the first found stays.
const TIE: f64 = 1e-9;

/// The triangles of the polygon with these vertices, counter-clockwise.
///
/// # Errors
/// [`PolygonError`].
pub fn triangulate(vertices: &[[f64; 2]]) -> Result<Vec<[u32; 3]>, PolygonError> {
    simple(vertices)?;
    let area = double_area(vertices);
    if area < 0.0 {
        return Err(PolygonError::Clockwise { area: 0.5 * area });
    }
    let mut triangles = cut_ears(vertices)?;
    flip(vertices, &mut triangles);
    Ok(triangles)
}

fn double_area(vertices: &[[f64; 2]]) -> f64 {
    let origin = vertices[0];
    vertices.windows(2).map(|pair| cross(origin, pair[0], pair[1])).sum()
}

/// (b - a) × (c - a).
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

fn extent(vertices: &[[f64; 2]]) -> f64 {
    vertices.iter().map(|v| distance(vertices[0], *v)).fold(0.0, f64::max)
}

/// Refuses repeated vertices and edges that meet elsewhere than at a common vertex.
fn simple(vertices: &[[f64; 2]]) -> Result<(), PolygonError> {
    let count = vertices.len();
    if count < 3 {
        return Err(PolygonError::TooFew { count });
    }
    let close = ROUNDING * extent(vertices);
    for second in 0..count {
        for first in 0..second {
            let apart = distance(vertices[first], vertices[second]);
            if apart.is_nan() || apart <= close {
                return Err(PolygonError::Repeated { first, second, place: vertices[first] });
            }
        }
    }
    for second in 0..count {
        for first in 0..second {
            let [p, q] = [vertices[first], vertices[first + 1]];
            let [r, s] = [vertices[second], vertices[(second + 1) % count]];
            let adjacent = first + 1 == second || (second + 1) % count == first;
            let meet = if adjacent {
                // They share a vertex; the far ends must not lie on the other edge.
                let (shared, a, b) = if first + 1 == second { (q, p, s) } else { (p, q, r) };
                let back = distance_to(a, shared, b).min(distance_to(b, shared, a));
                back <= close
            } else {
                let apart = [
                    distance_to(p, r, s),
                    distance_to(q, r, s),
                    distance_to(r, p, q),
                    distance_to(s, p, q),
                ];
                let touch = apart.into_iter().fold(f64::INFINITY, f64::min) <= close;
                let sides = |a, b, c, d| cross(a, b, c) * cross(a, b, d) < 0.0;
                touch || (sides(p, q, r, s) && sides(r, s, p, q))
            };
            if meet {
                return Err(PolygonError::Crossing { first, second });
            }
        }
    }
    Ok(())
}

fn distance_to(point: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let squared = (b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2);
    let along = (point[0] - a[0]) * (b[0] - a[0]) + (point[1] - a[1]) * (b[1] - a[1]);
    let s = (along / squared).clamp(0.0, 1.0);
    distance(point, [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])])
}

/// Cuts the ear with the largest smallest angle, again and again.
fn cut_ears(vertices: &[[f64; 2]]) -> Result<Vec<[u32; 3]>, PolygonError> {
    let at = |v: u32| vertices[v as usize];
    let flat = ROUNDING * extent(vertices);
    let mut left: Vec<u32> = (0..vertices.len() as u32).collect();
    let mut triangles = Vec::with_capacity(left.len() - 2);
    while left.len() > 3 {
        let count = left.len();
        let mut best: Option<(f64, usize)> = None;
        for i in 0..count {
            let ear = [left[(i + count - 1) % count], left[i], left[(i + 1) % count]];
            let [a, b, c] = ear.map(at);
            let inside = |v: &&u32| !ear.contains(v) && contains([a, b, c], at(**v), flat);
            if cross(a, b, c) <= flat * distance(a, c) || left.iter().any(|v| inside(&v)) {
                continue;
            }
            let sharpest = sharpest_cosine([a, b, c]);
            if best.is_none_or(|(known, _)| sharpest < known - TIE) {
                best = Some((sharpest, i));
            }
        }
        let Some((_, i)) = best else {
            return Err(PolygonError::TooThin { vertex: left[0] as usize });
        };
        triangles.push([left[(i + count - 1) % count], left[i], left[(i + 1) % count]]);
        left.remove(i);
    }
    let last = [left[0], left[1], left[2]];
    let [a, b, c] = last.map(at);
    if cross(a, b, c) <= flat * distance(a, c) {
        return Err(PolygonError::TooThin { vertex: left[0] as usize });
    }
    triangles.push(last);
    Ok(triangles)
}

/// True in the closed triangle, widened by `slack`.
fn contains([a, b, c]: [[f64; 2]; 3], p: [f64; 2], slack: f64) -> bool {
    [(a, b), (b, c), (c, a)].iter().all(|&(p0, p1)| cross(p0, p1, p) >= -slack * distance(p0, p1))
}

/// The cosine of the smallest angle.
fn sharpest_cosine(corners: [[f64; 2]; 3]) -> f64 {
    let angle = |i: usize| cosine(corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
    (0..3).map(angle).fold(-1.0, f64::max)
}

/// The cosine of the angle at `a` between `b` and `c`.
fn cosine(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let dot = (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]);
    dot / (distance(a, b) * distance(a, c))
}

/// Flips inner edges while the angles opposite to one sum to more than 180°.
fn flip(vertices: &[[f64; 2]], triangles: &mut [[u32; 3]]) {
    while let Some((s, t, [a, b, c, d])) = illegal(vertices, triangles) {
        // The edge ab, with c and d opposite, becomes cd.
        triangles[s] = [a, d, c];
        triangles[t] = [d, b, c];
    }
}

/// The first inner edge ab that is not Delaunay's, with its triangles and the vertices a, b, c, d: c in the
/// first triangle, d in the second. Each flip enlarges the sum of cotangents' defect by more than
/// [`TIE`], so there is an end.
fn illegal(vertices: &[[f64; 2]], triangles: &[[u32; 3]]) -> Option<(usize, usize, [u32; 4])> {
    let at = |v: u32| vertices[v as usize];
    for s in 0..triangles.len() {
        for i in 0..3 {
            let (a, b, c) = (triangles[s][i], triangles[s][(i + 1) % 3], triangles[s][(i + 2) % 3]);
            for t in s + 1..triangles.len() {
                let Some(j) = (0..3).find(|&j| triangles[t][j] == b) else { continue };
                if triangles[t][(j + 1) % 3] != a {
                    continue;
                }
                let d = triangles[t][(j + 2) % 3];
                // sin(γ + δ) < 0 for the angles γ at c and δ at d.
                let (cos_c, cos_d) = (cosine(at(c), at(a), at(b)), cosine(at(d), at(b), at(a)));
                let sine = |p: u32, q: u32, r: u32| {
                    cross(at(p), at(q), at(r)) / (distance(at(p), at(q)) * distance(at(p), at(r)))
                };
                let sum = sine(c, a, b) * cos_d + cos_c * sine(d, b, a);
                if sum < -TIE {
                    return Some((s, t, [a, b, c, d]));
                }
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const L_SHAPE: [[f64; 2]; 6] =
        [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

    fn area(vertices: &[[f64; 2]], triangles: &[[u32; 3]]) -> f64 {
        let one = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| vertices[v as usize]);
            assert!(cross(a, b, c) > 0.0);
            0.5 * cross(a, b, c)
        };
        triangles.iter().map(one).sum()
    }

    fn turned(vertices: &[[f64; 2]], angle: f64) -> Vec<[f64; 2]> {
        let (s, c) = angle.sin_cos();
        vertices.iter().map(|[x, y]| [c * x - s * y + 0.3, s * x + c * y - 7.0]).collect()
    }

    #[test]
    fn polygons_are_tiled_and_turn_with_their_triangles() {
        let comb: Vec<[f64; 2]> = (0..9)
            .map(|i| [8.0 - f64::from(i), if i % 2 == 0 { 3.0 } else { 0.5 }])
            .chain([[0.0, 0.0], [4.0, 0.0], [8.0, 0.0]])
            .collect();
        let rectangle = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        for (vertices, expected) in
            [(L_SHAPE.to_vec(), 3.0), (rectangle.to_vec(), 2.0), (comb.clone(), 14.0)]
        {
            let triangles = triangulate(&vertices).unwrap();
            assert_eq!(triangles.len(), vertices.len() - 2);
            assert!((area(&vertices, &triangles) - expected).abs() < 1e-13, "{triangles:?}");
            for angle in [0.3, 1.0, -2.2, std::f64::consts::FRAC_PI_4, 3.0] {
                assert_eq!(triangulate(&turned(&vertices, angle)).unwrap(), triangles);
            }
        }
    }

    /// Of the two diagonals of this quadrilateral Delaunay's is the short one, and cutting the ear with the
    /// best angles first finds the long one.
    #[test]
    fn edges_are_flipped_to_delaunay() {
        let kite = [[0.0, 0.0], [3.0, -1.0], [6.0, 0.0], [3.0, 1.0]];
        let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
        flip(&kite, &mut triangles);
        assert!(triangles.iter().all(|t| t.contains(&1) && t.contains(&3)), "{triangles:?}");
        area(&kite, &triangles);
        // Nothing to win on a square: no endless exchange of its diagonals.
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
        flip(&square, &mut triangles);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_vertex_may_sit_on_a_straight_side() {
        let vertices = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        assert!((area(&vertices, &triangulate(&vertices).unwrap()) - 4.0).abs() < 1e-14);
    }

    #[test]
    fn what_is_no_polygon_is_refused() {
        let text = |vertices: &[[f64; 2]]| triangulate(vertices).unwrap_err().to_string();
        let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(text(&[a, b]).contains("three vertices"));
        assert!(text(&[a, b, c, a, d]).contains("vertices 0 and 3 are the same point (0, 0)"));
        assert!(text(&[a, b, d, c]).contains("edges from vertex 1 and from vertex 3 meet"));
        assert!(text(&[a, d, c, b]).contains("clockwise (area -1)"));
        assert!(text(&[a, b, c, [1.0, 0.5]]).contains("meet"), "{}", text(&[a, b, c, [1.0, 0.5]]));
        assert!(text(&[a, [2.0, 0.0], [2.0, 2.0], b, [0.0, 2.0]]).contains("meet"));
        assert!(text(&[a, b, [f64::NAN, 0.0]]).contains("same point"));
        assert!(text(&[a, b, [2.0, 0.0]]).contains("meet"));
    }
}
