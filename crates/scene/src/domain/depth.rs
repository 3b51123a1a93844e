//! Extent of the body along the normal of a plane side.

use fem::mesh::{CoarseMesh, Piece};

/// Shorter lengths, relative to the side, are rounding.
const ROUNDING: f64 = 1e-9;

/// The longest normal line from the side within the body, if the side is one straight line and all these lines end on
/// sides accepted by `clamped`.
///
/// Between the feet of the other vertices the first edge met is constant, and the length affine: one line in the middle
/// gives the edge, those at both ends the lengths.
pub(super) fn under(coarse: &CoarseMesh, side: u32, clamped: impl Fn(u32) -> bool) -> Option<f64> {
    let all = coarse.pieces();
    let edges: Vec<&Piece> = all.iter().filter(|edge| edge.side == side).collect();
    let Piece { corners: first, normal: [x, y, _], .. } = edges.first()?;
    let (normal, along) = ([*x, *y], [-y, *x]);
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    // Position along the side and height into the body.
    let local = |p: [f64; 3]| {
        let away = [p[0] - first[0][0], p[1] - first[0][1]];
        [dot(away, along), -dot(away, normal)]
    };
    let ends = |edge: &Piece| [0, 1].map(|end| local(edge.corners[end]));
    let length = coarse.longest_edge();
    let mut deepest = 0.0f64;
    for edge in edges {
        let [p, q] = ends(edge);
        if [p, q].iter().any(|end| end[1].abs() > ROUNDING * length) {
            return None;
        }
        let (from, to) = (p[0].min(q[0]), p[0].max(q[0]));
        let mut cuts: Vec<f64> = coarse.vertices.iter().map(|v| local(*v)[0]).collect();
        cuts.retain(|cut| *cut > from && *cut < to);
        cuts.extend([from, to]);
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2).filter(|pair| pair[1] - pair[0] > ROUNDING * length) {
            let height = |edge: &Piece, s: f64| {
                let [p, q] = ends(edge);
                p[1] + (s - p[0]) / (q[0] - p[0]) * (q[1] - p[1])
            };
            let middle = 0.5 * (pair[0] + pair[1]);
            let crosses = |edge: &&Piece| {
                let [p, q] = ends(edge);
                (p[0] < middle) != (q[0] < middle) && height(edge, middle) > ROUNDING * length
            };
            let nearest = all
                .iter()
                .filter(crosses)
                .min_by(|a, b| height(a, middle).total_cmp(&height(b, middle)))?;
            if !clamped(nearest.side) {
                return None;
            }
            deepest = deepest.max(height(nearest, pair[0])).max(height(nearest, pair[1]));
        }
    }
    Some(deepest)
}

#[cfg(test)]
mod tests {
    use super::under;
    use fem::mesh::{CoarseMesh, triangulate};

    fn polygon(vertices: &[[f64; 2]]) -> CoarseMesh {
        let sides: Vec<u32> = (0..vertices.len() as u32).collect();
        let names = sides.iter().map(u32::to_string).collect();
        CoarseMesh::polygon(vertices, &triangulate(vertices).unwrap(), &sides, names).unwrap()
    }

    #[test]
    fn depths_of_known_shapes() {
        let turn = |[x, y]: [f64; 2]| [0.6 * x - 0.8 * y + 2.0, 0.8 * x + 0.6 * y];
        let trapezium = [[0.0, 0.0], [2.0, 0.0], [1.5, 1.0], [0.5, 0.8]].map(turn);
        // The lines from the bottom end on the right, top and left edges: the deepest at (1.5, 1).
        let depth = under(&polygon(&trapezium), 0, |_| true).unwrap();
        assert!((depth - 1.0).abs() < 1e-12, "{depth}");
        assert_eq!(under(&polygon(&trapezium), 0, |side| side == 2), None);
        // From the top down all lines end on the bottom.
        assert!(under(&polygon(&trapezium), 2, |side| side == 0).is_some());
        let notch = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.0, 2.0], [2.0, 0.5], [1.0, 0.5]];
        let notch: Vec<[f64; 2]> =
            notch.into_iter().chain([[1.0, 2.0], [0.0, 2.0]]).map(turn).collect();
        let depth = under(&polygon(&notch), 0, |_| true).unwrap();
        assert!((depth - 2.0).abs() < 1e-12, "{depth}");
        // From the left wall of the notch, lines run to the left side.
        let depth = under(&polygon(&notch), 5, |side| side == 7).unwrap();
        assert!((depth - 1.0).abs() < 1e-12, "{depth}");
    }
}
