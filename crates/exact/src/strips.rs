//! Quadrature over a polygon or a box in strips: Gauss points along x between its corners and cuts, and on the chords along y.
//!
//! All chords of a strip have their points at few abscissae, as on a rectangle: what depends on x alone, as memories of
//! contact scenes do, is evaluated there. Fields that are smooth between the cuts are integrated to rounding.

use fem::mesh::{CoarseMesh, Piece};
use fem::space::quadrature::gauss_legendre;

/// Gauss points per piece, and minimum of pieces of the width and of the height, in the plane and in space. A quarter of
/// the domain with 14 points resolves sin(4πx) squared to rounding, half of it with 8 points sin(πx) squared.
const PLANE: (usize, f64) = (14, 3.0);
const SPACE: (usize, f64) = (8, 2.0);
/// Gauss points per piece narrower than this share of the domain.
const FEWER: usize = 7;
const NARROW: f64 = 1.0 / 12.0;
/// Places closer than this share of the width are equal.
const APART: f64 = 1e-13;

pub(super) struct Strips {
    sides: Vec<[[f64; 2]; 2]>,
    /// Smallest and largest coordinates.
    pub(super) bounds: [[f64; 2]; 2],
    rule: (usize, f64),
    /// Places along z and their weights.
    deep: Vec<(f64, f64)>,
}

impl Strips {
    /// Strips of a polygon; `finer` takes pieces of half the size.
    pub(crate) fn new(coarse: &CoarseMesh, finer: bool) -> Self {
        let plane = |[x, y, _]: [f64; 3]| [x, y];
        let side = |piece: Piece| [0, 1].map(|end| plane(piece.corners[end]));
        let sides = coarse.pieces().into_iter().map(side).collect();
        let (points, parts) = PLANE;
        let parts = if finer { 2.0 * parts } else { parts };
        Self {
            sides,
            bounds: coarse.bounds().map(plane),
            rule: (points, parts),
            deep: vec![(0.0, 1.0)],
        }
    }

    /// Strips of a rectangle or box from the origin; if nothing varies along z, one plane suffices.
    pub(crate) fn of_box(size: &[f64], along_z: bool) -> Self {
        let [low, high] = [[0.0, 0.0], [size[0], size[1]]];
        let corners = [low, [high[0], 0.0], high, [0.0, high[1]]];
        let sides = (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).collect();
        let rule = if size.len() == 2 { PLANE } else { SPACE };
        let mut strips = Self { sides, bounds: [low, high], rule, deep: vec![(0.0, 1.0)] };
        if let Some(&depth) = size.get(2) {
            let whole = [0.0, depth];
            strips.deep = match along_z {
                true => strips.pieces(whole.to_vec(), whole),
                false => vec![(0.5 * depth, depth)],
            };
        }
        strips
    }

    /// The ends of the sides, at z = 0.
    pub(crate) fn corners(&self) -> Vec<[f64; 3]> {
        self.sides.iter().map(|[[x, y], _]| [*x, *y, 0.0]).collect()
    }

    /// Points and weights, cut where x or y has one of some values.
    pub(crate) fn points(&self, xs: &[f64], ys: &[f64]) -> (Vec<[f64; 3]>, Vec<f64>) {
        let [low, high] = self.bounds;
        let corners = self.sides.iter().flatten().map(|corner| corner[0]);
        // A chord gains or loses a piece where a side crosses a cut.
        let crossings = self
            .sides
            .iter()
            .flat_map(|side| ys.iter().filter_map(|&y| crossing(side.map(|[x, y]| [y, x]), y)));
        let edges: Vec<f64> = corners.chain(crossings).chain(xs.iter().copied()).collect();
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for (x, along) in self.pieces(edges, [low[0], high[0]]) {
            let mut chords: Vec<f64> =
                self.sides.iter().filter_map(|&side| crossing(side, x)).collect();
            chords.sort_by(f64::total_cmp);
            for chord in chords.chunks_exact(2) {
                let inside = ys.iter().copied().filter(|&y| chord[0] < y && y < chord[1]);
                let edges = chord.iter().copied().chain(inside).collect();
                for (y, across) in self.pieces(edges, [low[1], high[1]]) {
                    for &(z, down) in &self.deep {
                        points.push([x, y, z]);
                        weights.push(along * across * down);
                    }
                }
            }
        }
        (points, weights)
    }

    /// Gauss points and weights between edges, with pieces in proportion to their share of the whole.
    fn pieces(&self, mut edges: Vec<f64>, [low, high]: [f64; 2]) -> Vec<(f64, f64)> {
        let whole = high - low;
        edges.retain(|&edge| (low..=high).contains(&edge));
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|a, b| (*a - *b).abs() <= APART * whole);
        let mut out = Vec::new();
        for pair in edges.windows(2) {
            let length = pair[1] - pair[0];
            // Rounding must not add a piece.
            let (most, parts) = self.rule;
            let count = (parts * length / whole - 1e-9).ceil().max(1.0) as usize;
            let rule = gauss_legendre(if length < NARROW * whole { FEWER } else { most });
            let half = 0.5 * length / count as f64;
            for piece in 0..count {
                let middle = pair[0] + half * (2 * piece + 1) as f64;
                out.extend(rule.iter().map(|(x, w)| (middle + half * x, half * w)));
            }
        }
        out
    }
}

/// y where a side is at x, strictly inside.
fn crossing([p, q]: [[f64; 2]; 2], x: f64) -> Option<f64> {
    let inside = p[0].min(q[0]) < x && x < p[0].max(q[0]);
    inside.then(|| p[1] + (q[1] - p[1]) * ((x - p[0]) / (q[0] - p[0])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::mesh::triangulate;

    /// A downward arrow, whose chords come in pairs, against closed forms.
    #[test]
    fn chords_fill_a_polygon_that_is_not_convex() {
        let arrow = [[0.0, 0.0], [2.0, 3.0], [0.0, 1.0], [-2.0, 3.0]];
        let strips = strips(&arrow);
        let (points, weights) = strips.points(&[0.3], &[1.7]);
        let integral = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
            points.iter().zip(&weights).map(|(p, w)| w * f(p[0], p[1])).sum()
        };
        // Chords from 3x/2 to 1 + x, x from 0 to 2, and their mirror image.
        assert!((integral(&|_, _| 1.0) - 2.0).abs() < 1e-13);
        assert!((integral(&|x, _| x * x) - 2.0 * (8.0 / 3.0 - 2.0)).abs() < 1e-13);
        let kink = |x: f64| (x - 0.3).max(0.0);
        // ∫ (x - 0.3)(1 - x/2) from 0.3 to 2: of (s)(1.7 - s)/2 up to 1.7.
        assert!((integral(&|x, _| kink(x)) - 1.7f64.powi(3) / 12.0).abs() < 1e-13);
        // Above y = 1.7, on one side: from x = 0.7 to 2, ∫ (1 + x - max(1.7, 3x/2)).
        let to = 1.7 / 1.5;
        let above = 0.5 * (to - 0.7f64).powi(2) + 0.25 * (2.0 - to).powi(2);
        let found = integral(&|_, y| f64::from(u8::from(y > 1.7)));
        assert!((found - 2.0 * above).abs() < 1e-13, "{found}");
    }

    fn strips(corners: &[[f64; 2]]) -> Strips {
        let triangles = triangulate(corners).unwrap();
        let sides: Vec<u32> = (0..corners.len() as u32).collect();
        let names = sides.iter().map(u32::to_string).collect();
        let coarse = CoarseMesh::polygon(corners, &triangles, &sides, names).unwrap();
        Strips::new(&coarse, false)
    }
}
